import os
import sys
from pathlib import Path

import numpy as np
import pytest

from vtkmcvr.pictures.files import (
    read_environment,
    read_npz,
    write_exr,
    write_npz,
    write_png,
    write_vti,
)
from vtkmcvr.pictures.png_chunks import read_text

DATA = Path(os.environ.get("VTKMCVR_DATA", Path(__file__).parents[2] / "shared" / "data"))
RECIPE = {"preset": "ct-bone", "size": [4, 3], "seed": 1}
WRITERS = {
    ".png": lambda path, arrays: write_png(path, arrays["rgba"]),
    ".npz": lambda path, arrays: write_npz(path, arrays, RECIPE),
    ".vti": lambda path, arrays: write_vti(path, arrays, RECIPE),
    ".exr": lambda path, arrays: write_exr(path, arrays, RECIPE),
}


@pytest.fixture
def arrays():
    rng = np.random.default_rng(3)
    rgba = rng.integers(0, 256, (3, 4, 4)).astype(np.uint8)
    rgba[0, 0] = [255, 0, 10, 200]
    depth = rng.random((3, 4), np.float32)
    depth[0, 0] = np.inf
    return {
        "rgba": rgba,
        "radiance": rng.random((3, 4, 3), np.float32),
        "alpha": rng.random((3, 4), np.float32),
        "depth": depth,
        "normal": rng.random((3, 4, 3), np.float32),
        "standard_error": rng.random((3, 4, 3), np.float32),
    }


@pytest.fixture(params=WRITERS)
def ending(request):
    if request.param == ".exr":
        pytest.importorskip("OpenEXR")
    return request.param


def read_png(path):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOImage import vtkPNGReader

    reader = vtkPNGReader()
    reader.SetFileName(str(path))
    reader.Update()
    columns, rows, _ = reader.GetOutput().GetDimensions()
    pixels = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars())
    return pixels.reshape(rows, columns, -1)


@pytest.mark.parametrize("channels", [3, 4])
def test_png_round_trip(tmp_path, arrays, channels):
    rgba = arrays["rgba"][..., :channels]
    path = tmp_path / "größe 1.png"
    write_png(path, rgba, text={"recipe": '{"seed": 1}'})
    assert np.array_equal(read_png(path)[::-1], rgba)
    assert read_text(path.read_bytes()) == {"recipe": '{"seed": 1}'}


def test_png_has_row_0_on_top_for_other_readers(tmp_path):
    image = pytest.importorskip("PIL.Image")
    rgba = np.zeros((3, 4, 3), np.uint8)
    rgba[0, 3] = [255, 128, 1]
    write_png(tmp_path / "a.png", rgba)
    with image.open(tmp_path / "a.png") as picture:
        assert picture.getpixel((3, 0)) == (255, 128, 1)


def test_16_bit_png_for_an_independent_reader(tmp_path):
    import SimpleITK as sitk

    rgba = np.random.default_rng(5).integers(0, 2**16, (3, 4, 4)).astype(np.uint16)
    write_png(tmp_path / "a.png", rgba, text={"recipe": "{}"})
    stored = sitk.GetArrayFromImage(sitk.ReadImage(str(tmp_path / "a.png")))
    assert stored.dtype == np.uint16
    assert np.array_equal(stored, rgba)


@pytest.mark.parametrize("bad", [np.zeros((2, 2, 4)), np.zeros((2, 2), np.uint8)])
def test_png_of_something_else_is_refused(tmp_path, bad):
    with pytest.raises(ValueError, match="a PNG needs uint8 or uint16"):
        write_png(tmp_path / "a.png", bad)
    assert list(tmp_path.iterdir()) == []


def test_npz_round_trip(tmp_path, arrays):
    path = tmp_path / "a.npz"
    write_npz(path, arrays, {**RECIPE, "nrms": np.float32(0.5), "at": np.arange(2)})
    again, recipe = read_npz(path)
    assert recipe == {**RECIPE, "nrms": 0.5, "at": [0, 1]}
    assert again.keys() == arrays.keys()
    for name, array in arrays.items():
        assert again[name].dtype == array.dtype
        assert np.array_equal(again[name], array)


def test_npz_refuses_what_it_could_not_read_again(tmp_path):
    with pytest.raises(ValueError, match='named "recipe"'):
        write_npz(tmp_path / "a.npz", {"recipe": np.zeros(2)}, {})
    with pytest.raises(ValueError, match="Python objects"):
        write_npz(tmp_path / "a.npz", {"a": np.array([None])}, {})
    with pytest.raises(TypeError, match="a recipe cannot hold"):
        write_npz(tmp_path / "a.npz", {"a": np.zeros(2)}, {"camera": object()})
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("content", [b"", b"hello", b"PK\x03\x04 cut off"])
def test_npz_that_is_none_is_one_sentence(tmp_path, content):
    (tmp_path / "a.npz").write_bytes(content)
    with pytest.raises(ValueError, match="not a picture that vtkmcvr wrote"):
        read_npz(tmp_path / "a.npz")


