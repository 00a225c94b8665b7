"""Material channels by value: a channel that happens to be constant is the constant.

z-scores are compared with 4.5: by Bonferroni over fewer than 20 comparisons, chance exceeds it in
less than 20 x 6.8e-6 = 1.4e-4 of all choices of seeds.
"""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest
from scenes import WHITE, blob, frontal, medium, noise, render, scene, volume, z_score

from vtkmcvr import packed
from vtkmcvr.curves import ColourCurve, Curve
from vtkmcvr.film import error as film_error
from vtkmcvr.lights import ConstantEnvironment, DirectionalLight
from vtkmcvr.plan import plan
from vtkmcvr.scene import HenyeyGreenstein, Schlick, Surface, TransferFunction, Volume

SUN = (DirectionalLight((1, 2, -1.5), 2.0), ConstantEnvironment(0.2))
SHINY = Surface(0.8, specular=0.25, exponent=12.0)


def grey(x):
    return ColourCurve([(0, x, x, x)])


def lit(transfer, **options):
    return scene(transfer=transfer, lights=SUN, **options)


def nearly(x):
    """Curve that varies by less than a picture shows: packed as a table all the same."""
    return Curve([(0, x), (1, x * (1 + 1e-6))])


def nearly_grey(x):
    y = x * (1 + 1e-6)
    return ColourCurve([(0, x, x, x), (1, y, y, y)])


@pytest.mark.parametrize(
    ("channels", "constants"),
    [
        ({"g": nearly(0.6)}, {"phase": HenyeyGreenstein(0.6)}),
        pytest.param({"g": nearly(0.6)}, {"phase": Schlick(0.6)}, marks=pytest.mark.slow),
        pytest.param(
            {"specular": nearly_grey(0.25), "exponent": nearly(12)}, {"surface": SHINY},
            marks=pytest.mark.slow,
        ),
        # ((3 - 1) / (3 + 1))^2 = 0.25
        ({"refraction_index": nearly(3), "exponent": nearly(12)}, {"surface": SHINY}),
    ],
    ids=["g", "k", "specular and exponent", "index of refraction"],
)
def test_channel_of_one_value_is_that_value(channels, constants):
    # The same random numbers: equal but for paths that a rounding sends elsewhere
    plain = lit(medium(6.0, 0.7), **constants)
    other = {"surface": Surface(0.8, specular=0.5, exponent=99.0), "phase": Schlick(0.1)}
    by_value = lit(
        replace(medium(6.0, 0.7), **channels),
        **{name: other[name] for name in constants if constants[name] != HenyeyGreenstein(0.6)},
    )
    a, b = render(plain, samples=8), render(by_value, samples=8)
    assert a.radiance.mean() > 0.01
    assert np.mean(np.isclose(a.radiance, b.radiance, rtol=1e-3, atol=1e-5)) > 0.995


def test_channel_that_does_not_vary_costs_no_lookup():
    channels = {"g": Curve([(0, 0.6)]), "specular": grey(0.25), "exponent": Curve([(0, 12)])}
    options = {"surface": SHINY, "phase": HenyeyGreenstein(0.6)}
    by_value = plan(
        lit(replace(medium(3.0), **channels), surface=Surface(0.8, specular=0.5, exponent=99.0))
    ).packed
    plain = plan(lit(medium(3.0), **options)).packed
    assert by_value.gloss == plain.gloss
    assert by_value.phase == plain.phase
    assert by_value.transfer._replace(sigma_t=None, colour=None) == plain.transfer._replace(
        sigma_t=None, colour=None
    )


@pytest.mark.slow
def test_channels_follow_the_scalar():
    # Two halves side by side, each like a volume of one value with that material
    left, right = np.zeros((9, 9, 40), np.float32), np.zeros((9, 9, 40), np.float32)
    right[:] = 1
    both = np.where(np.arange(40) < 20, left, right)
    two = TransferFunction(
        None, ColourCurve([(0, 0.9, 0.9, 0.9), (1, 0.3, 0.3, 0.3)]), extinction=Curve([(0, 3)]),
        g=Curve([(0, -0.5), (1, 0.7)]), emission=ColourCurve([(0, 0, 0, 0), (1, 1, 1, 1)]),
    )  # fmt: skip
    for values, columns, seed in ((left, slice(0, 8), 2), (right, slice(24, 32), 3)):
        vols = [volume(v, (0.25, 0.25, 0.25)) for v in (both, values)]
        sun = (DirectionalLight((0, 1, -1), 2.0),)
        a, b = (
            render(
                scene(v, two, frontal(1.0), lights=sun, size=(160, 32)), samples=16, seed=seed + i
            )
            for i, v in enumerate(vols)
        )
        ends = slice(0, 40) if columns.start == 0 else slice(120, 160)
        a, b = (Part(columns_of(picture.film, ends)) for picture in (a, b))
        assert abs(z_score(a, b)) < 4.5


