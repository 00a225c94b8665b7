"""Seconds of a picture by vtkmcvr and by VTK's volume mappers: same volume, size and camera.

    python tests/bench/bench_vtk.py [--size 800x600] [--rounds 3] [--json FILE]

VTK's fixed-point mapper on the CPU, and its GPU mapper on whatever OpenGL there is (without a GPU:
Mesa's software renderer), shaded, without and with volumetric scattering and its shadow rays. Ours:
one sample with the look's environment and area lights, and what it takes to an error of 10 %. They
are different models of light, and VTK's pictures have no error to compare: what is compared is how
long a user waits. The least time by the clock of the rounds counts; volumes from VTKMCVR_DATA.
"""

import argparse
import json
import os
import time
from pathlib import Path

import numpy as np
from bench_effects import SUBJECTS, subject
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkRenderingCore import (
    vtkColorTransferFunction,
    vtkRenderer,
    vtkRenderWindow,
    vtkVolume,
    vtkVolumeProperty,
    vtkWindowToImageFilter,
)
from vtkmodules.vtkRenderingVolume import (
    vtkFixedPointVolumeRayCastMapper,
    vtkGPUVolumeRayCastMapper,
)
from vtkmodules.vtkRenderingVolumeOpenGL2 import vtkOpenGLGPUVolumeRayCastMapper  # noqa: F401

from vtkmcvr.plan import plan
from vtkmcvr.rendering import render_scene

# Error of ours that a picture to look at may have
ERROR = 0.1
# Of the pixels, by a volume that is seen
LEAST_COVERED = 0.05


def image_of(volume):
    """The volume for VTK, whose mappers show nothing where an index axis runs backwards."""
    steps, origin = np.diag(volume.index_to_world[:3, :3]), volume.index_to_world[:3, 3].copy()
    values = volume.values
    for axis in np.flatnonzero(steps < 0):
        origin[axis] += steps[axis] * (values.shape[2 - axis] - 1)
        values = np.flip(values, 2 - axis)
    image = vtkImageData()
    image.SetDimensions(*values.shape[::-1])
    image.SetSpacing(*np.abs(steps))
    image.SetOrigin(*origin)
    values = np.ascontiguousarray(values).ravel()
    image.GetPointData().SetScalars(numpy_to_vtk(values, deep=True))
    return image


def property_of(scene):
    """Opacity and colour of the scene's transfer function, shaded."""
    low, high = float(scene.volume.values.min()), float(scene.volume.values.max())
    opacity, colour = vtkPiecewiseFunction(), vtkColorTransferFunction()
    x = np.linspace(low, high, 512)
    for value, alpha, rgb in zip(
        x, scene.transfer.opacity(x), scene.transfer.colour(x), strict=True
    ):
        opacity.AddPoint(value, float(alpha))
        colour.AddRGBPoint(value, *(float(c) for c in rgb))
    result = vtkVolumeProperty()
    result.SetScalarOpacity(opacity)
    result.SetColor(colour)
    result.SetScalarOpacityUnitDistance(scene.transfer.unit_distance)
    result.SetInterpolationTypeToLinear()
    result.ShadeOn()
    return result


def window_of(scene, mapper):
    """Window that shows the scene's volume by a mapper."""
    mapper.SetInputData(image_of(scene.volume))
    volume = vtkVolume()
    volume.SetMapper(mapper)
    volume.SetProperty(property_of(scene))
    renderer = vtkRenderer()
    renderer.AddVolume(volume)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(*scene.camera.position)
    camera.SetFocalPoint(*scene.camera.focal_point)
    camera.SetViewUp(*scene.camera.view_up)
    camera.SetViewAngle(scene.camera.view_angle)
    renderer.ResetCameraClippingRange()
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetSize(*scene.size)
    window.AddRenderer(renderer)
    return window, mapper


def covered(window):
    """Share of the pixels that are not background, which is black."""
    grab = vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.Update()
    pixels = vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars())
    return float((pixels > 0).any(axis=1).mean())


def gpu_mapper(scattering):
    """VTK's GPU mapper; with `scattering`, one shadow ray from every sample along a ray."""
    mapper = vtkGPUVolumeRayCastMapper()
    if scattering:
        mapper.SetVolumetricScatteringBlending(1.0)
        mapper.SetGlobalIlluminationReach(1.0)
    return mapper


def least(rounds, work):
    """Least time by the clock of a few calls after one that prepares."""
    work()
    taken = []
    for _ in range(rounds):
        start = time.perf_counter()
        work()
        taken.append(time.perf_counter() - start)
    return min(taken)


def by_vtk(scene, rounds):
    """Seconds of a picture by each of VTK's mappers."""
    mappers = {
        "VTK fixed point, CPU": vtkFixedPointVolumeRayCastMapper(),
        "VTK GPU mapper": gpu_mapper(False),
        "VTK GPU mapper, scattering": gpu_mapper(True),
    }
    found = {}
    for name, mapper in mappers.items():
        window, mapper = window_of(scene, mapper)
        mapper.AutoAdjustSampleDistancesOff()
        found[name] = least(rounds, window.Render)
        assert covered(window) > LEAST_COVERED, f"{name} shows nothing"
    return found


def by_us(scene, rounds):
    """Seconds of one sample, and to the error."""
    planned = plan(scene)

    def sample():
        return render_scene(planned, samples=1, backend="cpu")

    ready = render_scene(planned, nrms=ERROR, backend="cpu")
    samples = {"vtkmcvr, one sample": least(rounds, sample)}
    return samples | {f"vtkmcvr, to {ERROR:.0%} (NRMS {ready.nrms:.1%})": ready.seconds}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", default="800x600")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--json", type=Path, help="write everything measured here")
    args = parser.parse_args()
    data = os.environ.get("VTKMCVR_DATA")
    if data is None:
        parser.error("where are the volumes? Set VTKMCVR_DATA")
    size = tuple(int(x) for x in args.size.split("x"))
    facts = {}
    for name in SUBJECTS:
        scene = subject(name, Path(data), size).scene
        facts[name] = by_us(scene, args.rounds) | by_vtk(scene, args.rounds)
        first = next(iter(facts[name].values()))
        print(f"{name}, {args.size}")
        for who, seconds in facts[name].items():
            print(f"  {who:36}{seconds:8.3f} s{seconds / first:9.2f} x")
    if args.json:
        args.json.write_text(json.dumps(facts, indent=1) + "\n")


if __name__ == "__main__":
    main()
