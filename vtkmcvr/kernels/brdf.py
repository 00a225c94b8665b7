"""Surface scattering: when it happens, and the Fresnel blend of Ashikhmin and Shirley.

Exposure Render (2012), Eq. 1-3 in their corrected form, and its references 35 and 36. The published
source of Exposure Render adds a coat to a full Lambert term, which reflects up to twice the light
that arrives; this is the energy-conserving blend that the paper names.
"""

import math

import numpy as np

from .grid import gradient
from .jit import device
from .rng import stratified, stratified_pair
from .transfer import opacity
from .vec import BLACK, add, dot, from_basis, orthonormal_basis, scale, sub
from .warp import INVERSE_PI, TWO_PI, cosine_hemisphere

f32 = np.float32
ZERO, HALF, ONE, TWO, FOUR = f32(0.0), f32(0.5), f32(1.0), f32(2.0), f32(4.0)
FIVE, TEN = f32(5.0), f32(10.0)
BLEND = f32(28.0 / (23.0 * math.pi))
INVERSE_2PI = f32(0.5 / math.pi)
NO_NORMAL = (ZERO, ZERO, ZERO)


@device
def surface_probability(surface, alpha, magnitude):
    """P_brdf = alpha (1 - exp(-25 g^3 |grad tau_n|)), Exposure Render Eq. 1 corrected."""
    return alpha * -math.expm1(-surface.exponent_scale * min(magnitude * surface.per_gradient, ONE))


@device
def surface_event(surface, medium, transfer, p, scalar, wo, rng):
    """Decide whether the collision at index position p scatters by the BRDF.

    Returns (True or False, normal, rng); the normal is on the side of wo. No gradient is fetched
    where the bound P_brdf <= alpha (1 - exp(-25 g^3)) already says no (HC-20); none exists without
    `surface`.
    """
    if surface is None:
        return False, NO_NORMAL, rng
    xi = ZERO
    alpha = ONE
    if not surface.always:
        rng, xi = stratified(rng)
        alpha = opacity(transfer, surface.opacity, scalar)
        if xi >= -alpha * math.expm1(-surface.exponent_scale):
            return False, NO_NORMAL, rng
    g = gradient(medium.values, surface.world_from_index_gradient, p)
    magnitude = math.sqrt(dot(g, g))
    # Without a gradient there is no normal: the phase function takes over (HC-17); also for NaN
    if not magnitude > ZERO:
        return False, NO_NORMAL, rng
    if not surface.always and xi >= surface_probability(surface, alpha, magnitude):
        return False, NO_NORMAL, rng
    toward = -ONE if dot(g, wo) < ZERO else ONE
    return True, scale(g, toward / magnitude), rng


@device
def blinn(gloss, n, h):
    """(n.h)^e, accurate next to 1 where large exponents live."""
    apart = sub(n, h)
    return math.exp(gloss.exponent * math.log1p(-min(HALF * dot(apart, apart), ONE)))


@device
def schlick(specular, cosine):
    """Fresnel reflectance by Schlick's approximation."""
    x = (ONE - cosine) ** 5
    return (
        specular[0] + (ONE - specular[0]) * x,
        specular[1] + (ONE - specular[1]) * x,
        specular[2] + (ONE - specular[2]) * x,
    )


@device
def half_vector(wo, wi):
    """Unit vector between wo and wi, and the cosine of its angle to both.

    The cosine is half the length of wo + wi, which stays precise where they are nearly
    opposite.
    """
    s = add(wo, wi)
    length = math.sqrt(dot(s, s))
    if not length > ZERO:
        return s, ZERO
    return scale(s, ONE / length), HALF * length


@device
def grazing(x):
    """1 - (1 - x)^5 without cancellation at small x, that is at grazing angles."""
    return x * (FIVE + x * (-TEN + x * (TEN + x * (-FIVE + x))))


@device
def brdf_value(gloss, diffuse, n, wo, wi):
    """f_r(wo, wi) times the cosine of wi, RGB per steradian; zero below the surface."""
    cos_o = dot(n, wo)
    cos_i = dot(n, wi)
    if cos_o <= ZERO or cos_i <= ZERO:
        return BLACK
    if gloss is None:
        return scale(diffuse, INVERSE_PI * cos_i)
    body = BLEND * grazing(HALF * cos_i) * grazing(HALF * cos_o)
    rs = gloss.specular
    under = (diffuse[0] * (ONE - rs[0]), diffuse[1] * (ONE - rs[1]), diffuse[2] * (ONE - rs[2]))
    f = scale(under, body)
    h, cos_h = half_vector(wo, wi)
    if cos_h > ZERO:
        d = (gloss.exponent + TWO) * INVERSE_2PI * blinn(gloss, n, h)
        f = add(f, scale(schlick(rs, cos_h), d / (FOUR * cos_h * max(cos_i, cos_o))))
    return scale(f, cos_i)


@device
def brdf_pdf(gloss, n, wo, wi):
    """Density of `sample_brdf` per steradian: the mean of both lobes' (HC-31)."""
    cos_i = dot(n, wi)
    if cos_i <= ZERO or dot(n, wo) <= ZERO:
        return ZERO
    if gloss is None:
        return cos_i * INVERSE_PI
    h, cos_h = half_vector(wo, wi)
    if cos_h <= ZERO:
        return HALF * cos_i * INVERSE_PI
    lobe = (gloss.exponent + ONE) * INVERSE_2PI * blinn(gloss, n, h) / (FOUR * cos_h)
    return HALF * (cos_i * INVERSE_PI + lobe)


@device
def sample_brdf(gloss, n, wo, rng):
    """Direction with density `brdf_pdf`; below the surface both value and density are 0.

    Returns (wi, rng).
    """
    s, t = orthonormal_basis(n)
    rng, u, v = stratified_pair(rng)
    if gloss is None:
        return from_basis(s, t, n, cosine_hemisphere(u, v)), rng
    rng, lobe = stratified(rng)
    if lobe < HALF:
        return from_basis(s, t, n, cosine_hemisphere(u, v)), rng
    cosine = (ONE - u) ** (ONE / (gloss.exponent + ONE))
    sine = math.sqrt(max(ZERO, ONE - cosine * cosine))
    phi = TWO_PI * v
    h = from_basis(s, t, n, (sine * math.cos(phi), sine * math.sin(phi), cosine))
    return sub(scale(h, TWO * dot(wo, h)), wo), rng
