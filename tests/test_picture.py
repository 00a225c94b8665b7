"""What a picture shows and saves, without a ray."""

import subprocess
import sys

import numpy as np
import pytest
from scenes import medium, noise, render, scene

from vtkmcvr import schedule
from vtkmcvr.lights import ConstantEnvironment
from vtkmcvr.pictures.picture import Display

LIGHTS = (ConstantEnvironment(1.0),)
LIT = scene(noise(), lights=LIGHTS, size=(20, 15))


@pytest.fixture(scope="module")
def picture():
    return render(LIT, 4)


def test_a_display_is_edited_without_a_ray(picture, monkeypatch):
    def no_rays(*args):
        raise AssertionError("traced")

    monkeypatch.setattr(schedule, "render_tile", no_rays)
    monkeypatch.setattr(schedule, "Launcher", no_rays)
    for changes in (
        {"exposure": 2.0},
        {"gamma": 1.5},
        {"background": (1, 0, 0)},
        {"film_filter": "gaussian-5x5"},
    ):
        shown = picture.with_display(**changes)
        assert shown.film is picture.film
        assert not np.array_equal(shown.rgba, picture.rgba)
        assert not np.array_equal(shown.denoised("knn").rgba, shown.rgba)
    assert picture.with_display(Display()).display == Display()
    with pytest.raises(AssertionError, match="traced"):
        picture.refine(8)


def test_a_picture_goes_on_under_another_display_with_the_same_bits(picture):
    brighter = picture.with_display(exposure=1.0, gamma=2.0).refine(8)
    assert brighter.display == Display(1.0, gamma=2.0)
    np.testing.assert_array_equal(brighter.radiance, render(LIT, 8).radiance)


@pytest.mark.parametrize(
    "edit",
    [
        {"lights": (ConstantEnvironment(0.5),)},
        {"transfer": medium(7.0)},
        {"camera": None},
    ],
)
def test_an_edit_of_the_scene_starts_anew_without_a_ghost(picture, edit):
    from dataclasses import replace

    if "camera" in edit:
        edit = {"camera": replace(LIT.camera, parallel_scale=0.5)}
    edited = replace(LIT, **edit)
    assert not np.array_equal(render(edited, 4).radiance, picture.radiance)
    np.testing.assert_array_equal(render(LIT, 4).radiance, picture.radiance)


@pytest.mark.parametrize("glow", [0.5, 3.0])
def test_premultiplied_radiance_composites_to_what_the_camera_would_have_seen(glow):
    # The same paths with the environment visible behind the volume, which is the film over it
    lit = {"lights": (ConstantEnvironment(glow),), "size": (20, 15)}
    hidden = render(scene(noise(), **lit), 16)
    seen = render(scene(noise(), environment_visible=True, **lit), 16)
    assert 0.1 < hidden.alpha.mean() < 0.9
    over = hidden.film.mean + (1 - hidden.film.hits / hidden.film.count)[..., None] * glow
    np.testing.assert_allclose(over, seen.film.mean, rtol=1e-6)


@pytest.mark.parametrize(
    ("display", "message"),
    [
        ({"exposure": np.nan}, "exposure must be finite"),
        ({"gamma": 0}, "gamma must be above 0"),
        ({"background": (2, 0, 0)}, r"background must be \(r, g, b\) in 0..1"),
    ],
)
def test_bad_displays_are_refused(display, message):
    with pytest.raises(ValueError, match=message):
        Display(**display)


def test_16_bits_are_for_png(picture, tmp_path):
    import SimpleITK as sitk

    path = picture.save(tmp_path / "a.png", bits=16)
    stored = sitk.GetArrayFromImage(sitk.ReadImage(str(path)))
    np.testing.assert_array_equal(stored, picture.show(picture.display, 16))
    assert stored.dtype == np.uint16
    with pytest.raises(ValueError, match=r"bits is for \.png"):
        picture.save(tmp_path / "a.npz", bits=16)
    with pytest.raises(ValueError, match="8 or 16 bits, got 12"):
        picture.save(tmp_path / "b.png", bits=12)
    assert list(tmp_path.iterdir()) == [path]


FULL = """
import resource, signal, sys
import numpy as np
from vtkmcvr.pictures.files import write_exr, write_npz, write_png, write_vti
path = sys.argv[1]
image = np.random.default_rng(1).random((200, 300, 3), np.float32)
recipe = {"text": np.random.default_rng(1).bytes(20_000).hex()}
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, 10_000))
try:
    if path.endswith("png"):
        write_png(path, (image * 255).astype(np.uint8), {"recipe": str(recipe)})
    else:
        write = {"exr": write_exr, "npz": write_npz, "vti": write_vti}[path[-3:]]
        write(path, {"radiance": image}, recipe)
except OSError as error:
    print(f"OSError: {error}")
"""


@pytest.mark.skipif(sys.platform == "win32", reason="limits the size of files as POSIX does")
@pytest.mark.parametrize("suffix", [".png", ".exr", ".vti", ".npz"])
def test_a_disk_that_is_full_leaves_the_old_file_and_nothing_else(tmp_path, suffix):
    if suffix == ".exr":
        pytest.importorskip("OpenEXR")
    path = tmp_path / f"a{suffix}"
    path.write_bytes(b"old")
    done = subprocess.run(
        [sys.executable, "-c", FULL, str(path)], capture_output=True, text=True, check=True
    )
    assert done.stdout.startswith(f"OSError: cannot write {path}: ")
    assert done.stdout.count("\n") == 1
    assert list(tmp_path.iterdir()) == [path]
    assert path.read_bytes() == b"old"


@pytest.mark.parametrize("suffix", [".exr", ".vti", ".npz"])
def test_all_aovs_are_saved(tmp_path, suffix):
    rich = render(scene(noise(), lights=LIGHTS, size=(20, 15), aovs=("albedo", "normal")), 4)
    path = tmp_path / f"a{suffix}"
    if suffix == ".exr":
        OpenEXR = pytest.importorskip("OpenEXR")
        rich.save(path)
        with OpenEXR.File(str(path), separate_channels=True) as file:
            planes = {name: channel.pixels for name, channel in file.channels().items()}
        assert not any(name.startswith("rgba") for name in planes)
        for c in range(3):
            np.testing.assert_array_equal(planes["RGB"[c]], rich.radiance[..., c])
            np.testing.assert_array_equal(planes["normal." + "XYZ"[c]], rich.normal[..., c])
            np.testing.assert_array_equal(planes["albedo." + "RGB"[c]], rich.albedo[..., c])
        np.testing.assert_array_equal(planes["A"], rich.alpha)
        np.testing.assert_array_equal(planes["Z"], rich.depth)
        return
    rich.save(path)
    if suffix == ".npz":
        stored = np.load(path)
    else:
        import pyvista

        image = pyvista.read(path)
        stored = {
            name: image.point_data[name].reshape(rich.arrays()[name].shape)[::-1]
            for name in image.point_data
        }
    for name, array in rich.arrays().items():
        np.testing.assert_array_equal(stored[name], array)
