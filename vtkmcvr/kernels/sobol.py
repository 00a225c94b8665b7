"""Sobol points of one batch of 16 samples, scrambled exactly as Owen describes.

The 16 points in one or two dimensions are the first ones of the Sobol sequence, which is a
(0, 2)-sequence in base 2: every elementary interval of area 1/16 holds one. Owen's nested
scrambling (Owen, "Randomly permuted (t,m,s)-nets and (t,s)-sequences", 1995) flips each binary
digit by a fair coin that belongs to the digits before it: 15 coins for 16 points. The digits below
are random and independent, since no two points share the four digits above. So each point is
uniform, and batches are independent.

Sets of points for further dimensions are padded by scrambling the order of the points (Burley,
"Practical hash-based Owen scrambling", JCGT 9(4), 2020).
"""

import numpy as np

from .jit import device

u64 = np.uint64

MIX_1 = u64(0xBF58476D1CE4E5B9)
MIX_2 = u64(0x94D049BB133111EB)
BELOW = u64(0xA0761D6478BD642F)
SHIFT_27, SHIFT_30, SHIFT_31, SHIFT_36 = u64(27), u64(30), u64(31), u64(36)
ONE, TWO, THREE, FOUR, EIGHT = u64(1), u64(2), u64(3), u64(4), u64(8)
# Coordinates of point i in sixteenths, at bits 4i to 4i + 3: its digits reversed, and the Pascal
# matrix modulo 2 times its digits
ACROSS, ALONG = u64(0xF7B3D591E6A2C480), u64(0x19D5B37FE62A4C80)
SIXTEENTH = u64(15)
COINS = u64(16)
REST, REST_BITS = u64(0xFFFFFFF), u64(28)


@device
def mix(z):
    """SplitMix64's finaliser: a bijection of 64-bit words."""
    z = (z ^ (z >> SHIFT_30)) * MIX_1
    z = (z ^ (z >> SHIFT_27)) * MIX_2
    return z ^ (z >> SHIFT_31)


@device
def scrambled(x, coins):
    """Four digits, each flipped by the coin, of bits 1 to 15, of the digits before it."""
    first = (coins >> ONE) & ONE
    second = (coins >> (TWO + (x >> THREE))) & ONE
    third = (coins >> (FOUR + (x >> TWO))) & ONE
    fourth = (coins >> (EIGHT + (x >> ONE))) & ONE
    return x ^ (first << THREE | second << TWO | third << ONE | fourth)


@device
def net_pair(key, index):
    """Two coordinates of point `index` of the points called `key`, as words of 32 bits."""
    coins = mix(key)
    below = mix(key + BELOW * (index + ONE))
    place = scrambled(index, coins) * FOUR
    x = scrambled((ACROSS >> place) & SIXTEENTH, coins >> COINS)
    y = scrambled((ALONG >> place) & SIXTEENTH, coins >> (COINS + COINS))
    return x << REST_BITS | below & REST, y << REST_BITS | below >> SHIFT_36
