"""A saved picture makes the same bits again, from every kind of file."""

import json

import numpy as np
import pytest
from scenes import frontal, medium, noise, render, scene, volume

import vtkmcvr
from vtkmcvr.cli import main
from vtkmcvr.curves import ColourCurve, Curve
from vtkmcvr.lights import ConstantEnvironment, EnvironmentMap
from vtkmcvr.phantom import head_phantom
from vtkmcvr.pictures.picture import Display
from vtkmcvr.pictures.png_chunks import with_text
from vtkmcvr.recipes.files import read_recipe
from vtkmcvr.recipes.recipe import counts_of, plain_counts, recipe_of
from vtkmcvr.recipes.replaying import replay
from vtkmcvr.scene import TransferFunction, Volume

SUFFIXES = (".png", ".exr", ".vti", ".npz")
LIT = scene(noise(), lights=(ConstantEnvironment(1.0),), size=(20, 15))
BONE = TransferFunction(
    Curve([(200, 0.0), (1000, 0.9)]), ColourCurve([(0, 0.8, 0.6, 0.5), (1500, 0.9, 0.9, 0.8)]), 5.0
)


@pytest.fixture(scope="module")
def picture():
    display = Display(exposure=0.5, background=(0.1, 0.2, 0.3), gamma=2.2)
    return render(LIT, 5, seed=7, display=display)


def saved(picture, folder, suffix):
    if suffix == ".exr":
        pytest.importorskip("OpenEXR")
    return picture.save(folder / f"picture{suffix}")


def pixels(path):
    image = pytest.importorskip("PIL.Image")
    with image.open(path) as picture:
        return np.asarray(picture)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_the_same_bits_from_every_file(picture, tmp_path, suffix):
    path = saved(picture, tmp_path, suffix)
    again, identical, notes = replay(path, LIT.volume)
    assert identical and not notes
    for name, array in picture.arrays().items():
        np.testing.assert_array_equal(again.arrays()[name], array)
    assert again.display == picture.display
    assert again.seed == 7 and again.samples == 5


@pytest.mark.parametrize("threads", [1, 3])
def test_the_same_bits_on_any_number_of_threads(picture, threads):
    assert replay(recipe_of(picture), LIT.volume, threads=threads).identical


def test_a_png_and_an_exr_are_made_again_as_files(picture, tmp_path):
    OpenEXR = pytest.importorskip("OpenEXR")
    for suffix in (".png", ".exr"):
        replay(saved(picture, tmp_path, suffix), LIT.volume).picture.save(
            tmp_path / f"again{suffix}"
        )
    np.testing.assert_array_equal(pixels(tmp_path / "picture.png"), pixels(tmp_path / "again.png"))
    planes = []
    for name in ("picture.exr", "again.exr"):
        with OpenEXR.File(str(tmp_path / name), separate_channels=True) as file:
            planes.append({key: channel.pixels for key, channel in file.channels().items()})
    assert planes[0].keys() == planes[1].keys() >= {"R", "G", "B", "A", "Z"}
    for name, plane in planes[0].items():
        np.testing.assert_array_equal(plane, planes[1][name])


def test_another_seed_would_be_noticed(picture):
    recipe = recipe_of(picture)
    recipe["replay"]["seed"] = 8
    again = replay(recipe, LIT.volume)
    assert not again.identical
    assert "the film differs" in again.notes[-1]


def test_a_run_that_was_cut_off_is_made_again(tmp_path):
    looks = iter([False] * 3 + [True] * 9)
    busy = scene(noise(), medium(40.0), lights=(ConstantEnvironment(1.0),), size=(200, 150))
    cut = render(busy, 100_000, abort=lambda: next(looks), threads=2)
    assert cut.stopped_by == "user"
    counts = cut.film.count
    assert np.array_equal(counts_of(plain_counts(counts), (200, 150)), counts)
    path = cut.save(tmp_path / "cut.npz")
    assert path.stat().st_size > 0
    assert replay(path, busy.volume).identical


