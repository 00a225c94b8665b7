"""Emission and absorption against values that can be written down, and against quadrature."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scenes import BOX, frontal, medium, scene, slab, volume
from scipy.integrate import quad

from vtkmcvr import ColourCurve, Curve, EmissionAbsorption, Layer, Phong, Surface, TransferFunction
from vtkmcvr.emission_absorption import render_emission_absorption

RGB = (0.9, 0.5, 0.2)
TINY = (3, 3)


def draw(seen, **settings):
    return render_emission_absorption(seen, EmissionAbsorption(**settings), threads=1)


def middle(picture):
    """Radiance, alpha and depth of the pixel in the middle."""
    row, column = (n // 2 for n in picture.alpha.shape)
    return picture.radiance[row, column], picture.alpha[row, column], picture.depth[row, column]


@pytest.mark.parametrize("tau", [1e-6, 1e-2, 1.0, 5.0, 60.0])
@pytest.mark.parametrize("step", [16.0, 0.5, 0.07])
def test_constant_slab_at_any_step(tau, step):
    # alpha = 1 - exp(-tau); the eye sees it 1/sigma - L exp(-tau) / alpha behind its face
    seen = scene(slab((2, 3, 2), 9), medium(tau / 3, RGB), frontal(0.5, distance=10), TINY)
    light, alpha, depth = middle(draw(seen, step=step))
    expected = -math.expm1(-tau)
    assert alpha == pytest.approx(expected, rel=1e-5)
    np.testing.assert_allclose(light, np.array(RGB) * expected, rtol=2e-5)
    where = 3 / tau - 3 * math.exp(-tau) / expected if tau > 1e-3 else 1.5
    # Rays end at a transmittance of 1e-5
    assert depth == pytest.approx(8.5 + where, abs=1e-4)


def test_two_layers_are_composited_front_to_back():
    front, back = slab((2, 1, 2), 3, centre=(0, -1, 0)), slab((2, 1, 2), 3, centre=(0, 1, 0))
    seen = scene(
        front, medium(0.7, (1.0, 0.0, 0.2)), frontal(0.5), TINY,
        layers=Layer(back, medium(1.3, (0.0, 1.0, 0.4))),
    )  # fmt: skip
    light, alpha, _ = middle(draw(seen))
    a, b = -math.expm1(-0.7), -math.expm1(-1.3)
    np.testing.assert_allclose(light, (a, (1 - a) * b, 0.2 * a + 0.4 * (1 - a) * b), rtol=1e-5)
    assert alpha == pytest.approx(1 - (1 - a) * (1 - b), rel=1e-5)


def test_extinctions_add_where_volumes_overlap():
    one, other = slab((2, 1, 2), 3), slab((2, 3, 2), 5)
    seen = scene(
        one, medium(0.6, (1.0, 0.0, 0.0)), frontal(0.5), TINY,
        layers=Layer(other, medium(0.2, (0.0, 1.0, 0.0))),
    )  # fmt: skip
    light, alpha, _ = middle(draw(seen, step=0.01))
    assert alpha == pytest.approx(-math.expm1(-1.2), rel=1e-5)
    # Depths 0.2 of green, 0.6 and 0.2 together, 0.2 of green
    red = 0.75 * math.exp(-0.2) * -math.expm1(-0.8)
    np.testing.assert_allclose(light[:2], (red, alpha - red), rtol=1e-3)


def ramp(n=9):
    """Values from 0 to 1 along y, two units deep."""
    y = np.linspace(0, 1, n, dtype=np.float32)
    return volume(np.broadcast_to(y[None, :, None], (3, n, 3)).copy(), (1.0, 2 / (n - 1), 1.0))


STEEP = TransferFunction(
    None, ColourCurve([(0, 0.1, 0.2, 0.9), (0.4, 0.8, 0.3, 0.1), (1, 1, 1, 0)]),
    extinction=Curve([(0, 0), (0.25, 0), (0.5, 3), (0.6, 0.5), (1, 2)]),
)  # fmt: skip


def quadrature(density, channel):
    """Integral of T sigma_t c over the ramp, with exact optical depths of the piecewise line."""
    x = np.linspace(0, 1, 20001)
    sigma_t = density * STEEP.extinction(x)
    depth = np.concatenate([[0], np.cumsum((sigma_t[1:] + sigma_t[:-1]) / 2 * np.diff(x))]) * 2

    def source(s):
        shown = 1.0 if channel is None else float(STEEP.colour(s)[channel])
        seen = math.exp(-np.interp(s, x, depth))
        return 2 * seen * density * float(STEEP.extinction(s)) * shown

    return quad(source, 0, 1, points=[0.25, 0.4, 0.5, 0.6], epsabs=1e-9, limit=200)[0]


@pytest.mark.parametrize("density", [1.0, 8.0])
def test_linear_ramp_is_the_integral(density):
    exact = np.array([quadrature(density, c) for c in (0, 1, 2)])
    seen = scene(ramp(33), replace(STEEP, density_scale=density), frontal(0.5), TINY)
    for step, limit in ((4.0, 2e-3), (0.5, 4e-4)):
        light, alpha, _ = middle(draw(seen, step=step))
        # Opacity is exact at any step where the scalar is linear: it is integrated beforehand
        assert alpha == pytest.approx(quadrature(density, None), abs=2e-5)
        np.testing.assert_allclose(light, exact, atol=limit)


def test_error_goes_with_the_square_of_the_step():
    # Faint enough for no step to be looked at in parts
    exact = np.array([quadrature(0.15, c) for c in (0, 1, 2)])
    seen = scene(ramp(33), replace(STEEP, density_scale=0.15), frontal(0.5), TINY)
    pictures = [draw(seen, step=step) for step in (8.0, 4.0, 2.0)]
    assert all(p.work.looked_up == p.work.naive for p in pictures)
    errors = [np.abs(middle(p)[0] - exact).max() for p in pictures]
    # A step of twice the length: four times the error; half of that would be first order
    assert errors[0] > 2.8 * errors[1] > 2.8**2 * errors[2] > 0


def test_headlight_shades_as_the_formula_says():
    # A plane of known slope: normal (0, -cos a, sin a) against the view along +y
    n, a = 17, math.radians(25)
    z, y, _ = np.mgrid[:n, :n, :n] - n // 2
    values = (0.5 + 0.02 * (y * math.cos(a) - z * math.sin(a))).astype(np.float32)
    lamp = Phong(0.15, 0.6, 0.3, 8.0)
    white = TransferFunction(
        None, ColourCurve([(0, 0.5, 0.4, 0.1)]), extinction=Curve([(0, 0.05), (1, 0.05)])
    )
    seen = scene(volume(values), white, frontal(2.0), TINY, surface=Surface(phong=lamp))
    light, alpha, _ = middle(draw(seen))
    f = math.cos(a)
    glint = 0.3 * (2 * f * f - 1) ** 8
    expected = np.array((0.5, 0.4, 0.1)) * (0.15 + 0.6 * f) + glint
    np.testing.assert_allclose(light / alpha, expected, rtol=1e-3)
    # Without shading pure colour; without a surface as well
    plain = draw(replace(seen, surface=None))
    np.testing.assert_array_equal(draw(seen, shading="none").radiance, plain.radiance)
    np.testing.assert_allclose(middle(plain)[0] / alpha, (0.5, 0.4, 0.1), rtol=1e-4)


def test_light_above_one_is_cut_off_as_in_vtk():
    seen = scene(ramp(), STEEP, frontal(0.5), TINY, surface=Surface(phong=Phong(5.0, 0, 0, 1)))
    light, alpha, _ = middle(draw(seen))
    assert light[0] <= alpha * 1.00001


def test_the_mediums_own_light_is_added():
    # An opaque black body shows its radiance, one of albedo c (1 - c) of it beside its colour
    glow = ColourCurve([(0, 1.0, 0.5, 0.25)])
    hot = replace(medium(30.0, (0.0, 0.4, 1.0)), emission=glow, emission_scale=2.0)
    light, alpha, _ = middle(draw(scene(slab((2, 2, 2), 5), hot, frontal(0.5), TINY)))
    np.testing.assert_allclose(light / alpha, (2.0, 0.4 + 0.6, 1.0), rtol=1e-3)


def test_rays_of_a_pixel_are_spread_by_its_filter():
    # The edge of a box runs through pixels: a tenth covered, and the rest of the row
    seen = scene(slab((2, 2, 2), 5), medium(40.0), frontal(1.25), (25, 25), pixel_filter=BOX)
    covered = draw(seen, rays=20).alpha
    assert covered.mean() == pytest.approx((2 / 2.5) ** 2, rel=1e-3)
    # One ray: through the centre
    assert set(np.unique(draw(seen).alpha > 0.5)) == {False, True}
