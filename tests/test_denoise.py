"""Noise reduction: it fades, it helps, and it never passes for a measurement."""

import builtins

import numpy as np
import pytest
from scenes import blob, medium, noise, render, scene

from vtkmcvr.film.filter import window_mean
from vtkmcvr.front import View
from vtkmcvr.front import render as render_volume
from vtkmcvr.lights import ConstantEnvironment
from vtkmcvr.phantom import head_phantom
from vtkmcvr.pictures import denoise
from vtkmcvr.pictures.denoised import DenoisedPicture
from vtkmcvr.pictures.picture import Display
from vtkmcvr.scene import Volume

f32 = np.float32
LIT = scene(noise(), lights=(ConstantEnvironment(1.0),), size=(32, 24))


def noisy(seed=1, shape=(20, 30)):
    rng = np.random.default_rng(seed)
    return rng.random((*shape, 3), f32), rng.random(shape, f32)


def nrms(image, truth):
    return float(np.sqrt(np.mean((image - truth) ** 2) / np.mean(truth**2)))


# KNN


@pytest.mark.parametrize("error", [0.0, 0.01, np.inf])
@pytest.mark.parametrize("value", [0.0, 0.1, 1 / 3, 50.0])
def test_knn_of_a_constant_is_the_same_bits(value, error):
    radiance, alpha = np.full((9, 8, 3), value, f32), np.full((9, 8), 0.7, f32)
    light, coverage = denoise.knn(radiance, alpha, np.full_like(radiance, error))
    np.testing.assert_array_equal(light, radiance)
    np.testing.assert_array_equal(coverage, alpha)


def test_knn_is_the_formula_in_float64():
    radiance, alpha = noisy()
    error = np.full_like(radiance, 0.2)
    light, coverage = denoise.knn(radiance, alpha, error, exposure=0.5)
    shown = 1 - np.exp(-radiance.astype(float) * 2**0.5)
    seen = np.where(shown <= 0.0031308, 12.92 * shown, 1.055 * shown ** (1 / 2.4) - 0.055)
    values = np.dstack([radiance, alpha]).astype(float)
    variance = denoise.display_variance(radiance, error, 0.5)
    share = variance / (variance + (2 / 255) ** 2)
    guide = np.dstack([seen, alpha])
    guide += share[..., None] * (window_mean(guide, [1, 2, 1]) - guide)
    for row, column in ((0, 0), (10, 10), (19, 29), (3, 28)):
        total, weights = np.zeros(4), 0.0
        for y in range(max(row - 3, 0), min(row + 4, 20)):
            for x in range(max(column - 3, 0), min(column + 4, 30)):
                apart = ((guide[y, x] - guide[row, column]) ** 2).sum()
                away = (y - row) ** 2 + (x - column) ** 2
                weight = np.exp(-(apart / (8 * variance[row, column]) + away / 49))
                total, weights = total + weight * values[y, x], weights + weight
        here = values[row, column]
        expected = here + share[row, column] * (total / weights - here)
        got = np.append(light[row, column], coverage[row, column])
        np.testing.assert_allclose(got, expected, rtol=2e-5)


def test_knn_fades_as_one_over_samples():
    # Values differ by less than 1, so no pixel moves by more than its share v / (v + v0), v = c/N:
    # that is c / (v0 N) at the most, and just that once v is far below v0.
    radiance, alpha = noisy()
    changes = []
    for n in (1e3, 1e5, 1e7):
        error = np.full_like(radiance, 1 / np.sqrt(n))
        bound = denoise.display_variance(radiance, error) / denoise.HALF_STRENGTH**2
        light, _ = denoise.knn(radiance, alpha, error)
        change = np.abs(light.astype(float) - radiance).max(axis=2)
        # float32 values below 1 are 6e-8 apart
        assert (change <= bound * 1.001 + 6e-8).all()
        changes.append(change.max())
    assert changes[0] > 10 * changes[1] > 100 * changes[2]
    few, many = (
        denoise.strength(denoise.display_variance(radiance, np.full_like(radiance, n**-0.5)))
        for n in (1e9, 1e11)
    )
    assert few == pytest.approx(100 * many, rel=1e-3)


def test_knn_without_noise_is_the_identity():
    radiance, alpha = noisy()
    light, coverage = denoise.knn(radiance, alpha, np.zeros_like(radiance))
    np.testing.assert_array_equal(light, radiance)
    np.testing.assert_array_equal(coverage, alpha)


def test_strength_by_numbers():
    assert denoise.strength(np.array([0.0, (2 / 255) ** 2])).tolist() == [0.0, 0.5]
    unknown = denoise.display_variance(np.ones((3, 3, 3)), np.full((3, 3, 3), np.inf))
    assert unknown == pytest.approx(np.ones((3, 3)))
    # Far up the tone curve no noise is seen, however large
    white = denoise.display_variance(np.full((3, 3, 3), 80.0), np.ones((3, 3, 3)))
    assert white.max() < 1e-30


