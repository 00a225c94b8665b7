"""What another renderer draws ends camera rays; volumes are packed once for several views."""

from dataclasses import replace

import numpy as np
import pytest
from scenes import blob, frontal, medium, render, scene, slab

from vtkmcvr.backdrop import Backdrop, Veils
from vtkmcvr.emission_absorption import EmissionAbsorption
from vtkmcvr.gpu.errors import CudaError
from vtkmcvr.lights import ConstantEnvironment
from vtkmcvr.noiseless import render_noiseless
from vtkmcvr.occlusion import Occlusion, render_occlusion
from vtkmcvr.openings import openings_of
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


def veiled(depths, colours, far=np.inf):
    """Backdrop with the same veils in all pixels, before nothing or black at a depth."""
    shape = (len(depths), 1, SIZE[1], SIZE[0])
    depth = np.broadcast_to(np.float32(depths)[:, None, None, None], shape)
    colour = np.broadcast_to(np.uint8(colours)[:, None, None, None], (*shape, 4))
    plain = backdrop(far, (0, 0, 0, 255))
    return replace(plain, veils=Veils.of_layers(depth, colour))


def test_veils_before_within_and_behind_a_slab_cover_what_lies_behind_them():
    """A slab of optical depth 1.5 per unit from depth 4.5 to 5.5; veils of opacity a show a c.

    With transmittance T(z): the volume's share is T(4.5) - T(4.9), times what the first leaves,
    plus T(4.9) - T(5.5), times what the first two leave. Each veil shows its colour by what is
    left before it, of veils and of the volume.
    """
    a = np.array([102, 51, 153]) / 255
    colours = [(255, 0, 0, 102), (0, 255, 0, 51), (0, 0, 255, 153)]
    one = scene(
        slab(), medium(1.5), frontal(0.3), size=SIZE,
        backdrop=veiled((4.0, 4.9, 6.0), colours),
        lights=(ConstantEnvironment(1.0),), shadow_reach=0.0,
    )  # fmt: skip
    picture = render(one, samples=256)
    n = 256 * SIZE[0] * SIZE[1]
    left = np.cumprod(1 - a)
    T = np.exp(-1.5 * np.array([0.4, 1.0]))
    cover = left[0] * (1 - T[0]) + left[1] * (T[0] - T[1])
    # Samples are 0, left[1] or left[0]: of a smaller variance than one of 0 and left[0]
    assert abs(picture.alpha.mean() - cover) < 5 * left[0] / np.sqrt(4 * n)
    shown = (a[0], left[0] * a[1] * T[0], left[1] * a[2] * T[1])
    behind = picture.film.behind.mean(axis=(0, 1))
    np.testing.assert_allclose(behind[:3], shown, atol=5 / np.sqrt(4 * n))
    # Nothing is lost: what volume, veils and black behind them show adds up
    np.testing.assert_allclose(picture.alpha + picture.film.behind[..., 3], 1, atol=1e-6)
    # Light of the volume is dimmed as its cover is: white under white light
    np.testing.assert_allclose(picture.radiance[..., 0], picture.alpha, rtol=1e-5)


def test_veils_alone_show_without_noise():
    """One before the other, without a volume in sight: to rounding, whatever the samples."""
    colours = [(200, 100, 0, 128), (0, 100, 200, 64)]
    far_away = replace(frontal(0.3), position=(50, -5, 0), focal_point=(50, 0, 0))
    one = scene(
        slab(), medium(1.5), far_away, size=SIZE, backdrop=veiled((1.0, 2.0), colours),
        lights=(ConstantEnvironment(1.0),), shadow_reach=0.0,
    )  # fmt: skip
    picture = render(one, samples=3)
    front, back = (np.array(c) / 255 for c in colours)
    expected = front[:3] * front[3] + (1 - front[3]) * back[:3] * back[3]
    np.testing.assert_allclose(
        picture.film.behind[..., :3], np.broadcast_to(expected, (*SIZE[::-1], 3)), atol=1e-12
    )
    assert not picture.alpha.any()


@pytest.mark.parametrize(
    ("first", "depth", "words"),
    [
        ([0, 1], [1.0, 2.0], "1 depths"),
        ([1, 2], [1.0, 2.0], "counts up from 0"),
        ([0, 2], [2.0, 1.0], "nearest first"),
        ([0, 2], [-1.0, 1.0], "depths >= 0"),
    ],
)
def test_bad_veils_are_refused(first, depth, words):
    with pytest.raises(ValueError, match=words):
        Veils(np.array(first), np.float32(depth), np.zeros((len(depth), 4), np.uint8))


