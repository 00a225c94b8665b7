"""A synthetic CT head: no patient, no scan, no file; the same bytes on every call.

The head is modelled from ellipsoids, boxes and chains of capsules (`skeleton`,
`anatomy`). It is made to be looked at, and to know what is where in it; it is no
anatomical reference.

World: LPS in mm, centred at the origin: x to the patient's left, y to the back, z up.

============================================================  ==============
Part                                                          HU
============================================================  ==============
air: outside, frontal/ethmoid/sphenoid/maxillary sinus, nose,
mouth, pharynx, ear canal, mastoid cells                      -1000
subcutaneous and orbital fat                                  -95, -80
skin                                                          45
muscle, with thin planes of fat                               55 (-65)
tongue, parotid, eye muscles, discs, great vessels            20 to 90
eye: sclera, vitreous, lens                                   60, 12, 110
fluid: ventricles, sulci, around brain and cord               8
brain: white, grey matter, cord, falx                         30, 39, 38, 55
bone: inner and outer table, all cortex                       1550
bone: diploe, marrow (textured)                               640 +- 130
thyroid cartilage                                             160
28 teeth                                                      2500
filling in the patient's lower left first molar               3000
============================================================  ==============

Edges are blurred over about 1.5 voxels; where there is tissue a noise of 6 HU is added.
The filling is the one part that the right half does not have: it tells left from right.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vtkmcvr.phantom import anatomy, skeleton
from vtkmcvr.phantom.shapes import Field, Grid, Shape, cover, sculpt

EXTENT = (200.0, 230.0, 240.0)
AIR, SKIN, FAT, MUSCLE = -1000, 45, -95, 55
FLUID, WHITE, GREY = 8, 30, 39
TABLE, DIPLOE, TOOTH, FILLING = 1550, 640, 2500, 3000
NOISE = 6.0
EDGE_VOXELS = 2.6
SLAB = 16


class HeadPhantom(NamedTuple):
    """A synthetic CT volume.

    Attributes
    ----------
    values : numpy.ndarray
        int16 HU, indexed [k, j, i].
    spacing : tuple of float
        mm along i, j, k.
    origin : tuple of float
        LPS mm of the voxel [0, 0, 0].
    """

    values: NDArray[np.int16]
    spacing: tuple[float, float, float]
    origin: tuple[float, float, float]


def head_phantom(size: int = 192) -> HeadPhantom:
    """Make the synthetic CT head, 200 x 230 x 240 mm between its outer points.

    Parameters
    ----------
    size : int
        Voxels along each axis, at least 16. 192 gives voxels of about 1.05 x 1.2 x 1.26 mm and
        takes about one second; thin bone needs that, the rest is fine at 64.

    Returns
    -------
    HeadPhantom
        Values (int16 HU, [k, j, i]), spacing and origin (mm).

    Raises
    ------
    ValueError
        Where `size` is below 16.
    """
    if size < 16:
        raise ValueError(f"size must be at least 16 voxels, got {size}")
    x, y, z = (np.linspace(-e / 2, e / 2, size, dtype=np.float32) for e in EXTENT)
    spacing = (EXTENT[0] / (size - 1), EXTENT[1] / (size - 1), EXTENT[2] / (size - 1))
    edge = EDGE_VOXELS * max(spacing)
    values = np.empty((size, size, size), np.int16)
    # slabs, so that the temporary fields stay in the processor's cache
    for start in range(0, size, SLAB):
        slab = slice(start, start + SLAB)
        grid = Grid(x[None, None], y[None, :, None], z[slab, None, None])
        values[slab] = np.rint(_scan(_head(grid, edge), seed=start))
    return HeadPhantom(values, spacing, (-EXTENT[0] / 2, -EXTENT[1] / 2, -EXTENT[2] / 2))


def _head(grid: Grid, edge: float) -> Field:
    right = grid.x.size // 2
    half = _tissues(Grid(grid.x[:, :, right:], grid.y, grid.z), edge)
    head = np.concatenate([half[:, :, ::-1][:, :, :right], half], axis=2)
    _paint(head, grid, skeleton.LEFT_FILLING, FILLING, edge)
    return head


def _scan(values: Field, seed: int) -> Field:
    """Add the noise of a scanner where there is tissue."""
    noise = np.random.default_rng(seed).standard_normal(values.shape, np.float32)
    return values + noise * np.clip((values - AIR) * (NOISE / 600), 0, NOISE)


def _blend(values: Field, share: Field, hounsfield: Field | float) -> None:
    values += share * (hounsfield - values)


def _paint(values: Field, grid: Grid, shape: Shape, hounsfield: float, edge: float) -> None:
    window = grid.window(*shape.box(), edge)
    if window is not None:
        share = cover(shape.distance(grid.part(window)), edge)
        _blend(values[window], share, hounsfield)


def _gyroid(grid: Grid, period: float) -> Field:
    """Return a smooth labyrinth, -1.5 to 1.5: the texture of cortex, marrow and muscle."""
    (sx, cx), (sy, cy), (sz, cz) = (
        (np.sin(a * (2 * np.pi / period)), np.cos(a * (2 * np.pi / period))) for a in grid
    )
    return sx * cy + sy * cz + sz * cx


def _tissues(grid: Grid, edge: float) -> Field:
    skin = sculpt(anatomy.SKIN, grid)
    values = np.full(grid.shape, AIR, np.float32)
    _blend(values, cover(skin, edge), SKIN)
    _blend(values, cover(skin + 2.0, edge), FAT)
    below_scalp = np.clip(1 - grid.z / 20, 0, 1)
    planes = np.clip(1 - 8 * np.abs(_gyroid(grid, 44)), 0, 1) * below_scalp
    flesh = MUSCLE + (FAT + 30 - MUSCLE) * planes
    _blend(values, cover(skin + 5.0, edge), flesh)
    for _, hounsfield, shape in anatomy.SOFT:
        _paint(values, grid, shape, hounsfield, edge)
    cavity = sculpt(skeleton.BRAINCASE, grid)
    _brain(values, grid, cavity, edge)
    _bones(values, grid, cavity, skin, edge)
    _blend(values, cover(-2.0 - skin, edge), SKIN)
    _blend(values, cover(-skin, edge), AIR)
    for _, shape in anatomy.AIR:
        _paint(values, grid, shape, AIR, edge)
    for _, hounsfield, shape in anatomy.TURBINATES:
        _paint(values, grid, shape, hounsfield, edge)
    return values


def _bones(values: Field, grid: Grid, cavity: Field, skin: Field, edge: float) -> None:
    wall = 8.0 - 2.5 * (grid.x / 66) ** 2
    bone = sculpt(skeleton.FACE_BONES, grid, np.maximum(cavity - wall, -cavity))
    for group in (skeleton.JAW, skeleton.NECK_BONES):
        bone = np.minimum(bone, sculpt(group, grid))
    bone = np.maximum(np.maximum(bone, -cavity), skin + 3.0)
    marrow = DIPLOE + 90 * _gyroid(grid, 7)
    hounsfield = TABLE + np.clip((-1.9 - bone) / 1.2, 0, 1) * (marrow - TABLE)
    _blend(values, cover(bone, edge), hounsfield)
    teeth = sculpt(skeleton.TEETH, grid)
    _blend(values, cover(teeth, edge), TOOTH)


def _brain(values: Field, grid: Grid, cavity: Field, edge: float) -> None:
    fold = np.abs(_gyroid(grid, 26))
    depth = -1.5 - cavity
    rind = np.clip((14 - depth) / 2, 0, 1)
    grey = np.maximum(np.clip(4.5 - depth, 0, 1), rind * np.clip(3 - fold * 5, 0, 1))
    matter = WHITE + (GREY - WHITE) * grey
    matter += rind * np.clip(1.2 - fold * 8, 0, 1) * (FLUID - matter)
    _blend(values, cover(cavity, edge), FLUID)
    _blend(values, cover(-depth, edge), matter)
    for _, hounsfield, shape in anatomy.BRAIN:
        _paint(values, grid, shape, hounsfield, edge)
