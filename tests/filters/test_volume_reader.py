"""The reader at the head of a pipeline: volumes, time steps, errors."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import pyvista
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkImagingCore import vtkImageShiftScale

from vtkmcvr.filters import VolumeReader
from vtkmcvr.readers import VolumeReadError, notes

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "reading"))

from made_dicom import positions, write_series
from made_volumes import OBLIQUE, VOXELS, save

SDDP = vtkStreamingDemandDrivenPipeline


def values_of(image: object) -> np.ndarray:
    wrapped = pyvista.wrap(image)
    return np.asarray(wrapped.active_scalars).reshape(wrapped.dimensions[::-1])


def time_series(folder: Path) -> Path:
    pixels = np.concatenate([VOXELS[:3], VOXELS[:3] + 1000, VOXELS[:3] + 2000])
    each = tuple(t for t in (0.0, 500.0, 1500.0) for _ in range(3))
    return write_series(folder, pixels, positions(3) * 3, TriggerTime=each)


def test_reads_with_place_type_and_notes(tmp_path: Path) -> None:
    reader = VolumeReader(file_name=save(tmp_path / "a.nrrd"))
    reader.Update()
    image = reader.GetOutputDataObject(0)
    np.testing.assert_array_equal(values_of(image), VOXELS)
    np.testing.assert_allclose(pyvista.wrap(image).direction_matrix, OBLIQUE)
    assert "read as NRRD" in notes(image)


def test_downstream_gets_the_announced_type(tmp_path: Path) -> None:
    reader = VolumeReader()
    reader.SetFileName(str(save(tmp_path / "a.nrrd")))
    shift = vtkImageShiftScale()
    shift.SetInputConnection(reader.GetOutputPort())
    shift.SetShift(40)
    shift.Update()
    assert shift.GetOutput().GetScalarTypeAsString() == "short"
    np.testing.assert_array_equal(values_of(shift.GetOutput()), VOXELS + 40)


def test_time_steps_are_announced_and_served(tmp_path: Path) -> None:
    reader = VolumeReader(file_name=time_series(tmp_path / "a"))
    reader.UpdateInformation()
    info = reader.GetOutputInformation(0)
    assert list(info.Get(SDDP.TIME_STEPS())) == [0.0, 0.5, 1.5]
    assert list(info.Get(SDDP.TIME_RANGE())) == [0.0, 1.5]
    for time, step in ((0.0, 0), (0.5, 1), (1.4, 1), (1.5, 2), (9.0, 2), (-1.0, 0)):
        reader.UpdateTimeStep(time)
        output = reader.GetOutputDataObject(0)
        np.testing.assert_array_equal(values_of(output), VOXELS[:3] + 1000 * step)
    assert output.GetInformation().Get(output.DATA_TIME_STEP()) == 0.0
    chosen = VolumeReader(file_name=tmp_path / "a", time=2)
    chosen.Update()
    np.testing.assert_array_equal(values_of(chosen.GetOutputDataObject(0)), VOXELS[:3] + 2000)


def test_reads_once_and_again_when_something_changed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import vtkmcvr.filters.volume_reader as module

    read: list[object] = []
    original = module.read_vtk
    monkeypatch.setattr(module, "read_vtk", lambda *a, **k: read.append(a) or original(*a, **k))
    path = save(tmp_path / "a.nrrd")
    reader = VolumeReader(file_name=path)
    for _ in range(3):
        reader.UpdateInformation()
        reader.Update()
    assert len(read) == 1
    reader.resample = True
    reader.Update()
    assert len(read) == 2


def test_errors_reach_the_caller_or_an_observer(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="has no file_name"):
        VolumeReader().Update()
    reader = VolumeReader(file_name=tmp_path / "none.nrrd")
    with pytest.raises(VolumeReadError, match="no such file or folder"):
        reader.Update()
    heard: list[str] = []

    def listen(_: object, __: str, text: str) -> None:
        heard.append(text)

    listen.CallDataType = "string0"
    reader.AddObserver("ErrorEvent", listen)
    shift = vtkImageShiftScale()
    shift.SetInputConnection(reader.GetOutputPort())
    reader.Modified()
    with pytest.raises(VolumeReadError):
        reader.UpdateInformation()
    assert any("no such file or folder" in text for text in heard)
    with pytest.raises(TypeError, match="has no parameter 'path'"):
        VolumeReader(path="a")
    with pytest.raises(TypeError, match="file_name must be a path"):
        VolumeReader(file_name=3)


def test_progress_is_told(tmp_path: Path) -> None:
    reader = VolumeReader(file_name=write_series(tmp_path / "a"))
    seen: list[float] = []
    reader.AddObserver("ProgressEvent", lambda *_: seen.append(reader.GetProgress()))
    reader.Update()
    assert max(seen) == 1.0


def test_a_series_is_chosen(tmp_path: Path) -> None:
    write_series(tmp_path / "a")
    second = {"SeriesNumber": 7, "SeriesInstanceUID": "1.2.3.7"}
    write_series(tmp_path / "b", VOXELS[:3], **second)
    reader = VolumeReader(file_name=tmp_path, series=7)
    reader.Update()
    assert reader.GetOutputDataObject(0).GetDimensions() == (7, 6, 3)


# PyVista


def test_pyvista_reads_the_true_direction_when_asked(tmp_path: Path) -> None:
    # In a process of its own: what is asked for holds until it ends
    names = [str(save(tmp_path / name)) for name in ("a.nrrd", "a.nii.gz", "a.mha")]
    code = (
        "import sys, numpy, pyvista, vtkmcvr\n"
        "before = [pyvista.read(name).direction_matrix for name in sys.argv[2:]]\n"
        "vtkmcvr.override_pyvista_readers()\n"
        "images = [pyvista.read(name) for name in sys.argv[2:]]\n"
        "after = [image.direction_matrix for image in images]\n"
        "values = [image.active_scalars for image in images]\n"
        "numpy.savez(sys.argv[1], before=before, after=after, values=values)\n"
    )
    subprocess.run([sys.executable, "-c", code, str(tmp_path / "found.npz"), *names], check=True)
    found = np.load(tmp_path / "found.npz")
    # PyVista alone knows that of MetaImage and NIfTI files at most, in axes of their own
    assert not all(np.allclose(one, OBLIQUE, atol=1e-6) for one in found["before"])
    for direction, values in zip(found["after"], found["values"], strict=True):
        np.testing.assert_allclose(direction, OBLIQUE, atol=1e-6)
        np.testing.assert_array_equal(values.reshape(VOXELS.shape), VOXELS)
