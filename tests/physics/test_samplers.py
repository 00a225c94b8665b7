"""Sobol points and independent numbers: the same expectation, and no more variance."""

from dataclasses import replace

import numpy as np
import pytest
from scenes import blob, everything, medium, render, scene, z_score
from scipy import stats

from vtkmcvr.lights import ConstantEnvironment, RectangleLight
from vtkmcvr.scene import Camera, Lens, Surface

SKY = ConstantEnvironment(1.0)
PANEL = RectangleLight((2, -2, 2), (0, 0, 0), (1.5, 1.5), 5.0)
LENS = Camera((0, -5, 0), (0, 0, 0), view_angle=25, lens=Lens(0.3, 4.5))
SCENES = {
    "fog": scene(transfer=medium(0.5), lights=(SKY,), camera=LENS),
    "all effects": everything(SKY, PANEL, surface=Surface(1.0)),
}


@pytest.mark.parametrize("name", SCENES)
def test_samplers_have_one_expectation(name):
    even = SCENES[name]
    independent = replace(even, sampler="independent")
    # 4 standard errors: 6e-5 for each of two scenes
    assert abs(z_score(render(even, 512, seed=1), render(independent, 512, seed=2))) < 4


def variances(view, runs, samples=16):
    """Variance between runs, summed over channels, by pixel."""
    radiance = np.stack([render(view, samples, seed=s).film.mean for s in range(1, runs + 1)])
    return radiance.var(axis=0, ddof=1).sum(axis=-1)


@pytest.mark.parametrize("name", SCENES)
def test_sobol_points_lower_the_variance(name):
    # Measured: 1.7 on fog, 1.3 with all effects. The sums over 1024 pixels of variances from 24
    # runs are known to some 2 % each
    before = variances(replace(SCENES[name], sampler="independent"), 24)
    after = variances(SCENES[name], 24)
    assert before.sum() / after.sum() > 1.1
    # Nowhere more: 16 parts of 64 pixels, each known to some 10 % as its pixels' variances differ;
    # 1e-3 for all parts, with the kurtosis of a pixel's mean counted in by the spread of the parts
    parts = [v.reshape(4, 8, 4, 8).sum(axis=(1, 3)) for v in (before, after)]
    lit = parts[0] > 1e-3 * parts[0].max()
    bound = stats.f.ppf(1 - 1e-3 / 32, 64 * 23 / 4, 64 * 23 / 4)
    assert (parts[1][lit] / parts[0][lit]).max() < bound


def test_interrupted_batches_go_on_with_the_same_bits():
    # 16 samples are one batch: stop inside of the first and of the second
    view = scene(blob(), lights=(SKY,))
    whole = render(view, 40, seed=3).film
    pieces = render(view, 5, seed=3).refine(16).refine(29).refine(40).film
    for name, a, b in zip(whole._fields, whole, pieces, strict=True):
        np.testing.assert_array_equal(a, b, err_msg=name)
    assert whole.batches is not None
