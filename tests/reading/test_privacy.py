"""Nothing that DICOM says about the patient leaves the file."""

from __future__ import annotations

import json
import logging
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from made_dicom import positions, write_multiframe, write_series, write_slice
from made_volumes import REPOSITORY, SECRET, VOXELS
from pydicom.datadict import dictionary_VR, tag_for_keyword

from vtkmcvr.commands.info_page import format_info
from vtkmcvr.readers import VolumeReadError, list_series, read
from vtkmcvr.volume_info import volume_info

PLANTED = {
    "PatientName": f"{SECRET}^NAME",
    "PatientID": SECRET,
    "PatientBirthDate": "19330217",
    "PatientAddress": SECRET,
    "PatientComments": SECRET,
    "OtherPatientIDs": SECRET,
    "AccessionNumber": SECRET,
    "ReferringPhysicianName": SECRET,
    "InstitutionName": SECRET,
    "StudyDescription": SECRET,
    "SeriesDescription": f"Head of {SECRET}",
    "ProtocolName": SECRET,
    "OperatorsName": SECRET,
    "StudyID": SECRET,
    "ImageComments": SECRET,
    "DeviceSerialNumber": SECRET,
    "PatientAge": "091Y",
    "StudyDate": "19330217",
}
TRACES = (SECRET, "19330217", "091Y")


def assert_clean(text: str) -> None:
    for trace in TRACES:
        assert trace not in text


@pytest.fixture
def series(tmp_path: Path) -> Path:
    return write_series(tmp_path / "ct", np.abs(VOXELS), **PLANTED)


def test_facts_and_page_are_clean(series: Path, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.DEBUG)
    info = volume_info(read(series))
    assert_clean(json.dumps(info) + format_info(info) + repr(list_series(series)) + caplog.text)


@pytest.mark.parametrize("keyword", [*PLANTED, "Rows", "RescaleSlope", "ImagePositionPatient"])
def test_errors_and_log_are_clean_whatever_is_damaged(
    series: Path, keyword: str, caplog: pytest.LogCaptureFixture, capfd: pytest.CaptureFixture[str]
) -> None:
    """Break the value of each attribute in one file, and its length."""
    caplog.set_level(logging.DEBUG)
    path = next(series.iterdir())
    whole = path.read_bytes()
    tag = tag_for_keyword(keyword)
    assert tag is not None
    mark = (tag >> 16).to_bytes(2, "little") + (tag & 0xFFFF).to_bytes(2, "little")
    place = whole.index(mark + dictionary_VR(tag).encode())
    for at, byte in ((place + 5, b"\xff"), (place + 6, b"\xff"), (place + 8, b"\xff")):
        path.write_bytes(whole[:at] + byte + whole[at + 1 :])
        told = ""
        try:
            image = read(series, units="suv") if keyword == "PatientID" else read(series)
            told = json.dumps(volume_info(image))
        except VolumeReadError as error:
            context = None if error.__suppress_context__ else error.__context__
            told = f"{error} {error.__cause__} {context}"
        assert_clean(told + caplog.text + "".join(capfd.readouterr()))


