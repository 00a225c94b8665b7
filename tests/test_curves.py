"""Curves against vtkPiecewiseFunction and vtkColorTransferFunction, every branch."""

import numpy as np
import pytest
from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction
from vtkmodules.vtkRenderingCore import vtkColorTransferFunction

from vtkmcvr.curves import ColourCurve, Curve

SHARPNESS = (0.0, 0.005, 0.009, 0.01, 0.3, 0.5, 0.99, 0.995, 1.0)
MIDPOINTS = (0.0, 1e-6, 0.2, 0.5, 0.9, 1.0)


def positions(nodes, rng):
    """Between, outside and exactly on the nodes, but not on a position that two nodes share."""
    xs = np.array([node[0] for node in nodes])
    low, high = xs.min() - 1, xs.max() + 1
    x = np.concatenate([rng.uniform(low, high, 200), xs, (xs[1:] + xs[:-1]) / 2])
    shared = [v for v in xs if np.count_nonzero(xs == v) > 1]
    return x[~np.isin(x, shared)]


def random_nodes(rng, width, duplicates):
    n = int(rng.integers(1, 7))
    x = np.round(rng.uniform(-1000, 3000, n), 3)
    if duplicates and n > 2:
        x[1] = x[0]
    rows = []
    for at in x:
        shape = (rng.choice(MIDPOINTS), rng.choice(SHARPNESS))
        rows.append((at, *rng.random(width), *shape))
    return [rows[i] for i in np.argsort(x, kind="stable")]


def vtk_piecewise(nodes, clamp):
    function = vtkPiecewiseFunction()
    function.AllowDuplicateScalarsOn()
    function.SetClamping(clamp)
    for node in nodes:
        function.AddPoint(*node)
    return function


def vtk_colour(nodes, clamp):
    function = vtkColorTransferFunction()
    function.AllowDuplicateScalarsOn()
    function.SetColorSpaceToRGB()
    function.SetClamping(clamp)
    for node in nodes:
        function.AddRGBPoint(*node)
    return function


@pytest.mark.parametrize("clamp", [True, False])
@pytest.mark.parametrize("duplicates", [True, False])
def test_curve_is_vtks_piecewise_function(clamp, duplicates):
    rng = np.random.default_rng(1)
    for _ in range(150):
        nodes = random_nodes(rng, 1, duplicates)
        x = positions(nodes, rng)
        function = vtk_piecewise(nodes, clamp)
        expected = [function.GetValue(v) for v in x]
        np.testing.assert_allclose(Curve(nodes, clamp)(x), expected, atol=1e-9, err_msg=str(nodes))


@pytest.mark.parametrize("clamp", [True, False])
@pytest.mark.parametrize("duplicates", [True, False])
def test_colour_curve_is_vtks_colour_transfer_function(clamp, duplicates):
    rng = np.random.default_rng(2)
    for _ in range(150):
        nodes = random_nodes(rng, 3, duplicates)
        x = positions(nodes, rng)
        function = vtk_colour(nodes, clamp)
        expected = [function.GetColor(v) for v in x]
        found = ColourCurve(nodes, clamp)(x)
        np.testing.assert_allclose(found, expected, atol=1e-9, err_msg=str(nodes))


def test_curve_keeps_the_shape_of_its_argument():
    curve = Curve([(0, 0), (1, 1)])
    assert np.shape(curve(0.5)) == ()
    assert curve(np.zeros((2, 3))).shape == (2, 3)
    assert ColourCurve([(0, 1, 1, 1)])(np.zeros((2, 3))).shape == (2, 3, 3)


def test_vertical_edge_steps_at_its_place():
    curve = Curve([(0, 0), (1, 0), (1, 1), (2, 1)])
    assert curve([0.5, 1 - 1e-12, 1 + 1e-12, 1.5]).tolist() == [0, 0, 1, 1]


def test_order_of_nodes_does_not_matter_but_at_one_place():
    nodes = [(3, 0.2), (1, 0.5), (2, 0.9)]
    x = np.linspace(0, 4, 50)
    assert Curve(nodes)(x).tolist() == Curve(sorted(nodes))(x).tolist()
    assert Curve([(1, 1), (1, 0)])(2.0) == 0


def test_finest_step():
    assert Curve([(0, 0), (1, 0), (1, 1), (1.25, 0)]).finest_step == 0.25
    assert Curve([(5, 1)]).finest_step == np.inf


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Curve([]), "at least one node"),
        (lambda: Curve([(0, 1, 0.5)]), r"2 numbers \(or 4.*\(0.0, 1.0, 0.5\)"),
        (lambda: Curve([(0, np.nan)]), "finite"),
        (lambda: ColourCurve([(0, 1, 1)]), "4 numbers"),
        (lambda: ColourCurve([(0, 1, 1, 1.5)]), "0 to 1.*1.5"),
        (lambda: ColourCurve([(0, 1, -0.1, 1)]), "0 to 1.*-0.1"),
    ],
)
def test_bad_nodes_are_named(make, words):
    with pytest.raises(ValueError, match=words):
        make()
