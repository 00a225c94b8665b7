"""NumPy, raw voxels, SLC, TIFF, NIfTI-2 and pairs, against other readers where there are some."""

from __future__ import annotations

import bz2
import gzip
from pathlib import Path

import numpy as np
import pytest
import pyvista
import SimpleITK
from hypothesis import given, settings
from hypothesis import strategies as st
from made_volumes import (
    DATA,
    OBLIQUE,
    ORIGIN,
    SPACING,
    VOXELS,
    affine,
    error_of,
    real,
    save,
    voxels,
)

from vtkmcvr.readers import RawLayout, VolumeReadError, notes, read

# NumPy


@pytest.mark.parametrize("kind", ["<i2", ">i2", "u1", "?", "<f8", "<i8", "<f2"])
def test_arrays_from_memory_and_file(tmp_path: Path, kind: str) -> None:
    array = (VOXELS % 100).astype(kind)
    np.save(tmp_path / "a.npy", array)
    np.save(tmp_path / "f.npy", np.asfortranarray(array))
    sources = [array, tmp_path / "a.npy", tmp_path / "f.npy", array[:, ::-1][:, ::-1]]
    for source in sources:
        image = read(source, spacing=SPACING, origin=ORIGIN, direction=OBLIQUE)
        np.testing.assert_array_equal(voxels(image), array)
        np.testing.assert_allclose(affine(image)[:3, :3], OBLIQUE * SPACING)
        np.testing.assert_allclose(image.origin, ORIGIN)
    assert any("no spacing in the file: 1 is assumed" in note for note in notes(read(array)))


def test_npz_holds_its_place(tmp_path: Path) -> None:
    np.savez_compressed(tmp_path / "a.npz", volume=VOXELS, spacing=SPACING, origin=ORIGIN,
                        direction=OBLIQUE)  # fmt: skip
    image = read(tmp_path / "a.npz")
    np.testing.assert_array_equal(voxels(image), VOXELS)
    np.testing.assert_allclose(affine(image)[:3, :3], OBLIQUE * SPACING)
    assert not any("no spacing" in note for note in notes(image))


def test_components_of_arrays() -> None:
    colours = np.stack([VOXELS, VOXELS + 1, VOXELS + 2], -1)
    np.testing.assert_array_equal(voxels(read(colours)), colours)


def test_bad_arrays(tmp_path: Path) -> None:
    for array, problem in (
        (np.zeros((4, 4)), "an array of shape (4, 4) is no volume; give (k, j, i)"),
        (np.zeros((4, 4, 4, 9)), "with 1 to 4 components"),
        (np.zeros((4, 4, 4), complex), "an array of complex128 is not one of numbers"),
        (np.zeros((4, 4, 4), object), "an array of object is not one of numbers"),
        (np.zeros((4, 1, 4)), "a 2-D image (4 x 1 x 4)"),
    ):
        with pytest.raises(VolumeReadError) as caught:
            read(array)
        assert problem in str(caught.value)
    (tmp_path / "a.npy").write_bytes(b"\x93NUMPY\x01\x00\x10\x00{'descr': 'junk'}")
    assert "its header is damaged" in error_of(tmp_path / "a.npy")
    np.save(tmp_path / "b.npy", np.array([[[{}]]], object), allow_pickle=True)
    assert "an array of object" in error_of(tmp_path / "b.npy")
    np.savez(tmp_path / "c.npz", flat=np.zeros(4))
    assert "holds no array with 3 axes" in error_of(tmp_path / "c.npz")
    (tmp_path / "d.npz").write_bytes(b"PK nothing")
    assert "not a NumPy file" in error_of(tmp_path / "d.npz")


