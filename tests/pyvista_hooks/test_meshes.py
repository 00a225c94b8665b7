"""Meshes of a plotter and its volumes hide each other as if one renderer had traced both."""

from dataclasses import replace

import numpy as np
import pytest
import pyvista as pv
from plotters import SIZE, add, fog, look, pixels, plotter

from vtkmcvr.film import error as film_error
from vtkmcvr.film.moments import alpha as film_alpha
from vtkmcvr.live import places, surroundings
from vtkmcvr.live.places import CENTRE
from vtkmcvr.pictures.files import write_png
from vtkmcvr.receivers import SphereReceiver
from vtkmcvr.rendering import render_scene

BLUE = (40, 120, 200)
BALL = (0.4, 0.2, 0.9)
RADIUS = 0.5


def view_of(target):
    return target.mcvr._live.views[0]


def ball(resolution=200):
    return pv.Sphere(
        radius=RADIUS, center=BALL, theta_resolution=resolution, phi_resolution=resolution
    )


def scene_with_ball(**camera):
    """Plotter of a ball half inside of fog; unlit, so that it is of one colour."""
    target = plotter()
    add(target, fog())
    target.add_mesh(ball(), color=(1.0, 0.5, 0.25), lighting=False)
    look(target, **camera)
    return target


def outline(depth):
    """Pixels beside the ball's outline, a pixel wide on either side."""
    inside = np.isfinite(depth)
    edge = np.zeros_like(inside)
    for axis in (0, 1):
        for step in (1, -1):
            edge |= inside != np.roll(inside, step, axis)
    return edge, inside & ~edge


def mean_difference(one, other, where):
    """Difference of the mean radiance in a region, in its standard errors."""
    variance = film_error.variance(one.film)[where] + film_error.variance(other.film)[where]
    difference = one.film.mean[where].mean() - other.film.mean[where].mean()
    # Channels are equal: light and fog are grey
    return difference / (np.sqrt(variance[..., 0].sum()) / where.sum())


@pytest.mark.parametrize("camera", [{}, {"parallel_projection": True}], ids=["near", "parallel"])
def test_a_ball_half_inside_fog_equals_one_that_is_traced(camera):
    target = scene_with_ball(**camera)
    target.mcvr.enable(samples=64, seed=1)
    target.show(auto_close=False)
    scene = replace(target.mcvr.picture.plan.scene, shadow_reach=0.0)
    target.close()
    edge, inside = outline(scene.backdrop.depth[0])
    assert inside.sum() > 100
    black = SphereReceiver(BALL, RADIUS, colour=0.0)
    truth = render_scene(replace(scene, backdrop=None, receivers=(black,)), samples=256, seed=2)
    ours = render_scene(scene, samples=256, seed=3)
    # Of 96 x 72 pixels, none off the edge is further off than 6 standard errors (expected: 1e-5)
    spread = np.hypot(truth.standard_error, ours.standard_error)[~edge]
    assert (np.abs(ours.radiance - truth.radiance)[~edge] <= 6 * spread).all()
    assert abs(mean_difference(ours, truth, inside)) < 4
    # A ball that is further by a tenth of its radius is noticed
    deeper = replace(scene.backdrop, depth=scene.backdrop.depth + 0.1 * RADIUS)
    other = render_scene(replace(scene, backdrop=deeper), samples=256, seed=4)
    assert abs(mean_difference(other, truth, inside)) > 8


def picture_and_truth(enlarged=4):
    """Screenshot, mean of a screenshot of more pixels, and depths."""
    target = scene_with_ball()
    target.mcvr.enable(samples=256, seed=1)
    target.show(auto_close=False)
    small, depth = pixels(target), target.mcvr.picture.plan.scene.backdrop.depth
    target.window_size = [enlarged * n for n in SIZE]
    target.mcvr.enable(samples=32)
    large = pixels(target)
    target.close()
    rows, columns = small.shape[:2]
    mean = large.reshape(rows, enlarged, columns, enlarged, 3).mean(axis=(1, 3))
    return small, mean, outline(depth[0])[0]


def test_edges_of_meshes_are_mixed_as_their_parts_are(monkeypatch):
    small, mean, edge = picture_and_truth()
    off = np.abs(small - mean).max(axis=2)
    # Bytes; at the edge the noise of 256 samples, of which some see the ball and some the fog
    assert off[~edge].mean() < 1
    assert off[edge].mean() < 7
    # Blending whole pixels, as a single depth in each must, shows the background in the edge
    nowhere = lambda backdrop: np.zeros(backdrop.depth.shape[1:], bool)  # noqa: E731
    monkeypatch.setattr(surroundings, "edges_of", nowhere)
    small, mean, edge = picture_and_truth()
    assert np.abs(small - mean).max(axis=2)[edge].mean() > 12


