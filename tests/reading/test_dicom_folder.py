"""A DICOM folder: which series is read, what is skipped and what is damaged."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from made_dicom import positions, write_series, write_slice
from made_volumes import ORIGIN, SECRET, VOXELS, error_of, voxels
from pydicom.uid import RTStructureSetStorage

from vtkmcvr.readers import VolumeReadError, modality, notes, read


def two_series(folder: Path, **attributes: object) -> Path:
    write_series(folder)
    second = {"SeriesNumber": 7, "Modality": "MR", "SeriesInstanceUID": "1.2.3.7"} | attributes
    return write_series(folder, VOXELS[:3], **second)


def test_largest_series_is_chosen_and_the_others_listed(tmp_path: Path) -> None:
    image = read(two_series(tmp_path / "both"))
    assert image.dimensions[2] == 5
    expected = "series 4 (CT), 5 slices of 6 x 7 read of 2 series; others: series 7 (MR), 3 slices"
    assert any(note.startswith(expected) for note in notes(image))
    assert SECRET not in " ".join(notes(image))


def test_series_is_chosen_by_number_or_uid(tmp_path: Path) -> None:
    folder = two_series(tmp_path / "both")
    for key in (7, "1.2.3.7"):
        image = read(folder, series=key)
        assert image.dimensions[2] == 3
        assert modality(image) == "MR"
    message = error_of(folder, series=5)
    assert "no series 5; allowed are 4 (CT, 5 slices), 7 (MR, 3 slices)" in message


def test_series_with_equal_or_no_number_need_the_uid(tmp_path: Path) -> None:
    same = two_series(tmp_path / "same", SeriesNumber=4, ImageType=["A"] * 2)
    for file in list(same.iterdir()):
        file.unlink()
    write_series(same)
    for k in range(3):
        write_slice(same / f"x{k}", VOXELS[k], positions(3)[k], SeriesInstanceUID="1.2.3.7")
    message = error_of(same, series=4)
    assert "2 series have the number 4; give one of the UIDs 1.2.3.4, 1.2.3.7" in message
    none = write_series(tmp_path / "none", SeriesNumber=None)
    assert "allowed are '1.2.3.4' (CT, 5 slices)" in error_of(none, series=9)
    assert read(none, series="1.2.3.4").dimensions[2] == 5


def test_other_files_are_skipped_and_noted(tmp_path: Path) -> None:
    folder = write_series(tmp_path / "ct")
    (folder / f"{SECRET}.txt").write_text("report")
    (folder / "empty").touch()
    write_slice(folder / "plan", VOXELS[0], None, Rows=None, SOPClassUID=RTStructureSetStorage)
    (folder / "copy of 4-97").write_bytes((folder / "4-97").read_bytes())
    image = read(folder)
    np.testing.assert_array_equal(voxels(image), VOXELS)
    assert set(notes(image)) >= {
        "2 files that are not DICOM skipped",
        "1 DICOM files without an image skipped",
        "1 copies of the same slice skipped",
    }
    assert SECRET not in " ".join(notes(image))


def test_folders_without_a_volume(tmp_path: Path) -> None:
    assert "the folder is empty" in error_of(tmp_path)
    (tmp_path / "inner").mkdir()
    assert "the folder is empty" in error_of(tmp_path)
    (tmp_path / "inner" / "a.txt").write_text("text")
    assert "no DICOM image among its 1 files" in error_of(tmp_path)
    write_slice(tmp_path / "one" / "a.dcm", VOXELS[0], list(ORIGIN))
    assert "series 4 (CT) has one slice, which is a 2-D image" in error_of(tmp_path / "one")


def test_damaged_slices(tmp_path: Path) -> None:
    folder = write_series(tmp_path / "ct")
    whole = (folder / "4-97").read_bytes()
    (folder / "4-97").write_bytes(whole[:-20])
    assert "the pixels of a slice cannot be decoded" in error_of(folder)
    for cut in range(132, len(whole) - VOXELS[0].nbytes - 120, 7):
        (folder / "4-97").write_bytes(whole[:cut])
        assert "file 3 of 5 in name order has a damaged DICOM header" in error_of(folder)


def test_damaged_header_never_quotes_the_patient(tmp_path: Path) -> None:
    folder = write_series(tmp_path / "ct")
    path = folder / "4-97"
    whole = path.read_bytes()
    for place in range(132, len(whole) - VOXELS[0].nbytes, 5):
        path.write_bytes(whole[:place] + b"\xff" + whole[place + 1 :])
        try:
            read(folder)
        except VolumeReadError as error:
            # The traceback shows the context too, unless it is suppressed.
            context = None if error.__suppress_context__ else error.__context__
            assert SECRET not in f"{error} {error.__cause__} {context}"