class Part(NamedTuple):
    """Columns of a picture, to be compared like one."""

    film: packed.Film


def columns_of(part, columns):
    """Film, or a part of it, with some of its columns only."""
    if isinstance(part, np.ndarray):
        return part[:, columns]
    return None if part is None else type(part)(*(columns_of(x, columns) for x in part))


def test_channels_that_nothing_asks_for_are_left_out():
    full = replace(
        medium(3.0), specular=grey(0.5), exponent=Curve([(0, 5)]), emission=grey(0.0),
        gradient_opacity=Curve([(0, 1)]),
    )  # fmt: skip
    bare, same = (plan(lit(t)).packed for t in (medium(3.0), full))
    assert same.transfer._replace(sigma_t=None, colour=None) == bare.transfer._replace(
        sigma_t=None, colour=None
    )
    varied = replace(full, specular=nearly_grey(0.5))
    assert plan(lit(varied, surface=SHINY)).packed.transfer.specular is not None


def test_specular_channel_of_zero_is_lambert():
    transfer = replace(medium(3.0), specular=grey(0.0))
    assert plan(lit(transfer, surface=SHINY)).packed.gloss is None


def test_gradient_opacity_on_a_ramp_is_beer_lambert():
    # A ramp has one gradient, 2 per unit: change over the mean spacing 2 (0.5 + 0.25 + 0.25) / 3
    x = np.arange(9) * 0.5
    values = np.broadcast_to(2 * x, (9, 9, 9)).astype(np.float32)
    vol = volume(values, (0.5, 0.25, 0.25))
    step = 2 * vol.spacing.mean()
    transfer = TransferFunction(
        None, WHITE, extinction=Curve([(0, 2)]),
        gradient_opacity=Curve([(0, 0), (2 * step, 1)]),
    )  # fmt: skip
    picture = render(scene(vol, transfer, frontal(0.9)), samples=64)
    n, p = picture.film.count.sum(), -math.expm1(-2 * 0.5 * 2.0)
    assert abs(picture.film.hits.sum() / n - p) < 4.5 * math.sqrt(p * (1 - p) / n)


def test_albedo_of_points_colours_the_picture():
    # Colour by point against the same colours by scalar: one extinction, one picture
    vol = blob()
    ramp = ColourCurve([(0, 0, 1, 0.5), (1, 1, 0, 0.5)])
    by_scalar = TransferFunction(None, ramp, extinction=Curve([(0, 0), (1, 5)]))
    colours = np.stack([vol.values, 1 - vol.values, np.full_like(vol.values, 0.5)], axis=-1)
    by_point = Volume(vol.values, vol.index_to_world, colours)
    a = render(scene(vol, by_scalar, lights=SUN), samples=8)
    b = render(scene(by_point, medium(5.0, 1.0), lights=SUN), samples=8)
    np.testing.assert_allclose(a.radiance, b.radiance, atol=1e-3)
    assert np.abs(a.radiance[..., 0] - a.radiance[..., 1]).max() > 0.05


def test_noise_in_the_data_is_less_noise_in_the_picture_by_a_lower_gradient_factor():
    # HC-18: normals of noise point anywhere, so that light reaches a random part of them. Relative
    # variances are 8.6, 15.3 and 19.4, which 64 samples of 1024 pixels give to some 3 %
    spread = []
    for g in (0.2, 0.5, 1.0):
        picture = render(
            scene(noise(), medium(6.0, 0.7), lights=SUN, surface=Surface(g, specular=0.25)), 64
        )
        variance = film_error.variance(picture.film)[..., 1].sum()
        spread.append(variance / picture.film.mean[..., 1].mean() ** 2)
    assert spread[0] < 0.8 * spread[1]
    assert spread[1] < spread[2]