def test_npz_of_others_or_missing(tmp_path):
    np.savez(tmp_path / "a.npz", a=np.zeros(2))
    with pytest.raises(ValueError, match="not a picture that vtkmcvr wrote"):
        read_npz(tmp_path / "a.npz")
    with pytest.raises(FileNotFoundError, match="there is no file"):
        read_npz(tmp_path / "b.npz")


def test_vti_round_trip(tmp_path, arrays):
    import pyvista as pv

    write_vti(tmp_path / "a.vti", arrays, RECIPE)
    image = pv.read(tmp_path / "a.vti")
    assert image.dimensions == (4, 3, 1)
    for name, array in arrays.items():
        stored = image.point_data[name].reshape(array.shape)
        assert stored.dtype == array.dtype
        assert np.array_equal(stored[::-1], array)
    assert '"preset": "ct-bone"' in image.field_data["recipe"][0]


def test_vti_refuses_other_types_and_sizes(tmp_path, arrays):
    with pytest.raises(ValueError, match="float32 or uint8"):
        write_vti(tmp_path / "a.vti", {"a": np.zeros((2, 2))}, {})
    with pytest.raises(ValueError, match="of one size"):
        write_vti(tmp_path / "a.vti", {**arrays, "a": np.zeros((2, 2), np.float32)}, {})
    assert list(tmp_path.iterdir()) == []


def test_exr_round_trip(tmp_path, arrays):
    OpenEXR = pytest.importorskip("OpenEXR")
    write_exr(tmp_path / "a.exr", arrays, RECIPE)
    with OpenEXR.File(str(tmp_path / "a.exr"), separate_channels=True) as file:
        channels = {name: channel.pixels for name, channel in file.channels().items()}
        assert '"seed": 1' in file.header()["recipe"]
    for c, letter in enumerate("RGB"):
        assert np.array_equal(channels[letter], arrays["radiance"][..., c])
        assert np.array_equal(
            channels[f"standard_error.{letter}"], arrays["standard_error"][..., c]
        )
    for c, letter in enumerate("XYZ"):
        assert np.array_equal(channels[f"normal.{letter}"], arrays["normal"][..., c])
    assert np.array_equal(channels["A"], arrays["alpha"])
    assert np.array_equal(channels["Z"], arrays["depth"])
    assert channels["rgba.A"].dtype == np.float32


def test_exr_refuses_channels_it_has_no_name_for(tmp_path):
    pytest.importorskip("OpenEXR")
    with pytest.raises(ValueError, match="alpha has 3 channels"):
        write_exr(tmp_path / "a.exr", {"alpha": np.zeros((2, 2, 3))}, {})
    with pytest.raises(ValueError, match="a has 5 channels"):
        write_exr(tmp_path / "a.exr", {"a": np.zeros((2, 2, 5))}, {})
    assert list(tmp_path.iterdir()) == []


def test_exr_without_its_package_says_what_to_install(tmp_path, arrays, monkeypatch):
    monkeypatch.setitem(sys.modules, "OpenEXR", None)
    with pytest.raises(ImportError) as caught:
        write_exr(tmp_path / "a.exr", arrays, {})
    assert str(caught.value) == (
        'writing .exr needs the OpenEXR package: pip install "vtkmcvr[exr]"'
    )
    (tmp_path / "b.exr").write_bytes(b"")
    with pytest.raises(ImportError, match=r"reading \.exr needs"):
        read_environment(tmp_path / "b.exr")


def test_another_ending_is_refused(tmp_path, arrays, ending):
    with pytest.raises(ValueError, match=rf"must end in \{ending}, got a\.jpg"):
        WRITERS[ending](tmp_path / "a.jpg", arrays)


def test_a_missing_folder_is_one_sentence(tmp_path, arrays, ending):
    with pytest.raises(FileNotFoundError, match="there is no folder"):
        WRITERS[ending](tmp_path / "none" / f"a{ending}", arrays)


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="needs Linux: nothing writes to /proc")
def test_an_unwritable_folder_is_one_sentence(arrays, ending, capfd):
    with pytest.raises(OSError, match=rf"^cannot write /proc/a\{ending}: "):
        WRITERS[ending](f"/proc/a{ending}", arrays)
    assert capfd.readouterr() == ("", "")


def test_a_failure_at_the_end_keeps_the_old_file(tmp_path, arrays, ending, monkeypatch):
    def fail(self, target):
        raise PermissionError(13, "Permission denied")

    path = tmp_path / f"a{ending}"
    path.write_bytes(b"old")
    monkeypatch.setattr(Path, "replace", fail)
    with pytest.raises(PermissionError, match=r"^cannot write .*: Permission denied$"):
        WRITERS[ending](path, arrays)
    assert list(tmp_path.iterdir()) == [path]
    assert path.read_bytes() == b"old"


