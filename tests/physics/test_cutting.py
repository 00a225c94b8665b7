"""Cuts, masks, labels and overlapping volumes with a known answer.

z-scores are compared with 4.5, as in test_media.py: chance exceeds it in less than 50 x 6.8e-6 of
all choices of seeds. The seeds are fixed.
"""

import dataclasses
import math

import numpy as np
import pytest
from scenes import WHITE, blob, frontal, mean_and_error, medium, noise, render, slab, z_score
from scenes import scene as any_scene

from vtkmcvr.curves import Curve
from vtkmcvr.cutting import ALL_REGIONS, CROSS, FENCE, Box, Cropping, Plane, Sphere
from vtkmcvr.film.error import variance
from vtkmcvr.labels import Labels
from vtkmcvr.layers import Layer
from vtkmcvr.lights import ConstantEnvironment, DirectionalLight
from vtkmcvr.scene import Camera, Surface, TransferFunction, Volume

SKY = (ConstantEnvironment(1.0),)
CUBE = slab((2, 2, 2), points=9)


def scene(*parts, **options):
    """Independent samples, whose errors are known pixel by pixel."""
    return any_scene(*parts, sampler="independent", **options)


def alpha_score(picture, expected):
    """Deviation of the mean alpha from the expected one, in binomial standard errors."""
    n = picture.film.count.sum()
    return (picture.film.hits.sum() / n - expected) / math.sqrt(expected * (1 - expected) / n)


def chi_square_score(picture, other):
    """Sum over pixels of the squared difference in standard errors, standardised."""
    a, b = picture.film, other.film
    error = (variance(a) + variance(b))[..., 1]
    known = error > 0
    z = (a.mean - b.mean)[..., 1][known] ** 2 / error[known]
    # Radiance is far from normal; its pixels' squares have this variance themselves
    return (z.mean() - 1) / (z.std() / math.sqrt(known.sum()))


@pytest.mark.parametrize(
    ("clip", "length"),
    [
        (Plane((0, 0.3, 0), (0, 1, 0)), 0.7),
        (Plane((0, 0.3, 0), (0, -1, 0)), 1.3),
        ((Plane((0, 0.3, 0), (0, -1, 0)), Plane((0, -0.2, 0), (0, 1, 0))), 0.5),
        (Box((0, 0.1, 0), (3, 0.6, 3)), 0.6),
        (Box((0, 0.1, 0), (3, 0.6, 3), keep="outside"), 1.4),
    ],
)
def test_what_a_clip_shape_leaves_obeys_beer_lambert(clip, length):
    picture = render(scene(CUBE, medium(1.5), frontal(0.9), lights=SKY, clip=clip), samples=32)
    assert abs(alpha_score(picture, -math.expm1(-1.5 * length))) < 4.5


@pytest.mark.parametrize("keep", ["inside", "outside"])
def test_ball_in_a_uniform_medium_has_the_mean_transmittance_of_its_chords(keep):
    # Parallel rays over the square around the ball: chord 2 sqrt(r^2 - q^2), mean over the disk
    # 2/r^2 int_0^r exp(-s c) q dq with c^2 = 4 (r^2 - q^2), so 2/(s D)^2 (1 - (1 + s D) exp(-s D))
    r, s = 0.8, 1.5
    depth = 2 * r * s
    inside = 2 / depth**2 * (1 - (1 + depth) * math.exp(-depth))
    share = math.pi / 4
    expected = 1 - (share * inside + (1 - share))
    if keep == "outside":
        # exp(-s (2 - c)) instead: the same integral with -s, behind the whole cube
        left = 2 / depth**2 * (1 + (depth - 1) * math.exp(depth)) * math.exp(-2 * s)
        expected = 1 - (share * left + (1 - share) * math.exp(-2 * s))
    clip = Sphere((0, 0, 0), r, keep)
    picture = render(scene(CUBE, medium(s), frontal(r), lights=SKY, clip=clip), samples=32)
    assert abs(alpha_score(picture, expected)) < 4.5


@pytest.mark.parametrize("top", [1.0, 0.25])
def test_clip_plane_lets_light_in(top):
    # Seen along y through 2 units; light falls along -z onto the cut at z = top: collisions at
    # height z are lit by exp(-s (top - z)); single scattering, isotropic, albedo 1
    s = 2.0
    lights = (DirectionalLight((0, 0, -1), 4 * math.pi),)
    clip = Plane((0, 0, top), (0, 0, -1)) if top < 1 else ()
    picture = render(scene(CUBE, medium(s), frontal(0.2), lights=lights, clip=clip), samples=128)
    heights = top - 0.2 * (np.arange(-399.5, 400) / 400)
    expected = -math.expm1(-2 * s) * np.exp(-s * heights).mean()
    mean, error = mean_and_error(picture)
    assert error < 0.02 * expected
    assert abs(mean - expected) < 4.5 * error


