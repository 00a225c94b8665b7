"""Real DICOM series and multi-frame files."""

from __future__ import annotations

import numpy as np
import pydicom
import pytest
from made_volumes import affine, real, voxels

from vtkmcvr.readers import modality, notes, read, units


def test_ct_head_is_headsq_with_the_slices_reversed() -> None:
    headsq = voxels(read(real("nrrd/variants/01_lps_gzip.nrrd")))
    np.testing.assert_array_equal(voxels(read(real("dicom/ct_head_tiny")))[::-1], headsq)
    first = np.fromfile(real("nrrd/headsq/quarter.1"), "<i2").reshape(64, 64)
    np.testing.assert_array_equal(headsq[0], first)


@pytest.mark.parametrize("syntax", ["j2k", "jpegls", "jpeg_lossless", "rle"])
def test_compressed_dicom_equals_the_reference(syntax: str) -> None:
    reference = read(real("dicom/syntax_reference"))
    image = read(real(f"dicom/syntax_{syntax}"))
    np.testing.assert_array_equal(voxels(image), voxels(reference))
    np.testing.assert_array_equal(affine(image), affine(reference))


@pytest.mark.parametrize("kind", ["RLE", "jpeg_2k_lossless", "jpeg_ls_lossless", "big_endian"])
def test_multiframe_in_every_syntax(kind: str) -> None:
    reference = read(real("dicom/multiframe_emri/emri_small.dcm"))
    image = read(real(f"dicom/multiframe_emri/emri_small_{kind}.dcm"))
    np.testing.assert_array_equal(voxels(image), voxels(reference))


@pytest.mark.parametrize(
    "name",
    ["hard_per_slice_rescale_nonsquare", "hard_gantry_tilt_4", "mr_head_coronal", "syntax_j2k"],
)
def test_every_slice_lies_where_its_header_says(name: str) -> None:
    image = read(real(f"dicom/{name}"))
    headers = [pydicom.dcmread(f, stop_before_pixels=True) for f in real(f"dicom/{name}").iterdir()]
    across = np.array(headers[0].ImageOrientationPatient, float)
    normal = np.cross(across[:3], across[3:])
    headers.sort(key=lambda header: np.array(header.ImagePositionPatient, float) @ normal)
    far = np.array([image.dimensions[0] - 1, image.dimensions[1] - 1])
    for k, header in enumerate(headers):
        row, column = (float(x) for x in header.PixelSpacing)
        corner = np.array(header.ImagePositionPatient, float)
        corner = corner + across[:3] * column * far[0] + across[3:] * row * far[1]
        np.testing.assert_allclose(affine(image) @ [*far, k, 1], [*corner, 1], atol=1e-3)


def test_per_slice_rescale_equals_pydicom() -> None:
    folder = real("dicom/hard_per_slice_rescale_nonsquare")
    slices = [pydicom.dcmread(file) for file in folder.iterdir()]
    slices.sort(key=lambda s: float(s.ImagePositionPatient[2]))
    expected = [s.pixel_array * float(s.RescaleSlope) + float(s.RescaleIntercept) for s in slices]
    image = read(folder)
    np.testing.assert_allclose(voxels(image), expected, rtol=1e-6)
    np.testing.assert_allclose(image.spacing[:2], (6.39996, 4.0), atol=1e-5)


def test_slightly_uneven_real_series_loads_with_a_note() -> None:
    image = read(real("dicom/mr_oblique_ge"))
    assert image.dimensions == (256, 256, 20)
    np.testing.assert_allclose(image.spacing, (0.85938, 0.85938, 7.0), atol=1e-3)
    expected = [[1, 0, 0], [0, 0.991, -0.134], [0, 0.134, 0.991]]
    np.testing.assert_allclose(image.direction_matrix, expected, atol=2e-3)
    assert (voxels(image).min(), voxels(image).max()) == (0, 1059)
    assert any("slices lie up to 0.086 mm off" in note for note in notes(image))


def test_units_of_real_series() -> None:
    thorax = read(real("dicom/ct_thorax_lidc0314"))
    assert (modality(thorax), units(thorax)) == ("CT", "HU")
    perfusion = read(real("dicom/multiframe_ct/eCT_Supplemental.dcm"))
    assert (modality(perfusion), units(perfusion)) == ("CT", "")
