"""One picture of an ImageData, in the words of `pyvista.Plotter.add_volume`."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any

import pyvista as pv
from vtkmodules.vtkCommonDataModel import vtkPlane
from vtkmodules.vtkRenderingCore import vtkLight

from ..camera import PixelFilter
from ..front import TECHNIQUES
from ..lights import Light
from ..live import LiveSettings
from ..live.reading import SceneReader
from ..noiseless import render_noiseless
from ..pictures.noiseless import NoiselessPicture
from ..pictures.picture import Display, Picture
from ..rendering import render_scene
from ..scene import Scene
from ..vtk_bridge.lights import light_of
from ..vtk_bridge.props import volumes_of

KITS = ("light kit", "three lights", "none")
STOPS = ("samples", "nrms", "seconds")
RUN = ("seed", "threads", "progress", "abort")
LOOK = ("exposure", "lens", "scattering", "gradient_factor", "occlusion", "emission_absorption")


@dataclass(frozen=True)
class Look:
    """What the volume looks like: words for `add_volume`, lights, planes that cut it."""

    words: dict[str, Any]
    lighting: Any
    clipping_planes: Any


@dataclass(frozen=True)
class View:
    """Where it is seen from, on how many pixels."""

    window_size: tuple[int, int]
    cpos: Any
    zoom: float | None
    parallel_projection: bool


def render(
    image: pv.ImageData, look: Look, view: View, behind: Any, options: dict[str, Any]
) -> Picture | NoiselessPicture:
    """Picture of an image; see `accessor.ImageAccessor.render`."""
    technique = options.pop("technique", TECHNIQUES[0])
    if technique not in TECHNIQUES:
        raise ValueError(f"technique is one of {', '.join(TECHNIQUES)}; got {technique!r}")
    how = {name: options.pop(name) for name in (*STOPS, *RUN) if name in options}
    settings = LiveSettings(
        technique=technique, **{name: options.pop(name) for name in LOOK if name in options}
    )
    with _plotter(image, look, view, options) as plotter:
        scene = _scene(plotter, look, settings, view.window_size)
    if technique == "monte-carlo":
        display = Display(settings.exposure_of(scene), behind)
        return render_scene(scene, display=display, **how)
    unused = [name for name in (*STOPS, "seed") if how.get(name) is not None]
    if unused:
        raise ValueError(f"technique {technique} has no {', '.join(unused)}: it takes no samples")
    how.pop("seed", None)
    return render_noiseless(
        technique, scene, settings.occlusion or settings.emission_absorption, settings.exposure,
        settings.exposure_of(scene), behind, **how,
    )  # fmt: skip


@contextmanager
def _plotter(
    image: pv.ImageData, look: Look, view: View, options: dict[str, Any]
) -> Iterator[pv.Plotter]:
    """Plotter that holds the volume and never renders."""
    kit: Any = look.lighting if isinstance(look.lighting, str) and look.lighting in KITS else "none"
    plotter: Any = pv.Plotter(off_screen=True, window_size=list(view.window_size), lighting=kit)
    try:
        volume = plotter.add_volume(
            image, show_scalar_bar=False, render=False, **look.words, **options
        )
        for plane in _planes(look.clipping_planes):
            volume.mapper.AddClippingPlane(plane)
        if view.parallel_projection:
            plotter.enable_parallel_projection()
        plotter.camera_position = view.cpos or plotter.renderer.get_default_cam_pos()
        if view.cpos is None or isinstance(view.cpos, str):
            plotter.renderer.ResetCamera()
        if view.zoom is not None:
            plotter.camera.zoom(view.zoom)
        yield plotter
    finally:
        plotter.close()


def _scene(plotter: pv.Plotter, look: Look, settings: LiveSettings, size: tuple[int, int]) -> Scene:
    reader = SceneReader()
    lighting = look.lighting
    if isinstance(lighting, str) and lighting not in (*KITS, "studio"):
        raise ValueError(
            f"lighting is one of {', '.join((*KITS, 'studio'))}, or lights; got {lighting!r}"
        )
    if not isinstance(lighting, str):
        lighting = _lights(lighting, plotter.camera)
    elif lighting in KITS:
        lighting = "scene"
    settings = replace(settings, lighting=lighting)
    scene = reader.scene(plotter.renderer, size, volumes_of(plotter.renderer), (), None, settings)
    return replace(scene, pixel_filter=PixelFilter())


def _lights(lighting: Any, camera: pv.Camera) -> tuple[Light, ...]:
    given = (lighting,) if isinstance(lighting, vtkLight | Light) else tuple(lighting)
    found = [x if isinstance(x, Light) else light_of(x, camera) for x in given]
    return tuple(light for light in found if light is not None)


def _planes(planes: Any) -> Iterator[vtkPlane]:
    """Planes of one or several vtkPlane, or of pairs of normal and origin."""
    for plane in (planes,) if isinstance(planes, vtkPlane) else planes:
        if isinstance(plane, vtkPlane):
            yield plane
            continue
        normal, origin = plane
        made = vtkPlane()
        made.SetNormal(*_normal(normal))
        made.SetOrigin(*origin)
        yield made


def _normal(normal: Any) -> tuple[float, ...]:
    """Direction of "x", "-y" and the like, or of three numbers."""
    if not isinstance(normal, str):
        return tuple(normal)
    sign, axis = (-1.0, normal[1:]) if normal.startswith("-") else (1.0, normal)
    if axis not in ("x", "y", "z"):
        raise ValueError(f"a normal is x, y, z, -x, -y, -z or three numbers; got {normal!r}")
    return tuple(sign * (axis == name) for name in "xyz")
