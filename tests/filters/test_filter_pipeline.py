"""Filters behave as VTK users expect: ports, settings, life time."""

import gc
import subprocess
import sys
import weakref

import numpy as np
import pytest
from vtkmodules.vtkCommonCore import VTK_FLOAT, vtkVersion
from vtkmodules.vtkCommonDataModel import vtkDataObject
from vtkmodules.vtkImagingCore import vtkImageCast, vtkImageFlip
from vtkmodules.vtkRenderingCore import vtkCamera

from vtkmcvr.filters import MonteCarloFilter, ToneMapFilter
from vtkmcvr.vtk_bridge.scene import array_of_image

# Output and announcements


def test_output_is_the_film(pipeline):
    pipeline.source.SetWholeExtent(2, 9, -3, 5, 1, 9)
    pipeline.render.Update()
    output, picture = pipeline.render.GetOutputDataObject(0), pipeline.render.picture
    assert output.GetExtent() == (0, 31, 0, 23, 0, 0)
    assert output.GetOrigin() == (0, 0, 0)
    assert output.GetSpacing() == (1, 1, 1)
    assert output.GetPointData().GetScalars().GetName() == "radiance"
    radiance = array_of_image(output, "radiance")
    assert radiance.dtype == np.float32
    np.testing.assert_array_equal(radiance[..., :3], picture.radiance)
    np.testing.assert_array_equal(radiance[..., 3], picture.alpha)
    np.testing.assert_array_equal(array_of_image(output, "depth")[..., 0], picture.depth)
    np.testing.assert_array_equal(array_of_image(output, "standard_error"), picture.standard_error)
    assert picture.alpha.max() > 0
    assert pipeline.render.plan is picture.plan


def test_announced_information_is_what_comes(pipeline):
    pipeline.render.UpdateInformation()
    info = pipeline.render.GetOutputInformation(0)
    scalars = vtkDataObject.GetActiveFieldInformation(info, 0, 0)
    assert scalars.Get(vtkDataObject.FIELD_ARRAY_TYPE()) == VTK_FLOAT
    assert scalars.Get(vtkDataObject.FIELD_NUMBER_OF_COMPONENTS()) == 4
    cast = vtkImageCast()
    cast.SetInputConnection(pipeline.render.GetOutputPort())
    cast.SetOutputScalarTypeToDouble()
    cast.Update()
    assert cast.GetOutput().GetNumberOfScalarComponents() == 4
    assert cast.GetOutput().GetDimensions() == (32, 24, 1)


def test_geometry_of_the_volume_does_not_reach_the_film(pipeline):
    flip = vtkImageFlip()
    flip.SetInputConnection(pipeline.source.GetOutputPort())
    flip.Update()
    turned = flip.GetOutput()
    turned.SetDirectionMatrix(0, 1, 0, -1, 0, 0, 0, 0, 1)
    pipeline.render.SetInputDataObject(turned)
    pipeline.tone.Update()
    for output in (pipeline.render.GetOutputDataObject(0), pipeline.tone.GetOutputDataObject(0)):
        assert output.GetDirectionMatrix().IsIdentity()


@pytest.mark.skipif(not hasattr(vtkImageFlip, "__rrshift__"), reason="VTK before 9.4")
def test_composition_by_shift(pipeline):
    composed = pipeline.source >> pipeline.render >> ToneMapFilter(exposure=1.0)
    output = composed.update().output
    assert output.GetDimensions() == (32, 24, 1)
    assert output.GetPointData().GetScalars().GetName() == "rgba"
    flipped = (pipeline.source >> pipeline.render >> vtkImageFlip()).update().output
    assert flipped[0].GetDimensions() == (32, 24, 1)


# Settings


def test_properties_have_twins_in_vtks_style(pipeline):
    render = pipeline.render
    render.SetFilmSize(16, 12)
    assert render.film_size == render.GetFilmSize() == (16, 12)
    render.film_size = [8, 6]
    assert render.GetFilmSize() == (8, 6)
    time = render.GetMTime()
    render.SetFilmSize((8, 6))
    assert render.GetMTime() == time
    render.ambient = 0.5
    assert render.GetAmbient() == (0.5, 0.5, 0.5)
    assert render.GetMTime() > time
    assert "pixels" in MonteCarloFilter.film_size.__doc__
    assert "pixels" in MonteCarloFilter.SetFilmSize.__doc__


@pytest.mark.parametrize(
    ("name", "value", "error"),
    [
        ("film_size", (0, 4), ValueError),
        ("samples", 0, ValueError),
        ("seconds", -1, ValueError),
        ("seed", -1, ValueError),
        ("threads", 1.5, ValueError),
        ("volume_property", None, TypeError),
        ("camera", "front", TypeError),
        ("lights", [vtkCamera()], TypeError),
        ("ambient", (-1, 0, 0), ValueError),
        ("gradient_factor", 2, ValueError),
        ("scattering", "none", ValueError),
        ("max_scatterings", 0, ValueError),
        ("pixel_filter", "box", TypeError),
    ],
)
def test_bad_settings_are_refused_and_change_nothing(pipeline, name, value, error):
    before, time = getattr(pipeline.render, name), pipeline.render.GetMTime()
    with pytest.raises(error):
        setattr(pipeline.render, name, value)
    assert getattr(pipeline.render, name) == before
    assert pipeline.render.GetMTime() == time


def test_unknown_settings_are_refused():
    with pytest.raises(TypeError, match="MonteCarloFilter has no parameter 'spp'"):
        MonteCarloFilter(spp=4)
    with pytest.raises(TypeError, match="no parameter 'picture'"):
        MonteCarloFilter(picture=None)
    with pytest.raises(ValueError, match="sRGB from 0 to 1"):
        ToneMapFilter(background=(2, 0, 0))


# Life time


def test_filters_are_freed_with_their_observers(pipeline):
    pipeline.tone.Update()
    names = ("property", "opacity", "colour", "camera", "lights", "light")
    watched = [getattr(pipeline, name) for name in names]
    assert all(owner.HasObserver("ModifiedEvent") for owner in watched)
    freed = [weakref.ref(pipeline.render), weakref.ref(pipeline.tone)]
    volume = weakref.ref(pipeline.render.picture.plan.scene.volume)
    # VTK 9.2 keeps the attributes of what downstream outlives until it frees something else
    old = vtkVersion.GetVTKMinorVersion() < 3
    for name in ("tone", "render") if old else ("render", "tone"):
        delattr(pipeline, name)
    gc.collect()
    assert [ref() for ref in freed] == [None, None]
    assert volume() is None
    assert not any(owner.HasObserver("ModifiedEvent") for owner in watched)


def test_importing_the_filters_loads_neither_pyvista_nor_all_of_vtk():
    code = "import sys, vtkmcvr.filters; print({'pyvista', 'vtk'} & set(sys.modules))"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True)
    assert result.stdout.strip() == b"set()"


def test_a_filter_lives_while_only_downstream_refers_to_it(pipeline, traced):
    tone = pipeline.tone
    del pipeline.render
    gc.collect()
    tone.Update()
    assert len(traced) == 1
