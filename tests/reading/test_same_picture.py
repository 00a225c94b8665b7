"""The same anatomy gives the same picture, whatever file it comes from."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import SimpleITK
from made_volumes import real

import vtkmcvr
from vtkmcvr.readers import read_vtk
from vtkmcvr.vtk_bridge.scene import volume_of

SIZE, SAMPLES = (40, 32), 64
SAME_FIELD = [
    "02_ras_gzip.nrrd", "03_las_gzip.nrrd", "04_flipped_axes.nrrd", "05_permuted_axes.nrrd",
    "07_detached_raw.nhdr", "08_detached_bzip2.nhdr", "09_detached_gzip.nhdr",
    "10_big_endian.nrrd", "13_float32_cell.nrrd", "18_float64.nrrd", "19_left_handed_det.nrrd",
]  # fmt: skip


def rendered(image, seed=0, camera=None):
    options = {} if camera is None else {"camera": camera}
    return vtkmcvr.render(
        image, preset="ct-bone", whole=True, size=SIZE, samples=SAMPLES, seed=seed, threads=1,
        **options,
    )  # fmt: skip


def excess(a, b) -> float:
    """Mean squared difference of two pictures of different seeds over its expectation.

    1 for two estimates of one picture. Of 40 x 32 pixels some 500 are covered; the square of a
    normal variable has the standard deviation sqrt(2), so that the mean of 500 exceeds
    1 + 5 sqrt(2 / 500) = 1.32 once in 3 million times.
    """
    difference = a.radiance.astype(float) - b.radiance
    expected = a.standard_error.astype(float) ** 2 + b.standard_error.astype(float) ** 2
    return float((difference**2).sum() / expected.sum())


@pytest.fixture(scope="module")
def reference():
    return rendered(read_vtk(real("nrrd/variants/01_lps_gzip.nrrd")), seed=1)


def test_variants_of_nrrd_give_one_picture(reference) -> None:
    """Flipped, permuted and left-handed storage walks other macrocells: equal but for noise."""
    camera = reference.plan.scene.camera
    for name in SAME_FIELD:
        image = read_vtk(real(f"nrrd/variants/{name}"))
        picture = rendered(image, seed=2, camera=camera)
        assert excess(reference, picture) < 1.32, name


def test_the_comparison_can_fail(reference) -> None:
    """A mirrored head, and one that is off by a voxel, are told apart."""
    camera = reference.plan.scene.camera
    volume = volume_of(read_vtk(real("nrrd/variants/01_lps_gzip.nrrd")))
    assert excess(reference, rendered(volume.flipped("i"), seed=2, camera=camera)) > 3
    moved = volume.index_to_world.copy()
    moved[2, 3] += 2 * 1.5
    other = vtkmcvr.Volume(volume.values, moved)
    assert excess(reference, rendered(other, seed=2, camera=camera)) > 3


def test_variants_that_turn_the_head_agree_with_each_other() -> None:
    nrrd = rendered(read_vtk(real("nrrd/variants/06_oblique.nrrd")))
    mha = rendered(read_vtk(real("metaimage/oblique_head.mha")))
    np.testing.assert_array_equal(nrrd.rgba, mha.rgba)


def test_dicom_nrrd_and_nifti_give_one_picture(tmp_path: Path) -> None:
    """The files are written by SimpleITK from its own reading of the series."""
    folder = real("dicom/ct_head_tiny")
    reader = SimpleITK.ImageSeriesReader()
    reader.SetFileNames(reader.GetGDCMSeriesFileNames(str(folder)))
    series = reader.Execute()
    dicom = rendered(read_vtk(folder))
    assert dicom.alpha.mean() > 0.1
    for name in ("a.nrrd", "a.nii.gz", "a.mha"):
        SimpleITK.WriteImage(series, str(tmp_path / name))
        picture = rendered(read_vtk(tmp_path / name))
        # NIfTI keeps its axes in float32, which turns a path here and there
        same = np.abs(picture.rgba.astype(int) - dicom.rgba).max(axis=-1) <= 2
        assert same.mean() > 0.98, name
