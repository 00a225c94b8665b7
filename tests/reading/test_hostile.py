"""Files made to hurt: huge promises in small files, bombs, pipes, links, endless numbers."""

from __future__ import annotations

import bz2
import contextlib
import gzip
import os
import resource
import struct
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import pyvista
from made_dicom import positions, write_multiframe, write_series
from made_volumes import REPOSITORY, VOXELS, error_of, nrrd_text, save, voxels
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

from vtkmcvr.readers import VolumeReadError, read
from vtkmcvr.reading import source as source_module

PLACE = {"space": "LPS", "space_directions": "(1,0,0) (0,1,0) (0,0,1)"}
HUGE = "20000 10000 5000"


def metaimage(size: str, data: bytes = b"", **fields: str) -> bytes:
    lines = {"NDims": "3", "DimSize": size, "ElementType": "MET_UCHAR", "CompressedData": "False"}
    text = "\n".join(f"{key} = {value}" for key, value in (lines | fields).items())
    return f"{text}\nElementDataFile = LOCAL\n".encode() + data


def nifti(size: tuple[int, int, int]) -> bytes:
    head = bytearray(352)
    struct.pack_into("<i", head, 0, 348)
    struct.pack_into("<8h", head, 40, 3, *size, 1, 1, 1, 1)
    struct.pack_into("<hh", head, 70, 2, 8)
    struct.pack_into("<8f", head, 76, 1, 1, 1, 1, 1, 1, 1, 1)
    struct.pack_into("<f", head, 108, 352)
    head[344:347] = b"n+1"
    return bytes(head)


def legacy_vtk(size: str) -> bytes:
    return (
        f"# vtk DataFile Version 3.0\nx\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS {size}\n"
        f"SPACING 1 1 1\nORIGIN 0 0 0\nPOINT_DATA {20000 * 10000 * 5000}\n"
        "SCALARS s unsigned_char 1\nLOOKUP_TABLE default\n"
    ).encode()


def xml_vtk(extent: str) -> bytes:
    return (
        f'<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian"><ImageData '
        f'WholeExtent="{extent}" Origin="0 0 0" Spacing="1 1 1"><Piece Extent="{extent}">'
        '<PointData Scalars="s"><DataArray type="UInt8" Name="s" format="ascii">0</DataArray>'
        "</PointData></Piece></ImageData></VTKFile>"
    ).encode()


def numpy_head(shape: tuple[int, ...]) -> bytes:
    text = f"{{'descr': '|u1', 'fortran_order': False, 'shape': {shape}, }}\n".encode()
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text


TERABYTE = {
    "raw.nrrd": nrrd_text(type="uint8", sizes=HUGE, endian="", **PLACE),
    "gzip.nrrd": nrrd_text(type="uint8", sizes=HUGE, endian="", encoding="gzip", **PLACE)
    + gzip.compress(b"x"),
    "bzip2.nrrd": nrrd_text(type="uint8", sizes=HUGE, endian="", encoding="bzip2", **PLACE)
    + bz2.compress(b"x"),
    "text.nrrd": nrrd_text(type="uint8", sizes=HUGE, endian="", encoding="ascii", **PLACE) + b"1",
    "wide.nrrd": nrrd_text(type="double", sizes="9999999999 9999999999 9999999999", **PLACE),
    "a.mha": metaimage(HUGE),
    "packed.mha": metaimage(HUGE, b"x", CompressedData="True", CompressedDataSize="1"),
    "a.nii": nifti((20000, 20000, 20000)),
    "a.nii.gz": gzip.compress(nifti((20000, 20000, 20000))),
    "a.vtk": legacy_vtk(HUGE),
    "a.vti": xml_vtk("0 19999 0 9999 0 4999"),
    "a.npy": numpy_head((20000, 10000, 5000)),
    "a.slc": b"11111 20000 10000 5000 8 1 1 1 0 0 0 0 1 1 X" + bytes(9),
}


