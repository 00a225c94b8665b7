"""What hard cases are rendered by, and from where. A new technique or backend joins the lists."""

import math
from dataclasses import replace

import numpy as np
import pytest

from vtkmcvr.emission_absorption import EmissionAbsorption, render_emission_absorption
from vtkmcvr.lights import ConstantEnvironment
from vtkmcvr.occlusion import Occlusion, render_occlusion
from vtkmcvr.rendering import render_scene
from vtkmcvr.scene import Camera

SKY = (ConstantEnvironment(1.0),)
MONTE_CARLO = ("monte-carlo single", "monte-carlo multiple")
OCCLUSION = ("occlusion default", "occlusion paper")
# One row of the table: it has no modes
EMISSION_ABSORPTION = "emission-absorption steps"
LIT = (*MONTE_CARLO, *OCCLUSION)
TECHNIQUES = (*LIT, EMISSION_ABSORPTION)
BACKENDS = ("cpu",)

every_technique = pytest.mark.parametrize("technique", TECHNIQUES)
by_light = pytest.mark.parametrize("technique", LIT)
by_monte_carlo = pytest.mark.parametrize("technique", MONTE_CARLO)
by_occlusion = pytest.mark.parametrize("technique", OCCLUSION)


def picture_by(technique, scene, samples=64, seed=1, half_angle=60.0, **settings):
    """Picture of a scene by one of the techniques."""
    name, how = technique.split()
    if name == "occlusion":
        return render_occlusion(scene, Occlusion(half_angle, mode=how, **settings))
    if name == "emission-absorption":
        # As many rays as make a mean over pixels
        return render_emission_absorption(scene, EmissionAbsorption(rays=4))
    picture = render_scene(replace(scene, scattering=how), samples=samples, seed=seed)
    assert picture.rejected_samples == 0
    return picture


def deviation(technique, picture, p, slices=2e-3, sigmas=4.5):
    """Tolerance of a mean alpha of p: binomial for Monte Carlo, that of the `slices` else.

    4.5 standard errors: by Bonferroni over fewer than 100 comparisons chance exceeds them in less
    than 100 x 6.8e-6 = 7e-4 of all choices of seeds. The seeds are fixed.
    """
    if technique not in MONTE_CARLO:
        return slices
    n = picture.film.count.sum()
    return sigmas * math.sqrt(max(p * (1 - p), 0) / n) + 1e-6


def cameras(volume, half_height):
    """Cameras by name around a volume: outside in either projection, and in its middle."""
    x, y, z = volume.centre
    back = 5 * half_height
    return {
        "perspective": Camera((x, y - back, z), (x, y, z), view_angle=20),
        "parallel": Camera((x, y - back, z), (x, y, z), parallel_scale=half_height),
        "inside": Camera((x, y, z), (x, y + 1, z), view_angle=60),
    }


every_camera = pytest.mark.parametrize("view", ["perspective", "parallel", "inside"])


def relative_difference(picture, other):
    """RMS difference of two radiances over the RMS of the second."""
    a, b = (np.asarray(p.radiance, np.float64) for p in (picture, other))
    return math.sqrt(np.mean((a - b) ** 2) / np.mean(b**2))
