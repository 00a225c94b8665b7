"""Tools that edit a live scene: each changes something of VTK's, and the picture begins anew.

Clip planes need none: `plotter.add_volume_clip_plane` works as it is.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pyvista as pv
from numpy.typing import NDArray
from vtkmodules.vtkChartsCore import vtkPiecewiseControlPointsItem
from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction

from ..live.job import Job
from ..vtk_bridge.props import volumes_of

# Handle of a lamp, over the size of the volumes
HANDLE = 0.04
# Points of a chart that one can still tell apart, and how far a curve may move to get there
MOST_POINTS, TOLERANCE = 24, 0.004
CHART_SIZE, CHART_PLACE = (0.42, 0.3), (0.56, 0.68)
BUTTONS = {
    "left": "LeftButtonPressEvent",
    "middle": "MiddleButtonPressEvent",
    "right": "RightButtonPressEvent",
}
# Pixels around the one that is clicked in which depth is averaged
AROUND = 1


def add_light_widget(plotter: Any, position: Any, intensity: float) -> pv.Light:
    """Lamp in the active subplot that shines all around, with a handle to drag it by.

    Parameters
    ----------
    plotter : pyvista.Plotter
    position : 3 floats, optional
        Default: above the volumes, toward the camera.
    intensity : float
        As of any `pyvista.Light`: it does not fall with distance.

    Returns
    -------
    pyvista.Light
    """
    low, high = np.reshape(plotter.bounds, (3, 2)).T
    centre, size = (low + high) / 2, float(np.linalg.norm(high - low))
    if position is None:
        toward = np.subtract(plotter.camera.position, centre)
        up = np.array(plotter.camera.up)
        position = centre + size * (0.5 * toward / np.linalg.norm(toward) + 0.4 * up)
    lamp = pv.Light(
        position=position, focal_point=centre, light_type="scene light", positional=True,
        cone_angle=180, intensity=intensity,
    )  # fmt: skip
    plotter.add_light(lamp)

    def move(place: Any) -> None:
        lamp.position = place

    plotter.add_sphere_widget(
        move, center=position, radius=HANDLE * size, color="gold", test_callback=False,
        interaction_event="always",
    )  # fmt: skip
    return lamp


def add_opacity_editor(plotter: pv.Plotter, volume: Any) -> pv.Chart2D:
    """Chart of a volume's scalar opacity in the active subplot.

    A point is dragged by the left button, added by a click on the curve, removed by the middle
    button. A function of many points, such as PyVista makes, is first reduced to few.

    Parameters
    ----------
    plotter : pyvista.Plotter
    volume : pyvista.Volume, optional
        Default: the only one of the subplot.

    Returns
    -------
    pyvista.Chart2D
        `plotter.remove_chart` removes it.
    """
    if volume is None:
        found = volumes_of(plotter.renderer)
        if len(found) != 1:
            raise ValueError(f"the subplot has {len(found)} volumes: say which one to edit")
        volume = found[0]
    function = volume.GetProperty().GetScalarOpacity()
    _reduce(function)
    points = vtkPiecewiseControlPointsItem()
    points.SetPiecewiseFunction(function)
    chart = pv.Chart2D(size=CHART_SIZE, loc=CHART_PLACE, x_label="", y_label="opacity")
    chart.AddPlot(points)
    chart.x_range, chart.y_range = function.GetRange(), (0.0, 1.05)
    chart.background_color = (1.0, 1.0, 1.0, 0.6)
    plotter.add_chart(chart)
    plotter.set_chart_interaction(chart)
    return chart


def simplified(nodes: NDArray[np.float64], most: int = MOST_POINTS) -> NDArray[np.float64]:
    """Nodes of a polyline that keep it within a tolerance (Ramer 1972, Douglas and Peucker 1973).

    Parameters
    ----------
    nodes : array (n, 2)
        Increasing x.
    most : int
        The tolerance is doubled until there are no more nodes.
    """
    scale = np.array([np.ptp(nodes[:, 0]) or 1.0, 1.0])
    tolerance = TOLERANCE
    while True:
        kept = nodes[_kept(nodes / scale, tolerance)]
        if len(kept) <= most:
            return kept
        tolerance *= 2


def _kept(nodes: NDArray[np.float64], tolerance: float) -> NDArray[np.bool_]:
    keep = np.zeros(len(nodes), bool)
    keep[[0, -1]] = True
    parts = [(0, len(nodes) - 1)]
    while parts:
        first, last = parts.pop()
        if last - first < 2:
            continue
        x, y = nodes[first : last + 1].T
        off = np.abs(y - np.interp(x, x[[0, -1]], y[[0, -1]]))
        middle = first + int(off.argmax())
        if off.max() > tolerance:
            keep[middle] = True
            parts += [(first, middle), (middle, last)]
    return keep


def _reduce(function: vtkPiecewiseFunction) -> None:
    count = function.GetSize()
    if count <= MOST_POINTS:
        return
    rows: list[list[float]] = [[0.0] * 4 for _ in range(count)]
    for index, row in enumerate(rows):
        function.GetNodeValue(index, row)
    kept = simplified(np.array(rows)[:, :2])
    function.RemoveAllPoints()
    for x, y in kept:
        function.AddPoint(x, y)


def focus_distance(job: Any, column: int, row: int) -> float:
    """Distance along the view axis of what is seen around a pixel.

    The mean depth of first collisions in the pixel and its neighbours; where there are none, that
    of a mesh.

    Raises
    ------
    RuntimeError
        Where there is no picture yet.
    ValueError
        Where nothing is seen, or the technique knows no depth.
    """
    if job is None:
        raise RuntimeError("there is no picture yet: show the plotter first")
    if not isinstance(job, Job):
        raise ValueError("only technique monte-carlo has a lens to focus")
    film = job.film
    height, width = film.count.shape
    if not (0 <= column < width and 0 <= row < height):
        raise ValueError(f"pixel ({column}, {row}) is not on the film of {width} x {height}")
    there = np.s_[
        max(row - AROUND, 0) : row + AROUND + 1, max(column - AROUND, 0) : column + AROUND + 1
    ]
    hits = film.hits[there]
    if hits.any():
        depth = float((film.depth[there] * hits).sum() / hits.sum())
        return depth * _cosine(job, column, row)
    backdrop = job.plan.scene.backdrop
    if backdrop is not None and np.isfinite(backdrop.depth[:, row, column]).any():
        return float(backdrop.depth[:, row, column].min())
    raise ValueError(f"nothing to focus on: pixel ({column}, {row}) shows neither volume nor mesh")


def _cosine(job: Job, column: int, row: int) -> float:
    """Cosine between the view axis and the ray of a pixel's centre."""
    camera = job.plan.packed.camera
    heading = np.array(camera.direction)
    heading = heading + (column + 0.5) * np.array(camera.direction_x)
    heading = heading + (row + 0.5) * np.array(camera.direction_y)
    return float(heading @ job.plan.scene.camera.frame[2] / np.linalg.norm(heading))


class FocusPicking:
    """Calls back with what is clicked.

    Parameters
    ----------
    plotter : pyvista.Plotter
    focus : callable
        Called with renderer, column and row from the upper left corner.
    button : {"left", "middle", "right"}
    """

    def __init__(self, plotter: Any, focus: Callable[[Any, int, int], object], button: str) -> None:
        if button not in BUTTONS:
            raise ValueError(f"button is one of {', '.join(BUTTONS)}; got {button!r}")
        self._focus, self._interactor = focus, plotter.iren.interactor
        self._tag = self._interactor.AddObserver(BUTTONS[button], self._click)

    def close(self) -> None:
        """Listen no more."""
        self._interactor.RemoveObserver(self._tag)

    def _click(self, *_: Any) -> None:
        x, y = self._interactor.GetEventPosition()
        renderer = self._interactor.FindPokedRenderer(x, y)
        left, low = renderer.GetOrigin()
        try:
            self._focus(renderer, x - left, renderer.GetSize()[1] - 1 - (y - low))
        except ValueError:
            # A click beside everything focuses on nothing
            return
