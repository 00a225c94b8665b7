"""Inside ParaView: a CT is shown as Volume, and rendered with that look by light transport.

Usage: pvbatch paraview_script.py VOLUME [OUTPUT.png]

docs/paraview.md has the environment that pvbatch needs. With ParaView of Debian 12, a shim comes
before the plugin.
"""

import inspect
import sys
from pathlib import Path

if not hasattr(inspect, "getargspec"):
    inspect.getargspec = inspect.getfullargspec

from paraview import simple

import vtkmcvr.filters.paraview

PLUGIN = Path(vtkmcvr.filters.paraview.__file__).parent / "plugin" / "vtkmcvr_plugin.py"


def shown_as_volume(reader):
    """Render view of a CT with bone opaque."""
    view = simple.CreateView("RenderView")
    view.ViewSize = [400, 300]
    reader.UpdatePipeline()
    name = reader.PointData.GetArray(0).Name
    display = simple.Show(reader, view)
    simple.ColorBy(display, ("POINTS", name))
    display.SetRepresentationType("Volume")
    display.ScalarOpacityUnitDistance = 2.0
    display.Shade = 1
    colours = simple.GetColorTransferFunction(name)
    opacities = simple.GetOpacityTransferFunction(name)
    colours.ColorSpace = "RGB"
    colours.RGBPoints = [150.0, 0.8, 0.5, 0.4, 600.0, 1.0, 0.95, 0.85]
    opacities.Points = [150.0, 0.0, 0.5, 0.0, 450.0, 0.9, 0.5, 0.0]
    # The first rendering places the camera
    simple.Render(view)
    camera = view.GetActiveCamera()
    camera.SetViewUp(0, 0, 1)
    camera.SetPosition([c + d for c, d in zip(camera.GetFocalPoint(), (0, -1, 0.2), strict=True)])
    simple.ResetCamera(view)
    return view


def main(volume, path="paraview_script.png"):
    """Render a volume."""
    simple.LoadPlugin(str(PLUGIN), remote=False, ns=vars(simple))
    reader = simple.MedicalVolumeReader(FileName=volume)
    view = shown_as_volume(reader)
    simple.SetActiveView(view)
    picture = simple.MonteCarloVolume(
        Input=reader, FilmSize=[400, 300], Samples=64, Exposure=0.5, Look="Active View",
        Camera="Active View", Lights="Studio",
    )  # fmt: skip
    picture.UpdatePipeline()

    # The picture, in a 2-D view of its own
    flat = simple.CreateView("RenderView")
    flat.ViewSize, flat.InteractionMode = [400, 300], "2D"
    flat.UseColorPaletteForBackground, flat.Background = 0, [0.12, 0.13, 0.15]
    flat.OrientationAxesVisibility = 0
    display = simple.Show(picture, flat)
    display.SetRepresentationType("Slice")
    simple.ColorBy(display, ("POINTS", "rgba"))
    display.MapScalars = 0
    simple.Render(flat)
    flat.CameraPosition, flat.CameraFocalPoint = [199.5, 149.5, 1000.0], [199.5, 149.5, 0.0]
    flat.CameraParallelScale = 150.0
    simple.SaveScreenshot(path, flat)


if __name__ == "__main__":
    main(*sys.argv[1:3])
