"""Decode the slices of one DICOM series, on the geometry that their headers give."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .dicom_geometry import judge_stack
from .dicom_headers import varying
from .dicom_values import IDENTITY_RESCALE, check_rescale, describe_values, place_volume
from .errors import VolumeReadError
from .itk import quiet_itk, volume_from_itk

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .dicom_headers import SliceHeader
    from .volume import LoadedVolume


def read_slices(headers: Sequence[SliceHeader], label: str) -> LoadedVolume:
    """Read the slices of one series, one file each.

    Parameters
    ----------
    headers : sequence of SliceHeader
        Two or more slices of equal size, in any order.
    label : str
        How to name the series in an error.

    Returns
    -------
    LoadedVolume
        Slices sorted along their normal, rescaled slice by slice.

    Raises
    ------
    VolumeReadError
        If the slices are not one regular stack, or their pixels cannot be decoded.
    """
    planes = [header.plane for header in headers if header.plane is not None]
    if len(planes) < len(headers):
        raise VolumeReadError(
            f"{label}: {len(headers) - len(planes)} of {len(headers)} slices have no position, "
            "orientation or pixel spacing, so their place is unknown; export the original series."
        )
    geometry = judge_stack(planes, label, varying(headers))
    check_rescale([header.rescale for header in headers], label)
    ordered = [headers[index] for index in geometry.order]
    volume = volume_from_itk(_decode_slices(ordered, label), ["read as DICOM series"])
    expected = (len(ordered), ordered[0].rows, ordered[0].columns)
    if volume.values.shape[:3] != expected:
        raise VolumeReadError(
            f"{label}: the decoded pixels do not fit the headers; export the series again."
        )
    return describe_values(place_volume(volume, geometry), ordered)


def _decode_slices(headers: Sequence[SliceHeader], label: str) -> Any:
    with quiet_itk() as sitk:
        reader = sitk.ImageSeriesReader()
        reader.SetImageIO("GDCMImageIO")
        reader.SetFileNames([str(header.path) for header in headers])
        reader.ForceOrthogonalDirectionOff()
        if _pixel_types_differ(headers):
            # SimpleITK would round every slice to the type that suits the first one.
            reader.SetOutputPixelType(sitk.sitkFloat64)
        try:
            return reader.Execute()
        except RuntimeError as error:
            raise VolumeReadError(
                f"{label}: the pixels of a slice cannot be decoded: a file is damaged, truncated "
                "or compressed in an unsupported way; copy or export the series again."
            ) from error


def _pixel_types_differ(headers: Sequence[SliceHeader]) -> bool:
    kinds = {(header.rescale or IDENTITY_RESCALE, header.pixel_format) for header in headers}
    return len(kinds) > 1 and all(header.pixel_format[2] == 1 for header in headers)
