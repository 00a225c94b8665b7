"""VTK images keep their arrays, and carry what the reader noticed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import pyvista
from made_dicom import write_series
from made_volumes import OBLIQUE, affine, error_of

from vtkmcvr.readers import modality, notes, read, units


def vtk_image() -> pyvista.ImageData:
    image = pyvista.ImageData(dimensions=(3, 4, 5), spacing=(1, 2, 3), origin=(7, 8, 9))
    image.direction_matrix = OBLIQUE
    image.point_data["heat"] = np.linspace(0, 1, 60)
    return image


@pytest.mark.parametrize("name", ["a.vti", "a.vtk"])
def test_vtk_image_keeps_its_arrays(tmp_path: Path, name: str) -> None:
    image = vtk_image()
    if name == "a.vtk":
        # The legacy format has no direction matrix.
        image.direction_matrix = np.eye(3)
    image.point_data["other"] = np.arange(60)
    image.set_active_scalars("heat")
    image.save(tmp_path / name)
    loaded = read(tmp_path / name)
    assert loaded.active_scalars_name == "heat"
    np.testing.assert_array_equal(loaded.point_data["heat"], image.point_data["heat"])
    np.testing.assert_allclose(affine(loaded), affine(image))
    assert any(note.startswith("arrays ") and "active: heat" in note for note in notes(loaded))


def test_vtk_image_without_active_array_gets_one(tmp_path: Path) -> None:
    image = vtk_image()
    image.GetPointData().SetActiveScalars(None)
    image.save(tmp_path / "a.vti")
    assert read(tmp_path / "a.vti").active_scalars_name == "heat"


def test_vtk_image_with_cell_values(tmp_path: Path) -> None:
    image = pyvista.ImageData(dimensions=(3, 4, 5))
    image.cell_data["label"] = np.arange(24)
    image.save(tmp_path / "a.vti")
    loaded = read(tmp_path / "a.vti")
    assert loaded.active_scalars_name == "label"
    assert "the values belong to cells, not to points" in notes(loaded)


def test_facts_survive_copies_and_vti_files(tmp_path: Path) -> None:
    image = read(write_series(tmp_path / "ct"))
    for copy in (image.copy(), image.copy(deep=False)):
        assert (notes(copy), modality(copy), units(copy)) == (notes(image), "CT", "HU")
    image.save(tmp_path / "a.vti")
    loaded = read(tmp_path / "a.vti")
    assert (modality(loaded), units(loaded)) == ("CT", "HU")
    assert notes(loaded)[: len(notes(image))] == notes(image)


def test_images_of_others_have_no_facts() -> None:
    image = pyvista.ImageData(dimensions=(2, 2, 2))
    assert (notes(image), modality(image), units(image)) == ([], "", "")


def test_bad_vtk_files(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    image = vtk_image()
    image.direction_matrix = np.eye(3)
    image.save(tmp_path / "a.vti")
    image.save(tmp_path / "a.vtk")
    pyvista.Sphere().save(tmp_path / "sphere.vtk")
    pyvista.ImageData(dimensions=(3, 4, 5)).save(tmp_path / "none.vti")
    flat = pyvista.ImageData(dimensions=(3, 4, 1))
    flat.point_data["heat"] = np.zeros(12)
    flat.save(tmp_path / "flat.vti")
    for name in ("a.vti", "a.vtk"):
        path = tmp_path / name
        path.write_bytes(path.read_bytes()[:-300])
        assert "damaged" in error_of(path)
        path.write_text("hello")
        assert "not a whole VTK file" in error_of(path)
    assert "holds vtkPolyData, not an image" in error_of(tmp_path / "sphere.vtk")
    assert "the image has no values" in error_of(tmp_path / "none.vti")
    assert "a 2-D image (3 x 4 x 1)" in error_of(tmp_path / "flat.vti")
    assert capfd.readouterr().err == ""


def test_singular_direction_and_zero_spacing_are_refused(tmp_path: Path) -> None:
    image = vtk_image()
    image.save(tmp_path / "a.vti", binary=False)
    text = (tmp_path / "a.vti").read_text()
    singular = tmp_path / "singular.vti"
    singular.write_text(text.replace('Direction="0.8 0 0.6 0.6 0 -0.8', 'Direction="0 0 0 0 0 0'))
    assert "the direction matrix is singular" in error_of(singular)
    flat = tmp_path / "flat.vti"
    flat.write_text(text.replace('Spacing="1 2 3"', 'Spacing="1 0 3"'))
    assert "spacing must be above 0" in error_of(flat)
