"""Counter-based random numbers, keyed by (seed, pixel, sample, dimension).

The state of a path is one 64-bit word: a key hashed from (seed, pixel, sample) plus, for each
dimension drawn, the golden-ratio increment; the number is SplitMix64's finaliser of it (Steele,
Lea, Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014). The n-th number of a
path is a pure function of (seed, pixel, sample, n): no thread, tile or interruption can change it.

The functions called `stratified` are for leading dimensions, those that nearly every path of a
pixel draws in the same order: pixel, lens, first collision, light. Where the scene asks for Sobol
points they come from `sobol.py`, as functions of (seed, pixel, batch, index in the batch, n).
"""

from typing import NamedTuple

import numpy as np

from ..packed import BATCH, Sobol
from .elementary import logarithm
from .jit import device
from .sobol import mix, net_pair

f32 = np.float32
u64, i64 = np.uint64, np.int64

GOLDEN = u64(0x9E3779B97F4A7C15)
SAMPLE_STRIDE = u64(0xD1342543DE82EF95)
SHIFT_8, SHIFT_32 = u64(8), u64(32)
BATCH_BITS, LAST_OF_BATCH = u64(BATCH.bit_length() - 1), u64(BATCH - 1)
TO_UNIT_24 = f32(2.0**-24)
TO_UNIT_32 = f32(2.0**-32)
HALF = f32(0.5)


class Stream(NamedTuple):
    """State of the random numbers of one path."""

    counter: np.uint64
    net: Sobol | None


@device
def key(seed, pixel, sample):
    """Word hashed from three numbers."""
    return mix(
        mix(u64(seed) + GOLDEN * (u64(pixel) + u64(1))) + SAMPLE_STRIDE * (u64(sample) + u64(1))
    )


@device
def start(seed, pixel, sample):
    """State before dimension 0 of one sample of one pixel, all dimensions independent."""
    return Stream(key(seed, pixel, sample), None)


@device
def net_of(sobol, seed, pixel, sample):
    """Place of the sample in its batch; None where all dimensions are independent."""
    # Numba does not prune this branch where `sobol` is there: it has to be of the same type
    if sobol is None:
        return sobol
    batch = u64(sample) >> BATCH_BITS
    # Inverted, so that no batch has the key of a sample
    return Sobol(~key(seed, pixel, batch), u64(sample) & LAST_OF_BATCH, sobol.sets)


@device
def start_path(sobol, seed, pixel, sample):
    """State before dimension 0; leading dimensions are Sobol points where the scene asks so."""
    return Stream(key(seed, pixel, sample), net_of(sobol, seed, pixel, sample))


@device
def word(rng):
    """Next 32 random bits. Returns (rng, word)."""
    counter = rng.counter + GOLDEN
    return Stream(counter, rng.net), mix(counter) >> SHIFT_32


@device
def stratified_words(net, rng):
    """Next two words of leading dimensions; `net` is that of `rng`. Returns (rng, word, word)."""
    if net is None:
        rng, a = word(rng)
        rng, b = word(rng)
        return rng, a, b
    counter, after = rng.counter + GOLDEN, Sobol(net.key + GOLDEN, net.place, net.sets - 1)
    # A key of the sample's own makes points of the batch independent of each other
    a, b = net_pair(after.key if net.sets > 0 else ~counter, net.place)
    return Stream(counter, after), a, b


@device
def stratified_word(net, rng):
    """Next word of a leading dimension; `net` is that of `rng`. Returns (rng, word)."""
    if net is None:
        return word(rng)
    rng, a, _ = stratified_words(net, rng)
    return rng, a


@device
def unit(bits):
    """Word as a variate in [0, 1), a multiple of 2^-24."""
    return f32(i64(bits >> SHIFT_8)) * TO_UNIT_24


@device
def uniform(rng):
    """Next variate in [0, 1), a multiple of 2^-24. Returns (rng, u)."""
    rng, bits = word(rng)
    return rng, unit(bits)


@device
def stratified(rng):
    """`uniform` of a leading dimension."""
    rng, bits = stratified_word(rng.net, rng)
    return rng, unit(bits)


@device
def stratified_pair(rng):
    """Next two variates in [0, 1) of leading dimensions, spread well together too.

    Returns (rng, u, v).
    """
    rng, a, b = stratified_words(rng.net, rng)
    return rng, unit(a), unit(b)


@device
def minus_logarithm(bits):
    """-log(u) with u in (0, 1] on 32 bits: u = 0 can't occur, and values up to 22.9 are reached."""
    return -logarithm((f32(i64(bits)) + HALF) * TO_UNIT_32)


@device
def exponential(rng):
    """Next standard exponential variate, in [0, 22.9]. Returns (rng, x)."""
    rng, bits = word(rng)
    return rng, minus_logarithm(bits)


@device
def stratified_exponential(rng):
    """`exponential` of a leading dimension."""
    rng, bits = stratified_word(rng.net, rng)
    return rng, minus_logarithm(bits)
