"""What another renderer draws ends camera rays; volumes are packed once for several views."""

from dataclasses import replace

import numpy as np
import pytest
from scenes import blob, frontal, medium, render, scene, slab

from vtkmcvr.backdrop import Backdrop
from vtkmcvr.lights import ConstantEnvironment
from vtkmcvr.plan import plan
from vtkmcvr.scene import Surface

SIZE = (16, 12)


def backdrop(depth, colour=(255, 0, 0, 255)):
    depth = np.broadcast_to(np.asarray(depth, np.float32), (1, SIZE[1], SIZE[0]))
    pixels = np.broadcast_to(np.asarray(colour, np.uint8), (*depth.shape, 4))
    return Backdrop(depth, pixels, [(0.5, 0.5)])


def test_opacity_before_the_backdrop_is_that_of_the_way_to_it():
    """A slab of optical depth 1.5 per unit: 1 - exp(-1.5 t) of rays that end after t = 0.4."""
    one = scene(
        slab(), medium(1.5), frontal(0.3), size=SIZE, backdrop=backdrop(5 - 0.5 + 0.4),
        lights=(ConstantEnvironment(1.0),), shadow_reach=0.0,
    )  # fmt: skip
    picture = render(one, samples=256)
    n, p = 256 * SIZE[0] * SIZE[1], 1 - np.exp(-1.5 * 0.4)
    # Samples of a Bernoulli variable, five standard errors; Sobol points are spread better
    assert abs(picture.alpha.mean() - p) < 5 * np.sqrt(p * (1 - p) / n)
    behind = picture.film.behind
    np.testing.assert_allclose(behind[..., 0], 1 - picture.alpha, atol=1e-6)
    np.testing.assert_allclose(behind[..., 3], 1 - picture.alpha, atol=1e-6)
    assert not behind[..., 1].any()


def test_no_film_keeps_it_without_one():
    planned = plan(scene(size=SIZE))
    assert planned.packed.backdrop is None
    assert "backdrop" in planned.explain()


@pytest.mark.parametrize(
    ("depth", "colour", "words"),
    [
        (np.ones((2, 3)), np.zeros((2, 3, 4), np.uint8), "places, H, W"),
        (np.ones((1, 2, 3)), np.zeros((1, 2, 3, 3), np.uint8), "bytes of shape"),
        (-np.ones((1, 2, 3)), np.zeros((1, 2, 3, 4), np.uint8), "distances >= 0"),
        (np.full((1, 2, 3), np.nan), np.zeros((1, 2, 3, 4), np.uint8), "distances >= 0"),
    ],
)
def test_bad_backdrops_are_refused(depth, colour, words):
    with pytest.raises(ValueError, match=words):
        Backdrop(depth, colour, [(0.5, 0.5)])


def test_it_must_fit_the_film_and_the_camera():
    with pytest.raises(ValueError, match="16 x 12 pixels, the film of 8 x 8"):
        scene(size=(8, 8), backdrop=backdrop(1.0))
    round_about = replace(frontal(), parallel_scale=None, panorama=True)
    with pytest.raises(ValueError, match="panorama"):
        plan(scene(camera=round_about, size=SIZE, backdrop=backdrop(1.0)))


def same(one, other):
    if isinstance(one, tuple):
        return len(one) == len(other) and all(map(same, one, other))
    if isinstance(one, np.ndarray):
        return np.array_equal(one, other, equal_nan=one.dtype.kind == "f")
    return one == other


def test_another_view_takes_the_volumes_over():
    vol, look = blob(), medium(3.0)
    first = plan(scene(vol, look, size=SIZE))
    moved = scene(vol, look, replace(frontal(0.9), position=(3, -4, 1)), size=(8, 8))
    again = plan(moved, first)
    assert again.volumes[0] is first.volumes[0]
    assert same(again.packed, plan(moved).packed)


def test_another_look_does_not():
    vol = blob()
    first = plan(scene(vol, medium(3.0), size=SIZE))
    for other in (
        scene(vol, medium(2.0), size=SIZE),
        scene(vol, first.scene.transfer, surface=Surface(), size=SIZE),
        scene(blob(9), first.scene.transfer, size=SIZE),
    ):
        again = plan(other, first)
        assert again.volumes[0] is not first.volumes[0]
        assert same(again.packed, plan(other).packed)
