"""Views, labels and cuts: the same rules as for light transport."""

from dataclasses import replace

import numpy as np
import pytest
from scenes import blob, frontal, medium, scene, slab

from vtkmcvr import Box, EmissionAbsorption, Labels, Sphere, Stereo, Surface, Volume
from vtkmcvr.emission_absorption import render_emission_absorption
from vtkmcvr.scene import Camera

VIEW = Camera((0.5, -4.0, 0.8), (0, 0, 0), view_angle=32)


def draw(seen, **settings):
    return render_emission_absorption(seen, EmissionAbsorption(**settings), threads=2)


def turned(camera, rotation, offset):
    """Camera moved along with the world."""
    place = {
        name: tuple(rotation @ np.array(getattr(camera, name)) + offset)
        for name in ("position", "focal_point")
    }
    return replace(camera, view_up=tuple(rotation @ np.array(camera.view_up)), **place)


@pytest.mark.parametrize("surface", [None, Surface()])
def test_a_turned_world_is_the_same_picture(surface):
    rng = np.random.default_rng(4)
    rotation, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    rotation *= np.linalg.det(rotation)
    whole = np.eye(4)
    whole[:3, :3], whole[:3, 3] = rotation, (200.0, -300.0, 50.0)
    vol = blob(33)
    seen = scene(vol, medium(5.0, (0.9, 0.5, 0.2)), VIEW, (40, 40), surface=surface)
    moved = replace(
        seen, volume=Volume(vol.values, whole @ vol.index_to_world),
        camera=turned(VIEW, rotation, whole[:3, 3]),
    )  # fmt: skip
    a, b = draw(seen), draw(moved)
    np.testing.assert_allclose(b.alpha, a.alpha, atol=5e-4)
    # Shading looks at a gradient, which changes quickly in the middle of the ball
    np.testing.assert_allclose(b.radiance, a.radiance, atol=5e-3)
    assert np.abs(b.radiance - a.radiance).mean() < 1e-4


@pytest.mark.parametrize("axes", [(0, 2, 1), (2, 0, 1)])
def test_axes_in_another_order_are_the_same_picture(axes):
    vol = blob(21)
    # Axis order [k, j, i] of the values, and their columns (i, j, k) of the matrix
    matrix = vol.index_to_world.copy()
    columns = [2 - axes[2 - n] for n in range(3)]
    matrix[:3, :3] = vol.index_to_world[:3, columns]
    other = Volume(np.ascontiguousarray(vol.values.transpose(axes)), matrix)
    a, b = (draw(scene(v, medium(5.0), VIEW, (24, 24))) for v in (vol, other))
    np.testing.assert_allclose(b.radiance, a.radiance, atol=2e-5)


def test_panorama_from_the_middle_of_a_box():
    # Distances to the faces of a cube of edge 2, by the largest component of each direction
    sigma_t = 0.7
    inside = Camera((0, 0, 0), (0, 1, 0), panorama=True)
    picture = draw(scene(slab((2, 2, 2), 9), medium(sigma_t), inside, (24, 12)))
    longitude = ((np.arange(24) + 0.5) / 24 * 2 - 1) * np.pi
    latitude = (0.5 - (np.arange(12) + 0.5) / 12)[:, None] * np.pi
    level = np.cos(latitude)
    d = [level * np.sin(longitude), level * np.cos(longitude), np.sin(latitude) + 0 * longitude]
    distance = 1 / np.abs(d).max(axis=0)
    np.testing.assert_allclose(picture.alpha, -np.expm1(-sigma_t * distance), rtol=1e-5)


def test_two_eyes_side_by_side_are_two_pictures():
    pair, left, right = (
        draw(scene(camera=replace(VIEW, stereo=Stereo(eyes, 8.0)), size=size))
        for eyes, size in (("both", (40, 20)), ("left", (20, 20)), ("right", (20, 20)))
    )
    both = np.concatenate([left.alpha, right.alpha], axis=1)
    np.testing.assert_allclose(pair.alpha, both, atol=1e-5)
    assert np.abs(left.alpha - right.alpha).max() > 0.05


def test_holes_labels_and_a_mask():
    # Half the volume by another transfer function, a corner hidden, a ball and a box cut out
    vol = blob(21)
    rows = np.zeros(vol.values.shape, np.uint8)
    rows[:, :, 11:] = 3
    mask = np.ones(vol.values.shape, bool)
    mask[:8] = False
    white, red = medium(9.0, (0.9, 0.9, 0.9)), medium(3.0, (0.8, 0.2, 0.1))
    holes = (Sphere((0.3, -0.4, 0.3), 0.35, "outside"),
             Box((-0.4, -0.5, 0.3), (0.3, 1.0, 0.3), keep="outside"))  # fmt: skip
    base = scene(vol, white, frontal(0.9), (32, 32), clip=holes, mask=mask)
    both = draw(replace(base, labels=Labels(rows, {3: red})))
    alone = [draw(replace(base, transfer=each)) for each in (white, red)]
    # Parallel rays: each stays on its side of the border between points 10 and 11 in x
    for part, one in zip((slice(0, 16), slice(17, 32)), alone, strict=True):
        np.testing.assert_allclose(both.radiance[:, part], one.radiance[:, part], atol=2e-3)
    # Nothing below the first slice that is kept, halfway between 7 and 8
    below = (np.arange(32) + 0.5) / 32 * 1.8 - 0.9 > 0.25 + 0.06
    assert not both.alpha[below].any()
    whole = draw(replace(base, clip=(), mask=None))
    assert (alone[0].alpha <= whole.alpha + 1e-5).all()
    assert alone[0].alpha.sum() < 0.75 * whole.alpha.sum()