def test_veils_of_some_pixels_are_theirs():
    depth = np.full((2, 1, 2, 2), np.inf, np.float32)
    depth[:, 0, 0, 1], depth[0, 0, 1, 0] = (1, 2), 3
    colour = np.arange(32, dtype=np.uint8).reshape(2, 1, 2, 2, 4)
    veils = Veils.of_layers(depth, colour)
    assert veils.first.tolist() == [0, 0, 2, 3, 3]
    part = veils.at(np.array([2, 1]))
    assert part.first.tolist() == [0, 1, 3] and part.depth.tolist() == [3, 1, 2]
    assert part.colour[:, 0].tolist() == [8, 4, 20]
    with pytest.raises(ValueError, match="given for 4 places"):
        replace(backdrop(1.0), veils=veils)


NOISELESS = {
    "fast occlusion": ("occlusion", Occlusion(mode="fast", detail=4.0)),
    "occlusion": ("occlusion", Occlusion(directions=8)),
    "emission-absorption": ("emission-absorption", EmissionAbsorption()),
}


def through(name, one):
    """Alpha of a picture without noise, and what shows beside and through the volume."""
    technique, settings = NOISELESS[name]
    picture = render_noiseless(technique, one, settings, None, 0.0, threads=1)
    return picture.alpha, picture.behind


@pytest.mark.parametrize("name", NOISELESS)
def test_without_noise_veils_and_an_opaque_end_are_exact(name):
    """As for the slab and its veils above, and black at depth 5.2: T(4.9) - T(5.2) is the rest."""
    a = np.array([102, 51]) / 255
    colours = [(255, 0, 0, 102), (0, 255, 0, 51)]
    one = scene(
        slab((3.0, 1.0, 3.0)), medium(1.5), frontal(0.3), size=SIZE,
        backdrop=veiled((4.0, 4.9), colours, 5.2),
    )  # fmt: skip
    alpha, behind = through(name, one)
    T = np.exp(-1.5 * np.array([0.4, 0.7]))
    left = np.cumprod(1 - a)
    cover = left[0] * (1 - T[0]) + left[1] * (T[0] - T[1])
    # Steps and slices are even: what is left is the rounding of 32 bits and of the volume's ends
    np.testing.assert_allclose(alpha, cover, atol=2e-3)
    shown = (a[0], left[0] * a[1] * T[0], 0.0, 1 - cover)
    np.testing.assert_allclose(behind, np.broadcast_to(shown, behind.shape), atol=2e-3)


def test_occlusion_before_a_backdrop_is_the_cpus():
    one = scene(
        slab(), medium(1.5), frontal(0.3), size=SIZE,
        backdrop=veiled((4.0, 4.9), [(255, 0, 0, 102), (0, 255, 0, 51)], 5.2),
    )  # fmt: skip
    settings = NOISELESS["fast occlusion"][1]
    assert render_occlusion(one, settings, threads=1).backend == "cpu"
    with pytest.raises(CudaError, match="backdrop of another renderer is not on CUDA"):
        render_occlusion(one, settings, threads=1, backend="cuda")


@pytest.mark.parametrize("name", NOISELESS)
def test_without_noise_a_silhouette_covers_its_share_of_a_pixel(name):
    """Of four places, one ends at depth 4.9, and one before the volume; two see all of it."""
    places = np.full((4, SIZE[1], SIZE[0]), np.inf, np.float32)
    places[1], places[2] = 4.9, 4.0
    colour = np.zeros((*places.shape, 4), np.uint8)
    colour[..., 3] = 255
    colour[0, ..., 0], colour[1, ..., 1], colour[2, ..., 2] = 255, 255, 255
    offsets = [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)]
    one = scene(
        slab((3.0, 1.0, 3.0)), medium(1.5), frontal(0.3), size=SIZE,
        backdrop=Backdrop(places, colour, np.array(offsets)),
    )  # fmt: skip
    alpha, behind = through(name, one)
    T = np.exp(-1.5 * np.array([0.4, 1.0]))
    np.testing.assert_allclose(alpha, (2 * (1 - T[1]) + (1 - T[0])) / 4, atol=2e-3)
    shown = np.array((T[1], T[0], 1.0, 2 * T[1] + T[0] + 1)) / 4
    np.testing.assert_allclose(behind, np.broadcast_to(shown, behind.shape), atol=2e-3)


def test_openings_of_finer_pixels_have_the_places_in_them():
    places = np.arange(1, 17, dtype=np.float32).reshape(4, 2, 2)
    places[:, 0, 0] = np.inf
    colour = np.full((4, 2, 2, 4), 255, np.uint8)
    offsets = [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)]
    found = openings_of(Backdrop(places, colour, np.array(offsets)), np.array((0, 0, 1.0)), 2)
    counts = np.diff(found.packed.first).reshape(4, 4)
    # Nothing but background: no edges
    assert not counts[:2, :2].any() and (counts[2:] == 1).all()
    depth = found.packed.depth.tolist()
    assert depth == [2, 6, 10, 14, 3, 7, 4, 8, 11, 15, 12, 16]
    assert not found.packed.left.any()
    found.packed.through[:] = 0.5
    np.testing.assert_allclose(found.behind()[0, 0], 0)
    np.testing.assert_allclose(found.behind()[1, 1], 0.5)