@pytest.mark.parametrize(
    "flags", [FENCE, pytest.param(ALL_REGIONS ^ CROSS, marks=pytest.mark.slow), 0x2000]
)
def test_cropping_between_voxels_equals_a_mask(flags):
    # Planes half-way between voxels: exactly where the nearest voxel of a mask changes
    vol = noise(12)
    crop = Cropping((3.5, 2.5, 4.5), (7.5, 8.5, 8.5), flags)
    index = np.indices(vol.values.shape)[::-1]
    thirds = [
        (i > a).astype(int) + (i > b)
        for i, a, b in zip(index, crop.lower, crop.upper, strict=True)
    ]  # fmt: skip
    mask = (flags >> (thirds[0] + 3 * thirds[1] + 9 * thirds[2])) & 1
    options = {"lights": SKY}
    one = render(scene(vol, medium(3.0), crop=crop, **options), samples=64, seed=1)
    other = render(scene(vol, medium(3.0), mask=mask, **options), samples=64, seed=2)
    assert 0.05 < one.alpha.mean() < 0.9
    assert abs(z_score(one, other)) < 4.5
    assert abs(chi_square_score(one, other)) < 4.5


def test_chi_square_tells_other_pictures_apart():
    vol = noise(12)
    crops = Cropping((3.5, 2.5, 4.5), (7.5, 8.5, 8.5)), Cropping((3.5, 2.5, 5.5), (7.5, 8.5, 8.5))
    one, other = (
        render(scene(vol, medium(3.0), crop=crop, lights=SKY), samples=64, seed=seed)
        for seed, crop in enumerate(crops)
    )
    assert chi_square_score(one, other) > 6


def test_box_clip_equals_a_mask():
    vol = noise(12)
    spacing = vol.spacing[0]
    lower, upper = (vol.index_to_world[:3, 3] + spacing * np.array(i) for i in (
        (3.5, 2.5, 4.5), (7.5, 8.5, 8.5)))  # fmt: skip
    bounds = np.stack([lower, upper], 1).ravel()
    mask = np.zeros(vol.values.shape, bool)
    mask[5:9, 3:9, 4:8] = True
    one = render(scene(vol, medium(3.0), clip=Box.from_bounds(bounds), lights=SKY), seed=1)
    other = render(scene(vol, medium(3.0), mask=mask, lights=SKY), seed=2)
    assert one.alpha.mean() > 0.05
    assert abs(z_score(one, other)) < 4.5
    assert abs(chi_square_score(one, other)) < 4.5


def test_mask_equals_a_label_without_extinction():
    vol = blob()
    mask = np.random.default_rng(2).random(vol.values.shape) > 0.4
    nothing = TransferFunction(None, WHITE, extinction=Curve([(0, 0)]))
    one = render(scene(vol, mask=mask, lights=SKY), seed=1)
    for hidden in (nothing, None):
        labelled = scene(vol, labels=Labels(mask.astype(int), {0: hidden}), lights=SKY)
        # The same walks: the same bits
        np.testing.assert_array_equal(render(labelled, seed=1).radiance, one.radiance)


def test_labels_equal_separate_volumes():
    # A transfer function by label, or two volumes that share the place, each with a mask
    vol = noise(12)
    left = np.arange(12) < 6
    labels = np.broadcast_to(left, vol.values.shape)
    red, blue = medium(4.0, (0.9, 0.1, 0.2)), medium(1.5, (0.1, 0.2, 0.9))
    by_label = scene(vol, red, labels=Labels(labels.astype(np.uint8), {0: blue}), lights=SKY)
    layer = Layer(Volume(vol.values, vol.index_to_world), blue, mask=~labels)
    as_layers = scene(vol, red, mask=labels, layers=layer, lights=SKY)
    one, other = render(by_label, seed=1), render(as_layers, seed=2)
    assert abs(chi_square_score(one, other)) < 4.5
    for channel in range(3):
        (a, ea), (b, eb) = mean_and_error(one, channel), mean_and_error(other, channel)
        assert abs(a - b) < 4.5 * math.hypot(ea, eb)
    assert abs(mean_and_error(one, 0)[0] - mean_and_error(one, 2)[0]) > 0.03


def test_two_volumes_of_half_the_density_equal_one():
    options = {"lights": SKY}
    whole = render(scene(noise(9), medium(3.0), **options), seed=1)
    vol = noise(9)
    half = scene(vol, medium(1.5), layers=Layer(vol, medium(1.5)), **options)
    both = render(half, seed=2)
    assert abs(z_score(whole, both)) < 4.5
    assert abs(chi_square_score(whole, both)) < 4.5


