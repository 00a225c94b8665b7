"""Radiance -> display picture."""

from __future__ import annotations

from typing import Any, Self

from vtkmodules.vtkCommonCore import VTK_UNSIGNED_CHAR
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkImageData
from vtkmodules.vtkRenderingCore import vtkRenderer

from vtkmcvr import checks
from vtkmcvr.pictures.display import EXPOSURE, SHADED_EXPOSURE, to_rgba8
from vtkmcvr.screen import CURVES
from vtkmcvr.vtk_bridge.background import background_of
from vtkmcvr.vtk_bridge.props import volumes_of
from vtkmcvr.vtk_bridge.scene import array_of_image, image_of_arrays

from .base import ImageFilter
from .parameters import Parameter, one_of, optional

RGBA_COMPONENTS = 4


def _background(value: Any) -> tuple[float, float, float]:
    colour = checks.colour("background", value)
    if max(colour) > 1:
        raise ValueError(f"background is sRGB from 0 to 1, got {colour}")
    return colour


class ToneMapFilter(ImageFilter):
    """Turns the radiance of a picture into 8-bit sRGB; changing it traces no ray upstream.

    Input: vtkImageData with the point array "radiance" of `MonteCarloFilter`. Output: an image of
    the same geometry with the uint8 point array "rgba" (active, straight alpha).

    Parameters
    ----------
    **settings
        Any parameter by name: `ToneMapFilter(exposure=1.0)`.
    """

    exposure = Parameter(
        0.0, lambda v: checks.number("exposure", v),
        "Stops; +1 doubles the brightness before tone mapping.",
    )  # fmt: skip
    background = Parameter(
        None, optional(_background), "sRGB from 0 to 1 behind the volume. None: transparent."
    )
    renderer = Parameter(
        None, optional(one_of("renderer", vtkRenderer)),
        "vtkRenderer whose background, gradient or background texture is behind the volume where "
        "`background` is None, or None.",
    )  # fmt: skip
    gamma = Parameter(
        None, optional(lambda v: checks.number("gamma", v, above=0.0, most=10.0)),
        "Encode by the power 1 / gamma, as in Exposure Render. None: sRGB.",
    )  # fmt: skip

    curve = Parameter(
        "film", lambda v: checks.choice("curve", v, CURVES),
        '"film": the tone curve of Exposure Render. "none": light above 1 is cut off, as in VTK.',
    )  # fmt: skip

    @classmethod
    def from_renderer(cls, renderer: vtkRenderer, **settings: Any) -> Self:
        """Filter with a renderer's background, and the exposure at which VTK is about as bright.

        Parameters
        ----------
        renderer : vtkRenderer
        **settings
            Parameters by name.
        """
        shaded = any(volume.GetProperty().GetShade() for volume in volumes_of(renderer))
        exposure = SHADED_EXPOSURE if shaded else EXPOSURE
        return cls(**{"renderer": renderer, "exposure": exposure, **settings})

    def RequestInformation(self, request: Any, inputs: Any, outputs: Any) -> int:
        """Announce 8-bit RGBA; the extent is the input's."""
        info = outputs.GetInformationObject(0)
        vtkDataObject.SetPointDataActiveScalarInfo(info, VTK_UNSIGNED_CHAR, RGBA_COMPONENTS)
        return 1

    def produce(self, image: vtkImageData) -> vtkImageData:
        """Return the display picture of an image with radiance."""
        radiance = array_of_image(image, "radiance")
        if radiance.shape[2] != RGBA_COMPONENTS:
            raise ValueError(
                "the array 'radiance' has red, green, blue and alpha, "
                f"got {radiance.shape[2]} components"
            )
        rgba = to_rgba8(
            radiance[..., :3], radiance[..., 3],
            exposure=self.exposure, background=self._behind(*radiance.shape[:2]), gamma=self.gamma,
            curve=self.curve,
        )  # fmt: skip
        shown = image_of_arrays({"rgba": rgba})
        result = vtkImageData()
        result.CopyStructure(image)
        result.GetPointData().SetScalars(shown.GetPointData().GetScalars())
        return result

    def _behind(self, rows: int, columns: int) -> Any:
        if self.background is not None or self.renderer is None:
            return self.background
        return background_of(self.renderer, rows, columns)
