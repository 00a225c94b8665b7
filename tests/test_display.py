import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from vtkmcvr.pictures.display import (
    decode,
    encode,
    srgb_decode,
    srgb_encode,
    to_rgba8,
    to_rgba16,
    tone_map,
)

FINITE = {"allow_nan": False, "allow_infinity": False}
GREY_8_BIT = round(255 * float(srgb_encode(1 - math.exp(-1))))


def test_tone_curve_at_one_is_that_of_the_paper():
    assert tone_map(1.0) == pytest.approx(0.6321205588285577, abs=1e-16)
    assert tone_map(0.0) == 0


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_dark_radiance_keeps_its_relative_precision(dtype):
    dark = np.array([1e-8, 1e-30], dtype)
    out = tone_map(dark)
    assert out.dtype == dtype
    assert out == pytest.approx(dark.astype(float) - dark.astype(float) ** 2 / 2, rel=2e-7)


def test_one_stop_doubles_the_radiance():
    radiance = np.linspace(0, 5, 101)
    assert tone_map(radiance, 1) == pytest.approx(tone_map(2 * radiance), abs=1e-15)
    assert tone_map(radiance, -0.5) == pytest.approx(tone_map(radiance / math.sqrt(2)), abs=1e-15)


@pytest.mark.parametrize(("exposure", "light"), [(1e308, 1), (-1e308, 0)])
def test_any_finite_exposure_is_taken(exposure, light):
    assert tone_map([0.0, 1.0], exposure).tolist() == [0, light]


def test_negative_radiance_is_black():
    assert tone_map([-1.0, -1e300]).tolist() == [0, 0]


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_what_is_not_finite_is_refused(bad):
    with pytest.raises(ValueError, match="radiance has 1 values"):
        tone_map([0.0, bad])
    with pytest.raises(ValueError, match="exposure must be a finite"):
        tone_map([0.0], bad)
    with pytest.raises(ValueError, match="alpha has 1 values"):
        to_rgba8(np.zeros((1, 1, 3)), [[bad]])


@given(
    arrays(np.float32, 8, elements=st.floats(width=32, **FINITE)),
    st.floats(-1e4, 1e4, **FINITE),
)
def test_tone_curve_stays_in_range_for_any_finite_input(radiance, exposure):
    out = tone_map(radiance, exposure)
    assert np.all((out >= 0) & (out <= 1))
    order = np.argsort(radiance)
    assert np.all(np.diff(out[order]) >= 0)


@pytest.mark.parametrize(
    ("linear", "encoded"),
    [
        (0, 0),
        (0.001, 0.01292),
        (0.0031308, 0.040449936),
        (0.18, 0.46135612950044164),
        (0.5, 0.7353569830524495),
        (1, 1),
    ],
)
def test_srgb_known_values(linear, encoded):
    assert srgb_encode(linear) == pytest.approx(encoded, abs=1e-9)
    assert srgb_decode(encoded) == pytest.approx(linear, abs=1e-7)


def test_srgb_clamps():
    assert srgb_encode([-1, 2]) == pytest.approx([0, 1], abs=1e-15)
    assert srgb_decode([-1, 2]) == pytest.approx([0, 1], abs=1e-15)


def test_every_8_bit_value_survives_the_round_trip():
    codes = np.arange(256)
    again = np.floor(srgb_encode(srgb_decode(codes / 255)) * 255 + 0.5)
    assert np.array_equal(again, codes)


@given(st.floats(0, 1))
def test_srgb_round_trip(value):
    # the two pieces of the standard miss each other by 3e-8 where they meet
    assert srgb_decode(srgb_encode(value)) == pytest.approx(value, abs=1e-7)


def test_srgb_is_monotone():
    ramp = np.linspace(0, 1, 100_001)
    assert np.all(np.diff(srgb_encode(ramp)) > 0)
    assert np.all(np.diff(srgb_decode(ramp)) > 0)


def picture(alpha, **options):
    """Return the pixels of a unit-radiance object seen with the given coverages."""
    coverage = np.array([alpha], float)
    return to_rgba8(coverage[..., None].repeat(3, 2), coverage, **options)[0].tolist()


def test_straight_alpha_keeps_the_colour_of_the_edge():
    grey = [GREY_8_BIT] * 3
    assert picture([0, 0.5, 1]) == [[0, 0, 0, 0], [*grey, 128], [*grey, 255]]


def test_background_is_mixed_in_linear_display_light():
    light = 1 - math.exp(-1)
    half = 0.5 * light + 0.5 * np.asarray(srgb_decode([1.0, 0.5, 0.0]))
    expected = [*np.floor(srgb_encode(half) * 255 + 0.5).astype(int).tolist(), 255]
    pixels = picture([0, 0.5, 1], background=(1.0, 0.5, 0.0))
    assert pixels == [[255, 128, 0, 255], expected, [GREY_8_BIT] * 3 + [255]]


