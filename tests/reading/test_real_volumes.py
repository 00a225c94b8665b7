"""Real files of every format."""

from __future__ import annotations

import numpy as np
import pytest
from made_volumes import affine, error_of, real, voxels

from vtkmcvr.readers import read

EXPECTED = [
    ("dicom/ct_thorax_lidc0314", (512, 512, 90), (0.78125, 0.78125, 1), "int16", (-1000, 1766)),
    ("dicom/ct_head_tiny", (64, 64, 93), (3.2, 3.2, 1.5), "int16", (0, 3926)),
    ("dicom/mr_head_coronal", (256, 256, 100), (1.01562, 1.01562, 2.5), "int16", (0, 5888)),
    ("dicom/pt_headneck", (128, 128, 299), (3.53782, 3.53782, 3.375), "float32", (0, 66260.76)),
    ("dicom/hard_gantry_tilt_4", (512, 512, 4), (0.41797, 0.41797, 5.0), "int16", (-1024, -770)),
    ("dicom/rgb_j2k", (52, 77, 4), (3, 3, 3), "uint8", (0, 255)),
    ("dicom/multiframe_mr_philips", (256, 256, 8), (1, 1, 1.20001), "float32", (0, 1081.748)),
    ("dicom/multiframe_ct", (512, 512, 2), (0.38867, 0.38867, 10), "int16", (-1024, 172)),
    ("nrrd/brain1_label.nrrd", (256, 256, 25), (0.78125, 0.78125, 6.5), "int16", (0, 1)),
    ("nrrd/avf_float_32.nrrd", (74, 93, 20), (0.72266, 0.72266, 1), "float32", (0, 2509.887)),
    ("nrrd/variants/14_rgba_first.nrrd", (64, 64, 93), (3.2, 3.2, 1.5), "uint8", (0, 255)),
    ("nrrd/variants/15_rgb_last.nrrd", (64, 64, 93), (3.2, 3.2, 1.5), "uint8", (0, 255)),
    ("scivis/cthead/CThead.nhdr", (256, 256, 113), (1, 1, 2), "uint16", (0, 3272)),
    ("scivis/engine.nhdr", (256, 256, 128), (1, 1, 1), "uint8", (0, 255)),
    ("nifti/MR_Gd.nii.gz", (176, 188, 144), (0.97656, 0.97656, 1.0026), "float32", (0, 1653)),
    ("nifti/example_ct.nii.gz", (122, 101, 112), (3, 3, 3), "int16", (-1207, 3382)),
    ("metaimage/frogtissue_fixed.mhd", (500, 470, 136), (1, 1, 1.5), "uint8", (0, 29)),
    ("metaimage/oblique_head.mha", (64, 64, 93), (3.2, 3.2, 1.5), "int16", (0, 3926)),
    ("vtk/carotid.vtk", (76, 49, 45), (1, 1, 1), "float32", (0, 580)),
    ("vtk/isabel_02.vti", (125, 125, 25), (4.00803, 4.00803, 4.04082), "float64", (0, 68.2455)),
]


@pytest.mark.parametrize(("name", "size", "spacing", "kind", "limits"), EXPECTED)
def test_real_volume(name: str, size: tuple, spacing: tuple, kind: str, limits: tuple) -> None:
    image = read(real(name))
    values = voxels(image)
    assert image.dimensions == size
    np.testing.assert_allclose(image.spacing, spacing, atol=1e-3)
    assert values.dtype == kind
    np.testing.assert_allclose([values.min(), values.max()], limits, rtol=1e-5)


@pytest.mark.parametrize(
    ("name", "direction"),
    [
        ("dicom/mr_head_coronal", [[1, 0, 0], [0, 0, 1], [0, -1, 0]]),
        ("dicom/syntax_j2k", [[0, 0, -1], [1, 0, 0], [0, -1, 0]]),
        ("nrrd/brain1_image.nrrd", np.diag([1, -1, 1])),
        ("nrrd/avf_float_32.nrrd", np.diag([-1, -1, 1])),
        ("nifti/ch2.nii.gz", np.diag([-1, -1, 1])),
        (
            "metaimage/oblique_head.mha",
            [[0.866, -0.470, 0.171], [0.5, 0.814, -0.296], [0, 0.342, 0.940]],
        ),
    ],
)
def test_real_direction(name: str, direction: object) -> None:
    np.testing.assert_allclose(read(real(name)).direction_matrix, direction, atol=2e-3)


@pytest.mark.parametrize(
    "variant",
    [
        "02_ras_gzip.nrrd",
        "03_las_gzip.nrrd",
        "04_flipped_axes.nrrd",
        "05_permuted_axes.nrrd",
        "07_detached_raw.nhdr",
        "09_detached_gzip.nhdr",
        "10_big_endian.nrrd",
        "13_float32_cell.nrrd",
        "18_float64.nrrd",
        "19_left_handed_det.nrrd",
    ],
)
def test_same_value_at_the_same_lps_point(variant: str) -> None:
    reference = read(real("nrrd/variants/01_lps_gzip.nrrd"))
    image = read(real(f"nrrd/variants/{variant}"))
    indices = np.random.default_rng(5).integers(0, reference.dimensions, (500, 3))
    world = indices @ affine(reference)[:3, :3].T + reference.origin
    inside = (world - image.origin) @ np.linalg.inv(affine(image)[:3, :3]).T
    i, j, k = np.rint(inside).astype(int).T
    np.testing.assert_allclose(inside, np.rint(inside), atol=1e-3)
    expected = voxels(reference)[indices[:, 2], indices[:, 1], indices[:, 0]]
    np.testing.assert_array_equal(voxels(image)[k, j, i], expected)


@pytest.mark.parametrize(
    ("name", "problem"),
    [
        ("dicom/hard_missing_slice_4", "1 missing slice between slice 3 and slice 4 of 4"),
        ("dicom/hard_same_position_4", "4 slices lie at one position"),
        ("dicom/hard_mixed_orientation_4", "different orientations (2 sagittal, 2 axial)"),
        ("nrrd/adi_slice.nrrd", "a 2-D image (192 x 192 x 1)"),
        ("nrrd/pynrrd_ball/test_customFields.nrrd", "a 1-D image is not a volume"),
        ("metaimage/frogtissue.mhd", "260020 bytes of compressed data but there are 262087"),
    ],
)
def test_real_files_that_are_no_volume(name: str, problem: str) -> None:
    assert problem in error_of(real(name))