@pytest.mark.parametrize("name", TERABYTE)
def test_a_terabyte_in_a_few_bytes_is_refused_at_once(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    path.write_bytes(TERABYTE[name])
    assert path.stat().st_size < 1000
    before, start = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, time.process_time()
    message = error_of(path)
    assert "truncated" in message or "promises" in message or "takes" in message
    # Nothing of that size was allocated or gone through.
    assert time.process_time() - start < 5.0
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 200_000


def test_dicom_that_promises_more_than_it_holds(tmp_path: Path) -> None:
    folder = write_series(tmp_path / "a", Rows=60000, Columns=60000)
    assert "cannot be decoded" in error_of(folder) or "of memory and" in error_of(folder)
    path = write_multiframe(tmp_path / "b.dcm", positions(5), frames=2_000_000_000)
    assert "the header promises 2000000000 frames" in error_of(path)


@pytest.mark.parametrize("packing", ["gzip", "bzip2"])
def test_a_bomb_is_unpacked_no_further_than_its_header_says(tmp_path: Path, packing: str) -> None:
    pack = {"gzip": gzip.compress, "bzip2": bz2.compress}[packing]
    path = tmp_path / "a.nrrd"
    bomb = pack(VOXELS.tobytes() + bytes(300_000_000))
    path.write_bytes(nrrd_text(encoding=packing, **PLACE) + bomb)
    start = time.process_time()
    np.testing.assert_array_equal(voxels(read(path)), VOXELS)
    assert time.process_time() - start < 2.0


def test_a_bomb_in_nifti(tmp_path: Path) -> None:
    path = save(tmp_path / "a.nii")
    whole = path.read_bytes()
    (tmp_path / "b.nii.gz").write_bytes(gzip.compress(whole + bytes(300_000_000)))
    start = time.process_time()
    np.testing.assert_array_equal(voxels(read(tmp_path / "b.nii.gz")), VOXELS)
    assert time.process_time() - start < 2.0


def test_volume_beyond_the_free_memory_is_refused_with_numbers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(source_module, "free_memory", lambda: 300)
    for path in (save(tmp_path / "a.nrrd"), save(tmp_path / "a.nii"), save(tmp_path / "a.mha"),
                 write_series(tmp_path / "ct")):  # fmt: skip
        message = error_of(path)
        assert "reading 7 x 6 x 5 voxels takes " in message
        assert "of memory and 1 kB are free; close other programs, or crop" in message


def test_pipes_and_devices_are_no_data_files(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    path = tmp_path / "a.nhdr"
    path.write_bytes(nrrd_text(data_file="pipe", **PLACE))
    assert "data file 'pipe' is missing" in error_of(path)
    folder = write_series(tmp_path / "ct")
    os.mkfifo(folder / "pipe")
    np.testing.assert_array_equal(voxels(read(folder)), VOXELS)
    assert "neither a file nor a folder" in error_of(tmp_path / "pipe")


def test_links_in_a_circle(tmp_path: Path) -> None:
    os.symlink(tmp_path / "b", tmp_path / "a")
    os.symlink(tmp_path / "a", tmp_path / "b")
    assert "no such file or folder" in error_of(tmp_path / "a") or "cannot be read" in error_of(
        tmp_path / "a"
    )


@pytest.mark.parametrize(
    "name", ["a.nrrd", "a.nii", "a.nii.gz", "a.mha", "a.vti", "a.vtk", "a.npy", "a.npz", "a.slc",
             "a.tif", "a.raw", "a.dcm", "a.zip", "DICOMDIR"],
)  # fmt: skip
def test_empty_files(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    path.touch()
    assert "the file is empty" in error_of(path) or "zip archive is damaged" in error_of(path)


@pytest.mark.skipif(os.geteuid() == 0, reason="root may read everything")
def test_files_without_permission(tmp_path: Path) -> None:
    path = save(tmp_path / "a.nrrd")
    path.chmod(0)
    assert "cannot be read (Permission denied)" in error_of(path)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.nrrd", b"NRRD0005\n" + b"x" * 5_000_000),
        ("b.nrrd", b"NRRD0005\n" + b"key: value\n" * 500_000),
        ("a.mha", b"x" * 5_000_000),
        ("a.vtk", b"# vtk DataFile Version 3.0\n" + b"x " * 2_000_000),
        ("a.vti", b"<VTKFile" + b" a='b'" * 500_000),
        ("a.slc", b"11111 " + b"9" * 5_000_000),
        ("a.npy", b"\x93NUMPY\x02\x00\xff\xff\xff\x7f" + b"(" * 5_000_000),
    ],
)
def test_endless_headers(tmp_path: Path, name: str, text: bytes) -> None:
    path = tmp_path / name
    path.write_bytes(text)
    start = time.process_time()
    error_of(path)
    assert time.process_time() - start < 5.0


def test_numbers_out_of_range(tmp_path: Path) -> None:
    path = tmp_path / "a.nrrd"
    for fields in (
        {"sizes": "-7 6 5"},
        {"sizes": "0 6 5"},
        {"sizes": "7 6 1e3"},
        {"dimension": "99999999"},
        {"byte_skip": "99999999999999"},
        {"line_skip": "9999999999"},
        {"space_directions": "(nan,0,0) (0,1,0) (0,0,1)"},
        {"space_directions": "(1e400,0,0) (0,1,0) (0,0,1)"},
        {"space_directions": "(0,0,0) (0,1,0) (0,0,1)"},
        {"space_origin": "(inf,0,0)"},
        {"space_origin": "(1,2)"},
    ):
        path.write_bytes(nrrd_text(**PLACE | fields) + VOXELS.tobytes())
        start = time.process_time()
        error_of(path)
        assert time.process_time() - start < 5.0


def test_wrong_byte_order_marks_change_values_and_nothing_else(tmp_path: Path) -> None:
    path = tmp_path / "a.nrrd"
    path.write_bytes(nrrd_text(endian="big", **PLACE) + VOXELS.tobytes())
    np.testing.assert_array_equal(voxels(read(path)), VOXELS.byteswap())


def test_vtk_files_of_other_kinds_do_not_end_the_process(tmp_path: Path) -> None:
    path = tmp_path / "a.vti"
    for text in (
        xml_vtk("0 -5 0 9 0 9"),
        xml_vtk("0 9 0 9 0 9"),
        xml_vtk("a b c d e f"),
        xml_vtk("0 2147483647 0 2147483647 0 2147483647"),
        b"<VTKFile type='PolyData'></VTKFile>",
    ):
        path.write_bytes(text)
        error_of(path)


def test_entities_of_xml_are_not_blown_up(tmp_path: Path) -> None:
    path = tmp_path / "a.vti"
    lines = "".join(f'<!ENTITY a{k + 1} "{f"&a{k};" * 10}">' for k in range(9))
    path.write_text(f'<?xml version="1.0"?><!DOCTYPE x [<!ENTITY a0 "ha">{lines}]><x>&a9;</x>')
    start = time.process_time()
    error_of(path)
    assert time.process_time() - start < 5.0


def test_nothing_is_left_behind_in_the_temporary_folder(tmp_path: Path) -> None:
    import zipfile

    folder = write_series(tmp_path / "ct")
    archive = tmp_path / "a.zip"
    with zipfile.ZipFile(archive, "w") as target:
        for file in folder.iterdir():
            target.write(file, file.name)
        target.writestr("broken.dcm", (folder / "4-99").read_bytes()[:300])
    place = tmp_path / "temporary"
    place.mkdir()
    code = "import sys, vtkmcvr\ntry: vtkmcvr.read(sys.argv[1])\nexcept ValueError as e: print(e)"
    done = subprocess.run(
        [sys.executable, "-c", code, str(archive)], cwd=REPOSITORY, capture_output=True, text=True,
        env={**os.environ, "TMPDIR": str(place)}, check=True,
    )  # fmt: skip
    assert f"{archive}: file" in done.stdout
    assert list(place.iterdir()) == []


# What the fuzzer found


def test_numbers_that_made_another_reader_hang(tmp_path: Path) -> None:
    """MetaIO never came back from a matrix that is not finite."""
    path = tmp_path / "a.mha"
    matrix = "1 0 0 0 1 0 0 0 41e308"
    path.write_bytes(metaimage("7 6 5", bytes(210), TransformMatrix=matrix))
    assert "the header is damaged" in error_of(path)


def test_pages_that_made_another_reader_write_behind_its_memory(tmp_path: Path) -> None:
    """libtiff in ITK broke the heap where the sizes of the strips are missing."""
    import SimpleITK

    path = tmp_path / "a.tif"
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(np.abs(VOXELS).astype(np.uint16)), str(path))
    whole = path.read_bytes()
    tag = whole.find(struct.pack("<HH", 279, 4))
    assert tag > 0
    for at in range(tag, tag + 12):
        path.write_bytes(whole[:at] + b"\xff" + whole[at + 1 :])
        with contextlib.suppress(VolumeReadError):
            assert voxels(read(path)).shape == VOXELS.shape


