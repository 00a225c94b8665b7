"""What other renderers make of hard cases: Mitsuba 3 and VTK's software mapper.

    PYTHONPATH=tests python tests/peers/numerics_of_peers.py

Prints the versions and, for each case, what is expected, what the peer gives and what vtkmcvr does.
"""

import numpy as np
from scenes import WHITE, frontal, medium, scene, slab, volume

from vtkmcvr.curves import Curve
from vtkmcvr.rendering import render_scene
from vtkmcvr.scene import TransferFunction


def plate():
    """Opaque plate of one voxel among 20, opacity 1 above 1/2: alpha 1 (HC-01)."""
    values = np.zeros((20, 20, 20), np.float32)
    values[:, 10, :] = 1
    return values


def by_vtk_fixed_point(values, distance, opaque, size=64):
    """Mean alpha by vtkFixedPointVolumeRayCastMapper with a given sample distance."""
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
    from vtkmodules.vtkRenderingVolume import vtkFixedPointVolumeRayCastMapper

    image = vtkImageData()
    image.SetDimensions(values.shape[::-1])
    image.GetPointData().SetScalars(numpy_to_vtk(values.ravel(), deep=True))
    opacity, white = vtkPiecewiseFunction(), vtkColorTransferFunction()
    for x, y in opaque:
        opacity.AddPoint(x, y)
    white.AddRGBPoint(0, 1, 1, 1)
    look = vtkVolumeProperty()
    look.SetScalarOpacity(opacity)
    look.SetColor(white)
    look.SetInterpolationTypeToLinear()
    mapper = vtkFixedPointVolumeRayCastMapper()
    mapper.SetInputData(image)
    mapper.AutoAdjustSampleDistancesOff()
    mapper.SetSampleDistance(distance)
    mapper.SetImageSampleDistance(1)
    actor = vtkVolume()
    actor.SetMapper(mapper)
    actor.SetProperty(look)
    renderer = vtkRenderer()
    renderer.AddVolume(actor)
    renderer.SetBackground(0, 0, 0)
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(size, size)
    window.AddRenderer(renderer)
    camera = renderer.GetActiveCamera()
    centre = [(n - 1) / 2 for n in values.shape[::-1]]
    camera.SetFocalPoint(*centre)
    camera.SetPosition(centre[0], centre[1] - 100, centre[2])
    camera.SetViewUp(0, 0, 1)
    camera.ParallelProjectionOn()
    camera.SetParallelScale(5)
    renderer.ResetCameraClippingRange()
    window.Render()
    grab = vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.SetInputBufferTypeToRGB()
    grab.ReadFrontBufferOff()
    grab.Update()
    pixels = vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars())
    return float(pixels.mean()) / 255


def by_mitsuba(sigma_t, length, samples=4096):
    """Mean radiance of a unit sky through an absorbing cube."""
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    half = length / 2
    cube = {
        "type": "cube",
        "to_world": mi.ScalarTransform4f().scale([half, half, half]),
        "bsdf": {"type": "null"},
        "interior": {
            "type": "heterogeneous",
            "sigma_t": {
                "type": "gridvolume",
                "grid": mi.VolumeGrid(np.full((2, 2, 2, 1), sigma_t, np.float32)),
                "to_world": mi.ScalarTransform4f().translate([-half] * 3).scale([length] * 3),
            },
            "albedo": 0.0,
        },
    }
    found = mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "volpath", "max_depth": -1, "rr_depth": 1000},
            "sensor": {
                "type": "orthographic",
                "near_clip": 1e-3 * length,
                "far_clip": 1e3 * length,
                "to_world": mi.ScalarTransform4f().look_at(
                    [0, -5 * length, 0], [0, 0, 0], [0, 0, 1]
                )
                @ mi.ScalarTransform4f().scale([0.1 * length, 0.1 * length, 1]),
                "film": {"type": "hdrfilm", "width": 4, "height": 4, "rfilter": {"type": "box"}},
                "sampler": {"type": "independent", "sample_count": samples},
            },
            "sky": {"type": "constant", "radiance": 1.0},
            "cube": cube,
        }
    )
    return float(np.array(mi.render(found)).mean())


def main():
    import mitsuba
    import vtkmodules
    from vtkmodules.vtkCommonCore import vtkVersion

    print(f"Mitsuba {mitsuba.__version__}, VTK {vtkVersion.GetVTKVersion()}, {vtkmodules.__name__}")
    print("HC-01, alpha of an opaque plate one voxel thick; expected 1")
    opaque = TransferFunction(Curve([(0.5, 0), (0.5, 1)]), WHITE, unit_distance=1.0)
    ours = render_scene(scene(volume(plate()), opaque, frontal(5)), samples=16).alpha.mean()
    print(f"  vtkmcvr {ours:.4f}")
    for distance in (0.5, 1.0, 3.0):
        got = by_vtk_fixed_point(plate(), distance, [(0.4999, 0), (0.5001, 1)])
        print(f"  vtkFixedPointVolumeRayCastMapper, sample distance {distance:g}: {got:.4f}")
    print("HC-08: unit sky behind an absorbing cube of optical depth 1; expected 0.367879")
    for length in (1e-6, 1e-4, 1e-2, 1.0, 1e4, 1e6):
        cube = scene(
            slab((length,) * 3), medium(1 / length), frontal(0.1 * length, distance=5 * length)
        )
        ours = 1 - render_scene(cube, samples=64).alpha.mean()
        print(
            f"  edge {length:g}: Mitsuba {by_mitsuba(1 / length, length):.4f}, vtkmcvr {ours:.4f}"
        )


if __name__ == "__main__":
    main()
