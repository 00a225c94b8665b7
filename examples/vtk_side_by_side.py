"""One vtkVolume, drawn by VTK's GPU ray caster, by emission and absorption, and by Monte Carlo.

python examples/vtk_side_by_side.py [PICTURE.png [VOLUME [LOW HIGH]]]

Same volume property, same camera. The first two are the same picture: opacities, silhouettes and a
lamp at the eye. The third has light: shadows, and an inside that shines through. Without a volume
the synthetic head is shown; LOW and HIGH are the scalars where it begins and where it is opaque.
"""

import sys

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkUnsignedCharArray
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkRenderingCore import (
    vtkCamera,
    vtkColorTransferFunction,
    vtkLight,
    vtkRenderer,
    vtkRenderWindow,
    vtkVolume,
    vtkVolumeProperty,
)
from vtkmodules.vtkRenderingVolumeOpenGL2 import vtkOpenGLGPUVolumeRayCastMapper

import vtkmcvr
from vtkmcvr.filters import EmissionAbsorptionFilter, MonteCarloFilter, ToneMapFilter
from vtkmcvr.pictures.display import srgb_decode
from vtkmcvr.vtk_bridge.scene import array_of_image

SIZE = (400, 400)
SAMPLES = 128


def synthetic_head(size: int = 160) -> vtkImageData:
    """The synthetic CT head as VTK holds it."""
    head = vtkmcvr.head_phantom(size)
    image = vtkImageData()
    image.SetDimensions(*head.values.shape[::-1])
    image.SetSpacing(*head.spacing)
    image.SetOrigin(*head.origin)
    image.GetPointData().SetScalars(numpy_to_vtk(np.ravel(head.values), deep=True))
    return image


def look(low: float, high: float, unit: float, linear: bool = False) -> vtkVolumeProperty:
    """Bone below skin: colour and opacity between two scalars, shaded.

    Colours are those of a display, or `linear`, the reflectances that look like them.
    """
    opacity, colour = vtkPiecewiseFunction(), vtkColorTransferFunction()
    for share, value in ((0.0, 0.0), (0.08, 0.03), (0.3, 0.04), (0.5, 0.6), (1.0, 0.95)):
        opacity.AddPoint(low + share * (high - low), value)
    for share, rgb in ((0.0, (0.85, 0.45, 0.3)), (0.3, (0.85, 0.5, 0.35)), (0.5, (0.95, 0.9, 0.8))):
        colour.AddRGBPoint(low + share * (high - low), *(srgb_decode(rgb) if linear else rgb))
    made = vtkVolumeProperty()
    made.SetInterpolationTypeToLinear()
    made.SetScalarOpacity(opacity)
    made.SetColor(colour)
    made.SetScalarOpacityUnitDistance(unit)
    made.ShadeOn()
    made.SetAmbient(0.2)
    made.SetDiffuse(0.8)
    made.SetSpecular(0.3)
    made.SetSpecularPower(20.0)
    return made


def camera_before(image: vtkImageData) -> vtkCamera:
    """Perspective view from the front, a little aside and above."""
    made = vtkCamera()
    x, y, z = image.GetCenter()
    made.SetFocalPoint(x, y, z)
    made.SetPosition(x, y - 1.4 * image.GetLength(), z)
    made.SetViewUp(0, 0, 1)
    made.SetViewAngle(25)
    made.Azimuth(-30)
    made.Elevation(12)
    return made


def by_vtk(image: vtkImageData, prop: vtkVolumeProperty, camera: vtkCamera) -> np.ndarray:
    """RGB bytes of VTK's GPU ray caster, with steps of a fifth of a voxel."""
    mapper, volume = vtkOpenGLGPUVolumeRayCastMapper(), vtkVolume()
    mapper.SetInputData(image)
    mapper.SetAutoAdjustSampleDistances(False)
    mapper.SetSampleDistance(0.2 * min(image.GetSpacing()))
    volume.SetMapper(mapper)
    volume.SetProperty(prop)
    renderer, window = vtkRenderer(), vtkRenderWindow()
    renderer.AddVolume(volume)
    renderer.SetActiveCamera(camera)
    renderer.ResetCameraClippingRange()
    window.SetOffScreenRendering(True)
    window.SetMultiSamples(0)
    window.SetSize(*SIZE)
    window.AddRenderer(renderer)
    window.Render()
    pixels = vtkUnsignedCharArray()
    window.GetRGBACharPixelData(0, 0, SIZE[0] - 1, SIZE[1] - 1, 0, pixels)
    return vtk_to_numpy(pixels).reshape(SIZE[1], SIZE[0], 4)[::-1, :, :3]


def by_filter(render, image: vtkImageData, **display) -> np.ndarray:
    """RGB bytes of one of this package's filters."""
    render.film_size = SIZE
    render.SetInputDataObject(image)
    show = ToneMapFilter(background=(0.0, 0.0, 0.0), **display)
    show.SetInputConnection(render.GetOutputPort())
    show.Update()
    return array_of_image(show.GetOutputDataObject(0), "rgba")[..., :3]


def key_light(camera: vtkCamera, image: vtkImageData) -> vtkLight:
    """A lamp above the left shoulder of the viewer."""
    made, reach = vtkLight(), image.GetLength()
    right = np.cross(camera.GetDirectionOfProjection(), camera.GetViewUp())
    place = np.array(camera.GetPosition()) - 1.2 * reach * right + (0, 0, 1.2 * reach)
    made.SetPosition(*place)
    made.SetFocalPoint(*image.GetCenter())
    made.SetIntensity(2.0)
    return made


def main(
    picture: str = "vtk_side_by_side.png",
    volume: str | None = None,
    low: str = "0",
    high: str = "1100",
) -> None:
    image = vtkmcvr.read(volume) if volume else synthetic_head()
    prop, reflectances = (
        look(float(low), float(high), 3 * min(image.GetSpacing()), linear)
        for linear in (False, True)
    )
    camera = camera_before(image)
    theirs = by_vtk(image, prop, camera)
    plain = EmissionAbsorptionFilter(camera=camera, volume_property=prop)
    ours = by_filter(plain, image, curve="none", gamma=1.0)
    traced = MonteCarloFilter(
        samples=SAMPLES, camera=camera, volume_property=reflectances,
        lights=[key_light(camera, image)], ambient=(0.25, 0.27, 0.3),
    )  # fmt: skip
    light = by_filter(traced, image, exposure=0.8)
    apart = np.abs(theirs.astype(float) - ours)
    print(f"VTK and emission-absorption: mean difference {apart.mean():.2f} of 255")
    sheet = np.hstack([theirs, ours, light])[::-1]
    result = vtkImageData()
    result.SetDimensions(sheet.shape[1], sheet.shape[0], 1)
    result.GetPointData().SetScalars(numpy_to_vtk(sheet.reshape(-1, 3), deep=True))
    write(result, picture)


def write(image: vtkImageData, path: str) -> None:
    from vtkmodules.vtkIOImage import vtkPNGWriter

    writer = vtkPNGWriter()
    writer.SetFileName(path)
    writer.SetInputData(image)
    writer.Write()


if __name__ == "__main__":
    main(*sys.argv[1:])
