"""Where DICOM comes from: nested folders, zip archives, DICOMDIR, and which series is wanted."""

from __future__ import annotations

import os
import shutil
import zipfile
from pathlib import Path

import numpy as np
import pytest
from made_dicom import positions, write_series, write_slice
from made_volumes import SECRET, VOXELS, error_of, save, voxels
from pydicom.dataset import Dataset, FileMetaDataset
from pydicom.uid import ExplicitVRLittleEndian, MediaStorageDirectoryStorage, generate_uid

from vtkmcvr.readers import list_series, modality, notes, read


def two_series(folder: Path) -> Path:
    write_series(folder / "a" / "deep", SeriesDescription="Thorax 1.0 B30f")
    second = {"SeriesNumber": 7, "Modality": "MR", "SeriesInstanceUID": "1.2.3.7"}
    write_series(folder / "b", VOXELS[:3], SeriesDescription="T1 axial", **second)
    return folder


def zipped(path: Path, folder: Path) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in sorted(folder.rglob("*")):
            archive.write(file, file.relative_to(folder))
    return path


def test_nested_folders_are_searched(tmp_path: Path) -> None:
    image = read(two_series(tmp_path))
    np.testing.assert_array_equal(voxels(image), VOXELS)


def test_circle_of_links_ends(tmp_path: Path) -> None:
    folder = two_series(tmp_path)
    os.symlink(folder, folder / "b" / "loop")
    os.symlink(folder / "a", folder / "again")
    os.symlink(folder / "nowhere", folder / "broken")
    np.testing.assert_array_equal(voxels(read(folder)), VOXELS)
    assert sum(series.slices for series in list_series(folder)) == 8


@pytest.mark.parametrize("key", [7, "1.2.3.7", "t1 AX"])
def test_series_by_number_uid_or_description(tmp_path: Path, key: object) -> None:
    assert modality(read(two_series(tmp_path), series=key)) == "MR"


def test_series_are_listed_and_descriptions_stay_out_of_texts(tmp_path: Path) -> None:
    folder = two_series(tmp_path)
    first, second = list_series(folder)
    assert (first.number, first.modality, first.slices) == (4, "CT", 5)
    assert (second.uid, second.rows, second.columns) == ("1.2.3.7", 6, 7)
    assert (first.description, second.description) == ("Thorax 1.0 B30f", "T1 axial")
    assert "Thorax" not in repr(first)
    message = error_of(folder, series="brain")
    assert "no series 'brain'; allowed are 4 (CT, 5 slices), 7 (MR, 3 slices)" in message
    assert "2 series have a description with A" in error_of(folder, series="A")


def test_zip_archive(tmp_path: Path) -> None:
    archive = zipped(tmp_path / "a.zip", two_series(tmp_path / "ct"))
    np.testing.assert_array_equal(voxels(read(archive)), VOXELS)
    assert modality(read(archive, series=7)) == "MR"
    assert [series.number for series in list_series(archive)] == [4, 7]
    assert "no series 9" in error_of(archive, series=9)