def test_display_variance_is_that_of_the_display():
    # Noise of 1e-3 through the whole chain; 20000 draws give its variance to 1 %
    from vtkmcvr.pictures.display import srgb_encode, tone_map

    draws = np.random.default_rng(1).normal(0.4, 1e-3, 20_000)
    shown = srgb_encode(tone_map(draws, 1.0))
    variance = denoise.display_variance(np.full((1, 1, 3), 0.4), np.full((1, 1, 3), 1e-3), 1.0)
    assert variance[0, 0] == pytest.approx(shown.var(), rel=0.05)


def test_knn_keeps_an_edge_that_stands_out_of_the_noise():
    rng = np.random.default_rng(4)
    truth = np.where(np.arange(40) < 20, 0.1, 0.9)[None, :, None].repeat(30, 0).repeat(3, 2)
    image = (truth + rng.normal(0, 0.03, truth.shape)).astype(f32)
    light, _ = denoise.knn(image, np.ones((30, 40), f32), np.full_like(image, 0.03))
    assert nrms(light, truth) < 0.5 * nrms(image, truth)
    assert np.abs(light - truth)[:, 18:22].mean() < 0.03


# Real pictures


@pytest.fixture(scope="module")
def head():
    """Four samples per pixel of a CT head, and the converged picture."""
    settings = {
        "preset": "ct-bone", "size": (96, 72), "view": View(azimuth=-28, elevation=6),
        "aovs": ("albedo", "normal"),
    }  # fmt: skip
    data = Volume.from_grid(*head_phantom(64))
    return (
        render_volume(data, samples=4, seed=1, **settings),
        render_volume(data, samples=512, seed=2, **settings).radiance,
    )


def test_knn_reduces_the_error_of_a_real_picture(head):
    picture, truth = head
    before, after = nrms(picture.radiance, truth), nrms(picture.denoised("knn").radiance, truth)
    print(f"NRMS {before:.3f} -> {after:.3f} by KNN")
    assert after < 0.5 * before


def test_oidn_reduces_the_error_of_a_real_picture(head):
    pytest.importorskip("pyoidn", reason="Open Image Denoise is not installed")
    picture, truth = head
    before, after = nrms(picture.radiance, truth), nrms(picture.denoised("oidn").radiance, truth)
    print(f"NRMS {before:.3f} -> {after:.3f} by OIDN")
    assert after < 0.4 * before
    assert np.abs(picture.denoised("oidn").alpha - picture.alpha).mean() < 0.05


def test_knn_does_not_harm_a_converging_picture():
    lit = scene(blob(), medium(8.0), lights=(ConstantEnvironment(1.0),), size=(32, 32))
    truth = render(lit, 8192, seed=9).radiance
    for samples in (16, 256, 1024):
        picture = render(lit, samples)
        assert nrms(picture.denoised("knn").radiance, truth) < nrms(picture.radiance, truth)


# What a denoised picture says


@pytest.mark.parametrize("method", ["knn", "oidn"])
def test_the_measured_picture_stays_and_the_other_says_what_it_is(method):
    if method == "oidn":
        pytest.importorskip("pyoidn", reason="Open Image Denoise is not installed")
    picture = render(LIT, 8)
    before = picture.radiance
    smooth = picture.denoised(method)
    np.testing.assert_array_equal(picture.radiance, before)
    assert picture.facts()["denoised"] is None
    assert isinstance(smooth, DenoisedPicture)
    assert not np.array_equal(smooth.radiance, before)
    np.testing.assert_array_equal(smooth.measured.radiance, before)
    np.testing.assert_array_equal(smooth.arrays()["measured"], before)
    facts = smooth.facts()
    assert facts["denoised"]["method"] == method
    assert facts["nrms"] is None
    assert facts["nrms_before_denoising"] == picture.nrms
    assert smooth.nrms == np.inf
    assert smooth.radiance.dtype == smooth.alpha.dtype == f32


def test_a_denoised_picture_goes_on_from_the_measured_one():
    picture = render(LIT, 4)
    np.testing.assert_array_equal(
        picture.denoised("knn").refine(8).radiance, render(LIT, 8).denoised("knn").radiance
    )


def test_display_changes_keep_the_denoised_radiance():
    smooth = render(LIT, 4).denoised("knn")
    brighter = smooth.with_display(Display(exposure=2.0))
    assert isinstance(brighter, DenoisedPicture)
    assert brighter.radiance is smooth.radiance
    assert brighter.rgba.astype(int).sum() > smooth.rgba.astype(int).sum()


def test_unknown_and_repeated_methods_are_refused():
    picture = render(LIT, 2)
    with pytest.raises(ValueError, match="one of knn, oidn; got 'median'"):
        picture.denoised("median")
    with pytest.raises(ValueError, match="already denoised by knn"):
        picture.denoised("knn").denoised("knn")


def test_without_pyoidn_the_message_says_what_to_install(monkeypatch):
    original = builtins.__import__

    def missing(name, *args):
        if name == "pyoidn":
            raise ImportError(name)
        return original(name, *args)

    monkeypatch.setattr(builtins, "__import__", missing)
    with pytest.raises(ImportError, match=r'pip install "vtkmcvr\[denoise\]"'):
        denoise.oidn(*noisy())
