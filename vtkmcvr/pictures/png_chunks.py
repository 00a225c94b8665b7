"""Text in PNG files: iTXt chunks (PNG specification, 11.3.3.4), which VTK does not write."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator, Mapping

SIGNATURE = b"\x89PNG\r\n\x1a\n"
# A recipe takes some kilobytes
LARGEST_TEXT = 2**26


def with_text(png: bytes, text: Mapping[str, str]) -> bytes:
    """Return a PNG file with compressed iTXt chunks before its pixels."""
    place = next(start for kind, start, _ in _chunks(png) if kind == b"IDAT")
    return png[:place] + b"".join(_itxt(*item) for item in text.items()) + png[place:]


def read_text(png: bytes) -> dict[str, str]:
    """Return the iTXt chunks of a PNG file by keyword; ValueError where it is none."""
    found = {}
    for kind, _, content in _chunks(png):
        if kind == b"iTXt":
            keyword, text = _parsed(content)
            found[keyword] = text
    return found


def _chunks(png: bytes) -> Iterator[tuple[bytes, int, bytes]]:
    """Yield type, position and content of each chunk."""
    if not png.startswith(SIGNATURE):
        raise ValueError("this is no PNG file")
    start = len(SIGNATURE)
    while start < len(png):
        head, content = png[start : start + 8], b""
        if len(head) == 8:
            content = png[start + 8 : start + 8 + int.from_bytes(head[:4], "big")]
        end = start + 12 + len(content)
        if len(head) < 8 or len(content) < int.from_bytes(head[:4], "big") or end > len(png):
            raise ValueError("the PNG file is cut off")
        if zlib.crc32(head[4:] + content) != int.from_bytes(png[end - 4 : end], "big"):
            raise ValueError("the PNG file is damaged: a checksum is wrong")
        yield head[4:], start, content
        start = end


def _itxt(keyword: str, text: str) -> bytes:
    # keyword, compressed by zlib, no language, no translated keyword
    content = keyword.encode("latin-1") + b"\0\1\0\0\0" + zlib.compress(text.encode(), 9)
    body = b"iTXt" + content
    return struct.pack(">I", len(content)) + body + struct.pack(">I", zlib.crc32(body))


def _parsed(content: bytes) -> tuple[str, str]:
    keyword, _, rest = content.partition(b"\0")
    if len(rest) < 2:
        raise ValueError("the PNG file has a damaged text")
    compressed = rest[0] == 1
    text = rest[2:].split(b"\0", 2)[-1]
    try:
        if compressed:
            text = zlib.decompressobj().decompress(text, LARGEST_TEXT)
        return keyword.decode("latin-1"), text.decode()
    except (zlib.error, UnicodeDecodeError) as error:
        raise ValueError(f"the PNG file has a damaged text: {error}") from None
