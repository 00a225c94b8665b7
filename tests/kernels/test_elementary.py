"""Elementary functions of kernels beside those of NumPy in float64."""

import numpy as np
import pytest

from vtkmcvr.kernels import elementary
from vtkmcvr.kernels.jit import entry_point

f32 = np.float32
UNIT = np.concatenate([np.linspace(0, 1, 20_001), np.geomspace(1e-30, 1, 2001)]).astype(f32)
REACH = np.concatenate([np.linspace(0, 87, 20_001), np.geomspace(1e-30, 87, 2001)]).astype(f32)
# A unit in the last place of numbers just below 1
ULP = 2.0**-24


@entry_point
def tabulate(x):
    out = np.empty((len(x), 3), np.float32)
    for i in range(len(x)):
        out[i, 0] = elementary.decay(x[i])
        out[i, 1] = elementary.opacity(x[i])
        out[i, 2] = elementary.logarithm(x[i])
    return out


@entry_point
def tabulate_unit(u):
    out = np.empty((len(u), 5), np.float32)
    for i in range(len(u)):
        out[i, 0] = elementary.logarithm_of_rest(u[i])
        out[i, 1], out[i, 2] = elementary.on_circle(u[i])
        out[i, 3], out[i, 4] = elementary.cosine_and_sine(np.float32(2) * u[i] - np.float32(1))
    return out


@entry_point
def tabulate_angle(x, y):
    out = np.empty(len(x), np.float32)
    for i in range(len(x)):
        out[i] = elementary.angle(x[i], y[i])
    return out


def test_decay_is_the_exponential():
    # The argument in halvings is rounded to float32: half a ulp of it is x ULP of the result
    x = REACH.astype(float)
    found = tabulate(REACH)[:, 0]
    assert (np.abs(found * np.exp(x) - 1) < 6 * ULP + 2 * x * ULP).all()


@pytest.mark.parametrize("x", [88.0, 1e10, 3e38, np.inf])
def test_decay_ends_at_zero(x):
    decay, opacity, _ = tabulate(np.array([x], f32))[0]
    assert (decay, opacity) == (0, 1)


def test_opacity_is_precise_next_to_zero():
    x = REACH[REACH > 0].astype(float)
    found = tabulate(REACH[REACH > 0])[:, 1]
    assert (np.abs(found / -np.expm1(-x) - 1) < 8 * ULP).all()
    assert tabulate(np.zeros(1, f32))[0, 1] == 0


def test_logarithm():
    x = REACH[REACH > 0]
    exact, found = np.log(x.astype(float)), tabulate(x)[:, 2]
    # Around 1 the result is as small as the rounding of the argument lets it be
    assert (np.abs(found - exact) < 6 * ULP * np.maximum(np.abs(exact), ULP)).all()


def test_logarithm_of_what_is_left_of_one():
    u = UNIT[UNIT < 1]
    exact, found = np.log1p(-u.astype(float)), tabulate_unit(u)[:, 0]
    assert (np.abs(found - exact) <= 8 * ULP * np.abs(exact)).all()
    # Nothing left: as little as makes every power of it vanish
    assert -np.inf < tabulate_unit(np.ones(1, f32))[0, 0] < -80


def test_points_of_the_circle():
    found = tabulate_unit(UNIT).astype(float)
    turn = 2 * np.pi * UNIT.astype(float)
    assert np.abs(found[:, 1] - np.cos(turn)).max() < 4 * ULP
    assert np.abs(found[:, 2] - np.sin(turn)).max() < 4 * ULP
    quarter = np.pi / 4 * (2 * UNIT - f32(1)).astype(float)
    assert np.abs(found[:, 3] - np.cos(quarter)).max() < 4 * ULP
    assert np.abs(found[:, 4] - np.sin(quarter)).max() < 4 * ULP


def test_angle():
    turn = np.linspace(-np.pi, np.pi, 40_001)
    for radius in (1e-18, 1.0, 1e18):
        x, y = (radius * f(turn) for f in (np.cos, np.sin))
        x, y = x.astype(f32), y.astype(f32)
        exact = np.arctan2(y.astype(float), x.astype(float))
        assert np.abs(tabulate_angle(x, y) - exact).max() < 4e-7
    axes = np.array([(1, 0), (0, 1), (-1, 0), (0, -1), (0, 0), (1, 1e-30)], f32)
    found = tabulate_angle(axes[:, 0].copy(), axes[:, 1].copy())
    np.testing.assert_allclose(found, np.arctan2(axes[:, 1], axes[:, 0]), rtol=1e-6)
