"""Phase functions: isotropic, Henyey-Greenstein.

wo and wi both point away from the scattering point; light goes straight on when wi = -wo, hence the
+ 2 g cos in the denominator. Source: Henyey and Greenstein 1941; form as in pbrt.
"""

import math

import numpy as np

from .jit import device
from .rng import uniform
from .vec import dot, from_basis, orthonormal_basis
from .warp import INVERSE_4PI, TWO_PI, uniform_sphere

f32 = np.float32
ZERO, ONE, TWO = f32(0.0), f32(1.0), f32(2.0)
ISOTROPIC_BELOW = f32(1e-3)


@device
def phase_value(phase, wo, wi):
    """p(wo, wi) in 1/steradian; also the density of `sample_phase`."""
    if phase is None:
        return INVERSE_4PI
    g = phase.g
    denominator = ONE + g * g + TWO * g * dot(wo, wi)
    return INVERSE_4PI * (ONE - g * g) / (denominator * math.sqrt(denominator))


@device
def sample_phase(phase, wo, rng):
    """Direction with density `phase_value`. Returns (wi, rng)."""
    rng, u = uniform(rng)
    rng, v = uniform(rng)
    if phase is None:
        return uniform_sphere(u, v), rng
    g = phase.g
    if abs(g) < ISOTROPIC_BELOW:
        cosine = ONE - TWO * u
    else:
        s = (ONE - g * g) / (ONE + g - TWO * g * u)
        cosine = -(ONE + g * g - s * s) / (TWO * g)
    cosine = min(max(cosine, -ONE), ONE)
    sine = math.sqrt(ONE - cosine * cosine)
    phi = TWO_PI * v
    a, b = orthonormal_basis(wo)
    return from_basis(a, b, wo, (sine * math.cos(phi), sine * math.sin(phi), cosine)), rng
