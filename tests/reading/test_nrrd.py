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
        (nrrd_text(dimension="2", sizes="6 5"), "a 2-D image is not a volume"),
        (nrrd_text(sizes="7 6 1"), "a 2-D image (7 x 6 x 1) is not a volume"),
        (nrrd_text(data_file="x.raw"), "data file 'x.raw' is missing; put it beside"),
        (nrrd_text(data_file="x.%d 1 a 1"), "the header is damaged"),
        (nrrd_text(sizes="7 6 x"), "the header is damaged"),
        (nrrd_text() + VOXELS.tobytes()[:-200], "its header promises 420 bytes"),
        (nrrd_text() + VOXELS.tobytes()[:-9], "voxels are missing at its end"),
        (
            nrrd_text(encoding="gzip") + gzip.compress(VOXELS.tobytes())[:-30],
            "voxels are missing at its end",
        ),
        (
            nrrd_text(space="left-posterior-superior", space_directions="(1,0,0) (1,0,0) (0,0,1)")
            + VOXELS.tobytes(),
            "the direction matrix is singular",
        ),
    ],
)
def test_bad_nrrd(tmp_path: Path, data: bytes, problem: str) -> None:
    path = tmp_path / "a.nrrd"
    path.write_bytes(data)
    assert problem in error_of(path)


@pytest.mark.parametrize("where", ["first", "last"])
def test_one_of_several_volumes_is_chosen(tmp_path: Path, where: str) -> None:
    path = tmp_path / "a.nrrd"
    steps = "(1,0,0) (0,1,0) (0,0,1)"
    place = f"none {steps}" if where == "first" else f"{steps} none"
    sizes = "9 7 6 5" if where == "first" else "7 6 5 9"
    kinds = "list domain domain domain" if where == "first" else "domain domain domain list"
    header = {"dimension": "4", "sizes": sizes, "space": "LPS", "space_directions": place}
    all_of_them = np.stack([VOXELS + 1000 * k for k in range(9)], -1 if where == "first" else 0)
    path.write_bytes(nrrd_text(**header, kinds=kinds) + all_of_them.tobytes())
    np.testing.assert_array_equal(voxels(read(path, time=7)), VOXELS + 7000)
    assert any("volume 0 of 0 to 8 read" in note for note in notes(read(path)))
    # Without kinds nobody knows what the volumes are.
    path.write_bytes(nrrd_text(**header, kinds="??? ??? ??? ???") + all_of_them.tobytes())
    assert "choose one with time=0 to time=8" in error_of(path)


ENCODED = {
    "raw": VOXELS.tobytes(),
    "gzip": gzip.compress(VOXELS.tobytes()),
    "bzip2": bz2.compress(VOXELS.tobytes()),
    "ascii": " ".join(map(str, VOXELS.ravel())).encode(),
    "hex": VOXELS.tobytes().hex().encode(),
}


@pytest.mark.parametrize("encoding", ENCODED)
def test_every_encoding_attached_and_detached(tmp_path: Path, encoding: str) -> None:
    place = {"space": "LPS", "space_directions": "(1,0,0) (0,1,0) (0,0,1)"}
    attached = tmp_path / "a.nrrd"
    attached.write_bytes(nrrd_text(encoding=encoding, **place) + ENCODED[encoding])
    (tmp_path / "data").write_bytes(b"one line\nanother\n" + ENCODED[encoding])
    detached = tmp_path / "a.nhdr"
    detached.write_bytes(nrrd_text(encoding=encoding, data_file="data", line_skip="2", **place))
    for path in (attached, detached):
        np.testing.assert_array_equal(voxels(read(path)), VOXELS)


def test_list_of_data_files(tmp_path: Path) -> None:
    for number, plane in enumerate(VOXELS):
        (tmp_path / f"s{number}.raw").write_bytes(plane.tobytes())
    header = tmp_path / "a.nhdr"
    names = "".join(f"s{number}.raw\n" for number in range(5))
    header.write_bytes(nrrd_text(spacings="1 1 1")[:-1] + b"data file: LIST\n" + names.encode())
    np.testing.assert_array_equal(voxels(read(header)), VOXELS)


@pytest.mark.parametrize("name", ["../a.raw", "/etc/hostname", "b/../../a.raw", "C:\\a.raw"])
def test_data_file_outside_the_folder_is_refused(tmp_path: Path, name: str) -> None:
    (tmp_path / "a.raw").write_bytes(VOXELS.tobytes())
    (tmp_path / "in").mkdir()
    path = tmp_path / "in" / "a.nhdr"
    path.write_bytes(nrrd_text(data_file=name, spacings="1 1 1"))
    assert "its data file lies outside the folder of the header" in error_of(path)
