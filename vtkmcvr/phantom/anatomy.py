"""The soft parts of the head phantom: skin, fat, eyes, brain and air, each where it lies in mm.

Coordinates and mirror image are those of `skeleton`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

from vtkmcvr.phantom.shapes import Box, Chain, Ellipsoid, Part, Point, Shape, Tissue, ball
from vtkmcvr.phantom.skeleton import ORBIT


def _across(solid: Ellipsoid, offsets: Iterable[tuple[float, float]]) -> list[Point]:
    """Return points on the front of an ellipsoid at (x, z) from its centre."""
    (cx, cy, cz), (rx, ry, rz) = solid.centre, solid.radii
    depths = ((x, ry * math.sqrt(1 - (x / rx) ** 2 - (z / rz) ** 2), z) for x, z in offsets)
    return [(cx + x, cy - y, cz + z) for x, y, z in depths]


def _rim(plate: Ellipsoid, angles: Iterable[float], out: float) -> list[Point]:
    """Return points on the rim of a turned plate, `out` mm to its outer side (0 is at the back)."""
    (cx, cy, cz), (_, ry, rz) = plate.centre, plate.radii
    c, s = math.cos(math.radians(plate.turn)), math.sin(math.radians(plate.turn))
    turns = [math.radians(angle) for angle in angles]
    flat = ((ry * math.cos(t), rz * math.sin(t)) for t in turns)
    return [(cx - s * v + c * out, cy + c * v + s * out, cz + w) for v, w in flat]


LIDS = Ellipsoid((31, -59, 6), (15, 14, 13))
EAR = Ellipsoid((75, 13, -4), (4, 15, 26), -27)

LID_CREASE = [(-12, 0), (-7, -3.5), (0, -5), (7, -4), (12, -1)]

SKIN = [
    Part("cranium", Ellipsoid((0, 16, 40), (72, 86, 68))),
    Part("forehead", Ellipsoid((0, -16, 38), (58, 64, 54)), 20),
    Part("upper face", Ellipsoid((0, -18, -4), (66, 53, 46)), 16),
    Part("lower face", Ellipsoid((0, -26, -42), (44, 46, 44)), 16),
    Part("muzzle", Ellipsoid((0, -50, -50), (27, 29, 30)), 14),
    Part("cheekbone", Ellipsoid((41, -46, -12), (16, 17, 12)), 16),
    Part("cheek", Ellipsoid((30, -46, -32), (19, 21, 22)), 18),
    Part("masseter", Ellipsoid((45, -8, -40), (12, 22, 24)), 16),
    Part(
        "jaw",
        Chain(
            [(0, -66, -79), (10, -64, -79), (24, -48, -74), (42, -6, -58), (52, 10, -14)],
            [11, 11, 11, 12, 12],
        ),
        18,
    ),
    Part("floor of the mouth", Ellipsoid((0, -28, -68), (36, 38, 20)), 14),
    Part("neck", Chain([(0, 27, -20), (0, 34, -170)], [47, 50]), 20),
    Part("nape", Ellipsoid((0, 60, -12), (44, 30, 52)), 20),
    Part("sternomastoid", Chain([(51, 26, -30), (34, 2, -90), (12, -14, -150)], [10, 8, 6]), 12),
    Part("larynx", Ellipsoid((0, -16, -114), (8, 9, 14)), 12),
    Part("brow", Chain([(7, -73, 22), (18, -74.5, 25), (30, -71, 26), (45, -59, 20)], 5.5), 16),
    Part("glabella", ball((0, -70, 20), 9), 12),
    Part("eye socket", Ellipsoid((30, -80, 7), (18, 14, 11)), 12, carve=True),
    Part("temple", Ellipsoid((86, -44, 26), (20, 34, 28)), 20, carve=True),
    Part("closed lids", LIDS, 6),
    Part("lid fold", Chain(_across(LIDS, [(-11, 6), (-5, 8.5), (3, 9), (11, 5)]), 0.8), 4, True),
    Part("lid crease", Chain(_across(LIDS, LID_CREASE), [0.4, 1.2, 1.3, 1.2, 0.4]), 3, True),
    Part("nose base", Chain([(0, -68, 8), (0, -74, -26)], [8, 11]), 8),
    Part("nose", Chain([(0, -73, 18), (0, -80, 3), (0, -97, -21)], [6, 6, 6.5]), 9),
    Part("nose side", Chain([(4, -78, 0), (8, -85, -22)], [4, 7]), 8),
    Part("nose tip", ball((0, -97.5, -23.5), 7.5), 6),
    Part("nose wing", Ellipsoid((11, -85, -27), (6, 9, 7)), 7),
    Part("nostril", Chain([(5.5, -92, -38), (5, -87, -28)], [3.4, 2.4]), 2.5, carve=True),
    Part("columella", Chain([(0, -94, -29), (0, -80, -34)], [3.5, 4]), 4),
    Part("philtrum", Chain([(0, -86, -38), (0, -86.5, -44)], 2), 5, True),
    Part(
        "upper lip",
        Chain([(0, -79.5, -48.5), (5, -80, -47.5), (13, -75, -50), (22, -65, -53)], [4.5, 5, 4, 2]),
        6,
    ),
    Part(
        "lower lip",
        Chain(
            [(0, -78, -58.5), (8, -76.5, -58), (15, -71, -56.5), (21, -64, -54.5)], [6, 6, 4.5, 2]
        ),
        6,
    ),
    Part(
        "mouth line",
        Chain(
            [
                (0, -86, -53.4),
                (7, -84.5, -52.6),
                (14, -79.5, -53),
                (20, -73.5, -53.8),
                (25, -69, -55),
            ],
            [2, 2, 1.8, 1.4, 0.5],
        ),
        4,
        carve=True,
    ),
    Part("chin fold", Ellipsoid((0, -86, -68), (16, 8, 4)), 10, carve=True),
    Part("chin", ball((0, -69, -80), 11), 10),
    Part("ear plate", EAR, 6),
    Part("helix", Chain(_rim(EAR, range(-215, 71, 15), 2.0), 3), 4),
    Part("antihelix", Chain([(81, 18, -18), (83, 20, -4), (81, 17, 8), (78, 10, 14)], 2), 5),
    Part("ear lobe", Ellipsoid((77, 6, -29), (4, 7, 8)), 6),
    Part("tragus", Ellipsoid((74.5, -3, -10), (4, 3.5, 5)), 5),
    Part("ear bowl", Ellipsoid((83, 7, -10), (8, 7, 9)), 4, carve=True),
]

SOFT: list[Tissue] = [
    ("orbital fat", -80, ORBIT),
    ("eye muscle, upper", 50, Chain([(31, -52, 18), (16, -30, 9)], [2, 1.5])),
    ("eye muscle, lower", 50, Chain([(31, -52, -6), (16, -30, 7)], [2, 1.5])),
    ("optic nerve", 40, Chain([(30, -48, 6), (14, -28, 8)], [2.2, 2])),
    ("sclera", 60, ball((31, -57, 6), 12)),
    ("vitreous", 12, ball((31, -57, 6), 10.8)),
    ("lens", 110, Ellipsoid((31, -66, 6), (4.5, 2.2, 4.5))),
    ("tongue", 60, Ellipsoid((0, -34, -54), (21, 32, 16))),
    ("parotid", 20, Ellipsoid((56, 4, -38), (8, 13, 18))),
    ("disc column", 90, Chain([(0, 22, -58), (0, 24, -140)], 7.5)),
    ("carotid and jugular", 45, Chain([(26, 6, -40), (20, 4, -130)], [4.5, 5.5])),
    ("thyroid cartilage", 160, Chain([(0, -7, -108), (0, -6, -130)], 12)),
]

BRAIN: list[Tissue] = [
    (
        "lateral ventricle",
        8,
        Chain([(6, -22, 36), (7, 0, 42), (13, 28, 42), (20, 36, 30)], [5, 4.5, 6, 4]),
    ),
    ("third ventricle", 8, Box((0, 6, 26), (2.2, 13, 9), 2)),
    ("fourth ventricle", 8, Ellipsoid((0, 36, -2), (6, 5, 10))),
    ("falx", 55, Box((0, 16, 74), (0.8, 80, 26), 0.6)),
    ("spinal fluid", 10, Chain([(0, 33, -24), (0, 39, -140)], [10, 8.5])),
    ("spinal cord", 38, Chain([(0, 31, -16), (0, 39, -140)], [8, 5.5])),
]

AIR: list[tuple[str, Shape]] = [
    ("frontal sinus", Ellipsoid((9, -68, 27), (8, 4, 8))),
    ("ethmoid cells, front", ball((6.5, -58, 9), 4)),
    ("ethmoid cells, middle", ball((6.5, -48.5, 9), 4)),
    ("ethmoid cells, back", ball((6.5, -39, 8), 4)),
    ("sphenoid sinus", Ellipsoid((6, -17, 4), (5.5, 10, 8))),
    ("maxillary sinus", Ellipsoid((27, -47, -22), (10, 12.5, 10))),
    ("nasal cavity", Box((5, -42, -13), (3.6, 34, 15), 3)),
    (
        "nasal floor",
        Chain([(5.5, -90, -40), (5.5, -82, -28), (6, -66, -26), (6, -8, -26)], [2.6, 3, 5, 5]),
    ),
    (
        "pharynx",
        Chain(
            [(0, -8, -24), (0, -2, -44), (0, -1, -80), (0, -4, -100), (0, -5, -140)],
            [8, 6.5, 6.5, 6, 8.5],
        ),
    ),
    ("mouth", Ellipsoid((0, -44, -39.5), (18, 20, 2.6))),
    ("ear canal", Chain([(81, 4, -11), (70, 6, -11), (52, 10, -9)], [4.5, 3.5, 3])),
    ("middle ear", ball((48, 11, -8), 3.5)),
    ("mastoid cells, front", ball((48, 20, -19), 3.2)),
    ("mastoid cells, back", ball((47, 28, -21), 3)),
    ("mastoid cells, deep", ball((42, 24, -17), 3)),
    ("mastoid cells, low", ball((48, 23, -29), 3)),
]

TURBINATES: list[Tissue] = [
    ("lower turbinate", 45, Chain([(7, -64, -24), (7, -26, -24)], [2.6, 2])),
    ("middle turbinate", 45, Chain([(6.5, -60, -12), (6.5, -28, -12)], [2.2, 1.8])),
]
