"""The choice of the reader, and paths that lead to nothing."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from made_volumes import REPOSITORY, error_of, save


def test_paths_that_lead_to_nothing(tmp_path: Path) -> None:
    assert "no such file or folder" in error_of(tmp_path / "absent.nrrd")
    (tmp_path / "a.jpg").write_bytes(b"picture")
    assert "unknown kind of file; allowed are .nrrd, .nhdr, .nii" in error_of(tmp_path / "a.jpg")
    (tmp_path / "a.nrrd").touch()
    assert "the file is empty" in error_of(tmp_path / "a.nrrd")
    (tmp_path / "a.dcm").write_bytes(b"no DICOM here")
    assert "not a DICOM file" in error_of(tmp_path / "a.dcm")
    assert "'series' is only for DICOM folders" in error_of(save(tmp_path / "b.nrrd"), series=1)


def test_unreadable_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = save(tmp_path / "a.nrrd")

    def refuse(*_: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", refuse)
    assert "cannot be read (Permission denied); check the path" in error_of(path)


def loaded_by(code: str, *arguments: object) -> str:
    """Which heavy libraries a fresh Python has imported after `code`."""
    heavy = ("SimpleITK", "pydicom", "pyvista", "vtkmodules")
    code += f"; import sys; print([name for name in {heavy} if name in sys.modules])"
    command = [sys.executable, "-c", code, *map(str, arguments)]
    done = subprocess.run(command, cwd=REPOSITORY, capture_output=True, text=True, check=True)
    return done.stdout.strip()


@pytest.mark.parametrize("module", ["vtkmcvr", "vtkmcvr.readers"])
def test_importing_the_readers_loads_no_heavy_library(module: str) -> None:
    assert loaded_by(f"import {module}") == "[]"


def test_reading_into_vtk_needs_no_pyvista(tmp_path: Path) -> None:
    code = "import sys; from vtkmcvr.readers import read_vtk; read_vtk(sys.argv[1])"
    assert loaded_by(code, save(tmp_path / "a.nrrd")) == "['vtkmodules']"
