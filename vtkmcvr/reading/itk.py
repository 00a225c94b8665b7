"""Read through SimpleITK, quietly."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, Any

from .volume import LoadedVolume

if TYPE_CHECKING:
    from collections.abc import Iterator


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


def image_from_volume(volume: LoadedVolume) -> Any:
    """Return a volume as a SimpleITK image."""
    import SimpleITK

    image = SimpleITK.GetImageFromArray(volume.values, isVector=volume.values.ndim == 4)
    image.SetSpacing([float(x) for x in volume.spacing])
    image.SetOrigin([float(x) for x in volume.origin])
    image.SetDirection([float(x) for x in volume.direction.ravel()])
    return image
