"""Values of DICOM pixels: types, padding, uptake values, doses, bits and every transfer syntax."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pydicom
import pytest
from made_dicom import positions, write_multiframe, write_series, write_slice
from made_volumes import SPACING, VOXELS, affine, error_of, real, voxels
from pydicom.data import get_testdata_file
from pydicom.dataset import Dataset
from pydicom.uid import (
    DeflatedExplicitVRLittleEndian,
    ExplicitVRBigEndian,
    ImplicitVRLittleEndian,
    PositronEmissionTomographyImageStorage,
    RLELossless,
)

from vtkmcvr.readers import notes, read, read_vtk, units

# Types


@pytest.mark.parametrize(
    ("stored", "rescale", "kept"),
    [
        (np.array([0, 4095], np.uint16), (1, -1024), np.int16),
        (np.array([-1024, 3071], np.int16), (1, 0), np.int16),
        (np.array([0, 65535], np.uint16), (1, 0), np.uint16),
        (np.array([0, 65535], np.uint16), (1, -32768), np.int16),
        (np.array([0, 65535], np.uint16), (1, -40000), np.int32),
        (np.array([-32768, 32767], np.int16), (1, -1000), np.int32),
        (np.array([-32768, 32767], np.int16), (1, 32768), np.uint16),
        (np.array([0, 30000], np.int16), (2, 0), np.uint16),
        (np.array([0, 32767], np.int16), (2.0222, 0), np.float32),
        (np.array([0, 255], np.uint8), (1, 0), np.uint8),
        (np.array([0, 255], np.uint8), (1, -128), np.int16),
        (np.array([0, 2**32 - 1], np.uint32), (1, 0), np.float32),
        (np.array([0, 2**31 - 1], np.uint32), (1, 0), np.int32),
    ],
)
def test_type_holds_the_values_exactly(
    tmp_path: Path, stored: np.ndarray, rescale: tuple[float, float], kept: type
) -> None:
    pixels = np.resize(stored, (3, 6, 7))
    bits = 8 * stored.dtype.itemsize
    format_ = {"BitsAllocated": bits, "BitsStored": bits, "HighBit": bits - 1}
    slope, intercept = rescale
    folder = write_series(
        tmp_path / "a", pixels, RescaleSlope=slope, RescaleIntercept=intercept, **format_
    )
    image = read(folder)
    assert voxels(image).dtype == kept
    expected = pixels.astype(np.float64) * slope + intercept
    np.testing.assert_allclose(voxels(image), expected, rtol=2.0**-23 if kept is np.float32 else 0)


def test_bits_above_the_stored_ones_are_cleared(tmp_path: Path) -> None:
    pixels = np.full((3, 6, 7), 0xF123, np.uint16)
    image = read(write_series(tmp_path / "a", pixels, BitsStored=12, HighBit=11))
    assert np.unique(voxels(image)) == [0x123]
    signed = np.full((3, 6, 7), 0x1FFF, np.int16)
    image = read(write_series(tmp_path / "b", signed, BitsStored=12, HighBit=11))
    assert np.unique(voxels(image)) == [-1]


def test_slices_of_different_sign_become_one_volume(tmp_path: Path) -> None:
    pixels = np.abs(VOXELS) + 5
    folder = write_series(tmp_path / "a", pixels)
    write_slice(folder / "4-99", pixels[0].astype(np.uint16), positions(5)[0])
    np.testing.assert_array_equal(voxels(read(folder)), pixels)


# Padding


def padded(folder: Path, value: int, limit: int | None = None) -> Path:
    """Add the padding value as unsigned, as many scanners do whatever the pixels are."""
    for file in folder.iterdir():
        dataset = pydicom.dcmread(file)
        dataset.add_new(0x00280120, "US", value % 65536)
        if limit is not None:
            dataset.add_new(0x00280121, "US", limit % 65536)
        dataset.save_as(file)
    return folder


@pytest.mark.parametrize(
    ("stored", "padding", "intercept"),
    [
        (np.int16, -3024, 0),
        (np.int16, -2000, -1024),
        (np.uint16, 63536, -1024),
        (np.int16, 63536, 0),
        (np.uint16, 4095, -1024),
    ],
)
def test_padding_of_ct_becomes_air(
    tmp_path: Path, stored: type, padding: int, intercept: int
) -> None:
    pixels = (np.arange(210).reshape(5, 6, 7) + 1024).astype(stored)
    pixels[:, 0, :3] = np.array(padding).astype(stored)
    folder = padded(write_series(tmp_path / "a", pixels, RescaleIntercept=intercept), padding)
    values = voxels(read(folder))
    known = np.ones(pixels.shape, bool)
    known[:, 0, :3] = False
    np.testing.assert_array_equal(values[known], pixels[known].astype(int) + intercept)
    assert set(values[~known]) == {-1000 if intercept < 0 else values[known].min()}
    assert values.dtype == np.int16
    assert any("padding voxels" in note for note in notes(read(folder)))


def test_padding_range_and_padding_at_the_floor(tmp_path: Path) -> None:
    pixels = np.abs(VOXELS) + 500
    pixels[0, 0, :4] = (-2000, -1990, -1995, 500)
    image = read(padded(write_series(tmp_path / "a", pixels, Modality="MR"), -2000, -1990))
    assert set(voxels(image)[0, 0, :3]) == {500}
    assert "3 padding voxels (value -2000) set to 500" in notes(image)
    mri = np.abs(VOXELS)
    image = read(padded(write_series(tmp_path / "b", mri, Modality="MR"), 0))
    np.testing.assert_array_equal(voxels(image), mri)


# PET, dose


def pet(folder: Path, **attributes: object) -> Path:
    tracer = Dataset()
    tracer.RadiopharmaceuticalStartTime = "110000"
    tracer.RadionuclideTotalDose = 370e6
    tracer.RadionuclideHalfLife = 6586.2
    usual = {
        "SOPClassUID": PositronEmissionTomographyImageStorage, "Modality": "PT", "Units": "BQML",
        "DecayCorrection": "START", "PatientWeight": 70.0, "SeriesTime": "120000",
        "AcquisitionTime": "120130", "RadiopharmaceuticalInformationSequence": [tracer],
    }  # fmt: skip
    return write_series(folder, np.abs(VOXELS) * 100, **usual | attributes)


def test_uptake_values(tmp_path: Path) -> None:
    image = read(pet(tmp_path / "a"), units="suv")
    # An hour from injection to scan.
    factor = 70.0 * 1000 / (370e6 * 0.5 ** (3600 / 6586.2))
    np.testing.assert_allclose(voxels(image), np.abs(VOXELS) * 100 * factor, rtol=1e-6)
    assert units(image) == "SUV"
    image = read(pet(tmp_path / "b", DecayCorrection="ADMIN"), units="suv")
    factor = 70.0 * 1000 / 370e6
    np.testing.assert_allclose(voxels(image), np.abs(VOXELS) * 100 * factor, rtol=1e-6)
    image = read(pet(tmp_path / "c", Units="GML"), units="suv")
    np.testing.assert_array_equal(voxels(image), np.abs(VOXELS) * 100)


def test_a_scan_over_midnight_and_a_series_made_later(tmp_path: Path) -> None:
    late = {"SeriesTime": "003000", "AcquisitionTime": "003000"}
    folder = pet(tmp_path / "a", **late)
    for file in folder.iterdir():
        dataset = pydicom.dcmread(file)
        tracer = dataset.RadiopharmaceuticalInformationSequence[0]
        tracer.RadiopharmaceuticalStartTime = "233000"
        dataset.save_as(file)
    factor = 70.0 * 1000 / (370e6 * 0.5 ** (3600 / 6586.2))
    image = read(folder, units="suv")
    np.testing.assert_allclose(voxels(image), np.abs(VOXELS) * 100 * factor, rtol=1e-6)
    made_later = pet(tmp_path / "b", SeriesTime="180000", AcquisitionTime="120000")
    image = read(made_later, units="suv")
    np.testing.assert_allclose(voxels(image), np.abs(VOXELS) * 100 * factor, rtol=1e-6)


@pytest.mark.parametrize(
    ("lacking", "problem"),
    [
        ({"PatientWeight": None}, "units='suv' needs the body weight"),
        ({"DecayCorrection": "NONE"}, "needs values corrected for decay"),
        ({"Units": "CNTS"}, "needs values in Bq/ml"),
        ({"RadiopharmaceuticalInformationSequence": None}, "needs injected dose and half-life"),
        ({"SeriesTime": None, "AcquisitionTime": None}, "needs the times of injection and scan"),
        ({"Modality": "CT"}, "needs a PET series"),
    ],
)
def test_uptake_needs_its_attributes(tmp_path: Path, lacking: dict, problem: str) -> None:
    message = error_of(pet(tmp_path / "a", **lacking), units="suv")
    assert problem in message
    assert "70" not in message


def test_uptake_of_a_real_scan() -> None:
    folder = real("dicom/pt_headneck")
    activity, uptake = read(folder), read(folder, units="suv")
    # Injection at 11:39:00, series from 13:02:44.678; 66.2 kg, 381.47 MBq, 6586.2 s.
    delay = (13 - 11) * 3600 + (2 - 39) * 60 + 44.678
    factor = 66200 / (381.47e6 * 0.5 ** (delay / 6586.2))
    np.testing.assert_allclose(voxels(uptake), voxels(activity) * factor, rtol=1e-5)
    assert (units(activity), units(uptake)) == ("", "SUV")
    assert 5 < voxels(uptake).max() < 60


@pytest.mark.parametrize("name", ["rtdose.dcm", "rtdose_rle.dcm"])
def test_dose(tmp_path: Path, name: str) -> None:
    path = Path(get_testdata_file(name))
    dataset = pydicom.dcmread(get_testdata_file("rtdose.dcm"))
    image = read(path)
    expected = dataset.pixel_array * float(dataset.DoseGridScaling)
    np.testing.assert_allclose(voxels(image), expected, rtol=1e-6)
    row, column = (float(x) for x in dataset.PixelSpacing)
    step = float(dataset.GridFrameOffsetVector[1])
    np.testing.assert_allclose(image.spacing, (column, row, step))
    np.testing.assert_allclose(image.origin, [float(x) for x in dataset.ImagePositionPatient])
    assert "unit of the values: RELATIVE" in notes(image)
    whole = pydicom.dcmread(path)
    whole.DoseUnits = "GY"
    whole.save_as(tmp_path / "a.dcm")
    assert units(read(tmp_path / "a.dcm")) == "Gy"


# Syntaxes


@pytest.mark.parametrize(
    "syntax",
    [ImplicitVRLittleEndian, ExplicitVRBigEndian, DeflatedExplicitVRLittleEndian, RLELossless],
)
@pytest.mark.parametrize("kind", [np.uint8, np.int16, np.uint16])
def test_syntax(tmp_path: Path, syntax: str, kind: type) -> None:
    pixels = (np.abs(VOXELS) * 3).clip(0, 255).astype(kind)
    bits = 8 * pixels.dtype.itemsize
    format_ = {"BitsAllocated": bits, "BitsStored": bits, "HighBit": bits - 1}
    folder = write_series(tmp_path / "a", pixels, **format_)
    for file in folder.iterdir():
        dataset = pydicom.dcmread(file)
        if syntax == RLELossless:
            dataset.compress(syntax, generate_instance_uid=False)
        elif syntax == ExplicitVRBigEndian:
            swapped = dataset.pixel_array.astype(dataset.pixel_array.dtype.newbyteorder(">"))
            dataset.PixelData = swapped.tobytes()
            dataset["PixelData"].VR = "OW" if bits == 16 else "OB"
        dataset.file_meta.TransferSyntaxUID = syntax
        little = syntax != ExplicitVRBigEndian
        implicit = syntax == ImplicitVRLittleEndian
        pydicom.dcmwrite(file, dataset, implicit_vr=implicit, little_endian=little,
                         force_encoding=True)  # fmt: skip
    image = read(folder)
    np.testing.assert_array_equal(voxels(image), pixels)
    np.testing.assert_allclose(image.spacing, SPACING)


FRAMES = {
    "MR_small.dcm": "MR_small.dcm",
    "MR_small_RLE.dcm": "MR_small.dcm",
    "MR_small_jp2klossless.dcm": "MR_small.dcm",
    "MR_small_jpeg_ls_lossless.dcm": "MR_small.dcm",
    "MR_small_bigendian.dcm": "MR_small.dcm",
    "MR_small_implicit.dcm": "MR_small.dcm",
    "MR_small_padded.dcm": "MR_small.dcm",
    "693_J2KI.dcm": "",
    "JPEG2000.dcm": "",
    "JPEGLSNearLossless_16.dcm": "",
    "JPGExtended.dcm": "",
    "image_dfl.dcm": "",
    "SC_rgb_rle.dcm": "",
    "SC_rgb_jpeg_dcmtk.dcm": "",
    "SC_rgb_dcmtk_+eb+cr.dcm": "",
    "SC_rgb_small_odd.dcm": "",
    "SC_rgb_small_odd_big_endian.dcm": "",
    "examples_palette.dcm": "",
    "SC_ybr_full_422_uncompressed.dcm": "",
}


@pytest.mark.parametrize("name", FRAMES)
def test_pixels_of_pydicoms_own_files(tmp_path: Path, name: str) -> None:
    """Two copies of a slice at different places: the same pixels as SimpleITK or the original."""
    import SimpleITK

    source = get_testdata_file(name, download=False)
    if source is None:
        pytest.skip(f"this pydicom comes without {name}")
    folder = tmp_path / "a"
    folder.mkdir()
    dataset = pydicom.dcmread(source)
    for number in (0, 1):
        dataset.SOPInstanceUID = dataset.file_meta.MediaStorageSOPInstanceUID = f"1.2.{number + 1}"
        dataset.SeriesInstanceUID = "1.2.3"
        dataset.ImagePositionPatient = [0, 0, 2 * number]
        dataset.ImageOrientationPatient = [1, 0, 0, 0, 1, 0]
        dataset.PixelSpacing = [1, 1]
        dataset.save_as(folder / f"{number}.dcm")
    pixels = voxels(read(folder))
    reference = FRAMES[name]
    if reference:
        expected = pydicom.dcmread(get_testdata_file(reference)).pixel_array
    else:
        itk = SimpleITK.ReadImage(source)
        expected = SimpleITK.GetArrayFromImage(itk)[0]
        # Padding of this CT is air.
        expected = np.where(expected == -3024, -1024, expected)
    np.testing.assert_array_equal(pixels[0], expected)
    np.testing.assert_array_equal(pixels[1], expected)


def test_frames_of_bits_are_unpacked(tmp_path: Path) -> None:
    bits = np.random.default_rng(2).integers(0, 2, (5, 6, 7)).astype(np.uint8)
    packed = np.packbits(bits.ravel(), bitorder="little")
    path = write_multiframe(tmp_path / "a.dcm", positions(5), [(1.0, 0.0)] * 5,
                            pixels=np.zeros((5, 6, 7), np.uint8))  # fmt: skip
    dataset = pydicom.dcmread(path)
    dataset.BitsAllocated = dataset.BitsStored = 1
    dataset.HighBit = 0
    dataset.PixelData = packed.tobytes() + b"\0" * (len(packed) % 2)
    dataset["PixelData"].VR = "OB"
    dataset.save_as(path)
    np.testing.assert_array_equal(voxels(read(path)), bits)
    frames = [np.packbits(frame.ravel(), bitorder="little").tobytes() for frame in bits]
    from pydicom.encaps import encapsulate

    dataset.PixelData = encapsulate([rle_of_bytes(frame) for frame in frames])
    dataset.file_meta.TransferSyntaxUID = RLELossless
    dataset.save_as(path)
    np.testing.assert_array_equal(voxels(read(path)), bits)


def rle_of_bytes(data: bytes) -> bytes:
    """One segment of literal runs, as PS3.5 annex G has it."""
    parts = [data[k : k + 128] for k in range(0, len(data), 128)]
    body = b"".join(bytes([len(part) - 1]) + part for part in parts)
    header = np.array([1, 64, *[0] * 14], "<u4").tobytes()
    return header + body + b"\0" * (len(body) % 2)


def test_float_pixels(tmp_path: Path) -> None:
    folder = write_series(tmp_path / "a")
    expected = VOXELS * 0.37
    for k, file in enumerate(sorted(folder.iterdir(), reverse=True)):
        dataset = pydicom.dcmread(file)
        del dataset.PixelData, dataset.BitsStored, dataset.HighBit, dataset.PixelRepresentation
        dataset.BitsAllocated = 32
        dataset.FloatPixelData = expected[k].astype("<f4").tobytes()
        dataset.save_as(file)
    np.testing.assert_allclose(voxels(read(folder)), expected, rtol=1e-6)


def test_threads_do_not_change_the_values_and_progress_ends_at_one(tmp_path: Path) -> None:
    folder = write_series(tmp_path / "a", RescaleSlope=(1, 0.5, 0.25, 2, 1))
    seen: list[float] = []
    texts: set[str] = set()

    def note(fraction: float, text: str) -> None:
        seen.append(fraction)
        texts.add(text)

    one = read(folder, threads=1, progress=note)
    many = read(folder, threads=4)
    np.testing.assert_array_equal(voxels(one), voxels(many))
    assert seen[-1] == 1.0
    assert 0.0 <= min(seen) <= max(seen) <= 1.0
    # The memory is stated before the first slice is read.
    assert any(text.startswith("7 x 6 x 5 voxels, ") for text in texts)
    np.testing.assert_allclose(affine(one), affine(many))


def test_errors_of_a_progress_callback_reach_the_caller(tmp_path: Path) -> None:
    def stop(fraction: float, text: str) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        read_vtk(write_series(tmp_path / "a"), progress=stop)
