"""Values that theory knows: half-spaces, slabs, penumbrae.

A layer of optical depth a is integrated exactly for homogeneous media, so what is left is the
quadrature over directions (midpoints in the cosine: error below 1e-3 at 40) and float32.
"""

import math

import numpy as np
import pytest
from occlusion_scenes import block, frontal, half_space, half_space_scene, penumbra
from scenes import scene

from vtkmcvr.occlusion import Occlusion, render_occlusion
from vtkmcvr.occlusion.single import half_space_value, mean_path

THETAS = [0, 30, 50, 80, 85, 89]
TABLE = dict(zip(THETAS, [0.5, 0.4825, 0.4492, 0.3550, 0.3322, 0.3069], strict=True))


def middle(picture):
    """Radiance of the middle pixel."""
    rows, columns = picture.alpha.shape
    return float(picture.radiance[rows // 2, columns // 2, 1])


@pytest.mark.parametrize("theta", THETAS)
def test_the_formula_gives_the_published_table(theta):
    # The table's last column is that of 90 degrees
    expected = TABLE[theta] if theta < 89 else half_space(89)
    assert half_space_value(math.radians(theta)) == pytest.approx(expected, abs=1e-4)
    assert half_space_value(math.radians(theta)) == pytest.approx(half_space(theta), rel=1e-9)


def test_the_mean_path_joins_smoothly_at_narrow_cones():
    angles = np.radians(np.geomspace(1e-3, 1.0, 60))
    values = [mean_path(a) for a in angles]
    assert (np.diff(values) > -1e-12).all()
    assert values[0] == pytest.approx(1)


@pytest.mark.parametrize("mode", ["default", "fast"])
@pytest.mark.parametrize("theta", THETAS)
@pytest.mark.parametrize("slices", [240, 24])
def test_half_space(mode, theta, slices):
    # 24 mean free paths deep, slices of 0.1 and of 1 mean free path (HC-83, HC-84). Beyond the
    # raster, 16 mean free paths away, all is lit: that counts less than 0.1 %.
    picture = render_occlusion(half_space_scene(), Occlusion(theta, mode, slices=slices))
    assert middle(picture) == pytest.approx(half_space(theta), rel=0.005)
    assert picture.alpha.min() > 0.9999


def test_paper_mode_has_the_published_value_of_coarse_slices():
    # Algorithm 3: 1 / (1 + e^-a) for slices of optical depth a, at every angle (HC-84); Algorithm 2
    # is darker than the integral in wide cones (0.203 at 80 degrees in thin slices)
    for slices in (240, 24):
        a = 24 / slices
        for theta in (30, 80):
            setting = Occlusion(theta, "paper", slices=slices, grid=5)
            found = middle(render_occlusion(half_space_scene(), setting))
            assert found == pytest.approx(1 / (1 + math.exp(-a)), rel=4e-3)
    exact = Occlusion(80, "paper", slices=240, grid=9, exact_distance=True)
    assert 0.18 < middle(render_occlusion(half_space_scene(), exact)) < 0.25


@pytest.mark.parametrize("mode", ["default", "fast"])
@pytest.mark.parametrize("tau", [1e-4, 0.1, 1.0, 4.0])
def test_slab_without_a_cone(mode, tau):
    # Every view ray shades itself: (1 - exp(-2 tau)) / 2
    vol, transfer = block(4.0, 12.0, tau / 4)
    picture = render_occlusion(scene(vol, transfer, frontal(1.0), size=(5, 5)), Occlusion(0, mode))
    assert middle(picture) == pytest.approx(-math.expm1(-2 * tau) / 2, rel=1e-3)
    assert float(picture.alpha[2, 2]) == pytest.approx(-math.expm1(-tau), rel=1e-3)


@pytest.mark.parametrize("mode", ["default", "fast", "paper"])
@pytest.mark.parametrize("sigma_t", [1e-7, 1e-3, 1e2, 1e4])
@pytest.mark.parametrize("theta", [0, 60, 89.9])
def test_stable_at_all_densities_and_angles(mode, sigma_t, theta):
    # HC-81: tan(theta) grows without bound
    vol, transfer = block(4.0, 12.0, sigma_t)
    picture = render_occlusion(
        scene(vol, transfer, frontal(2.0), size=(7, 7)), Occlusion(theta, mode, grid=3)
    )
    assert np.isfinite(picture.radiance).all()
    assert (picture.radiance >= 0).all()
    assert (picture.radiance <= picture.alpha[..., None] * 1.001 + 1e-9).all()
    # The table of extinction is cut off at 64 depths to a voxel
    depth = 4 * min(sigma_t, 64.0)
    assert float(picture.alpha[3, 3]) == pytest.approx(-math.expm1(-depth), rel=2e-3)
    if depth < 0.01:
        # All light arrives
        assert middle(picture) == pytest.approx(depth, rel=0.02)


def test_thin_media_add_up_over_thousands_of_slices():
    # 5000 slices of optical depth 1e-5 (HC-85): the light behind them is e^-0.05
    vol, transfer = block(10.0, 12.0, 0.005)
    picture = render_occlusion(
        scene(vol, transfer, frontal(1.0), size=(3, 3)), Occlusion(0, slices=5000)
    )
    expected = -math.expm1(-0.1) / 2
    assert middle(picture) == pytest.approx(expected, rel=1e-3)


def test_penumbra_of_a_half_plane_has_the_cones_width():
    # From 60 to 95 %: the widths agree within 10 %
    found, expected, most = penumbra(Occlusion(50, directions=256))
    assert found == pytest.approx(expected, rel=0.1)
    assert most > 0.97
    # A single buffer has it at one distance only (HC-80)
    narrow, _, _ = penumbra(Occlusion(50, "fast"))
    assert narrow < 0.7 * expected
