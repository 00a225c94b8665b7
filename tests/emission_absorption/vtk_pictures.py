"""The same volume property, mapper and camera drawn by VTK and by emission and absorption."""

import math

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkUnsignedCharArray
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkRenderingCore import (
    vtkCamera,
    vtkColorTransferFunction,
    vtkRenderer,
    vtkRenderWindow,
    vtkVolume,
    vtkVolumeProperty,
)
from vtkmodules.vtkRenderingOpenGL2 import vtkOpenGLRenderer  # noqa: F401  (registers factories)
from vtkmodules.vtkRenderingVolume import vtkFixedPointVolumeRayCastMapper
from vtkmodules.vtkRenderingVolumeOpenGL2 import vtkOpenGLGPUVolumeRayCastMapper

from vtkmcvr.emission_absorption import EmissionAbsorption, render_emission_absorption
from vtkmcvr.scene import Scene
from vtkmcvr.vtk_bridge.cutting import clip_of, cropping_of
from vtkmcvr.vtk_bridge.scene import camera_of, looks_of

GPU, FIXED_POINT = vtkOpenGLGPUVolumeRayCastMapper, vtkFixedPointVolumeRayCastMapper
SIZE = (80, 60)
# Of VTK's steps over ours: fine
FINE = 0.1


def image(values, spacing=(1, 1, 1), direction=None):
    """Image of an array [k, j, i], or of several components [k, j, i, c]."""
    made = vtkImageData()
    made.SetDimensions(*values.shape[2::-1])
    made.SetSpacing(*spacing)
    if direction is not None:
        made.SetDirectionMatrix(*np.ravel(direction))
    rows = np.ascontiguousarray(values).reshape(math.prod(values.shape[:3]), -1)
    array = numpy_to_vtk(rows, deep=True)
    array.SetName("values")
    made.GetPointData().SetScalars(array)
    return made


def lopsided(shape=(33, 40, 48)):
    """Soft ball of values from 0 to 1 that no symmetry hides an error of."""
    z, y, x = np.mgrid[tuple(slice(-1, 1, n * 1j) for n in shape)]
    ball = 1.1 - np.sqrt(x**2 + 1.5 * y**2 + z**2) + 0.1 * np.sin(5 * x) * z
    return np.clip(ball, 0, 1).astype(np.float32)


def look(low, high, unit=2.0, shade=False):
    """Property with three colours between two scalars, opacity from a fifth of the way on."""
    made = vtkVolumeProperty()
    made.SetInterpolationTypeToLinear()
    opacity, colour = vtkPiecewiseFunction(), vtkColorTransferFunction()
    for share, value in ((0.2, 0.0), (0.5, 0.25), (1.0, 0.6)):
        opacity.AddPoint(low + share * (high - low), value)
    for share, rgb in ((0, (0.1, 0.3, 0.9)), (0.5, (0.9, 0.6, 0.2)), (1, (1, 1, 0.9))):
        colour.AddRGBPoint(low + share * (high - low), *rgb)
    made.SetScalarOpacity(opacity)
    made.SetColor(colour)
    made.SetScalarOpacityUnitDistance(unit)
    made.SetShade(shade)
    made.SetAmbient(0.2)
    made.SetDiffuse(0.6)
    made.SetSpecular(0.5)
    made.SetSpecularPower(15.0)
    return made


def camera_on(centre, distance, view_angle=25.0, azimuth=30.0, elevation=20.0):
    """Perspective camera that looks at a point, z up."""
    made = vtkCamera()
    x, y, z = centre
    made.SetFocalPoint(x, y, z)
    made.SetPosition(x, y - distance, z)
    made.SetViewUp(0, 0, 1)
    made.SetViewAngle(view_angle)
    made.Azimuth(azimuth)
    made.Elevation(elevation)
    made.OrthogonalizeViewUp()
    return made


def by_vtk(data, prop, mapper, camera, distance, user_matrix=None, size=SIZE):
    """RGBA from 0 to 1, premultiplied, row 0 on top, by one of VTK's mappers."""
    mapper.SetInputData(data)
    mapper.SetAutoAdjustSampleDistances(False)
    mapper.SetSampleDistance(distance)
    volume, renderer, window = vtkVolume(), vtkRenderer(), vtkRenderWindow()
    volume.SetMapper(mapper)
    volume.SetProperty(prop)
    if user_matrix is not None:
        volume.SetUserMatrix(user_matrix)
    renderer.SetBackground(0, 0, 0)
    renderer.SetBackgroundAlpha(0)
    renderer.AddVolume(volume)
    renderer.SetActiveCamera(camera)
    renderer.ResetCameraClippingRange()
    window.SetOffScreenRendering(True)
    window.SetMultiSamples(0)
    window.SetAlphaBitPlanes(True)
    window.SetSize(*size)
    window.AddRenderer(renderer)
    window.Render()
    pixels = vtkUnsignedCharArray()
    window.GetRGBACharPixelData(0, 0, size[0] - 1, size[1] - 1, 0, pixels)
    window.Finalize()
    return vtk_to_numpy(pixels).reshape(size[1], size[0], 4)[::-1] / 255.0


def by_us(data, prop, mapper, camera, user_matrix=None, size=SIZE, step=FINE, **settings):
    """The same by emission and absorption."""
    (found,) = looks_of(data, prop)
    volume = found.volume
    if user_matrix is not None:
        from vtkmcvr.vtk_bridge.scene import volume_of

        volume = volume_of(data, user_matrix=user_matrix)
    scene = Scene(
        volume, found.transfer, camera_of(camera, None, aspect=size[0] / size[1]),
        surface=found.surface, size=size, clip=clip_of(mapper),
        crop=cropping_of(mapper, data, volume),
    )  # fmt: skip
    picture = render_emission_absorption(scene, EmissionAbsorption(step, **settings), threads=2)
    return np.dstack([picture.radiance, picture.alpha])


def difference(a, b):
    """Mean absolute difference of two pictures, of 255."""
    return float(255 * np.abs(a - b).mean())
