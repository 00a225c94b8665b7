"""Pixels that are known to be black see nothing, and take no path."""

import gc
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scenes import blob, everything, frontal, medium, noise, scene, slab, volume

from vtkmcvr import outline, tiles
from vtkmcvr.cutting import Plane
from vtkmcvr.kernels.cpu import render_tile as render_one_by_one
from vtkmcvr.lights import ConstantEnvironment, RectangleLight
from vtkmcvr.outline import dark_pixels
from vtkmcvr.plan import plan
from vtkmcvr.receivers import PlaneReceiver
from vtkmcvr.rendering import empty_film, render_scene
from vtkmcvr.scene import Camera, Lens, PixelFilter, Stereo

SKY = (ConstantEnvironment(1.0),)
SIZE = (24, 18)


def specks():
    """Sheared volume of uneven spacing with a few voxels that are not empty."""
    values = np.zeros((23, 31, 41), np.float32)
    random = np.random.default_rng(5)
    for at in random.integers(1, 22, size=(6, 3)):
        values[tuple(at)] = 1
    sparse = volume(values, (0.1, 0.07, 0.12))
    turned = np.array(sparse.index_to_world)
    turned[:3, :3] = turned[:3, :3] @ [[1, 0.3, 0], [0, 1, 0.2], [-0.1, 0, 1]]
    return replace(sparse, index_to_world=turned)


SPECKS = specks()


def traced(made, samples=4):
    """Film of all paths, one by one."""
    film = empty_film(made)
    goal = np.full_like(film.count, samples)
    height, width = film.count.shape
    render_one_by_one(film, made.packed, 0, height, 0, width, goal, np.int64(3))
    return film


def dark(some):
    made = plan(some)
    return dark_pixels(made.packed, some.size[::-1])


def opaque(camera, vol=SPECKS, **options):
    """Scene in which whatever can be hit is hit."""
    return scene(vol, medium(1e4), camera, **{"lights": SKY, "size": SIZE, **options})


numbers = st.floats(-1, 1, allow_subnormal=False)
directions = st.tuples(numbers, numbers, numbers).filter(lambda v: 0.1 < np.linalg.norm(v))


@st.composite
def cameras(draw):
    towards = np.array(draw(directions))
    away = np.array(draw(directions))
    distance = 10.0 ** draw(st.floats(-1, 4))
    focal = SPECKS.centre + towards
    up = np.cross(away, (0.3, 0.5, -0.8)) + 1e-3
    shift = (draw(numbers), draw(numbers))
    lens = draw(st.sampled_from((None, Lens(0.05), Lens(0.3, 2.0), Lens(0.5, 20.0, blades=3))))
    if draw(st.booleans()):
        scale = 10.0 ** draw(st.floats(-1, 2))
        how = {"parallel_scale": scale}
    else:
        how = {"view_angle": 10.0 ** draw(st.floats(-2, np.log10(170)))}
    return Camera(focal + distance * away, focal, up, window_centre=shift, lens=lens, **how)


@settings(max_examples=150, deadline=None, derandomize=True)
@given(
    camera=cameras(),
    width=st.sampled_from((0.1, 0.5, 2.0)),
    kind=st.sampled_from(("gaussian", "tent")),
)
def test_no_path_of_a_dark_pixel_meets_anything(camera, width, kind):
    some = opaque(camera, pixel_filter=PixelFilter(kind, width))
    made = plan(some)
    found = dark_pixels(made.packed, SIZE[::-1])
    film = traced(made)
    assert not film.hits[found].any()
    assert not film.mean[found].any()


@pytest.mark.parametrize("lens", [None, Lens(0.2)], ids=["pinhole", "lens"])
@pytest.mark.parametrize("parallel", [True, False])
def test_most_pixels_that_see_nothing_are_known(parallel, lens):
    camera = frontal(1.5) if parallel else Camera((3, -6, 2), (0, 0, 0), view_angle=30)
    camera = replace(camera, lens=lens)
    some = opaque(camera, blob(65), size=(96, 72))
    found, film = dark(some), traced(plan(some), 8)
    without = film.hits == 0
    assert 0.4 < without.mean() < 0.9
    # A rim as wide as a block of two voxels remains
    assert found[without].mean() > 0.8


