"""Surface scattering: when it happens, and the Fresnel blend of Ashikhmin and Shirley.

Exposure Render (2012), Eq. 1-3 in their corrected form, and its references 35 and 36. The published
source of Exposure Render adds a coat to a full Lambert term, which reflects up to twice the light
that arrives; this is the energy-conserving blend that the paper names.
"""

import math

import numpy as np

from .cut_faces import cut_face
from .elementary import decay, logarithm_of_rest, on_circle, opacity
from .grid import INFINITE, gradient
from .jit import device, glue
from .rng import stratified, stratified_pair
from .vec import BLACK, add, dot, from_basis, largest, orthonormal_basis, scale, sub
from .warp import INVERSE_PI, cosine_hemisphere

f32 = np.float32
ZERO, HALF, ONE, TWO, FOUR = f32(0.0), f32(0.5), f32(1.0), f32(2.0), f32(4.0)
FIVE, TEN = f32(5.0), f32(10.0)
BLEND = f32(28.0 / (23.0 * math.pi))
INVERSE_2PI = f32(0.5 / math.pi)
HYBRID, ALWAYS, THRESHOLD = 0, 1, 2
# Distance over which the packed surface says that any extinction is opaque
EVERYWHERE = f32(1e30)
NO_NORMAL = (ZERO, ZERO, ZERO)


@device
def opacity_over(distance, sigma_t):
    """Opacity of a medium of even extinction."""
    return opacity(sigma_t * distance)


@glue
def surface_opacity(surface, sigma_t):
    """Alpha of Eq. 1: opacity over the transfer function's unit distance, or 1 for everywhere."""
    if surface.opacity_distance >= EVERYWHERE:
        return ONE
    return opacity_over(surface.opacity_distance, sigma_t)


@device
def surface_variate(surface, rng):
    """Variate that decides between surface and volume; 0 in modes that leave no choice."""
    if surface.mode != HYBRID:
        return rng, ZERO
    return stratified(rng)


@device
def surface_probability(surface, alpha, magnitude):
    """P_brdf = alpha (1 - exp(-25 g^3 |grad tau_n|)), Exposure Render Eq. 1 corrected.

    Other modes: alpha at every gradient; alpha where the normalised gradient passes a threshold.
    """
    normalised = min(magnitude * surface.per_gradient, ONE)
    if surface.mode == HYBRID:
        return alpha * opacity(surface.exponent_scale * normalised)
    if surface.mode == THRESHOLD and not normalised > surface.threshold:
        return ZERO
    return alpha


@device
def surface_draw(surface, sigma_t, rng):
    """Opacity of a collision, the variate that decides, and whether it may be by the surface.

    Where a bound, P_brdf <= alpha (1 - exp(-25 g^3)), already says no, no gradient is asked for
    (HC-20). Returns (alpha, xi, True or False, rng).
    """
    rng, xi = surface_variate(surface, rng)
    alpha = surface_opacity(surface, sigma_t)
    return alpha, xi, xi < surface_probability(surface, alpha, INFINITE), rng


@device
def surface_by_gradient(surface, alpha, xi, g, wo):
    """Decide by the gradient whether a collision scatters by the BRDF. Returns (yes, normal).

    Without a gradient there is no normal: the phase function takes over (HC-17); also for NaN.
    """
    magnitude = math.sqrt(dot(g, g))
    if not magnitude > ZERO:
        return False, NO_NORMAL
    if xi >= surface_probability(surface, alpha, magnitude):
        return False, NO_NORMAL
    toward = -ONE if dot(g, wo) < ZERO else ONE
    return True, scale(g, toward / magnitude)


@device
def surface_event(surface, medium, p, sigma_t, wo, rng):
    """Decide whether the collision at index position p scatters by the BRDF.

    Returns (True or False, normal, rng); the normal is on the side of wo. No gradient is fetched
    where none is asked for; none exists without `surface`. A cut face has the cut's normal and the
    bound's probability, as the largest gradient has (HC-22).
    """
    if surface is None:
        return False, NO_NORMAL, rng
    alpha, xi, maybe, rng = surface_draw(surface, sigma_t, rng)
    if not maybe:
        return False, NO_NORMAL, rng
    on_face, face = cut_face(medium.clip, medium.holes, medium.regions, p, wo)
    if on_face:
        return True, face, rng
    g = gradient(medium.values, surface.world_from_index_gradient, p)
    yes, normal = surface_by_gradient(surface, alpha, xi, g, wo)
    return yes, normal, rng


@device
def toward_camera(g, wo):
    """Unit normal along a gradient, on the side of wo; 0 where there is none (HC-17)."""
    square = dot(g, g)
    if not square > ZERO:
        return NO_NORMAL
    toward = -ONE if dot(g, wo) < ZERO else ONE
    return scale(g, toward / math.sqrt(square))


@device
def first_normal(normal_map, medium, v):
    """Unit normal of a vertex for the film, toward the camera, also where the volume scatters.

    `normal_map` None: no gradient is fetched.
    """
    if normal_map is None:
        return NO_NORMAL
    if v.on_surface:
        return v.normal
    return toward_camera(gradient(medium.values, normal_map.world_from_index_gradient, v.p), v.wo)


