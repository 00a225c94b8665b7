"""Radiance -> radiance with less noise."""

from __future__ import annotations

from typing import Any

from vtkmodules.vtkCommonCore import vtkStringArray
from vtkmodules.vtkCommonDataModel import vtkImageData

from vtkmcvr import checks
from vtkmcvr.pictures.denoise import METHODS, knn, oidn
from vtkmcvr.vtk_bridge.scene import array_of_image, image_of_radiance

from .base import ImageFilter
from .parameters import Parameter


def _method(value: Any) -> str:
    if value not in METHODS:
        raise ValueError(f"method is one of {', '.join(METHODS)}; got {value!r}")
    return value


class DenoiseFilter(ImageFilter):
    """Reduces the noise of a picture, at a bias; changing it traces no ray upstream.

    Input: vtkImageData of `MonteCarloFilter`. Output: the same with another point array "radiance",
    and the method in the field data "denoised". "standard_error" stays that of the input.

    Parameters
    ----------
    **settings
        Any parameter by name: `DenoiseFilter(method="oidn")`.
    """

    method = Parameter(
        "knn", _method,
        '"knn": Exposure Render\'s, which fades out as samples come in. "oidn": Open Image '
        'Denoise, better where `MonteCarloFilter` has the `aovs` albedo and normal.',
    )  # fmt: skip
    exposure = Parameter(
        0.0, lambda v: checks.number("exposure", v),
        'Stops at which "knn" compares pixels: those of the tone mapping downstream.',
    )  # fmt: skip

    def produce(self, image: vtkImageData) -> vtkImageData:
        """Return the image with less noise."""
        pixels = array_of_image(image, "radiance")
        if pixels.shape[2] != 4:
            raise ValueError(
                "the array 'radiance' has red, green, blue and alpha, "
                f"got {pixels.shape[2]} components"
            )
        radiance, alpha = pixels[..., :3], pixels[..., 3]
        if self.method == "knn":
            error = array_of_image(image, "standard_error")
            smooth = knn(radiance, alpha, error, self.exposure)
        else:
            smooth = oidn(radiance, alpha, _guide(image, "albedo"), _guide(image, "normal"))
        result = vtkImageData()
        result.ShallowCopy(image)
        result.GetPointData().SetScalars(image_of_radiance(*smooth).GetPointData().GetScalars())
        note = vtkStringArray()
        note.SetName("denoised")
        note.InsertNextValue(self.method)
        result.GetFieldData().AddArray(note)
        return result


def _guide(image: vtkImageData, name: str) -> Any:
    present = image.GetPointData().HasArray(name)
    return array_of_image(image, name) if present else None