def test_uneven_counts_are_small_and_exact():
    counts = np.full((30, 40), 12, np.int64)
    counts[8:16, 8:24] = 13
    counts[20, 3] = 99
    plain = plain_counts(counts)
    assert len(plain) < 200
    np.testing.assert_array_equal(counts_of(plain, (40, 30)), counts)
    assert plain_counts(np.full((3, 4), 6)) == 6


def test_uneven_films_are_filled_up(picture):
    recipe = recipe_of(picture)
    counts = np.full((15, 20), 3, np.int64)
    counts[:8, :12] = 4
    counts[9, 5:7] = 0
    recipe["replay"]["samples"] = plain_counts(counts)
    again = replay(recipe, LIT.volume).picture
    np.testing.assert_array_equal(again.film.count, counts)
    for n in (3, 4):
        whole = render(LIT, n, seed=7)
        np.testing.assert_array_equal(again.film.mean[counts == n], whole.film.mean[counts == n])


@pytest.mark.parametrize("method", ["knn", "oidn"])
def test_denoised_pictures_are_made_again(picture, tmp_path, method):
    if method == "oidn":
        pytest.importorskip("pyoidn", reason="Open Image Denoise is not installed")
    smooth = picture.denoised(method).with_display(exposure=-1.0)
    path = smooth.save(tmp_path / "smooth.npz")
    assert read_recipe(path)["replay"]["denoised"]["method"] == method
    again, identical, _ = replay(path, LIT.volume)
    assert identical
    np.testing.assert_array_equal(again.radiance, smooth.radiance)
    np.testing.assert_array_equal(again.rgba, smooth.rgba)
    assert again.denoiser == smooth.denoiser


# What the recipe says


def test_recipe_holds_scene_seed_samples_error_and_version(picture, tmp_path):
    recipe = read_recipe(picture.save(tmp_path / "a.png"))
    assert recipe["measured"]["samples"] == 5
    assert recipe["measured"]["nrms"] == picture.nrms
    assert recipe["replay"]["seed"] == 7
    assert recipe["replay"]["version"] == vtkmcvr.__version__
    assert recipe["replay"]["scene"]["type"] == "scene.Scene"


def test_recipe_is_the_same_in_every_file(picture, tmp_path):
    texts = {
        json.dumps(read_recipe(saved(picture, tmp_path, suffix)), sort_keys=True)
        for suffix in SUFFIXES
    }
    assert len(texts) == 1


def test_no_file_name_and_no_voxel_is_in_a_picture(tmp_path):
    import SimpleITK as sitk

    head = head_phantom(16)
    image = sitk.GetImageFromArray(head.values)
    image.SetMetaData("Patient Name", "MUSTERFRAU")
    source = tmp_path / "MUSTERMANN-1967.nrrd"
    sitk.WriteImage(image, str(source))
    data = vtkmcvr.read(source)
    picture = vtkmcvr.render(
        data, transfer=BONE, lights=LIT.lights, surface=None, size=(8, 6), samples=1
    )
    text = json.dumps(read_recipe(picture.save(tmp_path / "a.png"))).upper()
    for secret in ("MUSTERMANN", "MUSTERFRAU", "1967", str(tmp_path).upper(), "NRRD"):
        assert secret not in text
    voxels = np.array(head.values).tobytes()
    for suffix in SUFFIXES:
        assert voxels[: 16 * 8] not in saved(picture, tmp_path, suffix).read_bytes()


def test_a_scene_without_plain_form_is_saved_all_the_same(picture, tmp_path, monkeypatch):
    from vtkmcvr.recipes import recipe
    from vtkmcvr.recipes.serialise import NotSerialisable

    def refuse(scene):
        raise NotSerialisable("scene.lights[0] is a function, which a recipe cannot hold")

    monkeypatch.setattr(recipe, "to_plain", refuse)
    path = picture.save(tmp_path / "a.png")
    with pytest.raises(ValueError, match=r"cannot be replayed: scene\.lights\[0\] is a function"):
        replay(path, LIT.volume)


# Data


