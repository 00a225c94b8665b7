"""Phase functions: isotropic, Henyey-Greenstein, Schlick, Rayleigh, cone.

wo and wi both point away from the scattering point; light goes straight on when wi = -wo, hence the
+ 2 g cos in the denominators. With x = 1 +- wo.wi, the distance of the cosine from its peak,
nothing cancels where the peak is narrow.

Sources: Henyey and Greenstein 1941, form as in pbrt; Blasi, Le Saec, Schlick, CGF 12(3), 1993;
Rayleigh, sampled as in Frisvad, JOSA A 28(12), 2011; cone: Schott et al., CGF 28(3), 2009, Eq. 6.
"""

import math

import numpy as np

from .elementary import on_circle
from .jit import device
from .rng import stratified_pair
from .vec import add, dot, from_basis, orthonormal_basis, scale
from .warp import INVERSE_4PI, uniform_sphere

f32 = np.float32
ZERO, HALF, ONE, TWO = f32(0.0), f32(0.5), f32(1.0), f32(2.0)
THREE_QUARTERS, THIRD = f32(0.75), f32(1.0 / 3.0)
INVERSE_2PI = f32(0.5 / math.pi)
HENYEY_GREENSTEIN, SCHLICK, RAYLEIGH, CONE = 0, 1, 2, 3


@device
def phase_value(phase, wo, wi):
    """p(wo, wi) in 1/steradian; also the density of `sample_phase`.

    1 + g^2 + 2 g cos is written as (1 - |g|)^2 + 2 |g| x, and Schlick's 1 - k cos alike, which does
    not cancel near |g| = 1.
    """
    if phase is None:
        return INVERSE_4PI
    shape = abs(phase.shape)
    apart = add(wo, scale(wi, math.copysign(ONE, phase.shape)))
    x = HALF * dot(apart, apart)
    if phase.kind == HENYEY_GREENSTEIN:
        square = (ONE - shape) * (ONE - shape) + TWO * shape * x
        return INVERSE_4PI * (ONE - shape) * (ONE + shape) / (square * math.sqrt(square))
    if phase.kind == SCHLICK:
        root = ONE - shape + shape * x
        return INVERSE_4PI * (ONE - shape) * (ONE + shape) / (root * root)
    if phase.kind == RAYLEIGH:
        cosine = ONE - x
        return INVERSE_4PI * THREE_QUARTERS * (ONE + cosine * cosine)
    return INVERSE_2PI / shape if x <= shape else ZERO


@device
def from_peak(phase, u):
    """Distance x of the cosine from the peak, by inversion of its distribution function."""
    shape = abs(phase.shape)
    if phase.kind == HENYEY_GREENSTEIN:
        rest = ONE + shape - TWO * shape * u
        return (ONE - shape) * u / rest * (ONE - shape) * (ONE + (ONE + shape) / rest)
    if phase.kind == SCHLICK:
        return TWO * (ONE - shape) * u / (ONE + shape - TWO * shape * u)
    if phase.kind == RAYLEIGH:
        z = TWO * (ONE - TWO * u)
        root = (abs(z) + math.sqrt(z * z + ONE)) ** THIRD
        return ONE - math.copysign(root - ONE / root, z)
    return shape * u


@device
def sample_phase(phase, wo, rng):
    """Direction with density `phase_value`. Returns (wi, rng)."""
    rng, u, v = stratified_pair(rng)
    if phase is None:
        return uniform_sphere(u, v), rng
    x = min(from_peak(phase, u), TWO)
    cosine = (x - ONE) * math.copysign(ONE, phase.shape)
    sine = math.sqrt(x * (TWO - x))
    a, b = orthonormal_basis(wo)
    c, s = on_circle(v)
    return from_basis(a, b, wo, (sine * c, sine * s, cosine)), rng