def test_an_old_file_is_replaced_and_nothing_else_is_left(tmp_path, arrays, ending):
    path = tmp_path / f"a{ending}"
    path.write_bytes(b"old")
    WRITERS[ending](path, arrays)
    assert list(tmp_path.iterdir()) == [path]
    assert path.stat().st_size > 60


def write_hdr(path, pixels, flat=False):
    """Write RGBE scanlines of one literal run per channel, row 0 on top."""
    rows, columns = pixels.shape[:2]
    _, exponent = np.frexp(pixels.max(axis=2, keepdims=True))
    rgbe = np.concatenate([pixels / 2.0**exponent * 256, exponent + 128], axis=2).astype(np.uint8)
    head = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {rows} +X {columns}\n".encode()
    if flat:
        path.write_bytes(head + rgbe.tobytes())
        return
    run = np.full((rows, 4, 1), columns, np.uint8)
    lines = np.concatenate([run, rgbe.transpose(0, 2, 1)], axis=2).reshape(rows, -1)
    starts = np.tile(np.array([2, 2, 0, columns], np.uint8), (rows, 1))
    path.write_bytes(head + np.hstack([starts, lines]).tobytes())


@pytest.mark.parametrize("flat", [False, True])
def test_hdr_has_the_zenith_in_row_0(tmp_path, flat):
    pixels = np.full((3, 64, 3), 0.5)
    pixels[0, 1] = [8, 2, 0.25]
    pixels[2, 7] = [0.25, 0.125, 0]
    write_hdr(tmp_path / "a.hdr", pixels, flat)
    light = read_environment(tmp_path / "a.hdr")
    assert light.dtype == np.float32
    assert light.shape == (3, 64, 3)
    assert light == pytest.approx(pixels, rel=0.01)


def test_hdr_cut_off_is_refused_and_vtk_kept_quiet(tmp_path, capfd):
    write_hdr(tmp_path / "a.hdr", np.full((16, 64, 3), 0.5))
    content = (tmp_path / "a.hdr").read_bytes()
    (tmp_path / "a.hdr").write_bytes(content[: len(content) // 2])
    with pytest.raises(ValueError, match="is not a complete"):
        read_environment(tmp_path / "a.hdr")
    assert capfd.readouterr() == ("", "")


def test_exr_environment(tmp_path):
    pytest.importorskip("OpenEXR")
    pixels = np.random.default_rng(1).random((3, 6, 3), np.float32)
    pixels[1, 1] = -0.01
    write_exr(tmp_path / "a.exr", {"radiance": pixels}, {})
    assert np.array_equal(read_environment(tmp_path / "a.exr"), np.maximum(pixels, 0))
    write_exr(tmp_path / "a.exr", {"Y": pixels[..., 0]}, {})
    assert np.array_equal(
        read_environment(tmp_path / "a.exr")[..., 2], np.maximum(pixels[..., 0], 0)
    )


def test_environment_that_lights_nothing_or_too_much(tmp_path):
    pytest.importorskip("OpenEXR")
    pixels = np.zeros((3, 6, 3), np.float32)
    write_exr(tmp_path / "a.exr", {"radiance": pixels}, {})
    with pytest.raises(ValueError, match="black everywhere"):
        read_environment(tmp_path / "a.exr")
    pixels[0, :2] = np.nan
    pixels[1, 0, 1] = np.inf
    write_exr(tmp_path / "a.exr", {"radiance": pixels}, {})
    with pytest.raises(ValueError, match="has 3 pixels that are not finite"):
        read_environment(tmp_path / "a.exr")
    write_exr(tmp_path / "a.exr", {"depth": pixels[..., 0]}, {})
    with pytest.raises(ValueError, match="neither R, G, B nor Y, only Z"):
        read_environment(tmp_path / "a.exr")


@pytest.mark.parametrize("name", ["a.hdr", "a.exr"])
def test_environment_that_is_no_image(tmp_path, name):
    if name.endswith("exr"):
        pytest.importorskip("OpenEXR")
    (tmp_path / name).write_bytes(b"hello")
    with pytest.raises(ValueError, match="is not a complete"):
        read_environment(tmp_path / name)


def test_environment_missing_or_of_another_kind(tmp_path):
    with pytest.raises(FileNotFoundError, match="there is no environment map"):
        read_environment(tmp_path / "a.hdr")
    (tmp_path / "a.jpg").write_bytes(b"")
    with pytest.raises(ValueError, match=r"must be a \.hdr or \.exr file, got a\.jpg"):
        read_environment(tmp_path / "a.jpg")


@pytest.mark.parametrize("name", ["venice_sunset_1k.hdr", "courtyard.exr"])
def test_real_environment(name):
    path = DATA / "env" / name
    if not path.is_file():
        pytest.skip(f"{path} is not here: set VTKMCVR_DATA to the folder that holds env/")
    if name.endswith("exr"):
        pytest.importorskip("OpenEXR")
    light = read_environment(path)
    assert light.shape == (512, 1024, 3)
    assert light.min() >= 0
    # outdoors: more light from above than from below
    assert light[:256].mean() > 2 * light[256:].mean()
