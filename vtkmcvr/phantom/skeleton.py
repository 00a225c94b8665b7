"""The skeleton of the head phantom: where each bone lies in mm, and what is joined or carved out.

LPS coordinates, the face towards -y. The head is its own mirror image, so only the patient's left
half (x >= 0) is written down. Sizes follow a small adult head; they are eyeballed, not measured.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from itertools import accumulate, pairwise
from typing import NamedTuple

from vtkmcvr.phantom.shapes import Box, Chain, Ellipsoid, Part, Point


class DentalArch(NamedTuple):
    """Half an ellipse of teeth: its half width, its depth and the y of its front, in mm."""

    width: float
    depth: float
    front: float


def _arch(arch: DentalArch, step: int, end: int, z: float) -> list[Point]:
    """Return points of an arch, by degrees from the midline."""
    turns = [math.radians(angle) for angle in range(0, end + 1, step)]
    return [
        (arch.width * math.sin(t), arch.front + arch.depth * (1 - math.cos(t)), z) for t in turns
    ]


def _teeth(arch: DentalArch, z: float) -> list[Part]:
    """Return the seven crowns of half an arch, edge to edge along it."""
    points = _arch(arch, 1, 90, z)
    run = [0.0, *accumulate(math.dist(p, q) for p, q in pairwise(points))]
    ends = list(accumulate(width for _, width, _ in CROWNS))
    teeth = []
    for (name, width, depth), end in zip(CROWNS, ends, strict=True):
        at = min(bisect_left(run, end - width / 2), 89)
        (x, y, _), (x2, y2, _) = points[at], points[at + 1]
        turn = math.degrees(math.atan2(x - x2, y2 - y))
        shape = Box((x, y, z), (depth / 2, width / 2 - 0.2, 5.6), 2.2, turn)
        teeth.append(Part(name, shape))
    return teeth


def _vertebra(z: float) -> list[Part]:
    return [
        Part("body", Box((0, 22, z), (9, 8, 7.2), 3)),
        Part("joint", Box((18, 33, z), (5, 6, 8), 3), 2),
        Part("transverse process", Chain([(9, 25, z), (24, 28, z - 2)], 3), 3),
        Part("arch", Chain([(16, 36, z), (8, 46, z - 3), (0, 49, z - 4)], 3), 2),
        Part("spinous process", Chain([(0, 50, z - 4), (0, 66, z - 9)], [3.4, 2.6]), 3),
    ]


CROWNS = [
    ("central incisor", 8.2, 5.0),
    ("lateral incisor", 6.6, 4.8),
    ("canine", 7.4, 6.2),
    ("first premolar", 6.8, 7.4),
    ("second premolar", 6.8, 7.8),
    ("first molar", 9.6, 9.2),
    ("second molar", 9.2, 9.2),
]
UPPER = DentalArch(26.5, 42, -72)
ROOTS = DentalArch(26, 41, -69.5)
LOWER = DentalArch(25, 41, -70)

BRAINCASE = [
    Part("cerebrum", Ellipsoid((0, 16, 40), (60, 75, 57))),
    Part("frontal lobe", Ellipsoid((0, -14, 40), (48, 47, 44)), 14),
    Part("front of the skull base", Box((0, -40, -30), (90, 55, 56), 4), 10, carve=True),
    Part("temporal lobe", Ellipsoid((33, 2, 14), (21, 32, 24)), 14),
    Part("back of the skull base", Box((0, 60, -66), (90, 90, 40), 4), 14, carve=True),
    Part("cerebellum", Ellipsoid((0, 42, 4), (44, 35, 34)), 14),
    Part("brain stem", Chain([(0, 20, 10), (0, 32, -22)], [12, 11]), 10),
]

ORBIT = Chain([(33, -84, 3), (31, -60, 5), (14, -28, 8)], [16, 15.5, 4])

FACE_BONES = [
    Part("sphenoid", Ellipsoid((0, -14, 4), (15, 16, 14)), 6),
    Part("ethmoid", Box((0, -44, 9), (12, 22, 11), 4), 4),
    Part("frontal bone", Ellipsoid((0, -42, 30), (44, 29, 16)), 12),
    Part(
        "brow ridge",
        Chain(
            [(0, -70, 21), (14, -70, 24), (30, -66.5, 25.5), (42, -59, 22), (48, -52, 13)],
            [5.5, 5, 4.5, 4.5, 4.5],
        ),
        10,
    ),
    Part("lateral orbital rim", Chain([(48, -52, 13), (48, -50, 2), (46, -52, -9)], 4.5), 4),
    Part("lateral orbital wall", Box((38.5, -33, 4), (2, 21, 15), 1.5, 29), 5),
    Part("cheekbone", Ellipsoid((43, -51, -15), (11, 9, 9)), 6),
    Part(
        "lower orbital rim",
        Chain([(46, -53, -10), (33, -64, -13), (17, -68, -8), (12, -70, 2)], 4),
        5,
    ),
    Part("maxilla", Ellipsoid((20, -49, -22), (21, 21, 17)), 6),
    Part("frontal process", Chain([(5, -71, 16), (9, -72, 2), (15, -67, -18)], 4.2), 6),
    Part("nasal bone", Chain([(0, -72, 17), (1.5, -77, 8), (3.5, -80, 0)], [6, 4.6, 3.2]), 6),
    Part("upper tooth sockets", Chain(_arch(ROOTS, 25, 80, -38), 4.6), 6),
    Part("canine pillar", Chain([(16, -64, -38), (15, -66, -18)], [5, 4]), 6),
    Part("maxilla, front", Chain(_arch(ROOTS, 25, 50, -34), 4), 6),
    Part("palate", Box((0, -48, -34), (22, 23, 1.8), 1.5), 4),
    Part(
        "zygomatic arch",
        Chain([(45, -46, -16), (54, -32, -14), (58, -16, -10), (55, -2, -5)], [6, 3.8, 3.4, 5]),
        6,
    ),
    Part("pterygoid plate", Box((13, -18, -22), (1.6, 6, 15), 1.5, 15), 3),
    Part("petrous bone", Chain([(52, 14, -8), (16, 0, -8)], [8, 6]), 6),
    Part("mastoid", Ellipsoid((52, 24, -26), (9, 13, 17)), 8),
    Part("orbit", ORBIT, 3, carve=True),
    Part("nasal aperture", Chain([(0, -78, -6), (4, -76, -22)], [3, 8]), 3, carve=True),
    Part("nasal passage", Box((0, -32, -16), (12, 32, 15), 5), 3, carve=True),
    Part("septum", Box((0, -38, -10), (0.8, 22, 24), 0.8), 1),
    Part("nasal spine", Chain([(0, -66, -33), (0, -74, -31)], [3, 1.2]), 3),
    Part("foramen magnum", Chain([(0, 33, -20), (0, 36, -60)], 14), 3, carve=True),
    Part("occipital condyle", Ellipsoid((13, 26, -37), (6, 9, 6)), 4),
]

JAW = [
    Part("chin", Ellipsoid((0, -67, -80), (9, 6, 6))),
    Part(
        "jaw body",
        Chain(
            [(0, -64, -78), (14, -60, -78), (26, -44, -75), (37, -22, -69), (43, -5, -58)],
            [7, 6.5, 6, 6, 6],
        ),
        5,
    ),
    Part("oblique line", Chain([(20, -54, -69), (32, -36, -64), (44, -17, -50)], 5.5), 8),
    Part("lower tooth sockets", Chain(_arch(LOWER, 25, 80, -68), 5), 6),
    Part("ramus", Box((45, -8, -42), (2.6, 13, 20), 2.4, -4), 8),
    Part("back of the ramus", Chain([(43, -3, -58), (46, 1, -34), (49, 2, -15)], [6, 4, 5]), 5),
    Part("coronoid", Chain([(44, -18, -46), (45, -21, -13)], [4.5, 2.2]), 5),
]

NECK_BONES = [
    Part(
        "atlas",
        Chain([(0, 12, -46), (12, 16, -46), (20, 28, -45), (14, 46, -47), (0, 53, -48)], 3.8),
    ),
    Part("atlas, side", Chain([(18, 26, -45), (33, 28, -46)], [7, 3.5]), 3),
    Part("dens", Chain([(0, 22, -62), (0, 21, -43)], [6, 4.5]), 3),
    Part("hyoid", Chain([(0, -12, -96), (10, -8, -96), (16, 6, -92)], [3, 2.5, 2])),
    *(part for z in (-62, -79, -96, -113) for part in _vertebra(z)),
]

TEETH = [*_teeth(UPPER, -46.5), *_teeth(LOWER, -58)]
LEFT_FILLING = Ellipsoid((24, -40, -55.5), (3.5, 3.5, 3.5))
