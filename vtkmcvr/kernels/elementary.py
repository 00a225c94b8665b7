"""Elementary functions of float32 by short series, inline.

A call of the C library's takes longer than the function itself, because every register that holds
something across it goes to memory and back. These take only arguments that kernels have.
"""

import math

import numpy as np

from .jit import device

f32, i32 = np.float32, np.int32
ZERO, HALF, ONE, TWO = f32(0.0), f32(0.5), f32(1.0), f32(2.0)
EXPONENT_OF_ONE = i32(127)
SQRT_HALF_BITS, MANTISSA_BITS = i32(0x3F3504F3), i32(23)
LN2, PER_LN2 = f32(math.log(2.0)), f32(1.0 / math.log(2.0))
# log((1 + s) / (1 - s)), odd powers of s
L3, L5, L7, L9 = f32(2.0 / 3.0), f32(2.0 / 5.0), f32(2.0 / 7.0), f32(2.0 / 9.0)
# Up to here log(1 - x) and 1 - exp(-x) are taken from their series around 0
SMALL = f32(0.25)
# Largest power of 1/2 that is a normal float32
MOST_HALVINGS = f32(126.0)
E2, E3, E4, E5, E6 = (f32(1.0 / math.factorial(k)) for k in (2, 3, 4, 5, 6))
QUARTER_PI = f32(math.pi / 4.0)
S3, S5, S7, S9 = (f32((-1) ** (k // 2) / math.factorial(k)) for k in (3, 5, 7, 9))
C2, C4, C6, C8 = (f32((-1) ** (k // 2) / math.factorial(k)) for k in (2, 4, 6, 8))
QUARTERS, EIGHTHS = f32(4.0), f32(8.0)
FIRST_BIT, SECOND_BIT = i32(1), i32(2)
# atan(r) / r in powers of r^2 at Chebyshev's points, to 2e-8 for |r| up to tan(pi / 8)
TAN_EIGHTH = f32(math.tan(math.pi / 8.0))
T0, T2, T4 = f32(0.99999998), f32(-0.33332786), f32(0.19974082)
T6, T8 = f32(-0.1384849), f32(0.07976292)
PI, HALF_PI = f32(math.pi), f32(0.5 * math.pi)


@device
def float_bits(x):
    """Bits of a float32."""
    return f32(x).view(i32)


@device
def bits_float(bits):
    """float32 of some bits."""
    return i32(bits).view(f32)


@device
def atanh_series(s):
    """log((1 + s) / (1 - s)) for |s| up to 0.172."""
    q = s * s
    return s * (TWO + q * (L3 + q * (L5 + q * (L7 + q * L9))))


@device
def logarithm(x):
    """Natural logarithm of a positive, normal float32, to 2e-7 relative."""
    bits = float_bits(x)
    exponent = (bits - SQRT_HALF_BITS) >> MANTISSA_BITS
    m = bits_float(bits - (exponent << MANTISSA_BITS))
    return f32(exponent) * LN2 + atanh_series((m - ONE) / (m + ONE))


@device
def logarithm_of_rest(x):
    """log(1 - x) for x in [0, 1], to 4e-7 relative; -87 or less at 1."""
    if x < SMALL:
        return -atanh_series(x / (TWO - x))
    return logarithm(ONE - x)


@device
def decay(x):
    """exp(-x) for x >= 0, to 3e-7 + 6e-8 x relative; 0 where it is below the normal float32."""
    y = x * PER_LN2
    halvings = i32(min(MOST_HALVINGS, y) + HALF)
    r = (f32(halvings) - y) * LN2
    power = ONE + r * (ONE + r * (E2 + r * (E3 + r * (E4 + r * (E5 + r * E6)))))
    whole = bits_float((EXPONENT_OF_ONE - halvings) << MANTISSA_BITS)
    return power * whole if y < MOST_HALVINGS else ZERO


@device
def opacity(x):
    """1 - exp(-x) for x >= 0, to 4e-7 relative."""
    if x < SMALL:
        return x * (ONE - x * (E2 - x * (E3 - x * (E4 - x * (E5 - x * E6)))))
    return ONE - decay(x)


@device
def cosine_and_sine(q):
    """Cosine and sine of q quarters of pi, |q| <= 1, to 1e-7."""
    a = q * QUARTER_PI
    z = a * a
    cosine = ONE + z * (C2 + z * (C4 + z * (C6 + z * C8)))
    return cosine, a * (ONE + z * (S3 + z * (S5 + z * (S7 + z * S9))))


@device
def on_circle(u):
    """Cosine and sine of 2 pi u for u in [0, 1], to 1e-7."""
    quarter = i32(u * QUARTERS + HALF)
    c, s = cosine_and_sine(u * EIGHTHS - TWO * f32(quarter))
    if quarter & FIRST_BIT:
        c, s = -s, c
    if quarter & SECOND_BIT:
        c, s = -c, -s
    return c, s


@device
def angle(x, y):
    """Angle of a finite point (x, y) in [-pi, pi], as `math.atan2(y, x)`, to 4e-7; 0 at (0, 0)."""
    across, up = abs(x), abs(y)
    most = max(across, up)
    q = min(across, up) / most if most > ZERO else ZERO
    steep = q > TAN_EIGHTH
    r = (q - ONE) / (q + ONE) if steep else q
    z = r * r
    a = r * (T0 + z * (T2 + z * (T4 + z * (T6 + z * T8))))
    a = QUARTER_PI + a if steep else a
    a = HALF_PI - a if up > across else a
    a = PI - a if x < ZERO else a
    return -a if y < ZERO else a
