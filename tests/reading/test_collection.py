"""Every row of the collection's table loads as stated, or is refused with a quoted message."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from made_volumes import DATA, affine, error_of, real, voxels

from vtkmcvr.environment_files import read_environment
from vtkmcvr.readers import read

TABLE = DATA / "README.md"

# The table gives what other readers show; here the headers say otherwise.
CORRECTED = {
    # Sparse frames of two segments, which the table counts one after the other.
    "dicom/seg_headneck": ("128x128x9", "3.53782 3.53782 3.375", "identity", "0 .. 2"),
    # Mean step instead of the median one, so that the first and the last slice are exact.
    "dicom/mr_oblique_ge": ("256x256x20", "0.85938 0.85938 7.0005", None, "0 .. 1059"),
    # Sheared: the step goes along the line of the slices, not along their normal.
    "dicom/hard_gantry_tilt_4": (
        "512x512x4", "0.41797 0.41797 5", "[1 0 0; 0 0.970 0; 0 -0.242 1]", "-1024 .. -770",
    ),
    # Sorted along the normal, which points down.
    "dicom/multiframe_ct/eCT_Supplemental.dcm": (
        "512x512x2", "0.38867 0.38867 10", "diag(-1,1,-1)", "-1024 .. 172",
    ),
    # One of the three volumes.
    "nifti/dti_V1.nii.gz": ("128x128x53", "1.71875 1.71875 3", "diag(1,-1,1)", "-1 .. 1"),
}  # fmt: skip
# The file gives a step between slices and nothing else; the table has SimpleITK's 1 mm.
for _name in ("", "_RLE", "_jpeg_2k_lossless", "_jpeg_ls_lossless", "_big_endian"):
    CORRECTED[f"dicom/multiframe_emri/emri_small{_name}.dcm"] = (
        "64x64x10", "1 1 1.2", "identity", "0 .. 467",
    )  # fmt: skip

REFUSED = {
    "dicom/hard_missing_slice_4": "1 missing slice between slice 3 and slice 4 of 4: the step "
    "there is 10.000 mm where 5.000 mm is usual, and steps may differ by 0.100 mm; give "
    "resample=True to interpolate at even steps, or export the complete series again.",
    "dicom/hard_same_position_4": "4 slices lie at one position (slice 1 of 1, 61.50 mm) and "
    "differ in acquisition number, but a volume has one slice at each; give "
    "ignore='duplicates' to keep the first at each position.",
    "dicom/hard_mixed_orientation_4": "the slices have different orientations (2 sagittal, "
    "2 axial), which is no single volume but may be a localiser; choose another series with "
    "series=..., or give ignore='orientations' to keep the most frequent one.",
    "nrrd/adi_slice.nrrd": "a 2-D image (192 x 192 x 1) is not a volume; give one with 2 or "
    "more voxels along each axis.",
    "nrrd/pynrrd_ball/BallBinary30x30x30_byteskip_minus_five.nhdr": "its header has a byte skip "
    "of -5 and a line skip of 0; allowed are -1 and more, and 0 and more.",
    "nrrd/pynrrd_ball/test_simple4d_raw.nrrd": "a 2-D image (1 x 1 x 1) is not a volume; give "
    "one with 2 or more voxels along each axis.",
    "nrrd/pynrrd_ball/test_customFields.nrrd": "a 1-D image is not a volume; give a file with "
    "3 dimensions.",
    "metaimage/frogtissue.mhd": "its header says 260020 bytes of compressed data but there are "
    "262087: the file is damaged or truncated; write it again.",
    "env/": "an environment map is not a volume; vtkmcvr.read_environment reads it.",
}


def rows() -> list[list[str]]:
    if not TABLE.exists():
        return []
    table = TABLE.read_text(encoding="utf-8").split("### What each file contains")[1]
    lines = table.split("### ")[0].splitlines()
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
    return [row for row in cells if row[0].startswith("`")]


def matrix(text: str) -> np.ndarray:
    if text.startswith("diag"):
        return np.diag([float(x) for x in re.findall(r"-?\d+", text)])
    if text == "identity":
        return np.eye(3)
    return np.array([[float(x) for x in row.split()] for row in text.strip("[]").split(";")])


def check_environment(path: Path, row: list[str]) -> None:
    if path.suffix == ".exr":
        pytest.importorskip("OpenEXR")
    light = read_environment(path)
    assert light.shape == (512, 1024, 3)
    np.testing.assert_allclose(light.max(), float(row[5].split("..")[1]), rtol=1e-3)


def test_the_table_is_found() -> None:
    real("README.md")
    assert len(rows()) == 89


@pytest.mark.parametrize("row", rows(), ids=lambda row: row[0].strip("`"))
def test_row_of_the_table(row: list[str]) -> None:
    name = row[0].strip("`").rstrip("/")
    path = real(name)
    refusal = REFUSED.get("env/" if name.startswith("env/") else name)
    if refusal is not None:
        assert refusal in error_of(path)
        if name.startswith("env/"):
            check_environment(path, row)
        return
    size, spacing, direction, limits = CORRECTED.get(name, (row[1], row[2], row[3], row[5]))
    image = read(path)
    assert "x".join(map(str, image.dimensions)) == size
    np.testing.assert_allclose(image.spacing, [float(x) for x in spacing.split()], atol=1e-3)
    expected = matrix(direction or row[3])
    np.testing.assert_allclose(image.direction_matrix, expected, atol=2e-3)
    values = voxels(image)
    finite = values[np.isfinite(values)]
    low, high = (float(x) for x in limits.split(".."))
    np.testing.assert_allclose([finite.min(), finite.max()], [low, high], rtol=1e-3, atol=1e-3)


# Truths that hold across files


def test_headsq_slices_are_the_first_variant() -> None:
    folder = real("nrrd/headsq")
    planes = [np.fromfile(folder / f"quarter.{n}", "<i2").reshape(64, 64) for n in range(1, 94)]
    first = voxels(read(real("nrrd/variants/01_lps_gzip.nrrd")))
    np.testing.assert_array_equal(first, planes)
    np.testing.assert_array_equal(voxels(read(folder / "quarter.nhdr")), planes)
    np.testing.assert_array_equal(voxels(read(real("dicom/ct_head_tiny")))[::-1], planes)


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("nifti/ch2.nii.gz", "nifti/aal.nii.gz"),
        ("nifti/example_ct.nii.gz", "nifti/example_ct_labels.nii.gz"),
        ("nrrd/brain1_image.nrrd", "nrrd/brain1_label.nrrd"),
        ("nrrd/variants/06_oblique.nrrd", "metaimage/oblique_head.mha"),
    ],
)
def test_files_on_one_grid(one: str, other: str) -> None:
    first, second = read(real(one)), read(real(other))
    assert first.dimensions == second.dimensions
    np.testing.assert_allclose(affine(first), affine(second), rtol=1e-6, atol=1e-6)


def variants() -> list[str]:
    folder = DATA / "nrrd" / "variants"
    return sorted(path.name for path in folder.glob("[0-9]*.n*rrd")) + sorted(
        path.name for path in folder.glob("[0-9]*.nhdr")
    )


@pytest.mark.parametrize("name", variants())
def test_variant_is_the_same_object(name: str) -> None:
    """Undo what the table says was done to the object, then it equals the first bit for bit."""
    reference = read(real("nrrd/variants/01_lps_gzip.nrrd"))
    image = read(real(f"nrrd/variants/{name}"))
    values, first = voxels(image), voxels(reference)
    place = np.linalg.inv(affine(reference)) @ affine(image)
    if name[:2] == "06":
        angle = np.radians([30, 20])
        (c, e), (s, f) = np.cos(angle), np.sin(angle)
        turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ [[1, 0, 0], [0, e, -f], [0, f, e]]
        turned = np.eye(4)
        turned[:3, :3] = turn
        place = np.linalg.inv(affine(reference)) @ np.linalg.inv(turned) @ affine(image)
    elif name[:2] == "12":
        place[:3, 3] = 0.0
    elif name[:2] == "16":
        place = np.eye(4)
        np.testing.assert_allclose(affine(image)[:3, 2], [0, 1.5 * np.tan(np.radians(14)), 1.5])
    if values.ndim == 4:
        grey = np.round(first.astype(float) * 255 / 3926)
        # The colours were made of the same field: its order must survive.
        values = values[..., 0]
        assert np.corrcoef(values.ravel(), grey.ravel())[0, 1] > 0.9
        np.testing.assert_allclose(place, np.eye(4), atol=1e-6)
        return
    k, j, i = np.indices(values.shape).reshape(3, -1)
    there = place @ np.stack([i, j, k, np.ones_like(i)])
    np.testing.assert_allclose(there, np.rint(there), atol=1e-3)
    a, b, c = np.rint(there[:3]).astype(int)
    expected = first[c, b, a].astype(values.dtype)
    finite = np.isfinite(values.ravel())
    assert np.count_nonzero(~finite) == (3 if name[:2] == "17" else 0)
    np.testing.assert_array_equal(values.ravel()[finite], expected[finite])


SAME_ARRAYS = [
    "02_ras_gzip.nrrd",
    "03_las_gzip.nrrd",
    "07_detached_raw.nhdr",
    "08_detached_bzip2.nhdr",
    "09_detached_gzip.nhdr",
    "10_big_endian.nrrd",
    "18_float64.nrrd",
]


def picture_of(path: Path) -> np.ndarray:
    from vtkmcvr import render

    picture = render(read(path), preset="ct-bone", size=(24, 18), samples=2, seed=3, threads=1)
    return picture.radiance


@pytest.mark.slow
def test_variants_with_the_same_array_give_one_picture_bit_for_bit() -> None:
    first = picture_of(real("nrrd/variants/01_lps_gzip.nrrd"))
    assert first.max() > 0.01
    for name in SAME_ARRAYS:
        np.testing.assert_array_equal(picture_of(real(f"nrrd/variants/{name}")), first)
    oblique = picture_of(real("nrrd/variants/06_oblique.nrrd"))
    other = picture_of(real("metaimage/oblique_head.mha"))
    # The directions that the files hold differ in the last bits of float64
    np.testing.assert_allclose(other, oblique, rtol=1e-5)
    assert not np.allclose(oblique, first, rtol=1e-2)


@pytest.mark.slow
def test_flipped_and_permuted_axes_give_the_same_picture_within_noise() -> None:
    """Alpha is a mean of samples from 0 to 1, so its standard error is below 0.5 / sqrt(n)."""
    from vtkmcvr import render

    names = ("01_lps_gzip.nrrd", "04_flipped_axes.nrrd", "05_permuted_axes.nrrd",
             "19_left_handed_det.nrrd", "13_float32_cell.nrrd")  # fmt: skip
    samples = 24
    alphas = [
        render(read(real(f"nrrd/variants/{name}")), preset="ct-bone", size=(24, 18),
               samples=samples, seed=k, threads=1).alpha
        for k, name in enumerate(names)
    ]  # fmt: skip
    # Difference of two means over all pixels: 6 standard deviations.
    allowed = 6 * 0.5 * np.sqrt(2 / samples)
    for alpha in alphas[1:]:
        assert np.abs(alpha - alphas[0]).max() < allowed
        spread = allowed / np.sqrt(alpha.size)
        assert abs(float(alpha.mean() - alphas[0].mean())) < spread
    # A flipped head would be seen.
    assert np.abs(alphas[0][::-1] - alphas[0]).max() > allowed


def test_the_same_anatomy_from_three_formats_is_one_volume(tmp_path: Path) -> None:
    """What a series holds survives as NRRD, NIfTI and MetaImage, values and place."""
    import SimpleITK

    image = read(real("dicom/mr_head_coronal"))
    copy = SimpleITK.GetImageFromArray(voxels(image))
    copy.SetSpacing(image.spacing)
    copy.SetOrigin(image.origin)
    copy.SetDirection(np.asarray(image.direction_matrix).ravel().tolist())
    for name in ("a.nrrd", "a.nii.gz", "a.mha"):
        SimpleITK.WriteImage(copy, str(tmp_path / name))
        again = read(tmp_path / name)
        np.testing.assert_array_equal(voxels(again), voxels(image))
        np.testing.assert_allclose(affine(again), affine(image), rtol=1e-5, atol=1e-4)
