"""Read through SimpleITK, quietly."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, Any

import numpy as np

from .compact import compact_values
from .errors import VolumeReadError
from .source import VolumeSource
from .volume import LoadedVolume, check_dimension

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from .options import ReadOptions


@contextlib.contextmanager
def quiet_itk() -> Iterator[Any]:
    """Yield the SimpleITK module with its warnings on stderr switched off meanwhile."""
    import SimpleITK

    before = SimpleITK.ProcessObject_GetGlobalWarningDisplay()
    SimpleITK.ProcessObject_SetGlobalWarningDisplay(False)
    try:
        yield SimpleITK
    finally:
        SimpleITK.ProcessObject_SetGlobalWarningDisplay(before)


def open_with_itk(
    source: Path, image_io: str, kind: str, options: ReadOptions, files: Sequence[Path] = ()
) -> VolumeSource:
    """Judge one file by what the named ITK image reader finds in its header.

    Parameters
    ----------
    source : Path
        The file.
    image_io : str
        Name of the ITK reader.
    kind : str
        Name of the format, for notes and errors.
    options : ReadOptions
        What the caller wants.
    files : sequence of Path, optional
        Slices to read instead of `source`, in order.

    Raises
    ------
    VolumeReadError
        If the file is damaged or not 3-D.
    """
    with quiet_itk() as sitk, _itk_errors(source, kind):
        reader = sitk.ImageFileReader()
        reader.SetImageIO(image_io)
        reader.SetFileName(str(files[0] if files else source))
        reader.ReadImageInformation()
        size = list(reader.GetSize())
        value = sitk.Image([1] * len(size), reader.GetPixelID(), reader.GetNumberOfComponents())
    if files:
        size = [*size[:2], len(files)]
    check_dimension(source, size[:3])
    step = reader.GetSpacing()[3] if len(size) > 3 else 1.0
    volumes = int(np.prod(size[3:], dtype=object))
    voxels = int(np.prod(size[:3], dtype=object))
    return VolumeSource(
        size=size[:3],
        memory=3 * voxels * max(volumes, 1) * value.GetSizeOfPixelComponent()
        * value.GetNumberOfComponentsPerPixel(),
        load=lambda index: _load(source, image_io, kind, index, files),
        times=[k * step for k in range(max(volumes, 1))],
    )  # fmt: skip


def _load(
    source: Path, image_io: str, kind: str, index: int, files: Sequence[Path]
) -> LoadedVolume:
    with quiet_itk() as sitk, _itk_errors(source, kind):
        if files:
            reader = sitk.ImageSeriesReader()
            reader.SetFileNames([str(file) for file in files])
        else:
            reader = sitk.ImageFileReader()
            reader.SetFileName(str(source))
        reader.SetImageIO(image_io)
        image = reader.Execute()
    size = image.GetSize()
    while image.GetDimension() > 3:
        last = image.GetDimension() - 1
        part = index % size[last] if last == 3 else 0
        image = image[(slice(None),) * last + (part,)]
    return volume_from_itk(image, [f"read as {kind}"])


@contextlib.contextmanager
def _itk_errors(source: Path, kind: str) -> Iterator[None]:
    try:
        yield
    except RuntimeError:
        raise VolumeReadError(
            f"{source}: the {kind} data cannot be read: the file is damaged, truncated or of "
            "an unsupported variant; copy or export it again."
        ) from None


def volume_from_itk(image: Any, noted: list[str]) -> LoadedVolume:
    """Convert a SimpleITK image to voxels and geometry, in a compact type."""
    import SimpleITK

    values = compact_values(SimpleITK.GetArrayFromImage(image), noted)
    return LoadedVolume(
        values=values,
        spacing=np.array(image.GetSpacing(), dtype=np.float64),
        origin=np.array(image.GetOrigin(), dtype=np.float64),
        direction=np.array(image.GetDirection(), dtype=np.float64).reshape(3, 3),
        notes=noted,
    )


def image_from_volume(volume: LoadedVolume) -> Any:
    """Return a volume as a SimpleITK image."""
    import SimpleITK

    image = SimpleITK.GetImageFromArray(volume.values, isVector=volume.values.ndim == 4)
    image.SetSpacing([float(x) for x in volume.spacing])
    image.SetOrigin([float(x) for x in volume.origin])
    image.SetDirection([float(x) for x in volume.direction.ravel()])
    return image
