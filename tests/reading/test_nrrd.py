"""NRRD: its space and units, and what is wrong with bad ones."""

from __future__ import annotations

import bz2
import gzip
from pathlib import Path

import numpy as np
import pytest
from made_volumes import VOXELS, error_of, nrrd_text, voxels

from vtkmcvr.readers import notes, read


def test_nrrd_without_space_is_taken_as_lps(tmp_path: Path) -> None:
    path = tmp_path / "a.nrrd"
    path.write_bytes(nrrd_text(spacings="1 2 3") + VOXELS.tobytes())
    image = read(path)
    assert image.spacing == (1.0, 2.0, 3.0)
    assert any("no anatomical space" in note for note in notes(image))
    path.write_bytes(nrrd_text() + VOXELS.tobytes())
    assert any("no spacing in the file" in note for note in notes(read(path)))


def test_nrrd_lengths_become_mm(tmp_path: Path) -> None:
    path = tmp_path / "a.nrrd"
    place = {
        "space": "left-posterior-superior",
        "space_directions": "(500,0,0) (0,500,0) (0,0,2000)",
        "space_origin": "(1000,2000,3000)",
    }
    path.write_bytes(nrrd_text(**place, space_units='"um" "um" "um"') + VOXELS.tobytes())
    image = read(path)
    np.testing.assert_allclose(image.spacing, [0.5, 0.5, 2.0])
    np.testing.assert_allclose(image.origin, [1.0, 2.0, 3.0])
    assert "lengths converted from um to mm" in notes(image)
    path.write_bytes(nrrd_text(**place, space_units='"mm" "mm" "s"') + VOXELS.tobytes())
    assert any("different length units" in note for note in notes(read(path)))
    path.write_bytes(nrrd_text(**place, space_units='"ly" "ly" "ly"') + VOXELS.tobytes())
    assert any("unknown length unit" in note for note in notes(read(path)))


def test_nrrd_reads_a_list_of_slice_files(tmp_path: Path) -> None:
    for number, plane in enumerate(VOXELS, start=1):
        (tmp_path / f"s.{number}").write_bytes(plane.tobytes())
    header = tmp_path / "a.nhdr"
    header.write_bytes(nrrd_text(data_file="s.%d 1 5 1", spacings="1 1 1"))
    np.testing.assert_array_equal(voxels(read(header)), VOXELS)
    (tmp_path / "s.4").unlink()
    assert "data file 's.4' is missing" in error_of(header)


@pytest.mark.parametrize(
    ("data", "problem"),
    [
        (b"just some text", "not a NRRD file"),
        (nrrd_text(encoding="bzip2"), "bzip2 encoding is not supported; convert it with Teem"),
        (nrrd_text(encoding="bzip2", data_file="x.bz2"), "unpack its data file with bunzip2"),
        (nrrd_text(space="3D-left-handed", spacings="1 1 1"), "space '3d-left-handed' is not"),
        (nrrd_text(space="3D-right-handed", spacings="1 1 1"), "instead of 'spacings'"),
        (nrrd_text(dimension="2", sizes="6 5"), "a 2-D image is not a volume"),
        (nrrd_text(sizes="7 6 1"), "a 2-D image (7 x 6 x 1) is not a volume"),
        (nrrd_text(dimension="4", sizes="7 6 5 9"), "a 4-D image with 9 volumes"),
        (
            nrrd_text(
                dimension="4",
                sizes="9 7 6 5",
                space="left-posterior-superior",
                space_directions="none (1,0,0) (0,1,0) (0,0,1)",
            ),
            "a 4-D image with 9 volumes",
        ),
        (nrrd_text(data_file="x.raw"), "data file 'x.raw' is missing; put it beside"),
        (nrrd_text(data_file="x.%d 1 a 1"), "the header is damaged"),
        (nrrd_text(sizes="7 6 x"), "the NRRD data cannot be read: the file is damaged"),
        (nrrd_text() + VOXELS.tobytes()[:-9], "the NRRD data cannot be read: the file is damaged"),
        (
            nrrd_text(encoding="gzip") + gzip.compress(VOXELS.tobytes())[:-30],
            "the NRRD data cannot be read: the file is damaged",
        ),
        (
            nrrd_text(space="left-posterior-superior", space_directions="(1,0,0) (1,0,0) (0,0,1)")
            + VOXELS.tobytes(),
            "the NRRD data cannot be read",
        ),
    ],
)
def test_bad_nrrd(tmp_path: Path, data: bytes, problem: str) -> None:
    path = tmp_path / "a.nrrd"
    path.write_bytes(data)
    assert problem in error_of(path)


def test_advice_about_bzip2_works(tmp_path: Path) -> None:
    (tmp_path / "a.raw.bz2").write_bytes(bz2.compress(VOXELS.tobytes()))
    header = tmp_path / "a.nhdr"
    header.write_bytes(nrrd_text(encoding="bzip2", data_file="a.raw.bz2", spacings="1 1 1"))
    advice = "write the name of the unpacked file and 'encoding: raw' into the header"
    assert advice in error_of(header)
    (tmp_path / "a.raw").write_bytes(bz2.decompress((tmp_path / "a.raw.bz2").read_bytes()))
    header.write_bytes(nrrd_text(encoding="raw", data_file="a.raw", spacings="1 1 1"))
    np.testing.assert_array_equal(voxels(read(header)), VOXELS)
