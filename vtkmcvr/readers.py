"""Read medical and scientific volume files into an image with its place in the world."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .reading.choice import list_path, open_path, unpack
from .reading.dicom_series import SeriesInfo
from .reading.errors import VolumeReadError, fail
from .reading.image import place_volume, to_image
from .reading.labels import check_labels, name_labels, on_grid
from .reading.numpy_files import volume_from_array
from .reading.options import checked_options
from .reading.raw import RawLayout
from .reading.resample import is_sheared, to_box
from .reading.source import amount, check_memory, chosen_volume, time_notes
from .reading.volume import LoadedVolume, check_geometry
from .recorded_facts import Segment, modality, notes, segments, units

if TYPE_CHECKING:
    from collections.abc import Callable
    from os import PathLike

    import numpy as np
    import pyvista
    from vtkmodules.vtkCommonDataModel import vtkImageData

    from .reading.options import ReadOptions
    from .reading.source import VolumeSource

__all__ = [
    "LoadedVolume",
    "RawLayout",
    "Segment",
    "SeriesInfo",
    "VolumeReadError",
    "list_series",
    "modality",
    "notes",
    "read",
    "read_labels",
    "read_vtk",
    "segments",
    "time_steps",
    "units",
]


def read(source: str | PathLike[str] | np.ndarray, **options: Any) -> pyvista.ImageData:
    """Read a volume with its origin, spacing and direction matrix.

    Reads DICOM (a folder with folders in it, a zip archive, a DICOMDIR or one file), NRRD,
    NIfTI-1 and -2, MetaImage, VTK images, TIFF stacks, SLC, NumPy files and arrays, and raw
    voxels. `docs/reading.md` has the table.

    Parameters
    ----------
    source : path-like or numpy.ndarray
        File or folder, or an array (k, j, i) or (k, j, i, component).
    **options
        See `read_vtk`.

    Returns
    -------
    pyvista.ImageData
        World coordinates are LPS in mm for medical formats, where the point array is named
        "values"; ``.vti`` and ``.vtk`` keep their own arrays. A gantry tilt stays as shear in
        the direction matrix. `notes`, `modality`, `units` and `segments` tell what else is known.

    Raises
    ------
    VolumeReadError
        If the input is not one regular 3-D volume; the message says what to do.
    """
    import pyvista

    image: Any = read_vtk(source, **options)
    return pyvista.ImageData(image)


def read_vtk(
    source: str | PathLike[str] | np.ndarray,
    *,
    series: str | int | None = None,
    time: int | None = None,
    resample: bool = False,
    ignore: str | tuple[str, ...] | None = None,
    units: str | None = None,
    spacing: Any = None,
    origin: Any = None,
    direction: Any = None,
    raw: Any = None,
    threads: int | None = None,
    progress: Callable[[float, str], None] | None = None,
) -> vtkImageData:
    """Read a volume as `read` does, without PyVista.

    Parameters
    ----------
    source : path-like or numpy.ndarray
        File or folder, or an array (k, j, i) or (k, j, i, component).
    series : str or int, optional
        Of several DICOM series: the number, instance UID or part of the description. Without
        it, the series with the most slices is read. `list_series` lists them.
    time : int, optional
        Volume of a 4-D source, from 0. Without it the first time step is read; volumes that
        differ in another way, such as the echo time, have to be chosen.
    resample : bool, optional
        Interpolate linearly onto a box with even steps where slices lie at uneven positions,
        are missing, or are sheared by gantry tilt. Otherwise shear is kept, the others refused.
    ignore : str or sequence of str, optional
        What to leave out of a DICOM series: "duplicates", "orientations", "image types",
        "sizes" (all but the first or the most frequent of them), "unplaced" or "damaged".
    units : str, optional
        "suv": PET as standardised uptake value by body weight.
    spacing, origin, direction : sequence, optional
        Place in the world in mm, instead of the file's; 3, 3 and 3 x 3 numbers.
    raw : mapping, RawLayout or str, optional
        Layout of a file without header: size (i, j, k), dtype, and perhaps byte_order, offset
        and components; or text such as "256x256x113:uint16:big".
    threads : int, optional
        Threads that decode slices; by default one per CPU of the process.
    progress : callable, optional
        Called with the share that is done, 0 to 1, and what is being done.

    Returns
    -------
    vtkImageData
        The volume, as described in `read`.

    Raises
    ------
    VolumeReadError
        If the input is not one regular 3-D volume, or needs more memory than is free.
    ValueError, TypeError
        For an option that means nothing.
    """
    options = checked_options(
        series=series, time=time, resample=resample, ignore=ignore, units=units, spacing=spacing,
        origin=origin, direction=direction, raw=raw, threads=threads, progress=progress,
    )  # fmt: skip
    if hasattr(source, "__array__"):
        name = Path("array")
        return to_image(name, _finished(name, volume_from_array(name, source, options), options))
    return _from_path(Path(source), options, lambda path: _image(path, options))


def read_labels(
    path: str | PathLike[str],
    *,
    like: vtkImageData | None = None,
    table: str | PathLike[str] | None = None,
    series: str | int | None = None,
    time: int | None = None,
) -> pyvista.ImageData:
    """Read a segmentation with the names and colours of its labels.

    Parameters
    ----------
    path : path-like
        A label map in any format of `read`, a 3D Slicer .seg.nrrd or a DICOM SEG.
    like : vtkImageData, optional
        The volume on whose grid the labels shall lie; each voxel gets the nearest label.
    table : path-like, optional
        Names and colours: .ctbl, .txt, .tsv, .json or .label. Without it those in the file,
        or in a table of the same name beside it, are used.
    series, time
        As for `read`.

    Returns
    -------
    pyvista.ImageData
        The point array "values" is uint8 or uint16, 0 where there is no segment. `segments`
        tells the names and colours.

    Raises
    ------
    VolumeReadError
        If the file holds no labels, or is refused by `read`.
    """
    import pyvista

    options = checked_options(series=series, time=time)

    def load(source: Path) -> vtkImageData:
        volume = _loaded(source, open_path(source, options), options)
        check_labels(source, volume)
        name_labels(Path(path), volume, None if table is None else Path(table))
        return to_image(source, volume if like is None else on_grid(volume, like))

    image: Any = _from_path(Path(path), options, load)
    return pyvista.ImageData(image)


def list_series(path: str | PathLike[str]) -> list[SeriesInfo]:
    """List the DICOM series of a folder, zip archive or DICOMDIR by their headers.

    Parameters
    ----------
    path : path-like

    Returns
    -------
    list of SeriesInfo
        By number. Descriptions are free text and may name the patient.

    Raises
    ------
    VolumeReadError
        If a file is damaged.
    """
    options = checked_options(ignore="damaged")
    return _from_path(Path(path), options, lambda source: list_path(source, options))


def time_steps(path: str | PathLike[str], *, series: str | int | None = None) -> list[float]:
    """List the volumes of a 4-D source by its headers.

    Parameters
    ----------
    path : path-like
    series : str or int, optional
        As for `read`.

    Returns
    -------
    list of float
        One value per volume: seconds where they are known, else 0, 1, 2 ...

    Raises
    ------
    VolumeReadError
        If the source is refused.
    """
    options = checked_options(series=series)

    def times(source: Path) -> list[float]:
        found = open_path(source, options)
        return [0.0] if found is None else [float(time) for time in found.times]

    return _from_path(Path(path), options, times)


def _from_path(source: Path, options: ReadOptions, work: Callable[[Path], Any]) -> Any:
    """Do `work` on a path, or on what a zip archive holds, and name `source` in every error."""
    opened = source
    try:
        with ExitStack() as stack:
            opened = unpack(source, options, stack)
            return work(opened)
    except VolumeReadError as error:
        if opened == source:
            raise
        raise VolumeReadError(str(error).replace(str(opened), str(source))) from None
    except MemoryError:
        raise VolumeReadError(f"{source}: not enough memory; close other programs.") from None
    except OSError as error:
        reason = error.strerror or "the system refuses"
        raise VolumeReadError(f"{source}: cannot be read ({reason}); check the path.") from None


def _image(source: Path, options: ReadOptions) -> vtkImageData:
    found = open_path(source, options)
    if found is None:
        from .reading.vtk_files import read_vtk_image

        return read_vtk_image(source, options)
    return to_image(source, _loaded(source, found, options))


def _loaded(source: Path, found: VolumeSource | None, options: ReadOptions) -> LoadedVolume:
    if found is None:
        fail(source, "VTK images hold no label map that is read here; save it as .nrrd")
    index = chosen_volume(source, found, options.time)
    check_memory(source, found)
    options.progress(0.0, f"{' x '.join(map(str, found.size))} voxels, {amount(found.memory)}")
    volume = found.load(index)
    volume.notes += time_notes(found, index)
    return _finished(source, volume, options)


def _finished(source: Path, volume: LoadedVolume, options: ReadOptions) -> LoadedVolume:
    place_volume(volume, options)
    check_geometry(source, volume)
    if options.units == "suv" and volume.units != "SUV":
        fail(source, "units='suv' is for PET in DICOM; leave out units to read it")
    if options.resample and is_sheared(volume.direction):
        return to_box(volume)
    return volume