def test_place_of_the_caller_replaces_that_of_the_file(tmp_path: Path) -> None:
    image = read(save(tmp_path / "a.nrrd"), spacing=(1, 2, 3), direction=np.eye(3).ravel())
    assert image.spacing == (1, 2, 3)
    np.testing.assert_array_equal(image.direction_matrix, np.eye(3))
    assert "spacing given by the caller, not by the file" in notes(image)
    pyvista.wrap(np.zeros((3, 4, 5))).save(tmp_path / "a.vti")
    assert read(tmp_path / "a.vti", spacing=(1, 2, 3)).spacing == (1, 2, 3)


# Raw


@pytest.mark.parametrize("kind", ["<u2", ">u2", "u1", "<f4", ">f8", "<i4"])
@pytest.mark.parametrize("suffix", ["", ".gz", ".bz2"])
def test_raw_voxels(tmp_path: Path, kind: str, suffix: str) -> None:
    array = np.abs(VOXELS).astype(kind)
    pack = {"": bytes, ".gz": gzip.compress, ".bz2": bz2.compress}[suffix]
    path = tmp_path / f"a.raw{suffix}"
    path.write_bytes(pack(b"header" + array.tobytes()))
    order = "big" if kind[0] == ">" else "little"
    layout = {"size": (7, 6, 5), "dtype": np.dtype(kind).name, "byte_order": order, "offset": 6}
    image = read(path, raw=layout, spacing=SPACING)
    np.testing.assert_array_equal(voxels(image), array)
    np.testing.assert_allclose(image.spacing, SPACING)
    text = f"7x6x5:{np.dtype(kind).name}:{order}:6"
    np.testing.assert_array_equal(voxels(read(path, raw=text)), array)
    np.testing.assert_array_equal(voxels(read(path, raw=RawLayout(**layout))), array)


def test_bad_raw_layouts(tmp_path: Path) -> None:
    path = tmp_path / "a.raw"
    path.write_bytes(VOXELS.tobytes())
    assert "says nothing about its voxels; give raw={'size': (i, j, k)" in error_of(path)
    too_large = {"size": (7, 6, 50), "dtype": "int16"}
    assert "promises 4200 bytes of voxels and there are only 420" in error_of(path, raw=too_large)
    shorter = {"size": (7, 6, 4), "dtype": "int16"}
    assert "the file is longer than the layout says" in notes(read(path, raw=shorter))
    for layout, problem in (
        ("7x6:int16", "a raw layout is IxJxK:TYPE"),
        ("7x6x5:complex", "dtype of a raw file must be one of"),
        ({"size": (7, 6, 5)}, "raw must give size and dtype"),
        ({"size": (7, 6), "dtype": "int16"}, "size of a raw file must be 3 whole numbers"),
        ({"size": (7, 6, 5), "dtype": "int16", "skip": 4}, "raw must give size and dtype"),
        ({"size": (7, 6, 5), "dtype": "int16", "offset": -4}, "offset of a raw file"),
    ):
        with pytest.raises(ValueError, match=problem.split(":")[0]):
            read(path, raw=layout)


# SLC


def test_slc_equals_vtk() -> None:
    path = real("scivis/neghip.slc")
    image, vtk_image = read(path), pyvista.SLCReader(str(path)).read()
    assert image.dimensions == vtk_image.dimensions
    np.testing.assert_array_equal(voxels(image), voxels(vtk_image))
    np.testing.assert_allclose(image.spacing, vtk_image.spacing)


def slc(packed: bool, values: np.ndarray) -> bytes:
    depth, height, width = values.shape
    head = f"11111\n{width} {height} {depth} 8\n0.5 1.5 2.5\n0 0 0 {int(packed)}\n2 1 X"
    body = b""
    for plane in values:
        data = plane.tobytes()
        if packed:
            runs = b"".join(
                bytes([0x80 | len(data[k : k + 100])]) + data[k : k + 100]
                for k in range(0, len(data), 100)
            )
            data = f"{len(runs) + 3} X".encode() + runs + b"\x05\x09\x00"
            # The last byte of the slice is repeated beyond its end; readers cut it off.
        body += data
    return head.encode() + bytes(6) + body