def test_changed_and_missing_data_is_refused(picture, tmp_path):
    path = picture.save(tmp_path / "a.png")
    with pytest.raises(ValueError, match=r"give what it was made of: scene\.volume\.values"):
        replay(path)
    changed = LIT.volume.values.copy()
    changed[4, 4, 4] += 1e-3
    with pytest.raises(ValueError, match=r"made of other data .* than what was given"):
        replay(path, Volume(changed))


def test_volumes_come_as_arrays_and_images_too(picture):
    from vtkmcvr.vtk_bridge.scene import volume_of

    pyvista = pytest.importorskip("pyvista")
    values = LIT.volume.values
    image = pyvista.ImageData(dimensions=values.shape[::-1])
    image["values"] = values.ravel()
    assert np.array_equal(volume_of(image).values, values)
    for data in (values, image, [image]):
        assert replay(recipe_of(picture), data).identical


def test_environment_maps_are_brought_along(tmp_path):
    sky = EnvironmentMap(np.random.default_rng(3).random((4, 8, 3)))
    lit = scene(noise(), lights=(sky,), size=(12, 9))
    path = render(lit, 2).save(tmp_path / "a.png")
    with pytest.raises(ValueError, match=r"scene\.lights\[0\]\.pixels: array of 4 x 8 x 3"):
        replay(path, lit.volume)
    assert replay(path, [lit.volume, sky.pixels]).identical


# Command line


@pytest.fixture(scope="module")
def demo(tmp_path_factory):
    head = Volume.from_grid(*head_phantom(16))
    lit = scene(head, BONE, frontal(120.0, distance=500.0), (20, 24), lights=LIT.lights)
    return render(lit, 3).save(tmp_path_factory.mktemp("demo") / "demo.png")


def test_command_replays_the_synthetic_head_without_input(demo, tmp_path, capsys):
    out, facts = tmp_path / "again.png", tmp_path / "facts.json"
    assert main(["replay", str(demo), "-o", str(out), "--json", str(facts)]) == 0
    assert "\nthe same bits\n" in "\n" + capsys.readouterr().out
    np.testing.assert_array_equal(pixels(out), pixels(demo))
    assert pixels(demo)[..., :3].max() > 50
    assert json.loads(facts.read_text())["identical"] is True


def test_command_replays_from_a_file(picture, tmp_path, capsys):
    import SimpleITK as sitk

    path = picture.save(tmp_path / "a.png")
    sitk.WriteImage(sitk.GetImageFromArray(LIT.volume.values), str(tmp_path / "v.mha"))
    command = ["replay", str(path), "-o", str(tmp_path / "b.npz")]
    assert main([*command, "--input", str(tmp_path / "v.mha")]) == 0
    assert main(command) == 2
    assert "give what it was made of" in capsys.readouterr().err
    sitk.WriteImage(sitk.GetImageFromArray(LIT.volume.values * 2), str(tmp_path / "w.mha"))
    assert main([*command, "--input", str(tmp_path / "w.mha")]) == 2
    assert "made of other data" in capsys.readouterr().err


def test_command_says_when_the_bits_differ(picture, tmp_path, capsys):
    recipe = recipe_of(picture)
    recipe["replay"]["film"], recipe["replay"]["version"] = "0" * 64, "0.0.1"
    (tmp_path / "a.png").write_bytes(with_text(pngs(tmp_path), {"recipe": json.dumps(recipe)}))
    import SimpleITK as sitk

    sitk.WriteImage(sitk.GetImageFromArray(LIT.volume.values), str(tmp_path / "v.mha"))
    out = str(tmp_path / "b.png")
    command = ["replay", str(tmp_path / "a.png"), "-o", out, "--input", str(tmp_path / "v.mha")]
    assert main(command) == 1
    text = capsys.readouterr().out
    assert "NOT the same bits" in text and "made by vtkmcvr 0.0.1" in text


# Hostile files


