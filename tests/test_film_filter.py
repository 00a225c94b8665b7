import numpy as np
import pytest
from scenes import render, scene

from vtkmcvr.film.filter import gaussian_5x5, window_mean
from vtkmcvr.lights import ConstantEnvironment
from vtkmcvr.pictures.picture import Display


def test_gaussian_is_the_papers():
    impulse = np.zeros((9, 9))
    impulse[4, 4] = 1
    line = np.exp(-(np.arange(-2, 3) ** 2) / (2 * 1.5**2))
    line /= line.sum()
    expected = np.zeros((9, 9))
    expected[2:7, 2:7] = np.outer(line, line)
    np.testing.assert_allclose(gaussian_5x5(impulse), expected, atol=1e-15)


@pytest.mark.parametrize("shape", [(1, 1), (1, 7), (2, 3, 3), (30, 20, 4)])
def test_a_constant_stays_also_at_the_border(shape):
    image = np.full(shape, 0.3, np.float32)
    filtered = gaussian_5x5(image)
    assert filtered.dtype == np.float32
    np.testing.assert_allclose(filtered, image, rtol=1e-6)


def test_window_mean_is_a_box_cut_at_the_border():
    image = np.random.default_rng(1).random((11, 12))
    mean = window_mean(image, [1.0] * 7)
    assert mean[5, 6] == pytest.approx(image[2:9, 3:10].mean())
    assert mean[0, 11] == pytest.approx(image[:4, 8:].mean())


def test_filtering_each_estimate_is_filtering_their_mean():
    estimates = np.random.default_rng(2).random((16, 8, 9, 3))
    one_by_one = np.mean([gaussian_5x5(estimate) for estimate in estimates], axis=0)
    np.testing.assert_allclose(one_by_one, gaussian_5x5(estimates.mean(axis=0)), rtol=1e-12)


def test_as_a_display_it_blurs_before_the_tone_curve_and_leaves_the_film():
    picture = render(scene(lights=(ConstantEnvironment(1.0),), size=(24, 24)), 4)
    before = picture.radiance
    blurred = picture.with_display(film_filter="gaussian-5x5")
    np.testing.assert_array_equal(blurred.radiance, before)
    assert blurred.film is picture.film
    rough, smooth = (np.abs(np.diff(p.rgba[..., 0].astype(int))).sum() for p in (picture, blurred))
    assert smooth < rough
    with pytest.raises(ValueError, match="film_filter is one of none, gaussian-5x5; got 'box'"):
        Display(film_filter="box")