@pytest.mark.parametrize("packed", [False, True])
def test_made_slc(tmp_path: Path, packed: bool) -> None:
    values = np.abs(VOXELS).astype(np.uint8)
    path = tmp_path / "a.slc"
    path.write_bytes(slc(packed, values))
    image = read(path)
    np.testing.assert_array_equal(voxels(image), values)
    assert image.spacing == (0.5, 1.5, 2.5)
    path.write_bytes(slc(packed, values)[:-60])
    assert "truncated" in error_of(path) or "damaged" in error_of(path)
    path.write_bytes(b"22222 " + slc(packed, values)[6:])
    assert "not an SLC file" in error_of(path)
    path.write_bytes(slc(packed, values).replace(b"7 6 5 8", b"9999 9999 9999 8"))
    assert "truncated" in error_of(path)


# TIFF


def test_tiff_stack_and_folder(tmp_path: Path) -> None:
    stack = SimpleITK.GetImageFromArray(np.abs(VOXELS).astype(np.uint16))
    SimpleITK.WriteImage(stack, str(tmp_path / "a.tif"))
    image = read(tmp_path / "a.tif", spacing=SPACING)
    np.testing.assert_array_equal(voxels(image), np.abs(VOXELS))
    np.testing.assert_allclose(image.spacing, SPACING)
    folder = tmp_path / "many"
    folder.mkdir()
    for k in range(12):
        plane = np.full((6, 7), k, np.uint8)
        SimpleITK.WriteImage(SimpleITK.GetImageFromArray(plane), str(folder / f"s{k}.tif"))
    image = read(folder)
    # By number: s2 before s10.
    assert voxels(image)[:, 0, 0].tolist() == list(range(12))
    assert any("no spacing" in note for note in notes(image))
    assert "give the folder that holds all its slices" in error_of(folder / "s3.tif")
    (folder / "s4.tif").write_bytes(b"text")
    assert "damaged or truncated TIFF data" in error_of(folder)
    whole = (tmp_path / "a.tif").read_bytes()
    (tmp_path / "a.tif").write_bytes(b"text" + whole)
    assert "not a TIFF file" in error_of(tmp_path / "a.tif")
    for cut in range(200, len(whole), 40):
        (tmp_path / "a.tif").write_bytes(whole[:-cut])
        assert "not a TIFF file, or it is damaged" in error_of(tmp_path / "a.tif")


# NIfTI, against nibabel


def nifti_files() -> list[str]:
    return sorted(path.name for path in (DATA / "nifti").glob("*.nii.gz"))


@pytest.mark.parametrize("name", nifti_files())
def test_nifti_equals_nibabel_and_simpleitk(name: str) -> None:
    nibabel = pytest.importorskip("nibabel")
    path = real(f"nifti/{name}")
    image, other = read(path), nibabel.load(path)
    values = np.asarray(other.dataobj)
    values = values.reshape(*values.shape[:3], -1)[..., 0].T
    np.testing.assert_allclose(voxels(image), values, rtol=1e-6)
    lps = np.diag([-1, -1, 1, 1]) @ other.affine
    np.testing.assert_allclose(affine(image), lps, rtol=1e-5, atol=1e-4)
    itk = SimpleITK.ReadImage(str(path))
    np.testing.assert_allclose(image.origin, itk.GetOrigin()[:3], rtol=1e-4, atol=1e-3)