def test_no_alpha_is_opaque():
    opaque = to_rgba8(np.ones((2, 3, 3), np.float32), None)
    assert opaque.shape == (2, 3, 4)
    assert opaque.dtype == np.uint8
    assert np.all(opaque == [GREY_8_BIT] * 3 + [255])


def test_alpha_is_rounded_not_cut():
    assert [p[3] for p in picture([0.4 / 255, 0.6 / 255, 254.4 / 255, 254.6 / 255])] == [
        0,
        1,
        254,
        255,
    ]


def test_a_smallest_coverage_does_not_overflow():
    tiny = np.full((1, 1), 1e-45, np.float32)
    assert to_rgba8(np.ones((1, 1, 3), np.float32), tiny).tolist() == [[[255, 255, 255, 0]]]


@given(
    arrays(np.float32, (2, 2, 3), elements=st.floats(width=32, **FINITE)),
    arrays(np.float32, (2, 2), elements=st.floats(width=32, **FINITE)),
    st.sampled_from([None, (0, 0, 0), (0.2, 0.5, 1)]),
)
def test_any_finite_film_makes_a_picture(radiance, alpha, background):
    out = to_rgba8(radiance, alpha, background=background)
    assert out.shape == (2, 2, 4)
    assert background is None or np.all(out[..., 3] == 255)


@pytest.mark.parametrize("shape", [(3,), (2, 2), (2, 2, 4)])
def test_radiance_of_another_shape_is_refused(shape):
    with pytest.raises(ValueError, match="rows, columns, 3"):
        to_rgba8(np.zeros(shape), None)


def test_alpha_of_another_shape_is_refused():
    with pytest.raises(ValueError, match="rows and columns of radiance"):
        to_rgba8(np.zeros((2, 3, 3)), np.zeros((3, 2)))


@pytest.mark.parametrize("background", [(0, 0), (0, 0, 1.5), (-0.1, 0, 0), (math.nan, 0, 0)])
def test_background_outside_its_range_is_refused(background):
    with pytest.raises(ValueError, match="background"):
        to_rgba8(np.zeros((1, 1, 3)), None, background=background)


# Gamma, 16 bits, compositing


def test_srgb_is_exact_at_16_bits():
    codes = np.arange(65536)
    assert np.array_equal(np.rint(srgb_encode(srgb_decode(codes / 65535)) * 65535), codes)
    # IEC 61966-2-1, written down again
    light = -np.log1p(-np.linspace(0, 0.999, 500))[None, :, None].repeat(3, 2)
    shown = np.linspace(0, 0.999, 500)
    curve = np.where(shown <= 0.0031308, 12.92 * shown, 1.055 * shown ** (1 / 2.4) - 0.055)
    expected = np.floor(curve * 65535 + 0.5)
    assert np.array_equal(to_rgba16(light, None)[0, :, 0], expected)
    # Through float32 no value is off by more than one step
    single = to_rgba16(light.astype(np.float32), None)[0, :, 0]
    assert np.abs(single - expected).max() <= 1


def test_16_bits_round_to_the_same_8_bits():
    light = np.random.default_rng(1).random((40, 50, 3))
    coarse, fine = to_rgba8(light, None), to_rgba16(light, None)
    assert fine.dtype == np.uint16
    assert fine.max() == 65535
    assert np.abs(fine / 257 - coarse).max() <= 0.5 + 1e-2


@pytest.mark.parametrize("gamma", [1.0, 2.2, None])
def test_encoding_and_back(gamma):
    values = np.linspace(0, 1, 101)
    assert decode(encode(values, gamma), gamma) == pytest.approx(values, abs=1e-12)
    if gamma is not None:
        assert encode(0.25, gamma) == pytest.approx(0.25 ** (1 / gamma))


@pytest.mark.parametrize("gamma", [None, 2.2])
@pytest.mark.parametrize("behind", [(1.0, 1.0, 1.0), (0.2, 0.0, 0.7)])
def test_straight_alpha_composites_to_the_picture_on_that_background(behind, gamma):
    rng = np.random.default_rng(2)
    alpha = rng.random((20, 30))
    alpha[:5], alpha[-5:] = 0, 1
    radiance = alpha[..., None] * rng.random((20, 30, 3)) * 3
    free = to_rgba16(radiance, alpha, exposure=0.5, gamma=gamma) / 65535
    colour, cover = decode(free[..., :3], gamma), free[..., 3:]
    mixed = encode(colour * cover + (1 - cover) * decode(np.array(behind), gamma), gamma)
    on = to_rgba16(radiance, alpha, exposure=0.5, gamma=gamma, background=behind)
    # Colour and alpha are rounded to 16 bits each; near black the curve is as steep as 12.92
    assert mixed == pytest.approx(on[..., :3] / 65535, abs=5e-4)
