"""The receivers' part of the plan: affine images of unit shapes, meshes in a hierarchy."""

from __future__ import annotations

import weakref
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import packed
from ..effects import Effect
from ..kernels.bvh_build import BINS, build
from ..pack import f32
from ..receivers import BoxReceiver, MeshReceiver, PlaneReceiver, Receiver, SphereReceiver

PLANE, BOX, SPHERE = 0, 1, 2
MOST_TRIANGLES = 2**29

# Hierarchies by mesh, with the centre that they are relative to
_built: weakref.WeakKeyDictionary[MeshReceiver, tuple[bytes, packed.Mesh | None]] = (
    weakref.WeakKeyDictionary()
)


def pack_receivers(
    receivers: Sequence[Receiver], centre: NDArray
) -> tuple[packed.Receivers | None, packed.Mesh | None, Effect]:
    """Pack receivers around a world position: shapes, meshes, and why."""
    name = "receivers"
    if not receivers:
        return None, None, Effect(name, False, "no surfaces around the volume")
    shapes = [r for r in receivers if not isinstance(r, MeshReceiver)]
    meshes = [r for r in receivers if isinstance(r, MeshReceiver)]
    maps = [_local_from_world(shape, centre) for shape in shapes]
    mesh = _mesh(meshes, centre, len(shapes))
    ordered = [*shapes, *meshes]
    result = packed.Receivers(
        np.array([_kind(shape) for shape in shapes], np.int32),
        np.ascontiguousarray(np.reshape(maps, (-1, 3, 4)), f32),
        np.ascontiguousarray([r.colour for r in ordered], f32),
        np.ascontiguousarray([r.specular for r in ordered], f32),
        np.array([r.exponent for r in ordered], f32),
        f32(max((_reach(r, centre) for r in ordered), default=0.0)),
    )
    parts = [f"{len(shapes)} plane, box or sphere"] if len(shapes) == 1 else []
    if len(shapes) > 1:
        parts.append(f"{len(shapes)} planes, boxes or spheres")
    if mesh is not None:
        parts.append(f"meshes of {len(mesh.triangles)} triangles")
    why = f"{' and '.join(parts)}, opaque: they receive light and cast shadows"
    return result, mesh, Effect(name, True, why)


def glossy(receivers: packed.Receivers | None) -> bool:
    """Whether any receiver has a coat."""
    return receivers is not None and bool(receivers.specular.any())


def _kind(shape: Receiver) -> int:
    return {PlaneReceiver: PLANE, BoxReceiver: BOX, SphereReceiver: SPHERE}[type(shape)]


def _local_from_world(shape: Receiver, centre: NDArray) -> NDArray[np.float64]:
    """World position relative to `centre` -> frame of the unit shape, (3, 4)."""
    if isinstance(shape, PlaneReceiver):
        # A plane without end has no width to divide by: all of it is at the middle
        inverse = np.zeros(2) if shape.size is None else 2 / np.array(shape.size)
        rows = shape.frame.T * np.array([*inverse, 1.0])[:, None]
    elif isinstance(shape, BoxReceiver):
        rows = shape.axes.T * (2 / np.array(shape.size))[:, None]
    else:
        assert isinstance(shape, SphereReceiver)
        rows = np.eye(3) / shape.radius
    return np.hstack([rows, -rows @ (np.array(shape.centre) - centre)[:, None]])


def _reach(receiver: Receiver, centre: NDArray) -> float:
    """Largest distance of its points from `centre`; of a plane without end, to its plane."""
    if isinstance(receiver, MeshReceiver):
        return float(np.abs(receiver.points - centre).max())
    offset = np.subtract(receiver.centre, centre)  # type: ignore[attr-defined]
    if isinstance(receiver, PlaneReceiver) and receiver.size is None:
        return float(abs(offset @ receiver.normal))
    size = 2 * receiver.radius if isinstance(receiver, SphereReceiver) else receiver.size  # type: ignore[attr-defined]
    return float(np.linalg.norm(offset) + np.linalg.norm(size))


def _mesh(meshes: list[MeshReceiver], centre: NDArray, first: int) -> packed.Mesh | None:
    """One hierarchy over all meshes, whose receivers are numbered from `first`."""
    if not meshes:
        return None
    if len(meshes) == 1:
        key = centre.tobytes() + first.to_bytes(4, "little")
        if meshes[0] not in _built or _built[meshes[0]][0] != key:
            _built[meshes[0]] = (key, _hierarchy(meshes, centre, first))
        return _built[meshes[0]][1]
    return _hierarchy(meshes, centre, first)


def _hierarchy(meshes: list[MeshReceiver], centre: NDArray, first: int) -> packed.Mesh | None:
    corners = np.concatenate([(m.points - centre)[m.triangles] for m in meshes])
    owner = np.repeat(np.arange(first, first + len(meshes)), [len(m.triangles) for m in meshes])
    normals = _normals(meshes)
    area = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    solid = np.flatnonzero(area > 0)
    if not len(solid):
        return None
    corners = corners[solid].astype(f32)
    order, nodes = _build(corners)
    corners, solid = corners[order], solid[order]
    return packed.Mesh(  # type: ignore[call-arg]
        *nodes,
        np.ascontiguousarray(corners.reshape(-1, 9), f32),
        np.ascontiguousarray(normals[solid] if len(normals) else normals, f32),
        owner[solid].astype(np.int32),
    )


def _normals(meshes: list[MeshReceiver]) -> NDArray[np.float64]:
    """Unit normals at the corners, (m, 9); (0, 9) where no mesh has any; zeros: flat."""
    if all(m.normals is None for m in meshes):
        return np.empty((0, 9))
    parts = []
    for m in meshes:
        if m.normals is None:
            parts.append(np.zeros((len(m.triangles), 9)))
            continue
        length = np.linalg.norm(m.normals, axis=1, keepdims=True)
        unit = m.normals / np.where(length > 0, length, 1)
        parts.append(unit[m.triangles].reshape(-1, 9))
    return np.concatenate(parts)


def _build(corners: NDArray[np.float32]) -> tuple[NDArray[np.int64], tuple[Any, ...]]:
    """Order of the triangles, and the nodes over them."""
    n = len(corners)
    if n > MOST_TRIANGLES:
        raise ValueError(f"receivers take at most {MOST_TRIANGLES} triangles, got {n}")
    boxes = np.concatenate([corners.min(axis=1), corners.max(axis=1)], axis=1)
    order = np.arange(n)
    bounds = np.zeros((2 * n + 1, 6), f32)
    first, count, axis, parent = (np.zeros(2 * n + 1, np.int32) for _ in range(4))
    used = build(
        boxes, order, bounds, first, count, axis, parent,
        np.empty((BINS + 1, 6), f32), np.empty(BINS, np.int64), np.empty(BINS),
    )  # fmt: skip
    return order, tuple(a[:used].copy() for a in (bounds, first, count, axis, parent))
