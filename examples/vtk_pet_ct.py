"""Two volumes in one place, from one vtkRenderer: a CT of a head, and the PET that goes with it.

Usage: python vtk_pet_ct.py [OUTPUT.png]

Both are synthetic. The PET has coarse voxels, and a place of its own: a matrix registers it.
"""

import sys

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction, vtkPlane
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkRenderingCore import (
    vtkColorTransferFunction,
    vtkLight,
    vtkRenderer,
    vtkVolume,
    vtkVolumeProperty,
)
from vtkmodules.vtkRenderingVolumeOpenGL2 import vtkSmartVolumeMapper

from vtkmcvr import head_phantom
from vtkmcvr.filters import MonteCarloFilter, ToneMapFilter

# Where the PET's own coordinates begin, mm
SHIFT = np.array((40.0, 0.0, -25.0))


def image_of(values, spacing, origin):
    result = vtkImageData()
    result.SetDimensions(values.shape[::-1])
    result.SetSpacing(spacing)
    result.SetOrigin(origin)
    result.GetPointData().SetScalars(numpy_to_vtk(values.ravel(), deep=True))
    return result


def ct():
    return image_of(*head_phantom(96))


def pet(shape=(40, 38, 34), step=6.0):
    """Uptake in the brain, and in a lesion."""
    origin = -step * (np.array(shape[::-1]) - 1) / 2
    k, j, i = np.indices(shape)
    x, y, z = (step * a + o for a, o in zip((i, j, k), origin, strict=True))
    inside = np.sqrt((x / 58) ** 2 + ((y - 0) / 74) ** 2 + ((z - 50) / 52) ** 2)
    brain = 1 / (1 + np.exp((inside - 0.85) / 0.06)) * np.where(inside > 0.5, 1.0, 0.7)
    lesion = 2.5 * np.exp(-((x - 28) ** 2 + (y + 30) ** 2 + (z - 62) ** 2) / (2 * 9.0**2))
    return image_of((5 * (brain + lesion)).astype(np.float32), (step,) * 3, origin - SHIFT)


def volume(image, opacities, colours, unit_distance):
    opacity, colour = vtkPiecewiseFunction(), vtkColorTransferFunction()
    for node in opacities:
        opacity.AddPoint(*node)
    for node in colours:
        colour.AddRGBPoint(*node)
    look, mapper, result = vtkVolumeProperty(), vtkSmartVolumeMapper(), vtkVolume()
    look.SetScalarOpacity(opacity)
    look.SetScalarOpacityUnitDistance(unit_distance)
    look.SetColor(colour)
    mapper.SetInputData(image)
    result.SetMapper(mapper)
    result.SetProperty(look)
    return result


def main(path="vtk_pet_ct.png"):
    bone = volume(
        ct(), [(300, 0.0), (900, 0.6)], [(300, 0.85, 0.75, 0.65), (1200, 0.95, 0.95, 0.9)], 2.0
    )
    # The skull is opened toward the viewer
    plane = vtkPlane()
    plane.SetOrigin(20, 0, 0)
    plane.SetNormal(-1, 0, 0)
    bone.GetMapper().AddClippingPlane(plane)
    uptake = volume(
        pet(), [(2.5, 0.0), (6.0, 0.03), (9.0, 0.5)],
        [(2.5, 0.1, 0.0, 0.4), (5.0, 0.8, 0.1, 0.3), (8.0, 1.0, 0.6, 0.1), (14.0, 1.0, 1.0, 0.7)],
        4.0,
    )  # fmt: skip
    uptake.SetPosition(SHIFT)

    renderer, light = vtkRenderer(), vtkLight()
    renderer.AddVolume(bone)
    renderer.AddVolume(uptake)
    light.SetLightTypeToCameraLight()
    light.SetPosition(-0.6, 0.8, 1.0)
    light.SetIntensity(1.6)
    renderer.AddLight(light)
    renderer.GradientBackgroundOn()
    renderer.SetBackground(0.05, 0.06, 0.08)
    renderer.SetBackground2(0.3, 0.33, 0.4)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(500, -420, 140)
    camera.SetViewUp(0, 0, 1)

    render = MonteCarloFilter.from_renderer(
        renderer, film_size=(360, 360), samples=64, ambient=0.25
    )
    show = ToneMapFilter.from_renderer(renderer)
    show.SetInputConnection(render.GetOutputPort())
    writer = vtkPNGWriter()
    writer.SetInputConnection(show.GetOutputPort())
    writer.SetFileName(path)
    writer.Write()
    print(render.plan.explain())


if __name__ == "__main__":
    main(*sys.argv[1:2])
