"""`image.mcvr`: a volume in PyVista's words -> a picture.

Found by the entry point group `pyvista.accessors`; nothing heavy is imported before `render`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import pyvista as pv

if TYPE_CHECKING:
    from ..pictures.noiseless import NoiselessPicture
    from ..pictures.picture import Picture

WINDOW_SIZE = (800, 600)


@pv.register_dataset_accessor("mcvr", pv.ImageData)
class ImageAccessor:
    """Physically based light for an ImageData.

    Parameters
    ----------
    image : pyvista.ImageData

    Examples
    --------
    >>> picture = image.mcvr.render(cmap="bone", opacity="sigmoid", shade=True, samples=64)
    """

    def __init__(self, image: pv.ImageData) -> None:
        self._image = image

    def render(
        self,
        scalars: str | None = None,
        *,
        cmap: Any = None,
        opacity: Any = "linear",
        clim: Sequence[float] | None = None,
        opacity_unit_distance: float | None = None,
        shade: bool = False,
        window_size: tuple[int, int] = WINDOW_SIZE,
        cpos: Any = None,
        zoom: float | None = None,
        parallel_projection: bool = False,
        lighting: Any = "light kit",
        background: Any = None,
        clipping_planes: Any = (),
        transparent_background: bool = False,
        **options: Any,
    ) -> Picture | NoiselessPicture:
        """Render the image as `pyvista.Plotter.add_volume` would show it, by light transport.

        Parameters
        ----------
        scalars : str, optional
            Name of the array. Default: the active one.
        cmap, opacity, clim, opacity_unit_distance, shade
            As for `pyvista.Plotter.add_volume`: opacity is a name such as "sigmoid_5", "linear_r",
            "geom", or an array.
        window_size : (width, height)
            Pixels.
        cpos : camera position, optional
            As for `pyvista.Plotter.camera_position`: "xz", "iso", three vectors. Default: that of
            the theme.
        zoom : float, optional
            As for `pyvista.Camera.zoom`.
        parallel_projection : bool
        lighting : {"light kit", "three lights", "none", "studio"} or sequence
            PyVista's lights by name; a key, a rim and a fill light; or `pyvista.Light` and lights
            of this package.
        background : colour, optional
            Any colour that PyVista knows. Default: that of the theme.
        clipping_planes : vtkPlane, or a sequence of them or of (normal, origin)
            What lies on the side to which the normals point is kept.
        transparent_background : bool
            Whether the picture keeps its alpha instead of a background.
        **options
            `samples`, `nrms`, `seconds`, `seed`, `threads`, `technique`, `occlusion`,
            `emission_absorption`, `exposure`, `lens`, `scattering`, `gradient_factor`, `progress`,
            `abort` as for `vtkmcvr.render`; all others are `add_volume`'s: `log_scale`, `diffuse`,
            `specular`, `user_matrix` ...

        Returns
        -------
        Picture or NoiselessPicture
            Shows itself in a notebook; `vtkmcvr.to_pyvista(picture)` is an ImageData, its
            attributes are NumPy arrays.
        """
        from .one_picture import Look, View, render

        look = Look(
            {
                "scalars": scalars, "cmap": cmap, "opacity": opacity, "clim": clim,
                "opacity_unit_distance": opacity_unit_distance, "shade": shade,
            },
            lighting, clipping_planes,
        )  # fmt: skip
        view = View(window_size, cpos, zoom, parallel_projection)
        behind = (
            None
            if transparent_background
            else pv.Color(background, default_color=pv.global_theme.background).float_rgb
        )
        return render(self._image, look, view, behind, options)
