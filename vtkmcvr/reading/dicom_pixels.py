"""Read the stored pixels of DICOM slices: plain ones directly, others through SimpleITK."""

from __future__ import annotations

import tempfile
from collections import defaultdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from .dicom_headers import read_dataset
from .errors import VolumeReadError
from .itk import quiet_itk
from .parallel import for_each

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from .dicom_headers import FileHeader, Frame
    from .options import ReadOptions

BIG_ENDIAN = "1.2.840.10008.1.2.2"
DEFLATED = "1.2.840.10008.1.2.1.99"
NATIVE = {"1.2.840.10008.1.2", "1.2.840.10008.1.2.1", BIG_ENDIAN, DEFLATED, ""}
RLE = "1.2.840.10008.1.2.5"
PIXEL_DATA = (b"\xe0\x7f\x10\x00", b"\x7f\xe0\x00\x10")
FLOAT_DATA = (b"\xe0\x7f\x08\x00", b"\x7f\xe0\x00\x08")
DOUBLE_DATA = (b"\xe0\x7f\x09\x00", b"\x7f\xe0\x00\x09")
PLAIN_COLOURS = {"MONOCHROME1", "MONOCHROME2", "RGB", ""}


def stored_type(header: FileHeader) -> np.dtype[Any]:
    """Return the type of the stored pixels of a file, in this machine's byte order.

    Raises
    ------
    VolumeReadError
        If there is no such type.
    """
    bits = 8 if header.pixels.allocated == 1 else header.pixels.allocated
    if bits not in (8, 16, 32, 64):
        raise _undecodable(header.path, f"{bits} bits per pixel are not supported")
    return np.dtype(f"{'i' if header.pixels.signed else 'u'}{bits // 8}")


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
        return _encapsulated(header)
    if header.syntax == DEFLATED:
        return _from_dataset(header)
    if header.pixels.photometric == "PALETTE COLOR":
        return _palette(header)
    if header.pixels.photometric.startswith("YBR_"):
        return _luminance(header)
    if header.pixels.photometric not in PLAIN_COLOURS:
        raise ValueError("unknown photometric interpretation")
    return _native(header)


def _undecodable(path: Path, why: str) -> VolumeReadError:
    return VolumeReadError(f"{path}: {why}; export the images again, uncompressed.")


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
            return _unpacked(data, first_bit % 8, header)
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


def _unpacked(data: bytes | bytearray, first: int, header: FileHeader) -> NDArray[np.uint8]:
    bits = np.unpackbits(np.frombuffer(data, np.uint8), bitorder="little")
    count = header.rows * header.columns
    return bits[first : first + count].reshape(header.rows, header.columns)


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


# Compressed pixels


def _decode(path: Path) -> NDArray[Any]:
    import SimpleITK

    with quiet_itk() as sitk:
        reader = sitk.ImageFileReader()
        reader.SetImageIO("GDCMImageIO")
        reader.SetFileName(str(path))
        return SimpleITK.GetArrayFromImage(reader.Execute())


def _encapsulated(header: FileHeader) -> Callable[[int], NDArray[Any]]:
    """Read compressed frames: each goes through a file that holds nothing else."""
    import pydicom
    from pydicom.encaps import generate_frames

    dataset = pydicom.dcmread(
        header.path, specific_tags=["PixelData", "ExtendedOffsetTable", "NumberOfFrames"]
    )
    frames = list(generate_frames(dataset.PixelData, number_of_frames=header.frames))

    def plane(index: int) -> NDArray[Any]:
        with tempfile.TemporaryDirectory(prefix="vtkmcvr-") as folder:
            path = Path(folder) / "frame.dcm"
            _write_frame(path, header, frames[index])
            values = _decode_frame(path)
        if header.pixels.allocated == 1:
            return _unpacked(values.tobytes(), 0, header)
        shape = (header.rows, header.columns)
        values = values.reshape(*shape, -1) if header.pixels.samples > 1 else values.reshape(shape)
        return values.astype(stored_type(header), copy=False)

    return plane


def _decode_frame(path: Path) -> NDArray[Any]:
    try:
        return _decode(path)
    except RuntimeError:
        # GDCM fails on small images in run lengths, which pydicom decodes.
        from pydicom.pixels import pixel_array

        return pixel_array(path, raw=True)


def _write_frame(path: Path, header: FileHeader, frame: bytes) -> None:
    from pydicom.dataset import Dataset, FileMetaDataset
    from pydicom.encaps import encapsulate
    from pydicom.uid import UID, SecondaryCaptureImageStorage, generate_uid

    dataset = Dataset()
    dataset.file_meta = FileMetaDataset()
    dataset.file_meta.TransferSyntaxUID = UID(header.syntax)
    dataset.file_meta.MediaStorageSOPClassUID = SecondaryCaptureImageStorage
    dataset.SOPClassUID = SecondaryCaptureImageStorage
    dataset.file_meta.MediaStorageSOPInstanceUID = dataset.SOPInstanceUID = generate_uid()
    pixels = header.pixels
    dataset.Rows, dataset.Columns = header.rows, header.columns
    dataset.BitsAllocated, dataset.BitsStored = pixels.allocated, pixels.stored
    if pixels.allocated == 1:
        # Run lengths of packed bits are decoded as bytes.
        dataset.Rows, dataset.Columns = 1, (header.rows * header.columns + 7) // 8
        dataset.BitsAllocated = dataset.BitsStored = 8
    dataset.HighBit = dataset.BitsStored - 1
    dataset.PixelRepresentation = int(pixels.signed)
    dataset.SamplesPerPixel = pixels.samples
    if pixels.samples > 1:
        dataset.PlanarConfiguration = int(pixels.planar)
    dataset.PhotometricInterpretation = pixels.photometric or "MONOCHROME2"
    dataset.PixelData = encapsulate([frame])
    dataset["PixelData"].VR = "OB"
    dataset.save_as(path, enforce_file_format=True)
