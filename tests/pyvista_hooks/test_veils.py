"""Translucent meshes of a plotter lie before, within and behind its volumes as they should."""

import numpy as np
import pytest
import pyvista as pv
from plotters import SIZE, add, fog, look, pixels, plotter

from vtkmcvr.live import places
from vtkmcvr.live.places import CENTRE

# Distance of the camera along z; opacity and colour of planes across its axis
AWAY, OPACITY, COLOUR = 6.0, 0.4, np.array((1.0, 0.5, 0.0))
# Middle of the picture: fog in every pixel
MIDDLE = np.s_[26:46, 38:58]
# Samples of a pixel; noise of a mean over the middle is below 0.2 bytes
SAMPLES = 64


def scene(z=None, opacity=OPACITY, background="navy", **mesh):
    """Fog seen along z, and a plane at height z."""
    target = plotter()
    add(target, fog(), opacity=[0.0, 0.2])
    target.set_background(background)
    if z is not None:
        plane = pv.Plane(center=(0, 0, z), i_size=9, j_size=9)
        target.add_mesh(plane, color=COLOUR, opacity=opacity, lighting=False, **mesh)
    look(target, (0.0, 0.0, AWAY), parallel_projection=True, parallel_scale=1.5)
    return target


def shot(target, **settings):
    """Screenshot and alpha."""
    target.mcvr.enable(samples=SAMPLES, seed=1, **settings)
    image, alpha = pixels(target), target.mcvr.picture.alpha
    target.close()
    return image, alpha


def test_before_the_volume_it_is_blended_over_it():
    plain, _ = shot(scene())
    ours, _ = shot(scene(2.0))
    expected = OPACITY * 255 * COLOUR + (1 - OPACITY) * plain
    # A byte of rounding each; the same samples
    np.testing.assert_allclose(ours, expected, atol=2)


def test_behind_the_volume_it_colours_the_background():
    blended = OPACITY * COLOUR + (1 - OPACITY) * np.array((0, 0, 128 / 255))
    expected, _ = shot(scene(background=tuple(blended)))
    ours, alpha = shot(scene(-2.0))
    np.testing.assert_allclose(ours, expected, atol=2)
    assert 0.2 < alpha[MIDDLE].mean() < 0.8
    # Blending it over the volume, as VTK alone would, is far off
    plain, _ = shot(scene())
    over = OPACITY * 255 * COLOUR + (1 - OPACITY) * plain
    assert np.abs(ours - over)[MIDDLE].mean() > 10


def test_within_the_volume_it_lies_between_what_is_before_and_behind():
    """Alpha before it is that before an opaque plane; the rest is dimmed by its opacity."""
    _, whole = shot(scene())
    _, front = shot(scene(0.3, opacity=1.0))
    _, ours = shot(scene(0.3))
    whole, front, ours = (a[MIDDLE].mean() for a in (whole, front, ours))
    # 400 pixels of 64 samples: five standard errors of a share, for each of three
    bound = 3 * 5 * 0.5 / np.sqrt(400 * SAMPLES)
    assert abs(ours - (front + (1 - OPACITY) * (whole - front))) < bound
    assert whole - front > 4 * bound


