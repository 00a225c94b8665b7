"""VTK alone: read, cut out, smooth, resample -> Monte Carlo -> tone mapping -> PNG.

Usage: python vtk_medical.py [OUTPUT.png] [VOLUME]

VOLUME is a CT in HU that `vtkmcvr.read` knows, by default a synthetic head.
"""

import sys

from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkCommonExecutionModel import vtkTrivialProducer
from vtkmodules.vtkImagingCore import vtkExtractVOI, vtkImageResample
from vtkmodules.vtkImagingGeneral import vtkImageGaussianSmooth
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkRenderingCore import vtkColorTransferFunction, vtkVolumeProperty

from vtkmcvr import head_phantom
from vtkmcvr.filters import MonteCarloFilter, ToneMapFilter, VolumeReader
from vtkmcvr.studio import Studio, view_camera
from vtkmcvr.vtk_bridge.scene import volume_of

SIZE = (400, 300)


def source_of(path):
    """Algorithm that gives the volume."""
    if path is not None:
        return VolumeReader(file_name=path)
    head = head_phantom(128)
    image = vtkImageData()
    image.SetDimensions(head.values.shape[::-1])
    image.SetSpacing(head.spacing)
    image.SetOrigin(head.origin)
    image.GetPointData().SetScalars(numpy_to_vtk(head.values.ravel(), deep=True))
    source = vtkTrivialProducer()
    source.SetOutput(image)
    return source


def look():
    """Bone, without what is softer."""
    opacity, colour = vtkPiecewiseFunction(), vtkColorTransferFunction()
    opacity.AddPoint(200, 0.0)
    opacity.AddPoint(500, 0.9)
    colour.AddRGBPoint(200, 0.85, 0.65, 0.5)
    colour.AddRGBPoint(700, 0.95, 0.92, 0.85)
    result = vtkVolumeProperty()
    result.SetScalarOpacity(opacity)
    result.SetColor(colour)
    result.ShadeOn()
    return result


def main(path="vtk_medical.png", volume=None):
    source = source_of(volume)
    source.Update()
    columns, rows, slices = source.GetOutputDataObject(0).GetDimensions()

    # The left half is cut off
    part = vtkExtractVOI()
    part.SetInputConnection(source.GetOutputPort())
    part.SetVOI(0, columns * 6 // 10, 0, rows - 1, 0, slices - 1)
    smooth = vtkImageGaussianSmooth()
    smooth.SetInputConnection(part.GetOutputPort())
    smooth.SetStandardDeviation(0.6)
    cubes = vtkImageResample()
    cubes.SetInputConnection(smooth.GetOutputPort())
    for axis in range(3):
        cubes.SetAxisOutputSpacing(axis, 1.5)
    cubes.Update()

    camera = view_camera(
        volume_of(cubes.GetOutput()), azimuth=50, elevation=15, zoom=1.2, aspect=SIZE[0] / SIZE[1]
    )
    render = MonteCarloFilter(
        film_size=SIZE, samples=64, camera=camera, studio=Studio(), volume_property=look()
    )
    render.SetInputConnection(cubes.GetOutputPort())
    show = ToneMapFilter(background=(0.12, 0.13, 0.15))
    show.SetInputConnection(render.GetOutputPort())
    writer = vtkPNGWriter()
    writer.SetInputConnection(show.GetOutputPort())
    writer.SetFileName(path)
    writer.Write()

    table = render.GetOutputDataObject(1)
    for name in ("samples", "seconds", "nrms"):
        print(f"{name}: {table.GetColumnByName(name).GetValue(0):.3g}")


if __name__ == "__main__":
    main(*sys.argv[1:3])