@device
def blinn(gloss, n, h):
    """(n.h)^e, accurate next to 1 where large exponents live."""
    apart = sub(n, h)
    return decay(-gloss.exponent * logarithm_of_rest(min(HALF * dot(apart, apart), ONE)))


@device
def microfacets(gloss, n, h):
    """Distribution D(h) of microfacet normals, and the density with which `sample_brdf` draws h.

    Blinn's (n.h)^e with the paper's (e + 2) / 2 pi, or that of Trowbridge and Reitz (GGX) with
    alpha^2 = 2 / (e + 2), which has the same curvature at its peak and longer tails.
    """
    if not gloss.ggx:
        lobe = INVERSE_2PI * blinn(gloss, n, h)
        return (gloss.exponent + TWO) * lobe, (gloss.exponent + ONE) * lobe
    apart = sub(n, h)
    q = dot(apart, apart)
    cosine = ONE - HALF * q
    if cosine <= ZERO:
        return ZERO, ZERO
    alpha_2 = TWO / (gloss.exponent + TWO)
    r = alpha_2 * cosine * cosine + q * (ONE - f32(0.25) * q)
    d = INVERSE_PI * alpha_2 / (r * r)
    return d, d * cosine


@glue
def sample_microfacet(gloss, u):
    """Cosine of the angle between normal and half vector, and its sine."""
    if not gloss.ggx:
        cosine = decay(logarithm_of_rest(u) / (-ONE - gloss.exponent))
        return cosine, math.sqrt(max(ZERO, ONE - cosine * cosine))
    alpha_2 = TWO / (gloss.exponent + TWO)
    whole = ONE - u + alpha_2 * u
    return math.sqrt((ONE - u) / whole), math.sqrt(alpha_2 * u / whole)


@device
def bare(gloss):
    """Whether there is no coat after all: the surface is Lambert's."""
    return largest(gloss.specular) <= ZERO


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
def coat(gloss, n, h, cos_h):
    """D(h) / (4 cos_h), and the density per steradian with which the coat draws wi.

    The first times Fresnel's factor, over the larger cosine of wo and wi, is the coat's BRDF.
    """
    if cos_h <= ZERO:
        return ZERO, ZERO
    d, pdf_h = microfacets(gloss, n, h)
    over = ONE / (FOUR * cos_h)
    return d * over, pdf_h * over


@device
def brdf_value_and_pdf(gloss, diffuse, n, wo, wi):
    """f_r(wo, wi) times the cosine of wi, RGB per steradian; and the density of `sample_brdf`.

    That is the mean of both lobes' (HC-31). Both are zero below the surface.
    """
    cos_o = dot(n, wo)
    cos_i = dot(n, wi)
    if cos_o <= ZERO or cos_i <= ZERO:
        return BLACK, ZERO
    lambert = INVERSE_PI * cos_i
    if gloss is None:
        return scale(diffuse, lambert), lambert
    if bare(gloss):
        return scale(diffuse, lambert), lambert
    body = BLEND * grazing(HALF * cos_i) * grazing(HALF * cos_o)
    rs = gloss.specular
    under = (diffuse[0] * (ONE - rs[0]), diffuse[1] * (ONE - rs[1]), diffuse[2] * (ONE - rs[2]))
    h, cos_h = half_vector(wo, wi)
    lobe, pdf_lobe = coat(gloss, n, h, cos_h)
    f = add(scale(under, body), scale(schlick(rs, cos_h), lobe / max(cos_i, cos_o)))
    return scale(f, cos_i), HALF * (lambert + pdf_lobe)


@device
def brdf_weight_and_pdf(gloss, diffuse, n, wo, wi):
    """Value over density for a direction drawn by `sample_brdf`, and the density."""
    if gloss is None:
        cos_i = dot(n, wi)
        if cos_i <= ZERO:
            return BLACK, ZERO
        return diffuse, INVERSE_PI * cos_i
    value, pdf = brdf_value_and_pdf(gloss, diffuse, n, wo, wi)
    if not pdf > ZERO:
        return BLACK, ZERO
    return scale(value, ONE / pdf), pdf


@device
def sample_brdf(gloss, n, wo, rng):
    """Direction with the density of `brdf_value_and_pdf`; below the surface both are 0.

    Returns (wi, rng).
    """
    s, t = orthonormal_basis(n)
    rng, u, v = stratified_pair(rng)
    if gloss is None:
        return from_basis(s, t, n, cosine_hemisphere(u, v)), rng
    rng, lobe = stratified(rng)
    if lobe < HALF or bare(gloss):
        return from_basis(s, t, n, cosine_hemisphere(u, v)), rng
    cosine, sine = sample_microfacet(gloss, u)
    a, b = on_circle(v)
    h = from_basis(s, t, n, (sine * a, sine * b, cosine))
    return sub(scale(h, TWO * dot(wo, h)), wo), rng
