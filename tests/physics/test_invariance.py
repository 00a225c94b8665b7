"""One object, described in different ways, is one picture.

z-scores of block means are compared with 5: with fewer than 500 of them, chance exceeds it in less
than 500 x 5.7e-7 = 3e-4 of all choices of seeds (the block means are of 4096 samples, nearly
Gaussian).
"""

import numpy as np
import pytest
from scenes import blob, everything, frontal, medium, render, scene, volume

from vtkmcvr.lights import ConstantEnvironment, DirectionalLight, EnvironmentMap, RectangleLight
from vtkmcvr.scene import Camera, Surface, Volume


def block_scores(a, b, edge=8):
    """z-scores of the difference of two independent pictures, over blocks of pixels."""

    def blocks(x):
        h, w = x.shape
        return x.reshape(h // edge, edge, w // edge, edge).sum(axis=(1, 3))

    def moments(picture):
        film = picture.film
        variance = film.m2[..., 1] / (film.count - 1) / film.count
        return blocks(film.mean[..., 1]), blocks(variance)

    (m1, v1), (m2, v2) = moments(a), moments(b)
    assert (v1 + v2 > 0).all()
    return (m1 - m2) / np.sqrt(v1 + v2)


def lit(vol, camera=None, seed=1, **options):
    """All effects, with surfaces whose normals decide the picture."""
    lights = (DirectionalLight((1, 2, -1.5), 2.0), ConstantEnvironment(0.2))
    return render(
        everything(
            *lights, vol=vol, surface=Surface(0.9, specular=0.2, exponent=20), size=(32, 32),
            **({} if camera is None else {"camera": camera}), **options,
        ),
        samples=64, seed=seed,
    )  # fmt: skip


def test_scene_moved_far_away_by_exact_numbers_is_the_same_to_the_bit():
    # All coordinates are multiples of 1/8 below 2^40: float64 holds them, and their differences,
    # exactly
    def picture(shift):
        centre = np.array(shift, float)
        lights = (
            RectangleLight(centre + np.array((2, -2, 2)), centre, (1, 1), 3.0),
            EnvironmentMap(np.ones((2, 4, 3))),
        )
        camera = Camera(centre + np.array((1.5, -4, 1)), centre, view_angle=30)
        vol = volume(blob().values, (0.125,) * 3, centre)
        return render(everything(*lights, vol=vol, camera=camera, size=(24, 24)), samples=8)

    near, far = picture((0, 0, 0)), picture((1e6, -(2.0**22), 3e5 + 0.125))
    assert near.radiance.mean() > 0.05
    for a, b in zip(near.film, far.film, strict=True):
        np.testing.assert_array_equal(a, b)


def test_scene_moved_far_away_by_any_numbers_is_nearly_the_same():
    # 1e6 costs float64 rays 1e-10 of a unit: a path changes its fate with a probability below 1e-6
    def picture(shift):
        camera = Camera(shift + np.array((1.5, -4.1, 1.3)), shift, view_angle=30)
        return render(scene(volume(blob().values, (0.13,) * 3, shift), camera=camera), samples=32)

    near, far = picture(np.zeros(3)), picture(np.array((1e6 + 0.1, -1e6 / 3, 7e5 / 9)))
    assert np.mean(near.film.hits != far.film.hits) < 0.01
    both = (near.film.hits > 0) & (near.film.hits == far.film.hits)
    np.testing.assert_allclose(near.depth[both], far.depth[both], atol=1e-4)


def test_camera_far_away_sees_the_same():
    # A parallel camera 1e6 away: float64 to the entry, 1e-10 lost
    near = render(scene(camera=frontal(0.9, distance=4)), samples=32)
    far = render(scene(camera=frontal(0.9, distance=1e6)), samples=32)
    assert np.mean(near.film.hits != far.film.hits) < 0.01


def wedge(nx, ny, nz, spacing):
    """Linear along z, piecewise linear in x and y with kinks at 0, where all grids have points."""
    x = (np.arange(nx) - (nx - 1) / 2) * spacing[0]
    y = (np.arange(ny) - (ny - 1) / 2) * spacing[1]
    z = (np.arange(nz) - (nz - 1) / 2) * spacing[2]
    values = (
        (1.2 - np.abs(x))[None, None, :]
        * (1.2 - np.abs(y))[None, :, None]
        * (1 + 0.4 * z)[:, None, None]
    )
    return volume((0.7 * values).astype(np.float32), spacing)


def test_resampled_object_is_the_same():
    # HC-16: twice and four times the spacing along z. Central differences reach over the kinks in x
    # and y alike in both, since only z is resampled
    fine = lit(wedge(17, 17, 17, (0.125, 0.125, 0.125)), seed=1)
    for seed, (nz, dz) in enumerate([(9, 0.25), (5, 0.5)], 2):
        coarse = lit(wedge(17, 17, nz, (0.125, 0.125, dz)), seed=seed)
        assert np.abs(block_scores(fine, coarse)).max() < 5


def test_alpha_of_a_resampled_object_is_the_same():
    def alpha(vol, seed):
        return render(scene(vol), samples=64, seed=seed).alpha.reshape(4, 8, 4, 8).mean(axis=(1, 3))

    a = alpha(wedge(17, 17, 17, (0.125,) * 3), 1)
    b = alpha(wedge(33, 9, 5, (0.0625, 0.25, 0.5)), 2)
    p = (a + b) / 2
    assert (np.abs(a - b) < 5 * np.sqrt(2 * p * (1 - p) / 4096)).all()


def permuted(vol):
    """The same object with its index axes permuted: a left-handed map."""
    matrix = vol.index_to_world[:, [1, 0, 2, 3]]
    return Volume(np.ascontiguousarray(vol.values.transpose(0, 2, 1)), matrix)


def flipped(vol):
    """The same object with one index axis reversed."""
    matrix = vol.index_to_world.copy()
    matrix[:3, 3] += matrix[:3, 0] * (vol.shape[0] - 1)
    matrix[:3, 0] *= -1
    return Volume(np.ascontiguousarray(vol.values[:, :, ::-1]), matrix)


@pytest.mark.parametrize("other", [permuted, flipped])
def test_left_handed_description_is_the_same_object(other):
    vol = blob()
    assert np.linalg.det(other(vol).index_to_world) < 0
    assert np.abs(block_scores(lit(vol, seed=1), lit(other(vol), seed=2))).max() < 5


def test_turned_scene_is_the_same():
    # Volume, camera and sun turned together; the camera's picture stays
    a, b = np.cos(0.8), np.sin(0.8)
    c, d = np.cos(-0.5), np.sin(-0.5)
    turn = np.array([[a, -b, 0], [b, a, 0], [0, 0, 1]]) @ np.array(
        [[1, 0, 0], [0, c, -d], [0, d, c]]
    )
    matrix = np.eye(4)
    matrix[:3, :3] = turn
    vol = blob()
    turned = Volume(vol.values, matrix @ vol.index_to_world)

    def picture(vol, turn, seed):
        camera = Camera(turn @ (1, -4, 2), (0, 0, 0), turn @ (0, 0, 1), parallel_scale=0.9)
        sun = DirectionalLight(turn @ (1, 2, -1.5), 2.0)
        surface = Surface(0.9, specular=0.2, exponent=20)
        return render(
            everything(sun, vol=vol, camera=camera, surface=surface, size=(32, 32)), 64, seed
        )

    scores = block_scores(picture(vol, np.eye(3), 1), picture(turned, turn, 2))
    assert np.abs(scores).max() < 5


def test_units_do_not_matter():
    # A thousand times larger with a thousandth of the extinction
    small = render(scene(blob(), medium(3.0), frontal(0.9)), samples=16)
    values = blob().values
    big = render(
        scene(volume(values, (125.0,) * 3), medium(3e-3), frontal(900, distance=5000)), samples=16
    )
    assert np.mean(small.film.hits != big.film.hits) < 0.01
