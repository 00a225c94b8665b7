"""What a caller sees of errors, progress and abort."""

import logging

import numpy as np
import pytest
from vtkmodules.vtkCommonCore import vtkCommand
from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkImagingCore import vtkImageFlip

from vtkmcvr.filters import MonteCarloFilter, ToneMapFilter
from vtkmcvr.vtk_bridge.scene import array_of_image

# Errors


def make_it_fail(pipeline):
    pipeline.property.SetScalarOpacity(vtkPiecewiseFunction())


@pytest.mark.parametrize("name", ["render", "tone"])
def test_exceptions_reach_the_caller_and_clear_the_output(pipeline, name):
    updated = getattr(pipeline, name)
    updated.Update()
    make_it_fail(pipeline)
    for _ in range(2):
        with pytest.raises(ValueError, match="has no nodes; add points"):
            updated.Update()
        assert pipeline.render.GetOutputDataObject(0).GetNumberOfPoints() == 0
    pipeline.property.SetScalarOpacity(pipeline.opacity)
    updated.Update()
    assert updated.GetOutputDataObject(0).GetNumberOfPoints() == 32 * 24


def test_errors_seen_from_a_vtk_filter_are_events_or_logged(pipeline, caplog):
    make_it_fail(pipeline)
    flip = vtkImageFlip()
    flip.SetInputConnection(pipeline.render.GetOutputPort())
    with caplog.at_level(logging.ERROR, "vtkmcvr"):
        flip.Update()
    assert "MonteCarloFilter: ValueError: the vtkPiecewiseFunction has no nodes" in caplog.text
    heard = []

    def on_error(caller, event, text):
        heard.append(text)

    on_error.CallDataType = "string0"
    pipeline.render.AddObserver(vtkCommand.ErrorEvent, on_error)
    pipeline.render.Modified()
    flip.Update()
    assert heard == ["ValueError: the vtkPiecewiseFunction has no nodes; add points to it"]


def test_input_is_checked_before_anything_runs(pipeline, traced):
    with pytest.raises(ValueError, match=r"MonteCarloFilter has no input: call SetInputConnection"):
        MonteCarloFilter().Update()
    sphere = vtkSphereSource()
    pipeline.render.SetInputConnection(sphere.GetOutputPort())
    with pytest.raises(TypeError, match="takes a vtkImageData, its input gives vtkPolyData"):
        pipeline.tone.Update()
    assert not traced


def test_tone_mapping_asks_for_radiance(pipeline):
    tone = ToneMapFilter()
    tone.SetInputConnection(pipeline.source.GetOutputPort())
    with pytest.raises(ValueError, match="no point array 'radiance'"):
        tone.Update()


# Progress and abort


def test_progress_rises_to_one(pipeline):
    seen, render = [], pipeline.render
    render.samples = 300
    render.AddObserver("ProgressEvent", lambda caller, _: seen.append(caller.GetProgress()))
    render.Update()
    assert seen == sorted(seen)
    assert seen[0] == 0.0
    assert seen[-1] == 1.0
    assert len(seen) > 3


def test_an_aborted_run_is_a_valid_picture_and_not_kept(pipeline, traced):
    render = pipeline.render
    render.samples = 1_000_000

    def stop(caller, _):
        if caller.picture is None and caller.GetProgress() > 0:
            caller.SetAbortExecute(1)

    render.AddObserver("ProgressEvent", stop)
    pipeline.tone.Update()
    assert render.picture.stopped_by == "user"
    assert 0 < render.picture.samples < 1_000_000
    radiance = array_of_image(render.GetOutputDataObject(0), "radiance")
    np.testing.assert_array_equal(radiance[..., :3], render.picture.radiance)
    assert pipeline.tone.GetOutputDataObject(0).GetNumberOfPoints() == 32 * 24
    pipeline.tone.Update()
    assert len(traced) == 1
    render.SetAbortExecute(0)
    render.samples = 2
    pipeline.tone.Update()
    assert render.picture.stopped_by == "samples"
    assert len(traced) == 2


def test_keyboard_interrupt_reaches_the_caller(pipeline):
    def render(scene):
        raise KeyboardInterrupt

    pipeline.render.render = render
    with pytest.raises(KeyboardInterrupt):
        pipeline.tone.Update()
