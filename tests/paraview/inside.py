"""Inside pvbatch: a picture of a volume by the plugin, under the active view's look and camera.

Usage: pvbatch inside.py PLUGIN VOLUME FOLDER
"""

import inspect
import sys
from pathlib import Path

# Debian's ParaView 5.11 asks Python 3.11 for what that no longer has
if not hasattr(inspect, "getargspec"):
    inspect.getargspec = inspect.getfullargspec

import numpy as np
from paraview import simple
from vtkmodules.util.numpy_support import vtk_to_numpy

sys.path.insert(0, str(Path(__file__).parent))
from picture_numbers import (
    CAMERA,
    COLOURS,
    EXPOSURE,
    OPACITIES,
    SAMPLES,
    SEED,
    SIZE,
    centre_of,
    position_of,
)


def flat(rows, tail=()):
    return [number for row in rows for number in (*row, *tail)]


def show_as_volume(source):
    """Render view of a volume with the look and the camera."""
    view = simple.CreateView("RenderView")
    simple.SetActiveView(view)
    source.UpdatePipeline()
    name = source.PointData.GetArray(0).Name
    display = simple.Show(source, view)
    simple.ColorBy(display, ("POINTS", name))
    display.SetRepresentationType("Volume")
    display.ScalarOpacityUnitDistance = 1.0
    colours = simple.GetColorTransferFunction(name)
    colours.ColorSpace = "RGB"
    colours.Discretize = 0
    colours.RGBPoints = flat(COLOURS)
    simple.GetOpacityTransferFunction(name).Points = flat(OPACITIES, (0.5, 0.0))
    view.ViewSize = list(SIZE)
    # The first rendering places the camera
    simple.Render(view)
    bounds = source.GetDataInformation().GetBounds()
    view.CameraPosition, view.CameraFocalPoint = position_of(bounds), centre_of(bounds)
    view.CameraViewUp, view.CameraViewAngle = CAMERA["up"], CAMERA["angle"]
    simple.Render(view)
    return view


def arrays_of(algorithm):
    """Point arrays of a picture, as VTK has them."""
    points = algorithm.SMProxy.GetClientSideObject().GetOutputDataObject(0).GetPointData()
    names = [points.GetArrayName(k) for k in range(points.GetNumberOfArrays())]
    return {name: vtk_to_numpy(points.GetArray(name)) for name in names}


def main(plugin, volume, folder):
    folder = Path(folder)
    simple.LoadPlugin(plugin, remote=False, ns=vars(simple))
    source = simple.MedicalVolumeReader(FileName=volume)
    view = show_as_volume(source)
    seen = []
    picture = simple.MonteCarloVolume(
        Input=source, FilmSize=list(SIZE), Samples=SAMPLES, Seed=SEED, Exposure=EXPOSURE
    )
    algorithm = picture.SMProxy.GetClientSideObject()
    algorithm.AddObserver("ProgressEvent", lambda caller, _: seen.append(caller.GetProgress()))
    picture.UpdatePipeline()
    np.savez(folder / "paraview.npz", **arrays_of(picture))
    statistics = algorithm.GetOutputDataObject(1)
    assert statistics.GetColumnByName("samples").GetValue(0) == SAMPLES
    assert max(seen) == 1.0

    # An edit of the view counts when it is asked for
    view.GetActiveCamera().Azimuth(40)
    picture.UpdatePipeline()
    before = arrays_of(picture)["radiance"]
    picture.SMProxy.InvokeCommand("TakeFromView")
    picture.UpdatePipeline()
    assert not np.array_equal(arrays_of(picture)["radiance"], before)

    # The view's lights, brightness without rays, a preset without any view
    picture.Lights = "Active View"
    picture.UpdatePipeline()
    radiance = arrays_of(picture)
    assert not np.array_equal(radiance["radiance"], before)
    picture.Exposure = 3.0
    picture.UpdatePipeline()
    brighter = arrays_of(picture)
    np.testing.assert_array_equal(brighter["radiance"], radiance["radiance"])
    assert brighter["rgba"].astype(int).sum() > radiance["rgba"].astype(int).sum()
    occlusion = simple.DirectionalOcclusion(
        Input=source, FilmSize=list(SIZE), Look="ct-bone", Camera="Whole Volume"
    )
    occlusion.UpdatePipeline()
    assert arrays_of(occlusion)["rgba"][:, 3].max() == 255
    simple.SaveData(str(folder / "occlusion.png"), proxy=occlusion)

    # As a picture in a 2-D view
    flat_view = simple.CreateView("RenderView")
    flat_view.ViewSize, flat_view.InteractionMode = [320, 240], "2D"
    flat_view.UseColorPaletteForBackground = 0
    display = simple.Show(picture, flat_view)
    display.SetRepresentationType("Slice")
    simple.ColorBy(display, ("POINTS", "rgba"))
    display.MapScalars = 0
    simple.ResetCamera(flat_view)
    simple.SaveScreenshot(str(folder / "view.png"), flat_view)
    print("pictures of ParaView are in", folder)


if __name__ == "__main__":
    main(*sys.argv[1:4])