@pytest.mark.parametrize("by", ["opacity", "texture"])
def test_a_textured_one_has_its_texels_everywhere(by):
    """Halves of two colours, translucent by the actor's opacity or by the texture's own."""
    alpha = OPACITY if by == "texture" else 1.0
    texels = np.array([[(255, 0, 0, 255 * alpha), (0, 255, 0, 255 * alpha)]], np.uint8)
    texture = pv.Texture(np.repeat(texels, 2, axis=0))
    texture.interpolate = False

    def textured(z):
        target = scene()
        plane = pv.Plane(center=(0, 0, z), i_size=9, j_size=9)
        opacity = OPACITY if by == "opacity" else 1.0
        target.add_mesh(plane, texture=texture, opacity=opacity, lighting=False)
        return shot(target)[0]

    plain, _ = shot(scene())
    halves = np.repeat(np.eye(3)[None, :2], SIZE[0] // 2, axis=1)
    before = OPACITY * 255 * halves + (1 - OPACITY) * plain
    away = np.abs(np.arange(SIZE[0]) - (SIZE[0] - 1) / 2) > 2
    np.testing.assert_allclose(textured(2.0)[:, away], before[:, away], atol=2)
    # Behind the fog both colours are there, dimmed
    behind = textured(-2.0)[MIDDLE].mean(axis=0)
    left, right = behind[:9].mean(axis=0), behind[11:].mean(axis=0)
    assert left[0] > right[0] + 25 and right[1] > left[1] + 25


def test_layers_are_where_a_sphere_is():
    """Two surfaces of a ball, nearer and farther; one where an opaque plane cuts it in halves."""
    target = scene(0.0, opacity=1.0)
    ball = pv.Sphere(radius=1.2, theta_resolution=160, phi_resolution=160)
    ball["x"] = ball.points[:, 0]
    target.add_mesh(ball, scalars="x", cmap="viridis", opacity=0.5, show_scalar_bar=False)
    target.mcvr.enable(samples=1)
    pixels(target)
    backdrop = target.mcvr.picture.plan.scene.backdrop
    target.close()
    rows, columns = np.indices(SIZE[::-1])
    counts = backdrop.veils.counts.reshape(backdrop.depth.shape)
    x = (columns + backdrop.offsets[0, 0] - SIZE[0] / 2) * 3 / SIZE[1]
    y = (rows + backdrop.offsets[0, 1] - SIZE[1] / 2) * 3 / SIZE[1]
    square = x**2 + y**2
    inside, outside = square < 1.15**2, square > 1.25**2
    assert (counts[0][inside] == 1).all() and not counts[0][outside].any()
    depth = backdrop.veils.depth[: counts[0].sum()]
    expected = AWAY - np.sqrt(np.maximum(1.44 - square, 0))
    # Facets of 160 x 160 lie up to 0.001 inside of the sphere, more at its rim
    near = (square < 1.0)[counts[0] > 0]
    np.testing.assert_allclose(depth[near], expected[counts[0] > 0][near], atol=0.003)
    # Colours of a map, each with its opacity
    assert (backdrop.veils.colour[:, 3] == 128).all()
    assert len(np.unique(backdrop.veils.colour[:, :3], axis=0)) > 20


def test_all_layers_are_found_in_any_window():
    """Meshes of three kinds, one in the other, in a subplot that is not at the corner."""
    target = plotter((2 * SIZE[0], 2 * SIZE[1]), shape=(2, 2))
    target.subplot(0, 1)
    add(target, fog())
    for radius in (0.6, 0.9):
        target.add_mesh(pv.Sphere(radius=radius), color="red", opacity=0.3)
    cube = pv.Cube(x_length=3, y_length=3, z_length=3)
    target.add_mesh(cube.cast_to_unstructured_grid(), opacity=0.2)
    look(target)
    target.mcvr.enable(samples=1)
    pixels(target)
    backdrop = target.mcvr.picture.plan.scene.backdrop
    counts = backdrop.veils.counts.reshape(backdrop.depth.shape)
    middle = np.s_[:, SIZE[1] // 2, SIZE[0] // 2]
    assert (counts[middle] == 6).all()
    first = backdrop.veils.first[:-1].reshape(backdrop.depth.shape)[middle][0]
    opacities = backdrop.veils.colour[first : first + 6, 3]
    assert opacities.tolist() == [51, 76, 76, 76, 76, 51]
    target.close()


def balls(enlarged):
    """Screenshot of a ball at half opacity before an opaque one; number of veils by place."""
    target = scene(background="white")
    target.add_mesh(pv.Sphere(radius=0.8, center=(0.3, 0, 0)), color="red", opacity=0.5)
    target.add_mesh(pv.Sphere(radius=0.6, center=(-0.3, 0, -1)), color="blue")
    target.window_size = [enlarged * n for n in SIZE]
    target.mcvr.enable(samples=256 // enlarged**2, seed=1)
    image, backdrop = pixels(target), target.mcvr.picture.plan.scene.backdrop
    target.close()
    return image, backdrop.veils.counts.reshape(backdrop.depth.shape)


def test_their_edges_are_mixed_as_their_parts_are(monkeypatch):
    ours, counts = balls(1)
    large, _ = balls(4)
    mean = large.reshape(SIZE[1], 4, SIZE[0], 4, 3).mean(axis=(1, 3))
    edge = (counts.min(axis=0) == 0) & (counts.max(axis=0) > 0)
    assert edge.sum() > 50
    off = np.abs(ours - mean).max(axis=2)
    # Bytes; eight places are off by up to a sixteenth of a contrast of 128, and there is noise
    assert off[~edge].mean() < 2
    assert off[edge].mean() < 9
    # One place in a pixel makes steps
    monkeypatch.setattr(places, "SPREAD", (CENTRE,))
    ours, _ = balls(1)
    assert np.abs(ours - mean).max(axis=2)[edge].mean() > 15


def test_an_edit_of_one_begins_a_new_picture():
    target = scene(2.0)
    meshes = [a for a in target.renderer.actors.values() if isinstance(a, pv.Actor)]
    actor = meshes[-1]
    target.mcvr.enable(samples=1)
    view = target.mcvr._live.views[0]
    pixels(target)
    before = pixels(target)
    assert view.restarts == 1 and actor.GetVisibility()
    actor.prop.opacity = 0.9
    after = pixels(target)
    assert view.restarts == 2
    expected = 0.9 * 255 * COLOUR + (0.1 / 0.6) * (before - 0.4 * 255 * COLOUR)
    np.testing.assert_allclose(after, expected, atol=3)
    target.mcvr.disable()
    assert actor.GetVisibility() and not actor.GetForceOpaque()
    target.close()


def test_what_has_no_layers_to_read_is_said():
    target = scene()
    blocks = pv.MultiBlock([pv.Sphere(radius=0.3), pv.Cube(center=(1, 1, 1))])
    target.add_mesh(blocks, opacity=0.5, color="red")
    target.mcvr.enable(samples=1)
    with pytest.warns(RuntimeWarning, match="blended over the volumes"):
        pixels(target)
    target.close()
