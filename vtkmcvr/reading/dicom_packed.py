"""Decode compressed DICOM frames by SimpleITK, or by pydicom where that fails."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import VolumeReadError
from .itk import quiet_itk

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from .dicom_headers import FileHeader


def stored_type(header: FileHeader) -> np.dtype[Any]:
    """Return the type of the stored pixels of a file, in this machine's byte order.

    Raises
    ------
    VolumeReadError
        If there is no such type.
    """
    bits = 8 if header.pixels.allocated == 1 else header.pixels.allocated
    if bits not in (8, 16, 32, 64):
        raise VolumeReadError(
            f"{header.path}: {bits} bits per pixel are not supported; export the images again, "
            "uncompressed."
        )
    return np.dtype(f"{'i' if header.pixels.signed else 'u'}{bits // 8}")


def unpacked_bits(data: bytes | bytearray, first: int, header: FileHeader) -> NDArray[np.uint8]:
    """Return the plane whose bits begin at bit `first` of `data`, lowest bit first."""
    bits = np.unpackbits(np.frombuffer(data, np.uint8), bitorder="little")
    count = header.rows * header.columns
    return bits[first : first + count].reshape(header.rows, header.columns)


def _decode(path: Path) -> NDArray[Any]:
    import SimpleITK

    with quiet_itk() as sitk:
        reader = sitk.ImageFileReader()
        reader.SetImageIO("GDCMImageIO")
        reader.SetFileName(str(path))
        return SimpleITK.GetArrayFromImage(reader.Execute())


def packed_frames(header: FileHeader) -> Callable[[int], NDArray[Any]]:
    """Return a function that reads the frame with a given index of a compressed file.

    Each frame goes through a file that holds nothing else, so that its decoder meets neither the
    rest of the header nor the patient's attributes.
    """
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
            return unpacked_bits(values.tobytes(), 0, header)
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
