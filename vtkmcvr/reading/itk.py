"""Read through SimpleITK, quietly."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, Any

import numpy as np

from .compact import compact_values
from .errors import VolumeReadError
from .volume import LoadedVolume, check_dimension

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


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


def read_with_itk(source: Path, image_io: str, kind: str) -> LoadedVolume:
    """Read one file through the named ITK image reader.

    Raises
    ------
    VolumeReadError
        If the file is damaged or not 3-D.
    """
    with quiet_itk() as sitk:
        reader = sitk.ImageFileReader()
        reader.SetImageIO(image_io)
        reader.SetFileName(str(source))
        try:
            reader.ReadImageInformation()
            check_dimension(source, reader.GetSize())
            image = reader.Execute()
        except RuntimeError as error:
            raise VolumeReadError(
                f"{source}: the {kind} data cannot be read: the file is damaged, truncated or of "
                "an unsupported variant; copy or export it again."
            ) from error
    return volume_from_itk(image, [f"read as {kind}"])


def volume_from_itk(image: Any, noted: list[str]) -> LoadedVolume:
    """Convert a SimpleITK image to voxels and geometry, in a compact type."""
    import SimpleITK

    while image.GetDimension() > 3:
        image = image[(slice(None),) * (image.GetDimension() - 1) + (0,)]
    values = compact_values(SimpleITK.GetArrayViewFromImage(image), noted)
    return LoadedVolume(
        values=values,
        spacing=np.array(image.GetSpacing(), dtype=np.float64),
        origin=np.array(image.GetOrigin(), dtype=np.float64),
        direction=np.array(image.GetDirection(), dtype=np.float64).reshape(3, 3),
        notes=noted,
    )
