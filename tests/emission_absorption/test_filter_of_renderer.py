"""`EmissionAbsorptionFilter.from_renderer` shows what VTK's own mapper shows."""

import numpy as np
import pytest
from vtk_pictures import GPU, SIZE, by_vtk, camera_on, difference, image, look, lopsided
from vtkmodules.vtkCommonExecutionModel import vtkTrivialProducer
from vtkmodules.vtkRenderingCore import vtkRenderer, vtkRenderWindow, vtkVolume

from vtkmcvr.emission_absorption import EmissionAbsorption
from vtkmcvr.filters import EmissionAbsorptionFilter
from vtkmcvr.vtk_bridge.scene import array_of_image


@pytest.fixture
def renderer():
    """A renderer of the film's size with one volume."""
    made, window, mapper, source = vtkRenderer(), vtkRenderWindow(), GPU(), vtkTrivialProducer()
    data = image(lopsided())
    source.SetOutput(data)
    mapper.SetInputConnection(source.GetOutputPort())
    volume = vtkVolume()
    volume.SetMapper(mapper)
    volume.SetProperty(look(0.0, 1.0))
    made.AddVolume(volume)
    made.SetActiveCamera(camera_on(data.GetCenter(), 120.0))
    window.SetSize(*SIZE)
    window.AddRenderer(made)
    yield made
    window.RemoveRenderer(made)


def test_filter_of_a_renderer_shows_what_vtk_shows(renderer):
    volume = next(iter(renderer.GetVolumes()))
    drawn = by_vtk(
        image(lopsided()), volume.GetProperty(), GPU(), renderer.GetActiveCamera(), 0.1
    )  # fmt: skip
    ours = EmissionAbsorptionFilter.from_renderer(
        renderer, emission_absorption=EmissionAbsorption(0.1)
    )
    ours.Update()
    shown = array_of_image(ours.GetOutputDataObject(0), "radiance")
    # Colours to rounding, not as reflectances in linear light
    assert difference(np.clip(shown, 0, 1), drawn) < 1.0
    assert shown[..., 3].max() > 0.5
    table = ours.GetOutputDataObject(1)
    assert table.GetColumnByName("stopped_by").GetValue(0) == "end"
    assert np.isnan(table.GetColumnByName("nrms").GetValue(0))