@pytest.mark.parametrize("focus", [3.0, 40.0])
@pytest.mark.parametrize("how", [{"parallel_scale": 2.0}, {"view_angle": 20.0}])
def test_a_point_out_of_focus_is_dark_beyond_its_blur(how, focus):
    values = np.zeros((9, 9, 9), np.float32)
    values[3:6, 3:6, 3:6] = 1
    camera = Camera((0, -12, 0), (0, 0, 0), lens=Lens(0.3, focus), **how)
    some = opaque(camera, volume(values, (0.05,) * 3), size=(80, 80))
    film, found = traced(plan(some), 400), dark(some)
    assert not film.hits[found].any()
    across = film.hits[38:42].any(0).sum()
    assert 10 < across <= (~found)[38:42].any(0).sum() <= across + 4


def test_specks_leave_the_space_between_them_dark():
    some = opaque(Camera((0, -9, 1), (0, 0, 0), view_angle=25), size=(96, 72))
    found = dark(some)
    assert 0.9 < found.mean() < 1
    assert not traced(plan(some)).hits[found].any()


@pytest.mark.parametrize("how", [{}, {"scattering": "multiple"}, {"aovs": ("albedo", "normal")}])
def test_the_film_is_the_same_to_the_bit(how, monkeypatch):
    some = everything(*SKY, vol=noise(), camera=frontal(2.5), size=(40, 30), **how)
    assert dark(some).any() and not dark(some).all()
    found = render_scene(some, samples=20, seed=4).film
    monkeypatch.setattr(tiles, "dark_pixels", lambda _, shape: np.zeros(shape, np.bool_))
    expected = render_scene(some, samples=20, seed=4).film
    for name, plane in expected._asdict().items():
        for part, other in zip(
            plane if isinstance(plane, tuple) else [plane],
            getattr(found, name) if isinstance(plane, tuple) else [getattr(found, name)],
            strict=True,
        ):
            np.testing.assert_array_equal(part, other, name)


def test_an_eye_among_the_voxels_has_no_dark_pixel():
    inside = Camera((0.1, 0, 0), (1, 0, 0), view_angle=60)
    assert not dark(opaque(inside, slab())).any()


def test_no_pixel_is_dark_where_voxels_lie_behind_the_eye():
    # No place on the film is theirs
    beside = Camera((0, 0.2, 0), (9, 0.2, 0), view_angle=30)
    assert not dark(opaque(beside, slab())).any()


def test_cuts_and_the_active_box_count():
    some = opaque(frontal(1.0), slab(points=33), size=(40, 40))
    half = replace(some, clip=(Plane((0, 0, 0), (1, 0, 0)),))
    left, right = dark(half)[:, :18], dark(half)[:, 22:]
    assert left.mean() > 0.9 and not right[12:28, :8].any()
    one = replace(some, estimator="woodcock")
    np.testing.assert_array_equal(dark(one).any(0)[:9], True)


@pytest.mark.parametrize(
    "change",
    [
        {"environment_visible": True},
        {"receivers": (PlaneReceiver((0, 0, -2), (0, 0, 1)),)},
        {"lights": (RectangleLight((0, 9, 0), (0, 0, 0), (1, 1), 5.0, visible=True),)},
        {"camera": Camera((0, -9, 0), (0, 0, 0), stereo=Stereo("both", 0.1))},
        {"camera": Camera((0, -9, 0), (0, 0, 0), panorama=True)},
    ],
    ids=["sky", "floor", "lamp", "stereo", "panorama"],
)
def test_no_pixel_is_dark_where_more_can_be_seen(change):
    some = opaque(Camera((0, -9, 0), (0, 0, 0), view_angle=60), blob())
    assert dark(some).any()
    assert not dark(replace(some, **change)).any()


def test_pixels_are_known_while_their_majorants_are_there():
    gc.collect()
    before = set(outline._known)
    made = plan(opaque(frontal(3.0)))
    first = dark_pixels(made.packed, SIZE[::-1])
    assert dark_pixels(made.packed, SIZE[::-1]) is first
    assert dark_pixels(made.packed, (9, 12)).shape == (9, 12)
    np.testing.assert_array_equal(dark_pixels(made.packed, SIZE[::-1]), first)
    assert len(set(outline._known) - before) == 1
    del made
    gc.collect()
    assert not set(outline._known) - before
