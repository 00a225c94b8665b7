"""Put a label map onto the grid of a volume."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..recorded_facts import Segment
from .colours import spread_colour
from .errors import VolumeReadError
from .itk import image_from_volume
from .segments import read_sidecar, sidecar_of
from .volume import LoadedVolume

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray
    from vtkmodules.vtkCommonDataModel import vtkImageData

HIGHEST_LABEL = 65535
SAME_PLACE = 1e-3


def check_labels(source: Path, volume: LoadedVolume) -> None:
    """Make the values of `volume` labels, uint8 or uint16.

    Raises
    ------
    VolumeReadError
        If they are not whole numbers from 0 to 65535, one per voxel.
    """
    values = volume.values
    if values.ndim != 3:
        raise VolumeReadError(f"{source}: {values.shape[3]} components are no labels; give one.")
    whole = values.dtype.kind in "iu" or bool(np.array_equal(values, np.rint(values)))
    if not whole or values.min() < 0 or values.max() > HIGHEST_LABEL:
        raise VolumeReadError(
            f"{source}: labels are whole numbers from 0 to {HIGHEST_LABEL}, and the values run "
            f"from {float(values.min()):g} to {float(values.max()):g}; give a label map."
        )
    volume.values = values.astype(np.uint8 if values.max() < 256 else np.uint16, copy=False)


def name_labels(source: Path, volume: LoadedVolume, table: Path | None) -> None:
    """Give each label a name and a colour: from `table`, the file, a table beside it, or made up.

    Raises
    ------
    VolumeReadError
        If the table cannot be read.
    """
    if table is None and not volume.segments:
        table = sidecar_of(source)
    if table is not None:
        volume.segments = read_sidecar(table)
    named = {segment.value for segment in volume.segments}
    present = [int(value) for value in np.unique(volume.values) if value]
    volume.segments += [
        Segment(value, str(value), spread_colour(value)) for value in present if value not in named
    ]


def on_grid(volume: LoadedVolume, like: vtkImageData) -> LoadedVolume:
    """Return labels at the points of `like`: the nearest one, 0 outside."""
    import SimpleITK

    target = _grid_of(like)
    if _same_grid(volume, target):
        return volume
    resampler = SimpleITK.ResampleImageFilter()
    resampler.SetReferenceImage(image_from_volume(target))
    resampler.SetInterpolator(SimpleITK.sitkNearestNeighbor)
    resampler.SetDefaultPixelValue(0.0)
    moved = resampler.Execute(image_from_volume(volume))
    target.values = SimpleITK.GetArrayFromImage(moved)
    target.notes = [*volume.notes, "labels put onto the grid of another volume"]
    target.modality, target.segments = volume.modality, volume.segments
    lost = set(np.unique(volume.values).tolist()) - set(np.unique(target.values).tolist())
    if lost:
        target.notes.append(f"{len(lost)} labels have no voxel on that grid")
    return target


def _grid_of(image: vtkImageData) -> LoadedVolume:
    size = image.GetDimensions()
    extent = image.GetExtent()
    direction = np.reshape(image.GetDirectionMatrix().GetData(), (3, 3)).astype(np.float64)
    spacing = np.array(image.GetSpacing())
    first = np.array(extent[::2]) * spacing
    empty: NDArray[Any] = np.broadcast_to(np.uint8(0), size[::-1])
    return LoadedVolume(
        values=np.ascontiguousarray(empty),
        spacing=spacing,
        origin=np.array(image.GetOrigin()) + direction @ first,
        direction=direction,
    )


def _same_grid(one: LoadedVolume, other: LoadedVolume) -> bool:
    if one.values.shape != other.values.shape:
        return False
    # Compare where the last voxel lies as well, for small errors of direction add up.
    last = np.array(one.values.shape[2::-1]) - 1
    ends = [
        (v.origin, v.origin + v.direction @ (v.spacing * last), v.direction @ v.spacing)
        for v in (one, other)
    ]
    step = float(one.spacing.min())
    return all(
        np.allclose(a, b, rtol=0.0, atol=SAME_PLACE * step) for a, b in zip(*ends, strict=True)
    )
