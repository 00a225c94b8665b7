"""Light handle, opacity editor, focus picking: what each changes, and that the picture follows."""

import numpy as np
import pytest
import pyvista as pv
from plotters import SIZE, add, look, pixels, plotter

from vtkmcvr.pyvista_hooks.tools import simplified


@pytest.fixture
def target():
    result = plotter()
    add(result)
    look(result)
    result.mcvr.enable(samples=8)
    result.show(auto_close=False)
    yield result
    result.close()


def restarts(target):
    return target.mcvr._live.views[0].restarts


def test_a_dragged_handle_moves_its_lamp(target):
    lamp = target.mcvr.add_light_widget(intensity=2.0)
    lit = pixels(target)
    widget = target.widgets.sphere_widgets[0]
    before = restarts(target)
    widget.SetCenter(-4, -5, 2)
    widget.InvokeEvent("InteractionEvent")
    moved = pixels(target)
    assert lamp.position == (-4, -5, 2)
    assert restarts(target) == before + 1
    # Light from the other side: right of the middle it gets darker, left of it brighter
    change = (moved - lit)[20:52].mean(axis=(0, 2))
    assert change[36:44].mean() > change[54:62].mean()


def test_points_of_the_opacity_chart_are_the_volumes_own(target):
    volume = next(a for a in target.actors.values() if isinstance(a, pv.Volume))
    chart = target.mcvr.add_opacity_editor()
    function = volume.GetProperty().GetScalarOpacity()
    assert function.GetSize() < 10
    before, done = pixels(target), restarts(target)
    points = chart.GetPlot(0)
    points.AddPoint(np.array([0.5, 0.9]))
    assert function.GetValue(0.5) == pytest.approx(0.9)
    after = pixels(target)
    assert restarts(target) == done + 1
    assert np.abs(after - before).max() > 10


def test_reduced_curves_stay_close():
    x = np.linspace(0, 1, 256)
    curve = np.column_stack([x, 1 / (1 + np.exp(-20 * (x - 0.5)))])
    few = simplified(curve)
    assert len(few) <= 24
    assert np.abs(np.interp(x, *few.T) - curve[:, 1]).max() < 0.01
    steps = np.column_stack([x, np.random.default_rng(1).random(256)])
    assert len(simplified(steps)) <= 24


def test_focus_is_where_the_blob_is(target):
    middle = (SIZE[0] // 2, SIZE[1] // 2)
    distance = target.mcvr.focus_at(*middle, aperture=0.3)
    nearest = np.linalg.norm((2.5, 3.0, 6.0)) - 1.0
    assert nearest < distance < nearest + 1.2
    assert target.mcvr.settings.lens.focus_distance == distance
    with pytest.raises(ValueError, match="nothing to focus on"):
        target.mcvr.focus_at(0, 0, aperture=0.3)


def test_a_click_focuses(target):
    target.mcvr.enable_focus_picking(aperture=0.2)
    interactor = target.iren.interactor
    interactor.SetEventInformation(SIZE[0] // 2, SIZE[1] // 2, 0, 0)
    interactor.InvokeEvent("RightButtonPressEvent")
    lens = target.mcvr.settings.lens
    assert lens is not None and lens.radius == 0.2
    # A click beside the blob changes nothing
    interactor.SetEventInformation(1, 1, 0, 0)
    interactor.InvokeEvent("RightButtonPressEvent")
    assert target.mcvr.settings.lens is lens


def test_tools_need_a_live_picture():
    result = plotter()
    with pytest.raises(RuntimeError, match=r"enable\(\) first"):
        result.mcvr.add_light_widget()
    add(result)
    add(result)
    result.mcvr.enable(samples=1)
    with pytest.raises(ValueError, match="2 volumes"):
        result.mcvr.add_opacity_editor()
    result.close()
