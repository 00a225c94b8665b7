"""The front door: a volume and a few words in, a picture out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from . import __version__, checks
from .lights import Light
from .occlusion import Occlusion, OcclusionPicture, render_occlusion
from .picture import Display, Picture
from .plan import plan
from .presets import Dressed, dress
from .rendering import render_scene
from .scene import Camera, Scene, TransferFunction, Volume
from .schedule import Progress
from .studio import view_camera
from .volume_info import units
from .vtk_scene import volume_of

TECHNIQUES = ("monte-carlo", "occlusion")
# sRGB colour behind presets
BACKDROP = (0.07, 0.08, 0.10)


@dataclass(frozen=True)
class View:
    """Where the camera stands; see `vtkmcvr.studio.view_camera`."""

    view: str = "front"
    azimuth: float = 0.0
    elevation: float = 0.0
    roll: float = 0.0
    zoom: float = 1.0


def scene_of(
    data: Any,
    *,
    preset: str | None = None,
    transfer: TransferFunction | None = None,
    camera: Camera | None = None,
    lights: Sequence[Light] | None = None,
    view: View | None = None,
    size: tuple[int, int] = (800, 600),
    shift: float | None = None,
    **effects: Any,
) -> Dressed:
    """Scene of a volume: a look, with any part of it replaced.

    Parameters
    ----------
    data : vtkImageData, pyvista.ImageData or Volume
    preset : str, optional
        One of `vtkmcvr.presets.LOOKS`. Default: chosen from the values.
    transfer, camera, lights : optional
        Instead of the look's.
    view : View, optional
        Where to look from, without `camera`.
    size : (width, height)
        Pixels.
    shift : float, optional
        Number to add to the values to get HU. Default: 0 for HU, else detected.
    **effects
        Other fields of `Scene`: surface, phase, scattering, shadow_reach, environment_visible,
        pixel_filter ...

    Returns
    -------
    Dressed
        The scene, its exposure, the name of the look, and notes.
    """
    volume = data if isinstance(data, Volume) else volume_of(data)
    known = units(data) if not isinstance(data, Volume) else ""
    width = checks.whole("film width", size[0], least=1)
    height = checks.whole("film height", size[1], least=1)
    place = camera or view_camera(volume)
    dressed = dress(volume, place, preset, units=known, shift=shift, size=(width, height))
    if camera is None:
        camera = _framed(dressed.scene, view or View())
        dressed = dress(volume, camera, preset, units=known, shift=shift, size=(width, height))
    changes = dict(effects)
    if transfer is not None:
        changes["transfer"] = transfer
    if lights is not None:
        changes["lights"] = tuple(lights)
    return replace(dressed, scene=replace(dressed.scene, **changes)) if changes else dressed


def _framed(scene: Scene, view: View) -> Camera:
    """Camera on the part of the volume that the transfer function shows."""
    volume, (width, height) = scene.volume, scene.size
    corners = plan(scene).corners
    return view_camera(
        volume, view.view, azimuth=view.azimuth, elevation=view.elevation, roll=view.roll,
        zoom=view.zoom, aspect=width / height,
        corners=corners if len(corners) else None,
    )  # fmt: skip


def render(
    data: Any,
    *,
    technique: str = "monte-carlo",
    occlusion: Occlusion | None = None,
    samples: int | None = None,
    seconds: float | None = None,
    nrms: float | None = None,
    adaptive: bool = False,
    seed: int = 0,
    threads: int | None = None,
    exposure: float | None = None,
    background: tuple[float, float, float] | None = BACKDROP,
    progress: Callable[[Progress], object] | None = None,
    abort: Callable[[], bool] | None = None,
    **scene: Any,
) -> Picture | OcclusionPicture:
    """Render a volume.

    Parameters
    ----------
    data : vtkImageData, pyvista.ImageData, Volume or Scene
    technique : {"monte-carlo", "occlusion"}
        Light transport, or directional occlusion shading: quick, without noise, biased.
    occlusion : Occlusion, optional
        Cone, mode and accuracy of technique "occlusion", which takes no samples, seconds or seed.
    samples : int, optional
        Samples per pixel. Default: 64, or unlimited with `seconds` or `nrms`.
    seconds : float, optional
        Time to render.
    nrms : float, optional
        Error to reach, such as 0.02. Whichever of the three is met first ends the render.
    adaptive : bool
        Samples go where the noise is; `samples` counts those of the mean pixel.
    seed : int
        The same seed gives the same bits on any number of threads.
    threads : int, optional
        Default: all CPUs that the process may use.
    exposure : float, optional
        Stops. Default: the look's.
    background : (r, g, b) or None
        sRGB colour behind the volume, or None for a transparent picture.
    progress, abort : callable, optional
        See `vtkmcvr.render_scene`.
    **scene
        `preset`, `size`, `camera`, `lights` and all else that `scene_of` takes.

    Returns
    -------
    Picture or OcclusionPicture

    Examples
    --------
    >>> picture = vtkmcvr.render(image, preset="ct-bone", size=(400, 300), samples=16)
    >>> picture = vtkmcvr.render(image, technique="occlusion")
    """
    if technique not in TECHNIQUES:
        raise ValueError(f"technique is one of {', '.join(TECHNIQUES)}; got {technique!r}")
    if isinstance(data, Scene):
        dressed = Dressed(replace(data, **scene), 0.0, "none", ())
    else:
        dressed = scene_of(data, **scene)
    display = Display(dressed.exposure if exposure is None else exposure, background)
    if technique == "occlusion":
        _check_unused(samples=samples, seconds=seconds, nrms=nrms, adaptive=adaptive or None)
        result = render_occlusion(
            dressed.scene, occlusion, threads=threads, display=display, progress=progress,
            abort=abort,
        )  # fmt: skip
        return replace(result, recipe=_recipe(result, dressed, None, None, None))
    if occlusion is not None:
        raise ValueError('occlusion=... needs technique="occlusion"')
    picture = render_scene(
        dressed.scene, samples=samples, seconds=seconds, nrms=nrms, adaptive=adaptive, seed=seed,
        threads=threads, display=display, progress=progress, abort=abort,
    )  # fmt: skip
    return replace(picture, recipe=_recipe(picture, dressed, samples, seconds, nrms))


def _check_unused(**options: float | None) -> None:
    for name, value in options.items():
        if value is not None:
            raise ValueError(
                f"technique occlusion has no {name} (got {value}); its accuracy is set by "
                "Occlusion(directions=..., detail=...)"
            )


def _recipe(
    picture: Picture | OcclusionPicture,
    dressed: Dressed,
    samples: int | None,
    seconds: float | None,
    nrms: float | None,
) -> dict[str, Any]:
    """What was asked for, as plain JSON values; nothing of the volume's file or patient."""
    volume, camera = dressed.scene.volume, dressed.scene.camera
    return {
        "version": __version__,
        "technique": "occlusion" if isinstance(picture, OcclusionPicture) else "monte-carlo",
        "preset": dressed.preset,
        "samples": samples,
        "seconds": seconds,
        "nrms": nrms,
        "seed": picture.seed,
        "size": list(picture.size),
        "exposure": picture.display.exposure,
        "background": picture.display.background,
        "camera": {
            "position": camera.position,
            "focal_point": camera.focal_point,
            "view_up": camera.view_up,
            "view_angle": camera.view_angle,
            "parallel_scale": camera.parallel_scale,
        },
        "volume": describe(volume),
        "notes": [*dressed.notes, *picture.plan.notes],
    }


def describe(volume: Volume) -> dict[str, Any]:
    """Dimensions, spacing, direction, origin and range of a volume, as plain JSON values."""
    spacing = volume.spacing
    values = volume.values
    return {
        "dimensions": list(volume.shape),
        "spacing": spacing.tolist(),
        "origin": volume.index_to_world[:3, 3].tolist(),
        "direction": (volume.index_to_world[:3, :3] / spacing).tolist(),
        "range": [_number(np.nanmin(values)), _number(np.nanmax(values))],
        "type": str(values.dtype),
    }


def _number(x: Any) -> float | int | None:
    x = x.item()
    return x if np.isfinite(x) else None
