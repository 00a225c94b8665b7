"""A label map at port 1: parts of a CT with a look each, among bone that is seen through.

Usage: python vtk_labels.py [OUTPUT.png]
"""

import sys

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkRenderingCore import vtkColorTransferFunction, vtkVolumeProperty

from vtkmcvr import head_phantom
from vtkmcvr.filters import MonteCarloFilter, ToneMapFilter
from vtkmcvr.studio import Studio, view_camera
from vtkmcvr.vtk_bridge.scene import volume_of

BRAIN, TEETH, EYES = 1, 2, 3
COLOURS = {BRAIN: (0.9, 0.55, 0.5), TEETH: (1.0, 0.95, 0.7), EYES: (0.3, 0.6, 0.9)}
SIZE = (360, 360)


def image_like(head, values):
    result = vtkImageData()
    result.SetDimensions(values.shape[::-1])
    result.SetSpacing(head.spacing)
    result.SetOrigin(head.origin)
    result.GetPointData().SetScalars(numpy_to_vtk(values.ravel(), deep=True))
    return result


def labels_of(head):
    """Label map by what is known of the synthetic head."""
    k, j, i = np.indices(head.values.shape)
    x, y, z = (s * a + o for a, s, o in zip((i, j, k), head.spacing, head.origin, strict=True))
    labels = np.zeros(head.values.shape, np.uint8)
    # The brain has bone in front, behind, on both sides and above
    bone = head.values > 300
    within = (head.values > -20) & (head.values < 120) & (z > -5)
    for axis in range(3):
        within &= np.flip(np.maximum.accumulate(np.flip(bone, axis), axis), axis)
        within &= np.maximum.accumulate(bone, axis) if axis else True
    labels[within] = BRAIN
    labels[(head.values > 1900) & (y < -20)] = TEETH
    labels[(np.abs(x) - 31) ** 2 + (y + 57) ** 2 + (z - 6) ** 2 < 12**2] = EYES
    return labels


def constant(value):
    result = vtkPiecewiseFunction()
    result.AddPoint(0, value)
    return result


def look():
    """Faint bone; opaque labels in their colours."""
    opacity, colour = vtkPiecewiseFunction(), vtkColorTransferFunction()
    result = vtkVolumeProperty()
    opacity.AddPoint(250, 0.0)
    opacity.AddPoint(1200, 0.02)
    colour.AddRGBPoint(0, 0.85, 0.85, 0.9)
    result.SetScalarOpacity(opacity)
    result.SetColor(colour)
    for label, rgb in COLOURS.items():
        own = vtkColorTransferFunction()
        own.AddRGBPoint(0, *rgb)
        result.SetLabelColor(label, own)
        result.SetLabelScalarOpacity(label, constant(0.7))
    return result


def main(path="vtk_labels.png"):
    head = head_phantom(128)
    image = image_like(head, head.values)
    camera = view_camera(volume_of(image), azimuth=35, elevation=10, zoom=1.4, aspect=1.0)
    render = MonteCarloFilter(
        film_size=SIZE, samples=64, camera=camera, studio=Studio(), colours="display",
        volume_property=look(),
    )  # fmt: skip
    render.SetInputDataObject(0, image)
    render.SetInputDataObject(1, image_like(head, labels_of(head)))
    show = ToneMapFilter(background=(0.1, 0.11, 0.13), exposure=1.0)
    show.SetInputConnection(render.GetOutputPort())
    writer = vtkPNGWriter()
    writer.SetInputConnection(show.GetOutputPort())
    writer.SetFileName(path)
    writer.Write()
    print(render.plan.explain())


if __name__ == "__main__":
    main(*sys.argv[1:2])
