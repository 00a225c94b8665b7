"""Read the stored pixels of DICOM slices: plain ones directly, others through SimpleITK."""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from .dicom_deflated import DEFLATED
from .dicom_headers import read_dataset
from .dicom_packed import packed_frames, stored_type, unpacked_bits
from .errors import VolumeReadError
from .parallel import for_each

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from .dicom_headers import FileHeader, Frame
    from .options import ReadOptions

BIG_ENDIAN = "1.2.840.10008.1.2.2"
NATIVE = {"1.2.840.10008.1.2", "1.2.840.10008.1.2.1", BIG_ENDIAN, DEFLATED, ""}
RLE = "1.2.840.10008.1.2.5"
PIXEL_DATA = (b"\xe0\x7f\x10\x00", b"\x7f\xe0\x00\x10")
FLOAT_DATA = (b"\xe0\x7f\x08\x00", b"\x7f\xe0\x00\x08")
DOUBLE_DATA = (b"\xe0\x7f\x09\x00", b"\x7f\xe0\x00\x09")
PLAIN_COLOURS = {"MONOCHROME1", "MONOCHROME2", "RGB", ""}


def read_frames(
    frames: Sequence[Frame], label: str, options: ReadOptions, finish: Callable[[int, Any], None]
) -> None:
    """Decode slices in parallel and hand each to `finish(number, pixels)`.

    Parameters
    ----------
    frames : sequence of Frame
        Slices in the order of their numbers.
    label : str
        How to name the series in an error.
    options : ReadOptions
        Threads and progress.
    finish : callable
        Takes the number of a slice and its stored pixels, shape (rows, columns) or
        (rows, columns, samples). Called from several threads.

    Raises
    ------
    VolumeReadError
        If pixels are missing or cannot be decoded.
    """
    files: dict[Path, list[int]] = defaultdict(list)
    for number, frame in enumerate(frames):
        files[frame.file.path].append(number)

    def read_file(numbers: list[int]) -> None:
        header = frames[numbers[0]].file
        try:
            planes = _open_file(header)
            for number in numbers:
                finish(number, planes(frames[number].index))
        except (VolumeReadError, OSError, MemoryError):
            raise
        except Exception:
            # Decoders raise many kinds of error, and pydicom's may quote patient attributes.
            raise VolumeReadError(
                f"{label}: the pixels of a slice cannot be decoded: a file is damaged, truncated "
                "or compressed in an unsupported way; copy or export the series again."
            ) from None

    text = f"reading {len(frames)} DICOM slices"
    for_each(read_file, files.values(), options, text)


def _open_file(header: FileHeader) -> Callable[[int], NDArray[Any]]:
    """Return a function that reads the plane with a given index."""
    if header.syntax not in NATIVE:
        return packed_frames(header)
    if header.syntax == DEFLATED:
        return _from_dataset(header)
    if header.pixels.photometric == "PALETTE COLOR":
        return _palette(header)
    if header.pixels.photometric.startswith("YBR_"):
        return _luminance(header)
    if header.pixels.photometric not in PLAIN_COLOURS:
        raise ValueError("unknown photometric interpretation")
    return _native(header)


# Plain pixels


def _native(header: FileHeader) -> Callable[[int], NDArray[Any]]:
    with header.path.open("rb") as stream:
        stream.seek(header.pixel_offset)
        element = stream.read(12)
    explicit = element[4:6] in (b"OB", b"OW", b"OF", b"OD", b"UN")
    start = header.pixel_offset + (12 if explicit else 8)
    kind = _element_type(header, element[:4])
    order: Literal["<", ">"] = ">" if header.syntax == BIG_ENDIAN else "<"

    def plane(index: int) -> NDArray[Any]:
        count = header.rows * header.columns * header.pixels.samples
        first_bit = index * count * header.pixels.allocated
        bits = count * header.pixels.allocated
        length = (first_bit % 8 + bits + 7) // 8
        if kind.itemsize == 1 and order == ">" and element[4:6] == b"OW":
            return _shaped(_of_words(header.path, start, first_bit // 8, length), header)
        data = _bytes(header.path, start + first_bit // 8, length)
        if header.pixels.allocated == 1:
            return unpacked_bits(data, first_bit % 8, header)
        return _shaped(np.frombuffer(data, kind.newbyteorder(order)), header)

    return plane


def _bytes(path: Path, start: int, length: int) -> bytearray:
    data = bytearray(length)
    with path.open("rb", buffering=0) as stream:
        stream.seek(start)
        if stream.readinto(data) < length:
            raise EOFError
    return data


def _of_words(path: Path, start: int, first: int, length: int) -> NDArray[np.uint8]:
    """Return bytes that are stored in big-endian words, in which they are swapped."""
    even = first // 2 * 2
    words = _bytes(path, start + even, (first - even + length + 1) // 2 * 2)
    swapped = np.frombuffer(words, np.uint16).byteswap().view(np.uint8)
    return swapped[first - even :][:length]


def _element_type(header: FileHeader, tag: bytes) -> np.dtype[Any]:
    if tag in FLOAT_DATA:
        return np.dtype(np.float32)
    if tag in DOUBLE_DATA:
        return np.dtype(np.float64)
    if tag not in PIXEL_DATA:
        raise EOFError
    return stored_type(header)


def _shaped(flat: NDArray[Any], header: FileHeader) -> NDArray[Any]:
    values = flat.astype(flat.dtype.newbyteorder("="), copy=False)
    samples = header.pixels.samples
    if samples == 1:
        return _stored_bits(values.reshape(header.rows, header.columns), header)
    if header.pixels.planar:
        return np.moveaxis(values.reshape(samples, header.rows, header.columns), 0, -1)
    return values.reshape(header.rows, header.columns, samples)


def _stored_bits(values: NDArray[Any], header: FileHeader) -> NDArray[Any]:
    """Return values without what older files keep in the bits above the stored ones."""
    unused = header.pixels.allocated - header.pixels.stored
    if unused == 0 or values.dtype.kind == "f":
        return values
    if header.pixels.signed:
        return (values << unused) >> unused
    return values & values.dtype.type((1 << header.pixels.stored) - 1)


def _from_dataset(header: FileHeader) -> Callable[[int], NDArray[Any]]:
    """Read a file that is deflated as a whole."""
    import pydicom

    data = pydicom.dcmread(header.path).PixelData
    count = header.rows * header.columns * header.pixels.samples

    def plane(index: int) -> NDArray[Any]:
        if header.pixels.allocated == 1:
            whole = np.unpackbits(np.frombuffer(data, np.uint8), bitorder="little")
            shape = header.rows, header.columns
            return whole[index * count :][:count].reshape(shape)
        kind = stored_type(header)
        start = index * count * kind.itemsize
        return _shaped(np.frombuffer(data[start:], kind.newbyteorder("<"), count), header)

    return plane


def _palette(header: FileHeader) -> Callable[[int], NDArray[Any]]:
    """Read colours that the pixels are numbers of, 8 bits each."""
    from pydicom.pixels import apply_color_lut

    dataset, _ = read_dataset(header.path)
    plane = _native(header)

    def coloured(index: int) -> NDArray[np.uint8]:
        colours = apply_color_lut(plane(index), dataset)
        shift = 8 * (colours.dtype.itemsize - 1)
        return (colours >> shift).astype(np.uint8)

    return coloured


def _luminance(header: FileHeader) -> Callable[[int], NDArray[Any]]:
    """Read colours that are stored as luminance and two differences."""
    from pydicom.pixels import pixel_array

    return lambda index: pixel_array(header.path, index=index)
