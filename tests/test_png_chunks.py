import struct
import zlib

import numpy as np
import pytest

from vtkmcvr.pictures.files import write_png
from vtkmcvr.pictures.png_chunks import read_text, with_text

TEXT = {"recipe": '{"größe": "' + "abc, " * 500 + '"}', "other": ""}


@pytest.fixture
def png(tmp_path):
    write_png(tmp_path / "a.png", np.full((5, 7, 4), 200, np.uint8))
    return (tmp_path / "a.png").read_bytes()


def test_text_round_trip_and_small(png):
    longer = with_text(png, TEXT)
    assert read_text(longer) == TEXT
    assert len(longer) - len(png) < 200
    assert read_text(png) == {}


def test_an_independent_reader_finds_the_text_and_the_pixels(png, tmp_path):
    image = pytest.importorskip("PIL.Image")
    (tmp_path / "b.png").write_bytes(with_text(png, TEXT))
    with image.open(tmp_path / "b.png") as picture:
        picture.load()
        assert picture.text == TEXT
        assert np.array_equal(np.asarray(picture), np.full((5, 7, 4), 200))


def chunk(kind, content, checksum=None):
    checksum = zlib.crc32(kind + content) if checksum is None else checksum
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", checksum)


def test_text_that_is_not_compressed_is_read_too(png):
    place = png.index(b"IDAT") - 4
    plain = chunk(b"iTXt", b"k\0\0\0en\0key\0" + "größe".encode())
    assert read_text(png[:place] + plain + png[place:]) == {"k": "größe"}


def damaged(png):
    place = png.index(b"IDAT") - 4
    return {
        "no PNG": b"hello",
        "empty": b"",
        "cut off in a head": png[:-3],
        "cut off in a chunk": png[: place + 10],
        "length beyond the end": png[:place] + struct.pack(">I", 2**31) + png[place + 4 :],
        "checksum": png[:place] + chunk(b"iTXt", b"k\0\0\0\0\0x", 1) + png[place:],
        "no zlib": png[:place] + chunk(b"iTXt", b"k\0\1\0\0\0hello") + png[place:],
        "no text": png[:place] + chunk(b"iTXt", b"k") + png[place:],
        "no UTF-8": png[:place] + chunk(b"iTXt", b"k\0\0\0\0\0\xff") + png[place:],
    }


@pytest.mark.parametrize("case", damaged(b"IDAT    "))
def test_damaged_files_are_one_sentence(png, case):
    with pytest.raises(ValueError, match="PNG file"):
        read_text(damaged(png)[case])


def test_a_text_that_unpacks_to_gigabytes_is_cut_off(png, monkeypatch):
    monkeypatch.setattr("vtkmcvr.pictures.png_chunks.LARGEST_TEXT", 1000)
    assert len(read_text(with_text(png, {"k": "x" * 100_000}))["k"]) == 1000
