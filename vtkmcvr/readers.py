"""Read medical and scientific volume files into an image with its place in the world."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from .reading.dicom_series import read_dicom
from .reading.errors import VolumeReadError, fail
from .reading.image import to_image
from .reading.metaimage import read_metaimage
from .reading.nifti import read_nifti
from .reading.nrrd import read_nrrd
from .reading.volume import LoadedVolume
from .reading.vtk_files import read_vtk_image
from .volume_info import modality, notes, units

if TYPE_CHECKING:
    from collections.abc import Callable
    from os import PathLike

    import pyvista
    from vtkmodules.vtkCommonDataModel import vtkImageData

__all__ = ["LoadedVolume", "VolumeReadError", "modality", "notes", "read", "read_vtk", "units"]

_MEDICAL_READERS: tuple[tuple[tuple[str, ...], Callable[[Path], LoadedVolume]], ...] = (
    ((".nrrd", ".nhdr"), read_nrrd),
    ((".nii", ".nii.gz"), read_nifti),
    ((".mha", ".mhd"), read_metaimage),
)


def read(path: str | PathLike[str], *, series: str | int | None = None) -> pyvista.ImageData:
    """Read a volume with its origin, spacing and direction matrix.

    Reads NRRD (.nrrd, .nhdr), NIfTI-1 (.nii, .nii.gz), MetaImage (.mha, .mhd), VTK images
    (.vti, .vtk), a folder with a DICOM series, or one multi-frame DICOM file.

    Parameters
    ----------
    path : str or path-like
        The file, or the folder that directly holds the DICOM slices.
    series : str or int, optional
        For a folder with several DICOM series: the series instance UID or the series number.
        Without it, the series with the most slices is read.

    Returns
    -------
    pyvista.ImageData
        World coordinates are LPS in mm for medical formats, where the point array is named
        "values"; ``.vti`` and ``.vtk`` keep their own arrays. A gantry tilt stays as shear in
        the direction matrix. `notes`, `modality` and `units` tell what else is known.

    Raises
    ------
    VolumeReadError
        If the input is not one regular 3-D volume; the message says what to do.
    """
    import pyvista

    image: Any = read_vtk(path, series=series)
    return pyvista.ImageData(image)


def read_vtk(path: str | PathLike[str], *, series: str | int | None = None) -> vtkImageData:
    """Read a volume as `read` does, without PyVista.

    Parameters
    ----------
    path : str or path-like
        The file, or the folder that directly holds the DICOM slices.
    series : str or int, optional
        Series instance UID or series number, for a folder with several DICOM series.

    Returns
    -------
    vtkImageData
        The volume, as described in `read`.

    Raises
    ------
    VolumeReadError
        If the input is not one regular 3-D volume.
    """
    source = Path(path)
    try:
        return _read_path(source, series)
    except OSError as error:
        reason = error.strerror or "the system refuses"
        raise VolumeReadError(f"{source}: cannot be read ({reason}); check the path.") from error


def _read_path(source: Path, series: str | int | None) -> vtkImageData:
    if not source.exists():
        fail(source, "no such file or folder; check the path")
    if source.is_dir() or _is_dicom_file(source):
        return to_image(source, read_dicom(source, series))
    if series is not None:
        fail(source, "'series' is only for DICOM folders; leave it out for a single file")
    if source.stat().st_size == 0:
        fail(source, "the file is empty; copy or export it again")
    return _read_file(source)


def _is_dicom_file(source: Path) -> bool:
    with source.open("rb") as stream:
        return stream.read(132)[128:] == b"DICM"


def _read_file(source: Path) -> vtkImageData:
    name = source.name.lower()
    if name.endswith((".vti", ".vtk")):
        return read_vtk_image(source)
    for suffixes, reader in _MEDICAL_READERS:
        if name.endswith(suffixes):
            return to_image(source, reader(source))
    if name.endswith((".dcm", ".dicom", ".ima", ".dic")):
        fail(source, "not a DICOM file (the mark 'DICM' is missing); export it again")
    fail(
        source,
        "unknown kind of file; allowed are .nrrd, .nhdr, .nii, .nii.gz, .mha, .mhd, .vti, .vtk, "
        "a DICOM folder or a multi-frame DICOM file",
    )
