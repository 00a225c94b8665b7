"""Counter-based random numbers, keyed by (seed, pixel, sample, dimension).

The state is one 64-bit word: a key hashed from (seed, pixel, sample) plus, for each dimension
drawn, the golden-ratio increment; the number is SplitMix64's finaliser of it (Steele, Lea, Flood,
"Fast splittable pseudorandom number generators", OOPSLA 2014). The n-th number of a path is a pure
function of (seed, pixel, sample, n): no thread, tile or interruption can change it.
"""

import numpy as np

from .jit import device

f32, i32 = np.float32, np.int32
u64 = np.uint64

GOLDEN = u64(0x9E3779B97F4A7C15)
MIX_1 = u64(0xBF58476D1CE4E5B9)
MIX_2 = u64(0x94D049BB133111EB)
SAMPLE_STRIDE = u64(0xD1342543DE82EF95)
SHIFT_27, SHIFT_30, SHIFT_31, SHIFT_32, SHIFT_40 = u64(27), u64(30), u64(31), u64(32), u64(40)
TO_UNIT_24 = f32(2.0**-24)
TO_UNIT_32 = f32(2.0**-32)
HALF, ONE, TWO = f32(0.5), f32(1.0), f32(2.0)
SQRT_HALF_BITS, MANTISSA_BITS = i32(0x3F3504F3), i32(23)
LN2 = f32(0.6931471805599453)
A3, A5, A7, A9 = f32(2.0 / 3.0), f32(2.0 / 5.0), f32(2.0 / 7.0), f32(2.0 / 9.0)


@device
def mix(z):
    """SplitMix64's finaliser: a bijection of 64-bit words."""
    z = (z ^ (z >> SHIFT_30)) * MIX_1
    z = (z ^ (z >> SHIFT_27)) * MIX_2
    return z ^ (z >> SHIFT_31)


@device
def start(seed, pixel, sample):
    """State before dimension 0 of one sample of one pixel."""
    return mix(
        mix(u64(seed) + GOLDEN * (u64(pixel) + u64(1))) + SAMPLE_STRIDE * (u64(sample) + u64(1))
    )


@device
def uniform(rng):
    """Next variate in [0, 1), a multiple of 2^-24. Returns (rng, u)."""
    rng = rng + GOLDEN
    return rng, f32(np.int64(mix(rng) >> SHIFT_40)) * TO_UNIT_24


@device
def logarithm(x):
    """Natural logarithm of a positive, normal float32, to 2e-7 relative.

    By atanh series on [sqrt(1/2), sqrt(2)]. Inline, where a call of the C library's logarithm would
    spill every register of the medium walker around it: four times as fast there.
    """
    bits = f32(x).view(i32)
    exponent = (bits - SQRT_HALF_BITS) >> MANTISSA_BITS
    m = i32(bits - (exponent << MANTISSA_BITS)).view(f32)
    s = (m - ONE) / (m + ONE)
    q = s * s
    series = A3 + q * (A5 + q * (A7 + q * A9))
    return f32(exponent) * LN2 + s * (TWO + q * series)


@device
def exponential(rng):
    """Next standard exponential variate, in [0, 22.9]. Returns (rng, x).

    -log(u) with u in (0, 1] on 32 bits: u = 0 can't occur, and optical depths up to 22 are reached.
    """
    rng = rng + GOLDEN
    u = (f32(np.int64(mix(rng) >> SHIFT_32)) + HALF) * TO_UNIT_32
    return rng, -logarithm(u)
