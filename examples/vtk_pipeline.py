"""A VTK pipeline: image source -> Monte Carlo -> tone mapping -> PNG.

Usage: python vtk_pipeline.py [OUTPUT.png]
"""

import sys

from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction
from vtkmodules.vtkImagingCore import vtkRTAnalyticSource
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkRenderingCore import (
    vtkCamera,
    vtkColorTransferFunction,
    vtkLight,
    vtkVolumeProperty,
)

from vtkmcvr.filters import MonteCarloFilter, ToneMapFilter


def light(position, colour, intensity):
    result = vtkLight()
    result.SetPosition(position)
    result.SetColor(colour)
    result.SetIntensity(intensity)
    return result


def main(path="vtk_pipeline.png"):
    source = vtkRTAnalyticSource()
    source.SetWholeExtent(-40, 40, -40, 40, -40, 40)

    opacity, colour = vtkPiecewiseFunction(), vtkColorTransferFunction()
    opacity.AddPoint(145, 0.0)
    opacity.AddPoint(155, 0.95)
    colour.AddRGBPoint(150, 0.95, 0.9, 0.8)
    look = vtkVolumeProperty()
    look.SetScalarOpacity(opacity)
    look.SetColor(colour)
    look.ShadeOn()

    camera = vtkCamera()
    camera.SetPosition(105, 90, 170)

    render = MonteCarloFilter(film_size=(400, 300), samples=96, ambient=(0.15, 0.2, 0.3))
    render.SetVolumeProperty(look)
    render.SetCamera(camera)
    key, rim = light((-60, 120, 90), (1, 0.8, 0.6), 2), light((90, 20, -60), (0.3, 0.5, 1), 3)
    render.SetLights([key, rim])
    render.SetInputConnection(source.GetOutputPort())
    show = ToneMapFilter(exposure=0.5, background=(0.12, 0.13, 0.15))
    show.SetInputConnection(render.GetOutputPort())
    writer = vtkPNGWriter()
    writer.SetInputConnection(show.GetOutputPort())
    writer.SetFileName(path)
    writer.Write()
    print(render.plan.explain())


if __name__ == "__main__":
    main(*sys.argv[1:2])
