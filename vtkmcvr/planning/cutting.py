"""The cuts' part of the plan: shapes in index coordinates, and the macrocells that they empty."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from .. import packed
from ..cutting import Box, Cropping, Plane, Shape, Sphere
from ..effects import Effect
from ..pack import f32, matrix, vector
from ..volume import Volume

# A collision is on a cut face when it is at most this many voxels (the smallest spacing) behind it
FACE_DEPTH = 0.5
MIDDLE = (1, 1, 1)


@dataclass
class _Faces:
    """Planes and balls of one kind of cut, in index coordinates."""

    planes: list[NDArray] = field(default_factory=list)
    normals: list[NDArray] = field(default_factory=list)
    spheres: list[NDArray] = field(default_factory=list)

    def add(self, m: NDArray, point: NDArray, normal: NDArray) -> None:
        """Add the half-space to which a unit normal points; the plane runs through a world point.

        `m` is the volume's index-to-world map.
        """
        self.planes.append(np.append(normal @ m[:3, :3], normal @ (m[:3, 3] - point)))
        self.normals.append(normal)

    def tables(self, volume: Volume) -> tuple:
        """Fields of `packed.Clip` and `packed.Holes`."""
        return (
            _table(self.planes, 4), _table(self.normals, 3), _table(self.spheres, 4),
            matrix(volume.index_to_world[:3, :3]), face_depth(volume),
        )  # fmt: skip

    def __bool__(self) -> bool:
        return bool(self.planes or self.spheres)


@dataclass(frozen=True)
class PackedCuts:
    """Cuts of one volume, None where there are none, with their effects."""

    clip: packed.Clip | None
    holes: packed.Holes | None
    regions: packed.Regions | None
    effects: tuple[Effect, ...]

    def empty_cells(self, majorant: NDArray[np.float32], cell: int, last: NDArray) -> None:
        """Set the majorant to zero in cells that are cut off altogether.

        Parameters
        ----------
        majorant : array (k, j, i) of macrocells
        cell : int
            Their edge, index units.
        last : (3,)
            Index coordinates of the volume's last point.
        """
        spans = [
            (cell * np.arange(n), np.minimum(cell * np.arange(1, n + 1), end))
            for n, end in zip(majorant.shape[::-1], last, strict=True)
        ]
        if self.clip is not None:
            for plane in self.clip.planes:
                majorant[_heights(plane, spans, 1) < 0] = 0
            for ball in self.clip.spheres:
                nearest, _ = _distances(self.clip.world_from_index, ball, spans)
                majorant[nearest > ball[3]] = 0
        if self.holes is not None:
            for box in self.holes.planes.reshape(-1, 6, 4):
                majorant[np.all([_heights(plane, spans, -1) > 0 for plane in box], axis=0)] = 0
            for ball in self.holes.spheres:
                _, farthest = _distances(self.holes.world_from_index, ball, spans)
                majorant[farthest < ball[3]] = 0
        if self.regions is not None:
            majorant[~_cells_in_regions(self.regions, spans)] = 0


def pack_cuts(volume: Volume, clip: Sequence[Shape], crop: Cropping | None) -> PackedCuts:
    """Pack the cuts of a volume."""
    kept, holes = _Faces(), _Faces()
    for shape in clip:
        _add_shape(shape, volume, holes if getattr(shape, "keep", "") == "outside" else kept)
    regions, crop_why = _pack_crop(crop, volume, kept)
    effects = (
        Effect("clipping", bool(clip), _clip_reason(clip)),
        Effect("cropping", not crop_why.startswith("the"), crop_why),
    )
    return PackedCuts(
        packed.Clip(*kept.tables(volume)) if kept else None,
        packed.Holes(*holes.tables(volume)) if holes else None,
        regions,
        effects,
    )


def face_depth(volume: Volume) -> np.float32:
    """World distance behind a cut face within which a collision is on it."""
    return f32(FACE_DEPTH * volume.spacing.min())


def _add_shape(shape: Shape, volume: Volume, faces: _Faces) -> None:
    m = volume.index_to_world
    if isinstance(shape, Plane):
        faces.add(m, np.array(shape.origin), np.array(shape.normal))
    elif isinstance(shape, Sphere):
        centre = np.linalg.solve(m[:3, :3], np.subtract(shape.centre, m[:3, 3]))
        faces.spheres.append(np.append(centre, shape.radius))
    else:
        for point, normal in _box_faces(shape):
            faces.add(m, point, normal)


def _box_faces(box: Box) -> Iterator[tuple[NDArray, NDArray]]:
    """Middle and inward normal of each face."""
    for axis, edge in zip(box.axes.T, box.size, strict=True):
        for sign in (-1, 1):
            yield np.add(box.centre, sign * edge / 2 * axis), -sign * axis


def _clip_reason(clip: Sequence[Shape]) -> str:
    if not clip:
        return "no clip planes, boxes or spheres"
    holes = sum(getattr(shape, "keep", "") == "outside" for shape in clip)
    parts = [f"{len(clip) - holes} shorten rays"] if len(clip) > holes else []
    if holes:
        parts.append(f"{holes} cut out, asked at each tentative collision")
    return ", ".join(parts)


def _pack_crop(
    crop: Cropping | None, volume: Volume, kept: _Faces
) -> tuple[packed.Regions | None, str]:
    """Regions, or planes added to `kept` where only the middle region is left; and why."""
    if crop is None:
        return None, "the scene has no cropping regions"
    last = np.array(volume.shape) - 1
    lower, upper = np.array(crop.lower), np.array(crop.upper)
    there = [
        (a > 0, b > 0 and a < end, b < end)
        for a, b, end in zip(lower, upper, last, strict=True)
    ]  # fmt: skip
    exists = np.einsum("x,y,z->zyx", *np.array(there))
    cut = exists & ~crop.kept
    if not cut.any():
        return None, "the cropping regions leave the whole volume"
    m = volume.index_to_world
    up = np.linalg.inv(m[:3, :3])
    pitch = 1 / np.linalg.norm(up, axis=1)
    up *= pitch[:, None]
    if crop.kept[MIDDLE] and np.count_nonzero(exists & crop.kept) == 1:
        for axis in range(3):
            for at, sign, present in ((lower, 1, there[axis][0]), (upper, -1, there[axis][2])):
                if present:
                    kept.add(m, m[:3, 3] + m[:3, axis] * at[axis], sign * up[axis])
        return None, "the middle region alone is kept: it shortens rays"
    regions = packed.Regions(
        vector(lower), vector(upper), np.int32(crop.flags), matrix(up), vector(pitch),
        face_depth(volume),
    )  # fmt: skip
    count = np.count_nonzero(exists & crop.kept)
    return regions, f"{count} of {np.count_nonzero(exists)} regions, asked at each collision"


def _table(rows: list[NDArray], columns: int) -> NDArray[np.float32]:
    return np.ascontiguousarray(np.reshape(rows, (-1, columns)), f32)


def _heights(plane: NDArray, spans: list, side: int) -> NDArray:
    """Height of each cell's highest (side 1) or lowest (-1) corner over a plane, [k, j, i]."""
    choose = np.maximum if side > 0 else np.minimum
    normal = plane[:3].astype(float)
    x, y, z = (choose(a * low, a * high) for a, (low, high) in zip(normal, spans, strict=True))
    return z[:, None, None] + y[:, None] + x + float(plane[3])