@pytest.mark.parametrize("technique", ["occlusion", "emission-absorption"])
def test_without_noise_meshes_hide_the_volume_at_their_edges_too(technique, monkeypatch):
    """A ball half inside of fog, with a translucent one around it, against more pixels."""

    def shot(enlarged):
        target = scene_with_ball()
        target.add_mesh(pv.Sphere(radius=1.2), color="blue", opacity=0.3, lighting=False)
        target.window_size = [enlarged * n for n in SIZE]
        target.mcvr.enable(technique=technique)
        image, picture = pixels(target), target.mcvr.picture
        target.close()
        return image, picture

    small, picture = shot(1)
    large, _ = shot(4)
    rows, columns = small.shape[:2]
    mean = large.reshape(rows, 4, columns, 4, 3).mean(axis=(1, 3))
    edge, inside = outline(picture.plan.scene.backdrop.depth[0])
    effect = next(e for e in picture.plan.effects if e.name == "backdrop")
    assert effect.on
    off = np.abs(small - mean).max(axis=2)
    # Bytes; slices and steps of a coarser picture, and eight places at the edge
    assert off[inside].mean() < 2 and off[~edge].mean() < 2
    assert off[edge].mean() < 7
    # One place in a pixel makes steps
    monkeypatch.setattr(places, "SPREAD", (CENTRE,))
    small, _ = shot(1)
    assert np.abs(small - mean).max(axis=2)[edge].mean() > 10


def test_traced_meshes_receive_the_shadow_of_the_volume():
    target = plotter()
    add(target, fog(), opacity=[0.0, 0.9])
    target.add_mesh(pv.Plane(center=(0, 0, -1.5), i_size=9, j_size=9), color="white")
    look(target, (0.0, 0.0, 9.0), parallel_projection=True, parallel_scale=3.0)
    target.mcvr.enable(samples=64, meshes="traced", exposure=0.0)
    target.show(auto_close=False)
    picture = target.mcvr.picture
    target.close()
    assert picture.plan.scene.backdrop is None
    radiance = picture.radiance[..., 0]
    # The lamp shines toward (-3, -4, -9): the fog's shadow falls below and left of it
    lit, shaded = radiance[4:12, 80:92].mean(), radiance[56:60, 30:34].mean()
    # A Lambert surface under the lamp's irradiance pi, which comes in at 9 / sqrt(106)
    assert lit == pytest.approx(9 / np.sqrt(106), rel=0.02)
    assert shaded < 0.5 * lit


def test_meshes_that_no_film_knows_are_left_to_vtk():
    """Lines, and surfaces coloured by an array, are drawn even where meshes are traced."""
    target = plotter()
    add(target)
    plane = pv.Plane(center=(0, 0, -1.5))
    target.add_mesh(plane, scalars=plane.points[:, 0], show_scalar_bar=False)
    target.add_mesh(pv.Line((-2, 0, 0), (2, 0, 0)), color="red", line_width=3)
    look(target)
    target.mcvr.enable(samples=4, meshes="traced")
    target.show(auto_close=False)
    assert target.mcvr.picture.plan.scene.receivers == ()
    assert target.mcvr.picture.plan.scene.backdrop is not None
    target.close()


def edge_before(file=None):
    """A ball in a thin volume before blue: a colour of the background, or an image of it."""
    target = plotter()
    add(target)
    target.add_mesh(pv.Sphere(radius=0.6, center=(1.0, 0.0, 0.6)), color="gold")
    if file:
        target.add_background_image(str(file))
    else:
        target.set_background([c / 255 for c in BLUE])
    look(target)
    target.mcvr.enable(samples=8, progressive=False)
    return target


def test_an_image_in_the_background_is_seen_as_a_colour_there_is(tmp_path):
    """PyVista draws it by a renderer below, which ours must not paint over."""
    file = tmp_path / "plain.png"
    write_png(file, np.full((SIZE[1], SIZE[0], 3), BLUE, np.uint8))
    seen = []
    for target in (edge_before(file), edge_before()):
        # The image's own border is a mix of pixels
        seen.append(pixels(target)[4:-4, 4:-4])
        target.close()
    np.testing.assert_allclose(*seen, atol=1.5)
    assert np.ptp(seen[0]) > 100


def test_edges_in_a_picture_with_alpha_have_that_of_their_parts():
    target = edge_before()
    rgba = target.screenshot(None, return_img=True, transparent_background=True)
    edges, film = view_of(target).job.edges.where, target.mcvr.picture.film
    clear = bool(target.render_window.GetAlphaBitPlanes())
    target.close()
    coverage = film_alpha(film)
    whole = 255 * (coverage + film.behind[..., 3])
    there = edges & (coverage > 0)
    np.testing.assert_allclose(rgba[there, 3], whole[there], atol=1.5)
    # A window without alpha shows its background as it is
    assert there.sum() > 20 and (rgba[there, 3].min() < 230) == clear
