"""Every row of the collection's table loads with the facts that it states, or is refused."""

from __future__ import annotations

import re

import numpy as np
import pytest
from made_volumes import DATA, error_of, voxels

from vtkmcvr.readers import read

# What the table lists and a volume reader refuses, and what it says
REFUSED = {
    "dicom/hard_missing_slice_4/": "missing slice",
    "dicom/hard_same_position_4/": "lie at one position",
    "dicom/hard_mixed_orientation_4/": "different orientations",
    "nrrd/adi_slice.nrrd": "2-D image",
    "nrrd/pynrrd_ball/BallBinary30x30x30_byteskip_minus_five.nhdr": "byte skip",
    "nrrd/pynrrd_ball/test_customFields.nrrd": "1-D image",
    "nrrd/pynrrd_ball/test_simple4d_raw.nrrd": "2-D image",
    "metaimage/frogtissue.mhd": "compressed data",
}
# Where the table has what a naive reader says, and the headers say otherwise
BY_HEADER = {
    "dicom/seg_headneck/": "13 frames of two segments at 9 places, one label map",
    "dicom/multiframe_emri/": "frames 1.2 mm apart by their spacing attribute",
    "dicom/multiframe_ct/": "rows run to -x, so the slices are ordered along -z",
}
COLUMNS = 6


def rows() -> dict[str, list[str]]:
    table = DATA / "README.md"
    if not table.exists():
        return {}
    part = table.read_text().split("### What each file contains")[1].split("### ")[0]
    cells = [[c.strip() for c in line.strip("|\n").split(" | ")] for line in part.splitlines()]
    found = {c[0].strip("| `"): c[1:] for c in cells if len(c) > COLUMNS - 1 and "`" in c[0]}
    return {name: facts for name, facts in found.items() if not name.startswith("env/")}


ROWS = rows()


def numbers(text: str) -> list[float]:
    return [float(x) for x in re.findall(r"-?\d+(?:\.\d+)?(?:e[+-]?\d+)?", text)]


def test_the_table_is_read() -> None:
    if not ROWS:
        pytest.skip("needs the volume collection (VTKMCVR_DATA)")
    assert len(ROWS) > 70
    assert set(REFUSED) <= set(ROWS)


@pytest.mark.parametrize(
    "name", [n for n in ROWS if n not in REFUSED and not n.startswith(tuple(BY_HEADER))]
)
def test_row_loads_with_its_facts(name: str) -> None:
    size, spacing, direction, _, limits, remarks = (*ROWS[name], "")[:6]
    image = read(DATA / name)
    assert list(image.dimensions) == [int(n) for n in size.split("x")[:3]]
    if "shear" not in name + remarks:
        # Slightly uneven series: the table has the median step, the reader the fitted one
        np.testing.assert_allclose(image.spacing, numbers(spacing), rtol=5e-3)
        np.testing.assert_allclose(image.direction_matrix, axes(direction), atol=6e-3)
    values = voxels(image)
    finite = values[np.isfinite(values)]
    if not name.endswith("dti_V1.nii.gz"):
        # The table's range is that of all three volumes of this one
        low, high = numbers(limits.replace("..", " "))
        np.testing.assert_allclose([finite.min(), finite.max()], (low, high), rtol=2e-3, atol=1e-3)


def axes(direction: str) -> np.ndarray:
    if direction == "identity":
        return np.eye(3)
    if direction.startswith("diag"):
        return np.diag(numbers(direction))
    return np.array([numbers(row) for row in direction.split(";")])


def test_rows_that_the_headers_correct() -> None:
    if not ROWS:
        pytest.skip("needs the volume collection (VTKMCVR_DATA)")
    labels = read(DATA / "dicom/seg_headneck")
    assert labels.dimensions == (128, 128, 9)
    np.testing.assert_allclose(labels.spacing, (3.53782, 3.53782, 3.375), atol=1e-4)
    frames = read(DATA / "dicom/multiframe_emri/emri_small.dcm")
    assert (frames.dimensions, frames.spacing) == ((64, 64, 10), (1.0, 1.0, 1.2))
    ct = read(DATA / "dicom/multiframe_ct/eCT_Supplemental.dcm")
    np.testing.assert_allclose(ct.direction_matrix, np.diag([-1, 1, -1]), atol=1e-6)
    assert (ct.dimensions, voxels(ct).min(), voxels(ct).max()) == ((512, 512, 2), -1024, 172)


@pytest.mark.parametrize("name", [name for name in REFUSED if name in ROWS])
def test_row_is_refused(name: str) -> None:
    assert REFUSED[name] in error_of(DATA / name)