@settings(max_examples=25, deadline=None)
@given(
    st.sampled_from(["nifti1", "nifti2", "pair"]),
    st.sampled_from(["u1", "i2", "<f4", ">f4", ">i4", "f8"]),
    st.tuples(*[st.floats(-1, 1)] * 4),
    st.booleans(),
    st.booleans(),
)
def test_any_nifti_equals_nibabel(
    tmp_path_factory: pytest.TempPathFactory, kind: str, dtype: str, turn: tuple, left: bool,
    by_quaternion: bool,
) -> None:  # fmt: skip
    nibabel = pytest.importorskip("nibabel")
    folder = tmp_path_factory.mktemp("nifti")
    array = np.abs(VOXELS.T).astype(dtype)
    quaternion = np.array(turn) if np.linalg.norm(turn) > 0.1 else np.array([1.0, 0, 0, 0])
    matrix = np.eye(4)
    rotation = nibabel.quaternions.quat2mat(quaternion)
    matrix[:3, :3] = rotation @ np.diag([0.7, 1.1, -2.5 if left else 2.5])
    matrix[:3, 3] = ORIGIN
    makers = {"nifti1": nibabel.Nifti1Image, "nifti2": nibabel.Nifti2Image,
              "pair": nibabel.Nifti1Pair}  # fmt: skip
    header = makers[kind].header_class(endianness=">" if dtype[0] == ">" else "<")
    header.set_data_dtype(dtype)
    other = makers[kind](array, matrix, header=header)
    other.set_qform(matrix, code=1)
    if by_quaternion:
        other.set_sform(None, code=0)
    path = folder / ("a.img" if kind == "pair" else "a.nii.gz")
    nibabel.save(other, path)
    image = read(path)
    np.testing.assert_array_equal(voxels(image), array.T)
    lps = np.diag([-1, -1, 1, 1]) @ nibabel.load(path).affine
    np.testing.assert_allclose(affine(image), lps, rtol=1e-4, atol=1e-4)
    if kind == "pair":
        np.testing.assert_array_equal(voxels(read(folder / "a.hdr")), array.T)


def test_rescaled_nifti(tmp_path: Path) -> None:
    nibabel = pytest.importorskip("nibabel")
    for slope, intercept, kept in ((0.5, 3.0, np.float32), (2.0, -5.0, np.int16)):
        stored = np.abs(VOXELS.T).astype(np.int16)
        image = nibabel.Nifti1Image(stored, np.eye(4))
        image.header.set_slope_inter(slope, intercept)
        # nibabel rescales on writing; the bytes are put in place of what it wrote.
        nibabel.save(image, tmp_path / "a.nii")
        data = bytearray((tmp_path / "a.nii").read_bytes())
        data[112:120] = np.array([slope, intercept], "<f4").tobytes()
        data[352:] = stored.T.tobytes()
        (tmp_path / "a.nii").write_bytes(data)
        values = voxels(read(tmp_path / "a.nii"))
        assert values.dtype == kept
        np.testing.assert_allclose(values, stored.T * slope + intercept)


def test_vectors_and_colours_of_nifti(tmp_path: Path) -> None:
    nibabel = pytest.importorskip("nibabel")
    vectors = np.random.default_rng(0).normal(size=(7, 6, 5, 1, 3)).astype(np.float32)
    image = nibabel.Nifti1Image(vectors, np.eye(4))
    image.header.set_intent("vector")
    nibabel.save(image, tmp_path / "v.nii")
    expected = vectors[..., 0, :].transpose(2, 1, 0, 3)
    np.testing.assert_array_equal(voxels(read(tmp_path / "v.nii")), expected)
    colours = np.zeros((7, 6, 5), [("R", "u1"), ("G", "u1"), ("B", "u1")])
    colours["G"] = np.abs(VOXELS.T)
    nibabel.save(nibabel.Nifti1Image(colours, np.eye(4)), tmp_path / "c.nii")
    found = voxels(read(tmp_path / "c.nii"))
    assert found.shape == (5, 6, 7, 3)
    np.testing.assert_array_equal(found[..., 1], np.abs(VOXELS))


def test_nifti_without_voxels(tmp_path: Path) -> None:
    nibabel = pytest.importorskip("nibabel")
    nibabel.save(nibabel.Nifti1Pair(VOXELS.T, np.eye(4)), tmp_path / "a.img")
    (tmp_path / "a.img").rename(tmp_path / "b.img")
    assert "put the .img beside it" in error_of(tmp_path / "a.hdr")
    assert "its header (.hdr) is missing" in error_of(tmp_path / "b.img")


