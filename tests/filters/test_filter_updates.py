"""A filter traces rays when, and only when, a value changed that matters."""

import numpy as np
import pytest
from vtkmodules.vtkCommonCore import VTK_FLOAT
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkFiltersCore import vtkPassThrough
from vtkmodules.vtkRenderingCore import vtkCamera, vtkLight

from vtkmcvr.filters import MonteCarloFilter
from vtkmcvr.filters.dependencies import Dependencies
from vtkmcvr.scene import PixelFilter


def edited_new_opacity(p):
    opacity = vtkPiecewiseFunction()
    opacity.AddPoint(0, 0.1)
    p.property.SetScalarOpacity(opacity)
    p.tone.Update()
    p.opacity = opacity
    opacity.AddPoint(200, 0.9)


def new_camera(p):
    camera = vtkCamera()
    camera.SetPosition(0, 0, 60)
    p.render.SetCamera(camera)


def second_light(p):
    p.lights.AddItem(vtkLight())


MATTERS = {
    "opacity": lambda p: p.opacity.AddPoint(200, 0.1),
    "colour": lambda p: p.colour.AddRGBPoint(200, 0, 1, 0),
    "new opacity, edited later": edited_new_opacity,
    "unit distance": lambda p: p.property.SetScalarOpacityUnitDistance(3),
    "camera": lambda p: p.camera.Azimuth(10),
    "another camera": new_camera,
    "no camera": lambda p: setattr(p.render, "camera", None),
    "light": lambda p: p.light.SetIntensity(2),
    "second light": second_light,
    "film": lambda p: p.render.SetFilmSize(16, 12),
    "samples": lambda p: setattr(p.render, "samples", 3),
    "seed": lambda p: p.render.SetSeed(9),
    "pixel filter": lambda p: p.render.SetPixelFilter(PixelFilter("box", 0.5)),
    "input": lambda p: p.source.SetMaximum(200),
}

DOES_NOT = {
    "nothing": lambda p: None,
    "Modified": lambda p: p.render.Modified(),
    "clipping range": lambda p: p.camera.SetClippingRange(1, 1000),
    "camera time stamp": lambda p: p.camera.Modified(),
    "headlight that follows": lambda p: p.light.SetPosition(p.camera.GetPosition()),
    "same node": lambda p: p.opacity.AddPoint(250, 0.6),
    "threads": lambda p: p.render.SetThreads(1),
    "surfaces without shading": lambda p: p.render.SetGradientFactor(0.9),
    "same film": lambda p: p.render.SetFilmSize((32, 24)),
    "exposure": lambda p: p.tone.SetExposure(2.0),
    "gamma": lambda p: p.tone.SetGamma(1.8),
    "background": lambda p: p.tone.SetBackground(0.1, 0.2, 0.3),
}


def pull_by_vtk(p):
    """Update from a filter that knows nothing of ours."""
    sink = vtkPassThrough()
    sink.SetInputConnection(p.tone.GetOutputPort())
    return sink.Update


PULLS = {
    "own": lambda p: p.render.Update,
    "tone": lambda p: p.tone.Update,
    "vtk": pull_by_vtk,
}


@pytest.mark.parametrize("pull", PULLS)
@pytest.mark.parametrize("edit", MATTERS)
def test_traces_once_for_a_change(pipeline, traced, edit, pull):
    update = PULLS[pull](pipeline)
    update()
    assert len(traced) == 1
    MATTERS[edit](pipeline)
    before = len(traced)
    update()
    update()
    assert len(traced) == before + 1


@pytest.mark.parametrize("edit", DOES_NOT)
def test_traces_nothing_without_a_change_of_value(pipeline, traced, edit):
    pipeline.tone.Update()
    picture = pipeline.render.picture
    DOES_NOT[edit](pipeline)
    pipeline.tone.Update()
    pipeline.render.Update()
    assert len(traced) == 1
    assert pipeline.render.picture is picture


def test_what_was_detached_no_longer_matters(pipeline):
    pipeline.render.SetCamera(vtkCamera())
    time = pipeline.render.GetMTime()
    pipeline.camera.Azimuth(20)
    assert pipeline.render.GetMTime() == time


def test_voxels_are_prepared_once_for_an_input(pipeline, prepared):
    pipeline.tone.Update()
    for edit in ("opacity", "colour", "camera", "film"):
        MATTERS[edit](pipeline)
        pipeline.tone.Update()
    assert len(prepared) == 1
    pipeline.source.SetMaximum(200)
    pipeline.tone.Update()
    assert len(prepared) == 2


def test_input_edited_in_place(traced):
    image = vtkImageData()
    image.SetDimensions(4, 4, 4)
    image.AllocateScalars(VTK_FLOAT, 1)
    image.GetPointData().GetScalars().Fill(1)
    render = MonteCarloFilter(film_size=(8, 6), samples=1)
    render.SetInputDataObject(image)
    render.Update()
    image.GetPointData().GetScalars().SetValue(5, 7)
    render.Update()
    assert len(traced) == 1
    image.GetPointData().GetScalars().Modified()
    render.Update()
    assert len(traced) == 2


def test_a_change_without_an_event_is_seen_by_polling(pipeline):
    table = vtkImageData()
    table.SetDimensions(2, 2, 1)
    table.AllocateScalars(VTK_FLOAT, 4)
    pipeline.property.SetTransferFunction2D(table)
    dependencies = Dependencies(pipeline.render)
    dependencies.watch("volume_property", pipeline.property)
    time = pipeline.render.GetMTime()
    dependencies.poll()
    assert pipeline.render.GetMTime() == time
    table.GetPointData().GetScalars().Modified()
    assert pipeline.render.GetMTime() == time
    dependencies.poll()
    assert pipeline.render.GetMTime() > time


def test_picture_is_the_same_after_a_change_and_back(pipeline):
    pipeline.render.Update()
    first = pipeline.render.picture.radiance
    pipeline.opacity.AddPoint(200, 0.9)
    pipeline.render.Update()
    assert not np.array_equal(pipeline.render.picture.radiance, first)
    pipeline.opacity.RemovePoint(200)
    pipeline.render.Update()
    np.testing.assert_array_equal(pipeline.render.picture.radiance, first)