def pngs(folder):
    from vtkmcvr.pictures.files import write_png

    write_png(folder / "empty.png", np.zeros((2, 2, 4), np.uint8))
    return (folder / "empty.png").read_bytes()


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_pictures_of_others_are_one_sentence(tmp_path, suffix):
    if suffix == ".exr":
        OpenEXR = pytest.importorskip("OpenEXR")
        OpenEXR.File({}, {"Y": np.zeros((2, 2), np.float32)}).write(str(tmp_path / "a.exr"))
    elif suffix == ".png":
        (tmp_path / "a.png").write_bytes(pngs(tmp_path))
    elif suffix == ".vti":
        import pyvista

        pyvista.ImageData(dimensions=(2, 2, 1)).save(tmp_path / "a.vti")
    else:
        np.savez(tmp_path / "a.npz", a=np.zeros(2))
    with pytest.raises(ValueError, match=r"holds no recipe|not a picture that vtkmcvr wrote"):
        read_recipe(tmp_path / f"a{suffix}")
    (tmp_path / f"b{suffix}").write_bytes(b"hello")
    with pytest.raises(ValueError, match=r"PNG|not a complete|not a picture"):
        read_recipe(tmp_path / f"b{suffix}")


def test_missing_files_and_other_types(tmp_path):
    with pytest.raises(FileNotFoundError, match="there is no picture"):
        read_recipe(tmp_path / "a.png")
    (tmp_path / "a.jpg").write_bytes(b"")
    with pytest.raises(ValueError, match=r"recipes are in \.png, \.exr, \.vti, \.npz; got a\.jpg"):
        read_recipe(tmp_path / "a.jpg")


@pytest.mark.parametrize("text", ["", "{", "[]", "3", "[" * 100_000])
def test_recipes_that_are_no_json_object(tmp_path, text):
    (tmp_path / "a.png").write_bytes(with_text(pngs(tmp_path), {"recipe": text}))
    with pytest.raises(ValueError, match="is damaged: it is no JSON object"):
        read_recipe(tmp_path / "a.png")


BROKEN = {
    "no replay part": (lambda r: r.pop("replay"), "does not say how to replay"),
    "format": (lambda r: r["replay"].update(format=99), "format 99 of vtkmcvr .*reads format 1"),
    "technique": (lambda r: r.update(technique="magic"), "technique 'magic' cannot be replayed"),
    "no scene": (lambda r: r["replay"].pop("scene"), "holds no scene"),
    "another thing": (lambda r: r["replay"].update(scene=[1, 2]), "holds no scene"),
    "unknown field": (lambda r: r["replay"]["scene"].update(fog=1), "the field 'fog'"),
    "wrong part": (
        lambda r: r["replay"]["scene"].update(camera=r["replay"]["scene"]["pixel_filter"]),
        "none of this version",
    ),
    "seed": (lambda r: r["replay"].update(seed="x"), "the recipe's seed must be a whole number"),
    "samples": (lambda r: r["replay"].update(samples=None), "how many samples"),
    "packed samples": (lambda r: r["replay"].update(samples="AAAA"), "how many samples"),
    "negative samples": (lambda r: r["replay"].update(samples=-1), "how many samples"),
    "display": (lambda r: r["replay"].update(display={"hue": 1}), "display is none of this"),
    "display type": (lambda r: r["replay"].update(display=3), "display is none of this"),
    "exposure": (lambda r: r["replay"]["display"].update(exposure="x"), "exposure must be"),
    "denoiser": (lambda r: r["replay"].update(denoised="knn"), "denoiser is none of this"),
    "denoising method": (lambda r: r["replay"].update(denoised={"method": "x"}), "one of knn"),
}


@pytest.mark.parametrize("case", BROKEN)
def test_hostile_recipes_are_one_sentence(picture, case):
    recipe = json.loads(json.dumps(recipe_of(picture)))
    edit, message = BROKEN[case]
    edit(recipe)
    with pytest.raises(ValueError, match=message):
        replay(recipe, LIT.volume)


def test_a_volume_that_replays_by_its_own_geometry():
    turned = volume(noise().values, (0.3, 0.2, 0.4), (5, 6, 7))
    lit = scene(turned, lights=LIT.lights, size=(12, 9))
    # Values alone decide; where they are in the world is in the recipe
    assert replay(recipe_of(render(lit, 2)), turned.values).identical
