"""The denoising filter: the picture's own noise reduction, and no ray for it."""

import numpy as np
import pytest

from vtkmcvr.filters import DenoiseFilter
from vtkmcvr.vtk_bridge.scene import array_of_image


@pytest.fixture
def denoised(pipeline):
    """Source -> Monte Carlo -> noise reduction -> tone mapping."""
    pipeline.denoise = DenoiseFilter()
    pipeline.denoise.SetInputConnection(pipeline.render.GetOutputPort())
    pipeline.tone.SetInputConnection(pipeline.denoise.GetOutputPort())
    return pipeline


def test_it_is_the_pictures_own(denoised):
    denoised.tone.Update()
    picture = denoised.render.picture.denoised("knn")
    output = denoised.denoise.GetOutputDataObject(0)
    radiance = array_of_image(output, "radiance")
    np.testing.assert_array_equal(radiance[..., :3], picture.radiance)
    np.testing.assert_array_equal(radiance[..., 3], picture.alpha)
    shown = array_of_image(denoised.tone.GetOutputDataObject(0), "rgba")
    np.testing.assert_array_equal(shown, picture.rgba)


def test_it_says_what_it_did_and_leaves_the_rest(denoised):
    denoised.denoise.Update()
    output = denoised.denoise.GetOutputDataObject(0)
    assert output.GetFieldData().GetAbstractArray("denoised").GetValue(0) == "knn"
    measured = denoised.render.GetOutputDataObject(0)
    assert measured.GetFieldData().GetAbstractArray("denoised") is None
    assert output.GetDimensions() == measured.GetDimensions()
    for name in ("depth", "standard_error"):
        np.testing.assert_array_equal(array_of_image(output, name), array_of_image(measured, name))
    assert not np.array_equal(
        array_of_image(output, "radiance"), array_of_image(measured, "radiance")
    )
    assert output.GetPointData().GetScalars().GetName() == "radiance"


def test_its_edits_trace_no_ray(denoised, traced):
    denoised.tone.Update()
    before = array_of_image(denoised.tone.GetOutputDataObject(0), "rgba").copy()
    denoised.denoise.SetExposure(3.0)
    denoised.tone.SetGamma(1.0)
    denoised.tone.Update()
    assert len(traced) == 1
    assert not np.array_equal(array_of_image(denoised.tone.GetOutputDataObject(0), "rgba"), before)


def test_open_image_denoise_is_guided_where_the_film_has_aovs(denoised):
    pytest.importorskip("pyoidn", reason="Open Image Denoise is not installed")
    denoised.denoise.method = "oidn"
    denoised.render.aovs = ("albedo", "normal")
    denoised.denoise.Update()
    picture = denoised.render.picture
    output = denoised.denoise.GetOutputDataObject(0)
    np.testing.assert_array_equal(array_of_image(output, "normal"), picture.normal)
    radiance = array_of_image(output, "radiance")[..., :3]
    np.testing.assert_array_equal(radiance, picture.denoised("oidn").radiance)


def test_bad_settings_and_inputs_are_refused(denoised):
    with pytest.raises(ValueError, match="method is one of knn, oidn; got 'median'"):
        denoised.denoise.SetMethod("median")
    denoised.denoise.SetInputConnection(denoised.source.GetOutputPort())
    with pytest.raises(ValueError, match="no point array 'radiance'"):
        denoised.denoise.Update()
