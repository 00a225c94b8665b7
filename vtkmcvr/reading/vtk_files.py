"""Read VTK's own image files, which keep their arrays."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, Any

import numpy as np

from ..volume_info import modality, notes, record_facts, units
from .errors import fail
from .volume import LoadedVolume, check_dimension, check_geometry, volume_notes

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from numpy.typing import NDArray
    from vtkmodules.vtkCommonDataModel import vtkImageData


def read_vtk_image(source: Path) -> vtkImageData:
    """Read a .vti or legacy .vtk file, with one of its arrays active.

    Raises
    ------
    VolumeReadError
        If the file is damaged or holds no regular 3-D image.
    """
    from vtkmodules.vtkCommonDataModel import vtkImageData

    output = _run_vtk_reader(source)
    if not isinstance(output, vtkImageData):
        fail(source, f"holds {output.GetClassName()}, not an image; give vtkImageData")
    image = vtkImageData()
    image.ShallowCopy(output)
    check_dimension(source, image.GetDimensions())
    noted = [*notes(image), f"read as VTK {'XML image' if _is_vti(source) else 'legacy file'}"]
    noted += _choose_active_array(source, image)
    volume = LoadedVolume(
        values=_active_values(image),
        spacing=np.array(image.GetSpacing()),
        origin=np.array(image.GetOrigin()),
        direction=np.reshape(image.GetDirectionMatrix().GetData(), (3, 3)),
    )
    check_geometry(source, volume)
    record_facts(image, noted + volume_notes(volume), modality(image), units(image))
    return image


def _is_vti(source: Path) -> bool:
    return source.suffix.lower() == ".vti"


def _run_vtk_reader(source: Path) -> Any:
    from vtkmodules.vtkIOLegacy import vtkGenericDataObjectReader
    from vtkmodules.vtkIOXML import vtkXMLImageDataReader

    reader = vtkXMLImageDataReader() if _is_vti(source) else vtkGenericDataObjectReader()
    reader.SetFileName(str(source))
    with _vtk_messages() as messages:
        reader.Update()
    output = reader.GetOutputDataObject(0)
    if messages.GetOutput() or output is None:
        fail(source, "not a whole VTK file: damaged, truncated or of another kind; write it again")
    return output


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
