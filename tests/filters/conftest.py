"""A small pipeline, and how often it traced rays. All its pictures have one set of effects."""

from types import SimpleNamespace

import pytest
from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction
from vtkmodules.vtkImagingCore import vtkRTAnalyticSource
from vtkmodules.vtkRenderingCore import (
    vtkCamera,
    vtkColorTransferFunction,
    vtkLight,
    vtkLightCollection,
    vtkVolumeProperty,
)

from vtkmcvr import voxels
from vtkmcvr.filters import MonteCarloFilter, ToneMapFilter, monte_carlo
from vtkmcvr.pictures.picture import Picture


def counted(monkeypatch, module, name):
    calls, original = [], getattr(module, name)

    def wrapper(*args, **kwargs):
        calls.append(args)
        return original(*args, **kwargs)

    monkeypatch.setattr(module, name, wrapper)
    return calls


@pytest.fixture
def traced(monkeypatch):
    """One entry for each time that rays are traced."""
    calls = counted(monkeypatch, monte_carlo, "render_scene")
    original = Picture.refine

    def refine(*args, **kwargs):
        calls.append(args)
        return original(*args, **kwargs)

    monkeypatch.setattr(Picture, "refine", refine)
    return calls


@pytest.fixture
def prepared(monkeypatch):
    """One entry for each look at all voxels."""
    return counted(monkeypatch, voxels, "_prepare")


def a_property():
    opacity, colour = vtkPiecewiseFunction(), vtkColorTransferFunction()
    opacity.AddPoint(130, 0.0)
    opacity.AddPoint(250, 0.6)
    colour.AddRGBPoint(100, 0.9, 0.4, 0.2)
    colour.AddRGBPoint(250, 0.9, 0.9, 0.8)
    result = vtkVolumeProperty()
    result.SetScalarOpacity(opacity)
    result.SetColor(colour)
    return result


@pytest.fixture
def pipeline():
    """Source -> Monte Carlo filter -> tone mapping, with the objects they depend on."""
    source = vtkRTAnalyticSource()
    source.SetWholeExtent(-6, 6, -6, 6, -6, 6)
    camera, light = vtkCamera(), vtkLight()
    camera.SetPosition(4, 6, 45)
    light.SetLightTypeToHeadlight()
    lights = vtkLightCollection()
    lights.AddItem(light)
    render = MonteCarloFilter(
        film_size=(32, 24),
        samples=2,
        volume_property=a_property(),
        camera=camera,
        lights=lights,
    )
    render.SetInputConnection(source.GetOutputPort())
    tone = ToneMapFilter()
    tone.SetInputConnection(render.GetOutputPort())
    return SimpleNamespace(
        source=source, render=render, tone=tone, camera=camera, light=light, lights=lights,
        property=render.volume_property, opacity=render.volume_property.GetScalarOpacity(),
        colour=render.volume_property.GetRGBTransferFunction(),
    )  # fmt: skip