def test_an_unknown_kind_of_colours_is_refused(tmp_path: Path) -> None:
    """GDCM never came back from some damaged headers; it gets frames in whole ones only."""
    folder = write_series(tmp_path / "a", PhotometricInterpretation="MONOCHROME9")
    assert "the pixels of a slice cannot be decoded" in error_of(folder)


@pytest.mark.parametrize("inline", [True, False])
def test_blocks_that_made_vtk_end_the_process(tmp_path: Path, inline: bool) -> None:
    """VTK ended the process, for want of memory, where a packed array has too many blocks."""
    path = tmp_path / "a.vti"
    image = pyvista.wrap(np.abs(VOXELS))
    writer = vtkXMLImageDataWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(image)
    writer.SetDataModeToBinary() if inline else writer.SetDataModeToAppended()
    writer.EncodeAppendedDataOff()
    writer.Write()
    whole = path.read_bytes()
    assert read(path).dimensions == (5, 6, 7)
    header = struct.pack("<I", 1) if not inline else b"AQAAAA"
    data = whole.index(b"<DataArray") if inline else whole.index(b"<AppendedData")
    place = whole.index(header, data)
    for text in (b"AQA1e3", b"////fw") if inline else (b"\xff\xff\xff\x7f",):
        path.write_bytes(whole[:place] + text + whole[place + len(text) :])
        assert "damaged: a block of its data has no possible size" in error_of(path)


def test_a_legacy_header_that_ends_in_a_word(tmp_path: Path) -> None:
    path = tmp_path / "a.vtk"
    for text in ("DIMENSIONS 7 6 5\nSCALARS", "DIMENSIONS 7", "DIMENSIONS 7 6 5 SCALARS s"):
        path.write_text("# vtk DataFile Version 3.0\nx\nBINARY\nDATASET STRUCTURED_POINTS\n" + text)
        error_of(path)


def test_one_file_is_never_changed_by_reading_it(tmp_path: Path) -> None:
    path = save(tmp_path / "a.mha", gz=True)
    before = path.read_bytes(), path.stat().st_mtime_ns
    read(path)
    with pytest.raises(VolumeReadError):
        read(tmp_path / "b.mha")
    assert (path.read_bytes(), path.stat().st_mtime_ns) == before