# NRRD, against SimpleITK and pynrrd


def nrrd_files() -> list[str]:
    folder = DATA / "nrrd" / "variants"
    return sorted(path.name for path in folder.glob("*.n*rrd"))


@pytest.mark.parametrize("name", ["HeadMRVolume.mhd", "frogtissue_fixed.mhd", "oblique_head.mha"])
def test_metaimage_equals_simpleitk(name: str) -> None:
    path = real(f"metaimage/{name}")
    image, itk = read(path), SimpleITK.ReadImage(str(path))
    np.testing.assert_array_equal(voxels(image), SimpleITK.GetArrayFromImage(itk))
    matrix = np.reshape(itk.GetDirection(), (3, 3)) * itk.GetSpacing()
    np.testing.assert_allclose(affine(image)[:3, :3], matrix, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(image.origin, itk.GetOrigin(), rtol=1e-6)


@pytest.mark.parametrize("packed", [False, True])
@pytest.mark.parametrize("kind", ["u1", "i1", "i2", "u2", "i4", "u4", "i8", "f4", "f8"])
def test_every_type_of_metaimage(tmp_path: Path, kind: str, packed: bool) -> None:
    values = np.abs(VOXELS % 100).astype(kind)
    np.testing.assert_array_equal(voxels(read(save(tmp_path / "a.mha", values, gz=packed))), values)
    colours = np.stack([values, values, values], -1)
    path = save(tmp_path / "c.mhd", colours, vector=True, gz=packed)
    np.testing.assert_array_equal(voxels(read(path)), colours)


def test_metaimage_written_by_hand(tmp_path: Path) -> None:
    (tmp_path / "a.raw").write_bytes(b"a header" + VOXELS.astype(">i2").tobytes())
    lines = ["NDims = 3", "DimSize = 7 6 5", "ElementType = MET_SHORT", "Position = 1 2 3",
             "ElementByteOrderMSB = True", "ElementSize = 0.5 1 2", "HeaderSize = -1"]  # fmt: skip
    path = tmp_path / "a.mhd"
    path.write_text("\n".join([*lines, "ElementDataFile = a.raw\n"]))
    image = read(path)
    np.testing.assert_array_equal(voxels(image), VOXELS)
    assert (image.spacing, image.origin) == ((0.5, 1, 2), (1, 2, 3))
    path.write_text("\n".join([*lines[:-1], "HeaderSize = 8", "ElementDataFile = a.raw\n"]))
    np.testing.assert_array_equal(voxels(read(path)), VOXELS)
    for line in ("TransformMatrix = 1 0 0 0 1 0 0 0 1e999", "Offset = 1 nan 3", "NDims = 4",
                 "ElementNumberOfChannels = 0", "HeaderSize = -7"):  # fmt: skip
        path.write_text("\n".join([*lines, line, "ElementDataFile = a.raw\n"]))
        assert "the header is damaged" in error_of(path)
    path.write_text("\n".join([*lines, "ElementDataFile = LIST\na.raw\n"]))
    assert "a list of data files is not supported" in error_of(path)


@pytest.mark.parametrize("name", nrrd_files())
def test_nrrd_equals_simpleitk(name: str) -> None:
    path = real(f"nrrd/variants/{name}")
    image, itk = read(path), SimpleITK.ReadImage(str(path))
    np.testing.assert_array_equal(voxels(image), SimpleITK.GetArrayFromImage(itk))
    matrix = np.reshape(itk.GetDirection(), (3, 3)) * itk.GetSpacing()
    np.testing.assert_allclose(affine(image)[:3, :3], matrix, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(image.origin, itk.GetOrigin(), rtol=1e-6)
