"""Outside ParaView: the volume to be shown, and the picture that ParaView's must equal.

Usage: python outside.py volume FOLDER        prints the path of a volume
       python outside.py compare VOLUME FOLDER
"""

import os
import sys
from pathlib import Path

import numpy as np
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
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkRenderingCore import vtkCamera, vtkColorTransferFunction, vtkVolumeProperty

from vtkmcvr.filters import MonteCarloFilter, ToneMapFilter, VolumeReader
from vtkmcvr.studio import Studio


def volume(folder):
    """Path of a CT: a real one where there is one, else of the phantom."""
    real = Path(os.environ.get("VTKMCVR_DATA", "../shared/data")) / "nifti" / "example_ct.nii.gz"
    if real.exists():
        return real.resolve()
    import SimpleITK

    from vtkmcvr import head_phantom

    phantom = head_phantom(96)
    image = SimpleITK.GetImageFromArray(phantom.values)
    image.SetSpacing(phantom.spacing)
    image.SetOrigin(phantom.origin)
    path = Path(folder) / "phantom.nrrd"
    SimpleITK.WriteImage(image, str(path))
    return path


def look():
    colour, opacity = vtkColorTransferFunction(), vtkPiecewiseFunction()
    result = vtkVolumeProperty()
    for node in COLOURS:
        colour.AddRGBPoint(*node)
    for node in OPACITIES:
        opacity.AddPoint(*node)
    result.SetColor(colour)
    result.SetScalarOpacity(opacity)
    return result


def picture(path):
    """Picture by plain VTK, and the filters that make it."""
    source = VolumeReader(file_name=path)
    source.Update()
    bounds = source.GetOutputDataObject(0).GetBounds()
    camera = vtkCamera()
    camera.SetPosition(position_of(bounds))
    camera.SetFocalPoint(centre_of(bounds))
    camera.SetViewUp(CAMERA["up"])
    camera.SetViewAngle(CAMERA["angle"])
    render = MonteCarloFilter(
        film_size=SIZE, samples=SAMPLES, seed=SEED, colours="display", studio=Studio(),
        volume_property=look(), camera=camera,
    )  # fmt: skip
    tone = ToneMapFilter(exposure=EXPOSURE)
    render.SetInputConnection(source.GetOutputPort())
    tone.SetInputConnection(render.GetOutputPort())
    tone.Update()
    return render, tone


def compare(path, folder):
    render, tone = picture(path)
    writer = vtkPNGWriter()
    writer.SetInputConnection(tone.GetOutputPort())
    writer.SetFileName(str(Path(folder) / "vtk.png"))
    writer.Write()
    theirs = np.load(Path(folder) / "paraview.npz")
    ours = render.GetOutputDataObject(0).GetPointData()
    differ = []
    for name in ("radiance", "depth", "standard_error"):
        mine = vtk_to_numpy(ours.GetArray(name))
        same = np.array_equal(mine, theirs[name], equal_nan=True)
        print(f"{name}: {'the same bits' if same else 'differs'}")
        differ += [] if same else [name]
    shown = vtk_to_numpy(tone.GetOutputDataObject(0).GetPointData().GetArray("rgba"))
    # Exponentials of another version of NumPy may round another way
    apart = np.abs(shown.astype(int) - theirs["rgba"]).max()
    print(f"rgba: within {apart} of 255")
    if apart > 1:
        differ.append("rgba")
    if theirs["rgba"][:, 3].mean() < 10:
        raise SystemExit("the picture of ParaView is empty")
    if differ:
        raise SystemExit(f"the picture of ParaView differs in {', '.join(differ)}")


if __name__ == "__main__":
    if sys.argv[1] == "volume":
        print(volume(sys.argv[2]))
    else:
        compare(*sys.argv[2:4])
