"""Choose the reader for a path."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .archive import unpacked
from .dicom_series import list_dicom, open_dicom
from .errors import fail
from .metaimage import open_metaimage
from .nifti import open_nifti
from .nrrd import open_nrrd
from .numpy_files import open_numpy
from .raw import open_raw
from .slc import open_slc
from .tiff import is_tiff, open_tiff

if TYPE_CHECKING:
    from collections.abc import Callable
    from contextlib import ExitStack
    from pathlib import Path

    from .dicom_series import SeriesInfo
    from .options import ReadOptions
    from .source import VolumeSource

READERS: tuple[tuple[tuple[str, ...], Callable[[Path, ReadOptions], VolumeSource]], ...] = (
    ((".nrrd", ".nhdr"), open_nrrd),
    ((".nii", ".nii.gz", ".img", ".img.gz", ".hdr.gz"), open_nifti),
    ((".mha", ".mhd"), open_metaimage),
    ((".tif", ".tiff"), open_tiff),
    ((".npy", ".npz"), open_numpy),
    ((".slc",), open_slc),
    ((".raw", ".bin", ".raw.gz", ".raw.bz2"), open_raw),
)
VTK_SUFFIXES = (".vti", ".vtk")
ALLOWED = (
    ".nrrd, .nhdr, .nii, .nii.gz, .hdr, .img, .mha, .mhd, .vti, .vtk, .tif, .tiff, .npy, .npz, "
    ".slc, .raw with a layout, .zip, DICOM files, a DICOM folder or DICOMDIR"
)
DICOM_SUFFIXES = (".dcm", ".dicom", ".ima", ".dic")


def unpack(source: Path, options: ReadOptions, stack: ExitStack) -> Path:
    """Return what to read for `source`: itself, or what a zip archive holds.

    Raises
    ------
    VolumeReadError
        If there is no such file, or the archive is refused.
    """
    if not source.exists():
        fail(source, "no such file or folder; check the path")
    if not source.is_dir() and not source.is_file():
        fail(source, "neither a file nor a folder; give one of them")
    if source.is_dir() or source.suffix.lower() != ".zip":
        return source
    folder = unpacked(source, options, stack)
    files = [file for file in folder.iterdir() if file.suffix.lower() not in DICOM_SUFFIXES]
    volumes = [file for file in files if _is_volume(file)]
    return volumes[0] if len(volumes) == 1 else folder


def open_path(source: Path, options: ReadOptions) -> VolumeSource | None:
    """Find and judge the volume in a file or folder; None stands for a VTK image.

    Raises
    ------
    VolumeReadError
        If there is no volume, or it is refused.
    """
    if source.is_dir():
        return open_tiff(source, options) if _holds_tiff(source) else open_dicom(source, options)
    if _is_dicom_file(source):
        return open_dicom(source, options)
    if options.series is not None:
        fail(source, "'series' is only for DICOM folders; leave it out for a single file")
    if source.stat().st_size == 0:
        fail(source, "the file is empty; copy or export it again")
    return _open_file(source, options)


def list_path(source: Path, options: ReadOptions) -> list[SeriesInfo]:
    """List the DICOM series of a file or folder."""
    if not source.is_dir() and not _is_dicom_file(source):
        return []
    return list_dicom(source, options)


def _open_file(source: Path, options: ReadOptions) -> VolumeSource | None:
    name = source.name.lower()
    if options.raw is not None:
        return open_raw(source, options)
    if name.endswith(VTK_SUFFIXES):
        return None
    if name.endswith(".hdr") and not _is_radiance(source):
        return open_nifti(source, options)
    for suffixes, reader in READERS:
        if name.endswith(suffixes):
            return reader(source, options)
    if name.endswith(DICOM_SUFFIXES):
        fail(source, "not a DICOM file (the mark 'DICM' is missing); export it again")
    if name.endswith((".hdr", ".exr")):
        fail(source, "an environment map is not a volume; vtkmcvr.read_environment reads it")
    fail(source, f"unknown kind of file; allowed are {ALLOWED}")


def _is_dicom_file(source: Path) -> bool:
    with source.open("rb") as stream:
        return stream.read(132)[128:] == b"DICM"


def _is_radiance(source: Path) -> bool:
    with source.open("rb") as stream:
        return stream.read(2) == b"#?"


def _is_volume(source: Path) -> bool:
    suffixes = (*VTK_SUFFIXES, *(suffix for group, _ in READERS for suffix in group))
    return source.name.lower().endswith(suffixes) and not _is_dicom_file(source)


def _holds_tiff(folder: Path) -> bool:
    files = [entry for entry in folder.iterdir() if entry.is_file()]
    return any(map(is_tiff, files)) and not any(map(_is_dicom_file, files))
