"""Errors that pictures of real volumes claim, against those that they have over 200 seeds."""

import dataclasses

import numpy as np
import pytest
from real_volumes import real_volume
from scenes import render

from vtkmcvr.front import scene_of

VOLUMES = {
    "CT head": ("scivis/cthead/CThead.nhdr", "k", "ct-bone"),
    "engine": ("scivis/engine.nhdr", "", "solid"),
    "CT thorax": ("dicom/ct_thorax_lidc0314", "", "ct-bone"),
}
SEEDS = 200


@pytest.fixture(scope="module", params=VOLUMES, ids=lambda name: name.replace(" ", "-"))
def known(request):
    """Scene of a real volume, and a picture of it whose own error is small: some 1 %."""
    path, flip, preset = VOLUMES[request.param]
    volume = real_volume(path)
    volume = volume.flipped(flip) if flip else volume
    lit = scene_of(volume, preset=preset, size=(40, 30)).scene
    return lit, render(lit, samples=8000, seed=10**6).film.mean


@pytest.mark.slow
@pytest.mark.parametrize("samples", [8, 32, 128])
@pytest.mark.parametrize("sampler", ["independent", "sobol"])
def test_claimed_errors_are_those_over_200_seeds(known, sampler, samples):
    lit, truth = known
    lit = dataclasses.replace(lit, sampler=sampler)
    shown = truth.sum(-1) > 0
    hits, claimed, wrong = [], [], []
    for seed in range(SEEDS):
        picture = render(lit, samples=samples, seed=seed)
        off = picture.film.mean - truth
        hits.append((np.abs(off) <= 1.96 * picture.standard_error)[shown].mean())
        claimed.append(picture.nrms**2)
        wrong.append((off**2).mean() / (truth**2).mean())
    ratio = np.sqrt(np.mean(claimed) / np.mean(wrong))
    if sampler == "sobol" and samples < 32:
        # No two batches: the error of independent samples, an upper estimate
        assert 0.93 <= np.mean(hits) <= 0.985
        assert 0.95 <= ratio <= 1.6
    else:
        assert 0.93 <= np.mean(hits) <= 0.97
        assert ratio == pytest.approx(1, abs=0.1)