def run(*arguments: str) -> str:
    done = subprocess.run(
        [sys.executable, "-W", "always", *arguments], cwd=REPOSITORY, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return done.stdout + done.stderr


def test_values_that_pydicom_would_warn_about(series: Path) -> None:
    """The name stays out of stderr, where pydicom's log goes without further settings."""
    for path in series.iterdir():
        path.write_bytes(path.read_bytes().replace(b"19330217", f"{SECRET}no".encode()))
    assert_clean(run("-c", f"import vtkmcvr; print(vtkmcvr.read({str(series)!r}))"))


def test_pictures_and_recipes_are_clean(series: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    small = ("--samples", "1", "--size", "8x8", "--threads", "1")
    told = run("-m", "vtkmcvr", "render", str(series), "-o", str(out / "a.npz"), *small,
               "--json", str(out / "render.json"))  # fmt: skip
    told += run("-m", "vtkmcvr", "info", str(series), "--json", str(out / "info.json"))
    told += run(
        "-c",
        f"""
import vtkmcvr
picture = vtkmcvr.render(vtkmcvr.read({str(series)!r}), samples=1, size=(8, 8), threads=1)
for name in ("a.png", "a.vti"):
    picture.save({str(out)!r} + "/" + name)
print(picture, picture.recipe, picture.plan.explain())""",
    )
    assert_clean(told)
    assert len(list(out.iterdir())) == 5
    for path in out.iterdir():
        data = path.read_bytes()
        for trace in TRACES:
            assert trace.encode() not in data
            assert trace.encode("utf-16-le") not in data
        if path.suffix == ".npz":
            with np.load(path) as arrays:
                assert_clean(" ".join(str(arrays[name]) for name in arrays))


def test_every_other_output_is_clean(
    series: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Reports, movies, thumbnails, looks, segmented pictures and what is printed on the way."""
    import vtkmcvr
    from vtkmcvr.cli import main

    out = tmp_path / "out"
    out.mkdir()
    labels = tmp_path / "labels.npy"
    np.save(labels, (VOXELS > 0).astype(np.uint8))
    small = ("--samples", "1", "--size", "8x8", "--threads", "1")
    source = str(series)
    commands = (
        ("render", source, "-o", f"{out}/a.png", *small),
        ("render", source, "-o", f"{out}/b.png", *small, "--bits", "16", "--whole"),
        ("render", source, "-o", f"{out}/c.gif", *small, "--time", "all"),
        ("presets", "ct-bone", "-o", f"{out}/thumbs", "--input", source, *small),
        ("presets", "ct-bone", "-o", f"{out}/look.json"),
        ("replay", f"{out}/b.png", "-o", f"{out}/f.png", "--input", source),
        # These are refused, which is told without a name as well
        ("render", source, "-o", f"{out}/g.png", *small, "--labels", str(labels), "--show", "9"),
        ("render", source, "-o", f"{out}/g.png", *small, "--preset", f"{source}.xml"),
    )
    statuses = [main(list(command)) for command in commands]
    assert statuses == [0] * 6 + [2] * 2
    picture = vtkmcvr.render(vtkmcvr.read(series), samples=1, size=(8, 8), threads=1)
    vtkmcvr.write_report(picture, out / "a.html")
    assert_clean("".join(capsys.readouterr()))
    files = [path for path in out.rglob("*") if path.is_file()]
    assert len(files) == 7
    for path in files:
        for trace in TRACES:
            assert trace.encode() not in path.read_bytes()
            assert trace.encode("utf-16-le") not in path.read_bytes()


def test_a_lone_patient_file_is_refused_without_its_name(tmp_path: Path) -> None:
    write_slice(tmp_path / "ct" / f"{SECRET}.dcm", VOXELS[0], positions(1)[0], **PLANTED)
    with pytest.raises(VolumeReadError) as caught:
        read(tmp_path / "ct")
    assert_clean(str(caught.value))


def test_file_names_stay_out_of_every_error(tmp_path: Path) -> None:
    """Files in a folder are often named after the patient."""
    path = tmp_path / "a" / f"{SECRET}.dcm"
    write_multiframe(path, positions(5), frames=900_000)
    write_multiframe(tmp_path / "b" / f"{SECRET}.dcm", positions(5), frames=4)
    write_series(tmp_path / "c", BitsAllocated=12)
    cut = write_multiframe(tmp_path / "d" / f"{SECRET}.dcm", positions(5))
    cut.write_bytes(cut.read_bytes()[:-200])
    for file in (tmp_path / "c").iterdir():
        file.rename(file.with_name(SECRET + file.name))
    for name in "abcd":
        with pytest.raises(VolumeReadError) as caught:
            read(tmp_path / name)
        assert_clean(str(caught.value))
        assert str(caught.value).startswith(str(tmp_path / name))