def test_volumes_of_different_grids_add_up():
    # 1 unit of the cube, and half of a turned, shifted slab of bytes, seen along y
    turn = np.array([[0.6, 0, -0.8], [0, 1, 0], [0.8, 0, 0.6]])
    bytes_ = Volume.from_grid(
        np.full((5, 4, 6), 100, np.uint8), (1.2, 0.25, 1.2), (0, 0, 0), direction=turn
    )
    matrix = bytes_.index_to_world.copy()
    matrix[:3, 3] += np.array((0.0, 0.4, 0.0)) - bytes_.centre
    thick = 0.25 * 3
    layer = Layer(Volume(bytes_.values, matrix), TransferFunction(
        None, WHITE, extinction=Curve([(0, 0), (100, 1.2)])))  # fmt: skip
    both = scene(CUBE, medium(0.7), frontal(0.5), lights=SKY, layers=(layer,))
    picture = render(both, samples=64)
    assert abs(alpha_score(picture, -math.expm1(-(1.4 + 1.2 * thick)))) < 4.5
    # Distances: collisions of both, in front of each other's
    assert picture.depth.min() > 3.9


def test_white_furnace_stays_white_with_cuts_labels_and_layers():
    # Albedo 1, unlimited scattering, light 1 from everywhere: 1 along every path, whatever is cut.
    # Only Russian roulette, which keeps the mean, and rounding
    vol = blob()
    furnace = scene(
        vol, medium(4.0), lights=SKY, scattering="multiple",
        clip=(Sphere((0, 0, 0), 0.7), Plane((0, -0.3, 0), (0, 1, 0.2))),
        labels=Labels((vol.values > 0.5).astype(int), {1: medium(9.0)}),
        layers=Layer(noise(8), medium(2.0)), environment_visible=True,
    )  # fmt: skip
    picture = render(furnace, samples=64)
    assert picture.alpha.mean() > 0.5
    np.testing.assert_allclose(picture.radiance, 1, atol=1e-4)


def test_cut_face_is_a_lambert_surface():
    # Dense, constant: no gradients. Light along the view onto a face that the plane cut off; the
    # medium shadows itself: 1 / 2 where light and view have equal cosines
    lights = (DirectionalLight((0, 1, 0), math.pi),)
    clip = Plane((0, -0.5, 0), (0, 1, 0))
    cut = scene(
        CUBE, medium(150.0, 0.8), frontal(0.5), lights=lights, clip=clip,
        surface=Surface(mode="brdf", specular=0.0), ratio_tracking=False,
    )  # fmt: skip
    mean, error = mean_and_error(render(cut, samples=256))
    assert abs(mean - 0.8 / 2) < 4.5 * error
    # Seen at 60 degrees: cosine of the light 1, of the view 1/2
    aslant = Camera((0, -0.5 - 4 * 0.5, 4 * math.sqrt(0.75)), (0, -0.5, 0), parallel_scale=0.1)
    mean, error = mean_and_error(render(dataclasses.replace(cut, camera=aslant), samples=256))
    # int exp(-s d / c) exp(-s d) s / c dd = 1 / (1 + c)
    assert abs(mean - 0.8 / 1.5) < 4.5 * error
    # Without surfaces the same material scatters by its phase function: albedo / 4 pi times pi
    mean, error = mean_and_error(render(dataclasses.replace(cut, surface=None), samples=256))
    assert abs(mean - 0.8 / 4 / 2) < 4.5 * error


def test_what_is_cut_off_altogether_is_black_and_transparent():
    for parts in ({"clip": Plane((0, 0, 9), (0, 0, 1))}, {"crop": Cropping((0,) * 3, (0,) * 3)},
                  {"mask": np.zeros(CUBE.values.shape, bool)}):  # fmt: skip
        picture = render(scene(CUBE, medium(2.0), lights=SKY, **parts), samples=2)
        assert picture.plan.empty
        assert not picture.alpha.any()
        assert not picture.radiance.any()


def test_far_from_the_origin_cuts_are_the_same():
    here, there = np.zeros(3), np.array((1e6, -2e6, 5e5))

    def picture(centre):
        near = tuple((centre + np.array((0.1, 0.2, 0.0))).tolist())
        return render(
            scene(
                blob(centre=centre), lights=SKY,
                clip=(Plane(near, (0.3, 1, 0.2)), Sphere(near, 0.7), Sphere(near, 0.2, "outside")),
                layers=Layer(noise(5, centre=centre + 0.25), medium(1.0)),
            ),
            samples=16,
        )  # fmt: skip

    a, b = picture(here), picture(there)
    # Not the same bits: 1e6 rounds the place of the volume itself
    assert np.abs(a.radiance - b.radiance).max() < 0.15
    assert abs(a.radiance.mean() - b.radiance.mean()) < 1e-3
