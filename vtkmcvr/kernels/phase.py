"""Phase functions: isotropic, Henyey-Greenstein.

wo and wi both point away from the scattering point; light goes straight on when wi = -wo, hence the
+ 2 g cos in the denominator. Source: Henyey and Greenstein 1941; form as in pbrt.
"""

import math

import numpy as np

from .jit import device
from .rng import stratified_pair
from .vec import add, dot, from_basis, orthonormal_basis, scale
from .warp import INVERSE_4PI, TWO_PI, uniform_sphere

f32 = np.float32
ONE, TWO = f32(1.0), f32(2.0)


@device
def phase_value(phase, wo, wi):
    """p(wo, wi) in 1/steradian; also the density of `sample_phase`.

    1 + g^2 + 2 g cos is written as (1 - |g|)^2 + |g| |wo +- wi|^2, which does not cancel
    near |g| = 1.
    """
    if phase is None:
        return INVERSE_4PI
    g = abs(phase.g)
    apart = add(wo, scale(wi, math.copysign(ONE, phase.g)))
    square = (ONE - g) * (ONE - g) + g * dot(apart, apart)
    return INVERSE_4PI * (ONE - g) * (ONE + g) / (square * math.sqrt(square))


@device
def sample_phase(phase, wo, rng):
    """Direction with density `phase_value`. Returns (wi, rng).

    The distance x of the cosine from the peak has a closed form that also holds for g = 0.
    """
    rng, u, v = stratified_pair(rng)
    if phase is None:
        return uniform_sphere(u, v), rng
    g = abs(phase.g)
    rest = ONE + g - TWO * g * u
    x = min((ONE - g) * u / rest * (ONE - g) * (ONE + (ONE + g) / rest), TWO)
    cosine = (x - ONE) * math.copysign(ONE, phase.g)
    sine = math.sqrt(x * (TWO - x))
    phi = TWO_PI * v
    a, b = orthonormal_basis(wo)
    return from_basis(a, b, wo, (sine * math.cos(phi), sine * math.sin(phi), cosine)), rng
