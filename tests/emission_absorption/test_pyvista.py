"""A plotter looks the same whether VTK draws the volume or emission and absorption does."""

import numpy as np
import pyvista as pv
from vtk_pictures import difference, lopsided

from vtkmcvr import EmissionAbsorption

TECHNIQUE = "emission-absorption"
FINE = EmissionAbsorption(0.1)
WORDS = {"cmap": "viridis", "opacity": [0.0, 0.1, 0.4], "opacity_unit_distance": 2.0}


def grid():
    made = pv.ImageData(dimensions=(48, 40, 33), spacing=(0.6, 0.5, 1.3))
    made["values"] = lopsided().ravel()
    return made


def plotter(mesh):
    made = pv.Plotter(off_screen=True, window_size=(120, 90))
    actor = made.add_volume(grid(), show_scalar_bar=False, mapper="gpu", **WORDS)
    actor.prop.SetInterpolationTypeToLinear()
    actor.mapper.SetAutoAdjustSampleDistances(False)
    actor.mapper.SetSampleDistance(0.05)
    if mesh:
        made.add_mesh(pv.Sphere(radius=6.0, center=grid().center), color="tomato")
    return made


def test_volume_alone_and_around_a_mesh():
    for mesh in (False, True):
        shown = plotter(mesh)
        vtk = shown.screenshot() / 255
        shown.mcvr.enable(technique=TECHNIQUE, emission_absorption=FINE, text=False)
        shown.render()
        ours = shown.screenshot() / 255
        assert shown.mcvr.picture.technique == TECHNIQUE
        shown.close()
        # Edges of the mesh are those of a whole pixel here
        assert difference(vtk, ours) < (1.5 if mesh else 0.7)
        assert np.std(ours) > 0.05


def test_picture_of_an_image():
    picture = grid().mcvr.render(
        technique=TECHNIQUE, emission_absorption=FINE, window_size=(60, 45), **WORDS
    )
    assert picture.rgba.shape == (45, 60, 4)
    assert 0.05 < picture.alpha.mean() < 0.9