def _distances(to_world: packed.Matrix, ball: NDArray, spans: list) -> tuple[NDArray, NDArray]:
    """Bounds of the distance from a ball's centre to the points of each cell, [k, j, i]."""
    m = np.array(to_world, float)
    middle = [
        (low + high) / 2 - c for (low, high), c in zip(spans, ball[:3].astype(float), strict=True)
    ]
    half = np.array([(high - low).max() / 2 for low, high in spans])
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half
    reach = np.linalg.norm(corners @ m.T, axis=1).max()
    x, y, z = middle
    square = sum((row[0] * x + row[1] * y[:, None] + row[2] * z[:, None, None]) ** 2 for row in m)
    distance = np.sqrt(square)
    return distance - reach, distance + reach


def _cells_in_regions(regions: packed.Regions, spans: list) -> NDArray[np.bool_]:
    """Whether any kept region meets each cell, [k, j, i]."""
    meets = [
        np.stack([low < a, (high > a) & (low < b), high > b])
        for (low, high), a, b in zip(spans, regions.lower, regions.upper, strict=True)
    ]
    kept = Cropping((0, 0, 0), (0, 0, 0), int(regions.flags)).kept
    return np.einsum("zyx,xi,yj,zk->kji", kept.astype(int), *(m.astype(int) for m in meets)) > 0