def test_zip_with_one_volume_of_another_format(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    save(tmp_path / "in" / "a.nrrd")
    (tmp_path / "in" / "readme.txt").write_text("about")
    np.testing.assert_array_equal(voxels(read(zipped(tmp_path / "a.zip", tmp_path / "in"))), VOXELS)


def test_zip_names_that_lead_elsewhere_do_no_harm(tmp_path: Path) -> None:
    folder = write_series(tmp_path / "ct")
    archive = tmp_path / "deep" / "a.zip"
    archive.parent.mkdir()
    names = ("../../out/x", "/tmp/vtkmcvr-out/y", "C:\\z", "a/../b", "c/same")
    with zipfile.ZipFile(archive, "w") as target:
        for name, file in zip(names, sorted(folder.iterdir()), strict=True):
            target.writestr(zipfile.ZipInfo(name), file.read_bytes())
    before = sorted(tmp_path.rglob("*"))
    np.testing.assert_array_equal(voxels(read(archive)), VOXELS)
    assert sorted(tmp_path.rglob("*")) == before
    assert not Path("/tmp/vtkmcvr-out").exists()


def test_bad_zip_archives(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    archive = zipped(tmp_path / "a.zip", write_series(tmp_path / "ct"))
    data = archive.read_bytes()
    broken = tmp_path / "b.zip"
    broken.write_bytes(data[:-40])
    assert "the zip archive is damaged" in error_of(broken)
    broken.write_bytes(data[:100] + bytes(200) + data[300:])
    assert "the zip archive is damaged" in error_of(broken)
    with zipfile.ZipFile(broken, "w"):
        pass
    assert "the zip archive holds no file" in error_of(broken)
    flags = data.find(b"PK\x01\x02") + 8
    broken.write_bytes(data[:flags] + b"\x01" + data[flags + 1 :])
    assert "is encrypted; unpack it first" in error_of(broken)
    monkeypatch.setattr("vtkmcvr.reading.archive.free_memory", lambda: 100)
    assert "unpacking takes" in error_of(archive)


def test_zip_bomb_is_refused_before_unpacking(tmp_path: Path) -> None:
    bomb = tmp_path / "bomb.zip"
    with zipfile.ZipFile(bomb, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("a.dcm", bytes(1 << 20))
    data = bytearray(bomb.read_bytes())
    # The directory of the archive promises 4 GB per entry, 1000 times.
    start = data.find(b"PK\x01\x02")
    entry = data[start : data.find(b"PK\x05\x06")]
    entry[24:28] = b"\xfe\xff\xff\xff"
    end = bytearray(data[data.find(b"PK\x05\x06") :])
    end[8:12] = (1000).to_bytes(2, "little") * 2
    end[12:16] = (1000 * len(entry)).to_bytes(4, "little")
    bomb.write_bytes(data[:start] + entry * 1000 + end)
    assert "unpacking takes 4.29 TB" in error_of(bomb)


def write_directory(folder: Path, names: list[list[str]]) -> Path:
    """Write a DICOMDIR with one record per file."""
    dataset = Dataset()
    dataset.file_meta = FileMetaDataset()
    dataset.file_meta.TransferSyntaxUID = ExplicitVRLittleEndian
    dataset.file_meta.MediaStorageSOPClassUID = MediaStorageDirectoryStorage
    dataset.file_meta.MediaStorageSOPInstanceUID = generate_uid()
    dataset.DirectoryRecordSequence = [Dataset() for _ in names]
    for record, name in zip(dataset.DirectoryRecordSequence, names, strict=True):
        record.DirectoryRecordType = "IMAGE"
        record.ReferencedFileID = name
    dataset.save_as(folder / "DICOMDIR", enforce_file_format=True)
    return folder / "DICOMDIR"


def test_dicomdir(tmp_path: Path) -> None:
    series = write_series(tmp_path / "disc" / "IMAGES")
    # Names on a disc are in capitals, whatever the system made of them.
    for file in series.iterdir():
        file.rename(series / f"i{file.name[-2:]}")
    names = [["IMAGES", file.name.upper()] for file in sorted(series.iterdir())]
    path = write_directory(series.parent, names)
    for source in (path, path.parent):
        np.testing.assert_array_equal(voxels(read(source)), VOXELS)
    (series / "i99").unlink()
    assert "1 files that the DICOMDIR names are missing" in notes(read(path))
    shutil.rmtree(series)
    assert "none of the files it names is there" in error_of(path)


@pytest.mark.filterwarnings("ignore:Invalid value for VR CS")
@pytest.mark.parametrize("name", [["..", "in", "4-99"], ["IN/..", "X"], ["C:\\X"], ["."]])
def test_dicomdir_that_leads_elsewhere_is_refused(tmp_path: Path, name: list[str]) -> None:
    write_series(tmp_path / "in")
    (tmp_path / "disc").mkdir()
    path = write_directory(tmp_path / "disc", [name])
    assert "outside its folder" in error_of(path) or "none of the files" in error_of(path)


def test_a_file_stands_for_its_series(tmp_path: Path) -> None:
    folder = two_series(tmp_path)
    image = read(next((folder / "b").iterdir()))
    np.testing.assert_array_equal(voxels(image), VOXELS[:3])


def test_damaged_files_can_be_left_out(tmp_path: Path) -> None:
    folder = write_series(tmp_path / "ct")
    whole = (folder / "4-99").read_bytes()
    (folder / "4-99").write_bytes(whole[:400])
    assert "give ignore='damaged' to leave it out" in error_of(folder)
    image = read(folder, ignore="damaged")
    np.testing.assert_array_equal(voxels(image), VOXELS[1:])
    assert "1 damaged DICOM files left out" in notes(image)


def test_patient_in_file_names_stays_out_of_texts(tmp_path: Path) -> None:
    folder = tmp_path / "ct"
    for k, (plane, place) in enumerate(zip(VOXELS, positions(5), strict=True)):
        write_slice(folder / f"{SECRET}-{k}.dcm", plane, place)
    assert SECRET not in " ".join(notes(read(folder)))
    (folder / f"{SECRET}-2.dcm").write_bytes(b"")
    assert "missing slice" in error_of(folder)
    data = (folder / f"{SECRET}-1.dcm").read_bytes()
    (folder / f"{SECRET}-1.dcm").write_bytes(data[:-20])
    (folder / f"{SECRET}-2.dcm").unlink()
    assert "cannot be decoded" in error_of(folder, resample=True)
