"""Read VTK's own image files, which keep their arrays."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, Any

import numpy as np

from ..recorded_facts import modality, notes, record_facts, segments, units
from .errors import fail, header_errors
from .image import place_image, to_image
from .resample import is_sheared, to_box
from .source import check_bytes
from .streams import check_promise
from .volume import LoadedVolume, check_dimension, check_geometry, volume_notes
from .vtk_blocks import check_blocks

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from numpy.typing import NDArray
    from vtkmodules.vtkCommonDataModel import vtkImageData

    from .options import ReadOptions

BYTES = {
    "bit": 1, "char": 1, "unsigned_char": 1, "signed_char": 1, "short": 2, "unsigned_short": 2,
    "int": 4, "unsigned_int": 4, "long": 8, "unsigned_long": 8, "vtkidtype": 4, "float": 4,
    "double": 8, "vtktypeint64": 8, "vtktypeuint64": 8,
}  # fmt: skip
LEGACY_HEAD = 4096
# Nine components of eight bytes.
LARGEST_VOXEL = 72
LINE_LIMIT = 256


def read_vtk_image(source: Path, options: ReadOptions) -> vtkImageData:
    """Read a .vti or legacy .vtk file, with one of its arrays active.

    Raises
    ------
    VolumeReadError
        If the file is damaged or holds no regular 3-D image.
    """
    from vtkmodules.vtkCommonDataModel import vtkImageData

    if options.time not in (None, 0):
        fail(source, f"there is no volume with time={options.time}; allowed is only 0")
    if not _is_vti(source):
        with header_errors(source):
            _check_legacy(source)
    output = _run_vtk_reader(source)
    if not isinstance(output, vtkImageData):
        fail(source, f"holds {output.GetClassName()}, not an image; give vtkImageData")
    image = vtkImageData()
    image.ShallowCopy(output)
    place_image(image, options)
    check_dimension(source, image.GetDimensions())
    noted = [*notes(image), f"read as VTK {'XML image' if _is_vti(source) else 'legacy file'}"]
    noted += _choose_active_array(source, image)
    volume = LoadedVolume(
        values=_active_values(image),
        spacing=np.array(image.GetSpacing()),
        origin=np.array(image.GetOrigin()),
        direction=np.reshape(image.GetDirectionMatrix().GetData(), (3, 3)),
        segments=segments(image),
    )
    check_geometry(source, volume)
    if options.resample and is_sheared(volume.direction):
        volume.values = volume.values.reshape(
            *image.GetDimensions()[::-1], *volume.values.shape[1:]
        )
        volume.notes, volume.modality, volume.units = noted, modality(image), units(image)
        return to_image(source, to_box(volume))
    record_facts(
        image, noted + volume_notes(volume), modality(image), units(image), volume.segments
    )
    return image


def _is_vti(source: Path) -> bool:
    return source.suffix.lower() == ".vti"


def _run_vtk_reader(source: Path) -> Any:
    from vtkmodules.vtkIOLegacy import vtkGenericDataObjectReader
    from vtkmodules.vtkIOXML import vtkXMLImageDataReader

    reader = vtkXMLImageDataReader() if _is_vti(source) else vtkGenericDataObjectReader()
    reader.SetFileName(str(source))
    with _vtk_messages() as messages:
        if _is_vti(source):
            reader.UpdateInformation()
            if not messages.GetOutput():
                _check_extent(source, reader)
        if not messages.GetOutput():
            reader.Update()
    output = reader.GetOutputDataObject(0)
    if messages.GetOutput() or output is None:
        fail(source, "not a whole VTK file: damaged, truncated or of another kind; write it again")
    return output


def _check_extent(source: Path, reader: Any) -> None:
    """Refuse extents that VTK would allocate memory for without looking at the file."""
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline

    key = vtkStreamingDemandDrivenPipeline.WHOLE_EXTENT()
    extent = reader.GetOutputInformation(0).Get(key)
    size = [extent[2 * axis + 1] - extent[2 * axis] + 1 for axis in range(3)]
    if min(size) < 1:
        fail(source, "its extent is empty; write it again")
    check_dimension(source, size)
    voxels = int(np.prod(size, dtype=object))
    check_blocks(source, voxels * LARGEST_VOXEL)
    count = voxels * max(reader.GetNumberOfPointArrays(), 1)
    # In the file, zlib, lz4 or lzma may have packed the voxels.
    check_promise(source, [source], "gzip", count)
    check_bytes(source, count, " x ".join(map(str, size)))


def _check_legacy(source: Path) -> None:
    """Refuse sizes beyond the file, for which the VTK reader would allocate memory."""
    with source.open("rb") as stream:
        head = stream.read(LEGACY_HEAD).decode("ascii", errors="replace")
    words = head.split()
    lower = [word.lower() for word in words]
    if "dimensions" not in lower:
        return
    at = lower.index("dimensions")
    size = [int(word) for word in words[at + 1 : at + 4]]
    if min(size) < 1:
        raise ValueError("dimensions below 1")
    if "scalars" in lower:
        at = lower.index("scalars")
        kind = BYTES.get(lower[at + 2], 1) if "binary" in lower else 1
        bits = lower[at + 2] == "bit"
        promised = int(np.prod(size, dtype=object)) * kind // (8 if bits else 1)
        check_promise(source, [source], "raw", promised)


@contextlib.contextmanager
def _vtk_messages() -> Iterator[Any]:
    """Collect VTK's messages, which its readers give instead of raising, off the screen."""
    from vtkmodules.vtkCommonCore import vtkLogger, vtkOutputWindow, vtkStringOutputWindow

    window, before = vtkStringOutputWindow(), vtkOutputWindow.GetInstance()
    verbosity = vtkLogger.GetCurrentVerbosityCutoff()
    vtkOutputWindow.SetInstance(window)
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    try:
        yield window
    finally:
        vtkLogger.SetStderrVerbosity(verbosity)
        vtkOutputWindow.SetInstance(before)


def _choose_active_array(source: Path, image: vtkImageData) -> list[str]:
    points, cells = image.GetPointData(), image.GetCellData()
    if points.GetNumberOfArrays() == 0 and cells.GetNumberOfArrays() == 0:
        fail(source, "the image has no values; give one with a point or cell array")
    data = points if points.GetNumberOfArrays() else cells
    if data.GetScalars() is None:
        data.SetActiveScalars(data.GetArrayName(0))
    names = [data.GetArrayName(index) for index in range(data.GetNumberOfArrays())]
    noted = [] if data is points else ["the values belong to cells, not to points"]
    if len(names) > 1:
        noted.append(f"arrays {', '.join(names)}; active: {data.GetScalars().GetName()}")
    return noted


def _active_values(image: vtkImageData) -> NDArray[Any]:
    from vtkmodules.util.numpy_support import vtk_to_numpy

    scalars = image.GetPointData().GetScalars() or image.GetCellData().GetScalars()
    return vtk_to_numpy(scalars)
