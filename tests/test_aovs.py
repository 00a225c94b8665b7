"""Albedo and normal of the first collision: right, and free where nobody asks."""

import numpy as np
import pytest
from scenes import blob, frontal, medium, noise, render, scene, slab, volume

from vtkmcvr.film.moments import new_film
from vtkmcvr.lights import ConstantEnvironment
from vtkmcvr.plan import plan
from vtkmcvr.scene import Surface, Volume

LIGHTS = (ConstantEnvironment(1.0),)


def ramp(direction):
    """Values that grow along a direction (x, y, z), two units wide."""
    z, y, x = np.mgrid[-1:1:9j, -1:1:9j, -1:1:9j]
    values = 1 + 0.1 * (x * direction[0] + y * direction[1] + z * direction[2])
    return volume(values.astype(np.float32), (0.25,) * 3)


def opaque(vol, **options):
    options = {"lights": LIGHTS, "size": (8, 8), "aovs": ("albedo", "normal"), **options}
    return scene(vol, medium(500.0, (0.2, 0.4, 0.8)), frontal(0.5, vol.centre), **options)


@pytest.mark.parametrize("surface", [None, Surface(gradient_factor=1.0)])
@pytest.mark.parametrize("direction", [(0, 1, 0), (0, -1, 0), (1, 1, 0), (2, -1, 3)])
def test_normal_is_the_gradient_toward_the_camera(direction, surface):
    picture = render(opaque(ramp(direction), surface=surface), 4)
    # The camera looks along +y
    normal = np.array(direction) / np.linalg.norm(direction) * -np.sign(direction[1])
    np.testing.assert_allclose(
        picture.normal, np.broadcast_to(normal, picture.normal.shape), atol=2e-3
    )
    assert picture.normal.dtype == np.float32


def test_normal_is_in_world_coordinates():
    # Index axes turned by 30 degrees about z and stretched: values grow along index axis j
    values = np.linspace(1, 2, 9, dtype=np.float32)[None, :, None].repeat(9, 0).repeat(9, 2)
    c, s = np.cos(np.radians(30)), np.sin(np.radians(30))
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    vol = Volume.from_grid(values, (0.3, 0.5, 0.3), direction=turn)
    picture = render(opaque(vol), 4)
    expected = -turn[:, 1]
    np.testing.assert_allclose(
        picture.normal, np.broadcast_to(expected, picture.normal.shape), atol=2e-3
    )


def test_means_are_over_all_samples_and_so_premultiplied():
    vol = ramp((0, 1, 0))
    colour = (0.25, 0.5, 1.0)
    thin = scene(
        vol,
        medium(0.3, colour),
        frontal(1.2),
        lights=LIGHTS,
        aovs=("albedo", "normal"),
        size=(9, 9),
    )
    picture = render(thin, 64)
    assert 0.1 < picture.alpha.mean() < 0.9
    np.testing.assert_allclose(picture.albedo, picture.alpha[..., None] * colour, atol=1e-6)
    np.testing.assert_allclose(picture.normal[..., 1], -picture.alpha, atol=2e-3)


def test_where_there_is_no_gradient_the_normal_is_zero():
    picture = render(opaque(slab()), 4)
    assert picture.alpha.max() == 1
    assert not picture.normal.any()


@pytest.mark.parametrize("aovs", [(), ("albedo",), ("normal",), ("albedo", "normal")])
def test_only_what_was_asked_for_is_there(aovs):
    lit = scene(blob(), lights=LIGHTS, aovs=aovs, size=(8, 8))
    planned = plan(lit)
    assert (planned.packed.normal_map is None) == ("normal" not in aovs)
    film = new_film(8, 8, aovs=aovs)
    for name in ("albedo", "normal"):
        assert (getattr(film, name) is None) == (name not in aovs)
    (effect,) = (effect for effect in planned.effects if effect.name == "first-hit AOVs")
    assert effect.on == bool(aovs)


@pytest.mark.parametrize("aovs", [(), ("albedo",), ("albedo", "normal")])
def test_a_picture_has_what_was_asked_for(aovs):
    picture = render(scene(blob(), lights=LIGHTS, aovs=aovs, size=(8, 8)), 2)
    for name in ("albedo", "normal"):
        assert (getattr(picture, name) is None) == (name not in aovs)
        assert (name in picture.arrays()) == (name in aovs)


def test_radiance_does_not_depend_on_aovs():
    settings = {"surface": Surface(0.7), "size": (24, 18), "lights": LIGHTS}
    plain, rich = (
        render(scene(noise(), aovs=aovs, **settings), 8) for aovs in ((), ("normal", "albedo"))
    )
    np.testing.assert_array_equal(plain.alpha, rich.alpha)
    # No random number is drawn for them; another compilation may round differently
    np.testing.assert_allclose(plain.radiance, rich.radiance, rtol=1e-4, atol=1e-6)


def test_order_and_repetition_do_not_matter_and_unknown_names_are_refused():
    assert scene(aovs=["normal", "albedo", "normal"]).aovs == ("albedo", "normal")
    assert scene(aovs="normal").aovs == ("normal",)
    with pytest.raises(ValueError, match="aovs are some of albedo, normal; got 'depth'"):
        scene(aovs=("depth",))


def test_continued_films_have_the_same_aovs():
    lit = scene(blob(), lights=LIGHTS, aovs=("albedo", "normal"), size=(8, 8))
    once, again = render(lit, 8), render(lit, 3).refine(8)
    np.testing.assert_array_equal(once.film.normal, again.film.normal)
    np.testing.assert_array_equal(once.film.albedo, again.film.albedo)
