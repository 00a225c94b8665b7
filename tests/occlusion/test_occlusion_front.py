"""Occlusion through the front door, the command line and the VTK filter."""

import json

import numpy as np
import pytest
from scenes import blob
from vtkmodules.vtkImagingCore import vtkRTAnalyticSource

import vtkmcvr
from vtkmcvr.cli import main
from vtkmcvr.filters import DirectionalOcclusionFilter, MonteCarloFilter, ToneMapFilter
from vtkmcvr.lights import GradientEnvironment, headlight
from vtkmcvr.occlusion.ambient import ambient_radiance
from vtkmcvr.vtk_bridge.scene import array_of_image

SMALL = {"preset": "solid", "size": (24, 18)}


def test_front_door():
    picture = vtkmcvr.render(blob(), technique="occlusion", **SMALL)
    assert picture.rgba.shape == (18, 24, 4)
    assert picture.recipe["technique"] == "occlusion"
    json.dumps(picture.facts(), allow_nan=False)
    json.dumps(picture.recipe, allow_nan=False)
    with pytest.raises(ValueError, match="no samples"):
        vtkmcvr.render(blob(), technique="occlusion", samples=3, **SMALL)
    with pytest.raises(ValueError, match="technique="):
        vtkmcvr.render(blob(), occlusion=vtkmcvr.Occlusion(), **SMALL)


def test_a_look_is_as_bright_as_by_monte_carlo():
    # The lights of a look become one radiance, of about the same irradiance
    data = blob(25)
    occlusion = vtkmcvr.render(data, technique="occlusion", **SMALL)
    traced = vtkmcvr.render(data, samples=32, **SMALL)
    ratio = occlusion.radiance.mean() / traced.radiance.mean()
    assert 0.5 < ratio < 2
    np.testing.assert_allclose(occlusion.alpha.mean(), traced.alpha.mean(), rtol=0.03)


@pytest.mark.parametrize(
    ("light", "expected"),
    [
        (vtkmcvr.ConstantEnvironment((1, 2, 3)), (1, 2, 3)),
        (vtkmcvr.EnvironmentMap(np.full((4, 8, 3), 0.5), 2.0), (1, 1, 1)),
        (vtkmcvr.DirectionalLight((0, 0, 1), 2 * np.pi), (1, 1, 1)),
        (GradientEnvironment((3, 0, 1), (1, 1, 1), (1, 0, 3)), (1.3634, 0.6366, 1.3634)),
        (headlight(2 * np.pi), (1, 1, 1)),
        (vtkmcvr.PointLight((0, 0, 2), 8 * np.pi), (1, 1, 1)),
        # A square of solid angle 1e-2 at distance 10, head-on
        (vtkmcvr.RectangleLight((0, 0, 10), (0, 0, 0), (1, 1), np.pi * 200), (1, 1, 1)),
    ],
)
def test_radiance_in_place_of_lights(light, expected):
    scene = vtkmcvr.Scene(
        blob(), vtkmcvr.TransferFunction(vtkmcvr.Curve([(0, 0), (1, 1)]),
                                         vtkmcvr.ColourCurve([(0, 1, 1, 1)])),
        vtkmcvr.Camera((0, -3, 0), (0, 0, 0)), (light,),
    )  # fmt: skip
    np.testing.assert_allclose(ambient_radiance(scene), expected, rtol=5e-3)


def test_command_line(tmp_path, capsys):
    out, facts = tmp_path / "a.npz", tmp_path / "a.json"
    demo = ["demo", "-o", str(out), "--technique", "occlusion", "--theta", "40", "--size", "32x24",
            "--toward-light", "-0.5", "-1", "0.2", "--slices", "90", "--json",
            str(facts), "--threads", "2"]  # fmt: skip
    assert main(demo) == 0
    text = capsys.readouterr().out
    assert "cone of 40 degrees" in text and "biased" in text
    assert "the direction (-0.4" in text
    assert json.loads(facts.read_text())["mode"] == "default"
    assert np.load(out)["radiance"].max() > 0


def test_command_line_says_what_needs_the_technique(tmp_path, capsys):
    assert main(["demo", "-o", str(tmp_path / "a.png"), "--theta", "40"]) != 0
    assert "--technique occlusion" in capsys.readouterr().err
    assert main(["demo", "-o", str(tmp_path / "a.png"), "--technique", "occlusion",
                 "--denoise", "knn"]) != 0  # fmt: skip
    assert "--denoise is not for" in capsys.readouterr().err


def test_filter_gives_the_arrays_of_the_monte_carlo_filter():
    source = vtkRTAnalyticSource()
    source.SetWholeExtent(-6, 6, -6, 6, -6, 6)
    filters = [
        DirectionalOcclusionFilter(occlusion=vtkmcvr.Occlusion(50), aovs=("albedo", "normal")),
        MonteCarloFilter(samples=8),
    ]
    images = []
    for each in filters:
        each.film_size = (16, 12)
        opacity = each.volume_property.GetScalarOpacity(0)
        opacity.AddPoint(130, 0.0)
        opacity.AddPoint(250, 0.6)
        each.SetInputConnection(source.GetOutputPort())
        each.Update()
        images.append(each.GetOutputDataObject(0))
    occlusion, traced = images
    assert occlusion.GetDimensions() == traced.GetDimensions() == (16, 12, 1)
    for name in ("radiance", "depth"):
        assert array_of_image(occlusion, name).shape == array_of_image(traced, name).shape
    albedo = array_of_image(occlusion, "albedo")
    assert (albedo <= array_of_image(occlusion, "radiance")[..., 3:] + 1e-5).all()
    assert albedo.max() > 0.1
    normal = array_of_image(occlusion, "normal")
    assert 0.5 < np.linalg.norm(normal, axis=2).max() < 1.001
    alpha = [array_of_image(image, "radiance")[..., 3] for image in images]
    assert np.abs(alpha[0] - alpha[1]).mean() < 0.05
    assert occlusion.GetPointData().GetArray("standard_error") is None
    # The picture is kept until a value changes
    first = filters[0].picture
    filters[0].Modified()
    filters[0].Update()
    assert filters[0].picture is first
    filters[0].occlusion = vtkmcvr.Occlusion(20)
    filters[0].Update()
    assert filters[0].picture is not first
    display = ToneMapFilter()
    display.SetInputConnection(filters[0].GetOutputPort())
    display.Update()
    assert display.GetOutputDataObject(0).GetDimensions() == (16, 12, 1)
