"""How collisions and transmittances are estimated changes the noise, not the picture.

z-scores are compared with 4.5: by Bonferroni over fewer than 100 comparisons, chance exceeds it in
less than 100 x 6.8e-6 = 7e-4 of all choices of seeds. The seeds are fixed.
"""

from dataclasses import replace

import numpy as np
import pytest
from scenes import blob, everything, mean_and_error, medium, noise, render, scene, volume, z_score

from vtkmcvr.lights import (
    ConstantEnvironment,
    DirectionalLight,
    EnvironmentMap,
    PointLight,
    RectangleLight,
)
from vtkmcvr.plan import plan
from vtkmcvr.scene import HenyeyGreenstein, Schlick, Surface, Volume

LIGHTS = {
    "sky": ConstantEnvironment(1.0),
    "map": EnvironmentMap(np.random.default_rng(2).random((4, 8, 3))),
    "rectangle": RectangleLight((2, -2, 2), (0, 0, 0), (1, 1), 20.0),
    "sun": DirectionalLight((1, 2, -1.5), 2.0),
    "lamp": PointLight((-1, -2, 1), 8.0),
}
LOBES = {
    "phase": {"phase": HenyeyGreenstein(0.6)},
    "Schlick": {"phase": Schlick(-0.5)},
    "coat": {"surface": Surface(mode="brdf", specular=0.3, exponent=20.0)},
    "GGX coat": {"surface": Surface(mode="threshold", threshold=0.1, specular=0.3, coat="ggx")},
}
# Fine enough that its bias is far below the noise: 0.01 mean free paths
FINE = {"estimator": "ray-march", "step": 0.0033}


def estimated(light, lobe, seed, **options):
    lit = everything(LIGHTS[light], **LOBES[lobe], **options)
    return render(lit, samples=24, seed=seed)


def pairs():
    """Every light with every lobe; each light and each lobe once in the quick tests."""
    for i, light in enumerate(LIGHTS):
        for j, lobe in enumerate(LOBES):
            yield pytest.param(light, lobe, marks=() if j == i % len(LOBES) else pytest.mark.slow)


@pytest.mark.parametrize(("light", "lobe"), list(pairs()))
def test_three_estimators_agree(light, lobe):
    grid = estimated(light, lobe, 1)
    assert mean_and_error(grid)[0] > 0.005
    assert abs(z_score(grid, estimated(light, lobe, 2, estimator="woodcock"))) < 4.5
    assert abs(z_score(grid, estimated(light, lobe, 3, **FINE))) < 4.5


@pytest.mark.parametrize("estimator", ["majorant-grid", "ray-march"])
def test_shadows_by_either_tracking_agree(estimator):
    options = {"estimator": estimator, "step": 0.02, "lights": (LIGHTS["sky"],)}
    ratio = render(scene(**options), samples=64, seed=1)
    delta = render(scene(**options, ratio_tracking=False), samples=64, seed=2)
    assert abs(z_score(ratio, delta)) < 4.5
    assert mean_and_error(ratio)[1] < mean_and_error(delta)[1]


def test_estimators_agree_on_multiple_scattering():
    options = {"scattering": "multiple", "lights": (LIGHTS["sky"],), "transfer": medium(8.0, 0.9)}
    grid = render(scene(**options), samples=64, seed=1)
    woodcock = render(scene(**options, estimator="woodcock"), samples=64, seed=2)
    marched = render(scene(**options, estimator="ray-march", step=0.002), samples=64, seed=3)
    assert abs(z_score(grid, woodcock)) < 4.5
    assert abs(z_score(grid, marched)) < 4.5


def plate():
    """Opaque plate, one voxel thick, in air that keeps the march from starting at it (HC-01)."""
    values = np.full((20, 20, 20), 1e-6, np.float32)
    values[:, 10, :] = 1
    return scene(volume(values, (0.1,) * 3), medium(500.0))


def test_marching_misses_what_is_thinner_than_its_step():
    # The plate is a tent of height 500 and width 0.2. Steps of 0.6 are looked at in their middles:
    # one in three sees it
    exact = render(plate(), samples=8)
    coarse = render(replace(plate(), estimator="ray-march", step=0.6), samples=8)
    fine = render(replace(plate(), estimator="ray-march", step=0.05), samples=8)
    assert exact.alpha.min() == 1
    assert coarse.alpha.mean() == pytest.approx(1 / 3, abs=0.05)
    assert fine.alpha.min() == 1


def test_woodcock_has_one_majorant_and_needs_no_compilation():
    vol = noise()
    grid, woodcock = (plan(scene(vol, estimator=e)).packed for e in ("majorant-grid", "woodcock"))
    assert woodcock.medium.majorant.shape == (1, 1, 1)
    assert woodcock.medium.majorant.max() == grid.medium.majorant.max()
    assert grid.marching is None
    assert woodcock.marching is None


def test_step_that_would_take_forever_is_refused():
    with pytest.raises(ValueError, match=r"step is at least 0.001 of the smallest.*got 1e-06"):
        plan(scene(estimator="ray-march", step=1e-6))


@pytest.mark.parametrize("spacing", [(1, 1, 1), (1, 0.3, 2.5)])
def test_march_sees_world_lengths_in_every_spacing(spacing):
    # Beer-Lambert along y over 2 units: 1 - exp(-1)
    vol = Volume.from_grid(np.ones((3, 3, 3), np.float32), spacing, -np.array(spacing))
    deep = 2 * spacing[1]
    picture = render(
        scene(vol, medium(1 / deep), estimator="ray-march", step=0.7, size=(16, 16)), samples=64
    )
    n, p = picture.film.count.sum(), 1 - np.exp(-1)
    assert abs(picture.film.hits.sum() / n - p) < 4.5 * np.sqrt(p * (1 - p) / n)


def test_blob_is_the_same_by_every_estimator_pixel_by_pixel():
    # Sum of z^2 over pixels: mean 1 each; 1024 pixels keep it below 1.3 with probability 1 - 1e-9
    lights = (LIGHTS["sky"],)
    a = render(scene(blob(), lights=lights), samples=64, seed=1)
    b = render(scene(blob(), lights=lights, estimator="woodcock"), samples=64, seed=2)
    variance = a.standard_error[..., 1] ** 2 + b.standard_error[..., 1] ** 2
    seen = variance > 0
    z2 = (a.radiance - b.radiance)[..., 1][seen] ** 2 / variance[seen]
    assert z2.mean() < 1.3
