"""Give decoded DICOM voxels their place and say what their values mean."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .dicom_headers import rescale_from, value_of
from .errors import VolumeReadError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .dicom_geometry import StackGeometry
    from .dicom_headers import SliceHeader
    from .volume import LoadedVolume

IDENTITY_RESCALE = (1.0, 0.0)


def check_rescale(rescales: Sequence[tuple[float, float] | None], label: str) -> None:
    """Refuse a rescale slope of 0.

    Raises
    ------
    VolumeReadError
        If a slope is 0.
    """
    if any(rescale is not None and rescale[0] == 0.0 for rescale in rescales):
        raise VolumeReadError(
            f"{label}: a rescale slope of 0 would give every pixel the same value; "
            "export the series again."
        )


def place_volume(volume: LoadedVolume, geometry: StackGeometry) -> LoadedVolume:
    """Give `volume` the place that its planes have."""
    volume.origin = geometry.origin
    volume.spacing = geometry.spacing
    volume.direction = geometry.direction
    volume.notes += geometry.notes
    return volume


def describe_values(
    volume: LoadedVolume, headers: Sequence[SliceHeader], transform: Any = None
) -> LoadedVolume:
    """Note modality, units and oddities of the values.

    Parameters
    ----------
    volume : LoadedVolume
        The volume to describe.
    headers : sequence of SliceHeader
        Headers of its slices, or of its one multi-frame file.
    transform : pydicom.Dataset, optional
        The pixel value transformation of a multi-frame file, in place of the header's rescale.
    """
    first = headers[0]
    rescale = first.rescale if transform is None else rescale_from(transform)
    kind = (
        first.rescale_type if transform is None else str(value_of(transform, "RescaleType") or "")
    )
    volume.modality = first.modality
    if first.modality == "CT" and rescale is not None and kind in {"", "HU"}:
        volume.units = "HU"
    volume.notes += _value_notes(headers, rescale, volume.units)
    return volume


def _value_notes(
    headers: Sequence[SliceHeader], rescale: tuple[float, float] | None, unit: str
) -> list[str]:
    first = headers[0]
    noted = []
    if len({header.rescale for header in headers}) > 1:
        noted.append("rescale slope and intercept differ between slices and were applied to each")
    elif rescale not in {None, IDENTITY_RESCALE}:
        noted.append(f"rescaled: value = {rescale[0]:g} x stored + {rescale[1]:g}")
    if rescale is None and not first.is_signed and first.modality == "CT":
        noted.append("stored unsigned without rescale: the values may not be HU")
    if first.modality == "CT" and rescale is not None and not unit:
        noted.append("the rescale type is not HU")
    if first.unit:
        noted.append(f"unit of the values: {first.unit}")
    if first.photometric == "MONOCHROME1":
        noted.append("stored inverted (MONOCHROME1)")
    if first.pixel_format[0] == 1:
        noted.append("1-bit segmentation, kept as 0 and 1")
    return noted
