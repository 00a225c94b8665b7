"""The front door: a volume and a few words in, a picture out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from . import __version__, checks
from .emission_absorption import EmissionAbsorption, EmissionAbsorptionPicture
from .lights import Light
from .noiseless import TECHNIQUES as NOISELESS
from .noiseless import check_settings, render_noiseless
from .occlusion import Occlusion, OcclusionPicture
from .pictures.picture import Display, Picture
from .presets import Dressed, Look, dress
from .presets.fit import look_of
from .presets.framing import view_of_slab
from .presets.overlay import with_overlay
from .presets.recorded import chosen_labels
from .presets.solids import as_solids, with_segmentation
from .recorded_facts import modality, segments, units
from .rendering import render_scene
from .scene import Camera, Scene, TransferFunction, Volume
from .schedule import Progress
from .segmentation import Segmentation
from .studio import View, view_camera

TECHNIQUES = ("monte-carlo", *NOISELESS)
# sRGB colour behind presets
BACKDROP = (0.07, 0.08, 0.10)


def scene_of(
    data: Any,
    *,
    preset: str | Look | None = None,
    transfer: TransferFunction | None = None,
    camera: Camera | None = None,
    lights: Sequence[Light] | None = None,
    view: View | None = None,
    size: tuple[int, int] = (800, 600),
    shift: float | None = None,
    whole: bool = False,
    segmentation: Segmentation | None = None,
    overlay: Any = None,
    overlay_preset: str | Look | None = None,
    **effects: Any,
) -> Dressed:
    """Scene of a volume: a look, with any part of it replaced.

    Parameters
    ----------
    data : vtkImageData, pyvista.ImageData or Volume
    preset : str or Look, optional
        One of `vtkmcvr.presets.LOOKS`, or a look of your own. Default: chosen from the values.
    transfer, camera, lights : optional
        Instead of the look's.
    view : View, optional
        Where to look from, without `camera`. Default: the look's.
    size : (width, height)
        Pixels.
    shift : float, optional
        Number to add to the values to get HU. Default: 0 for HU, else detected.
    whole : bool
        Also show what a CT look leaves out: the table, what lies close under the skin.
    segmentation : Segmentation, optional
        Labels on the grid of the volume: those chosen become solids, those hidden are left out.
    overlay : vtkImageData, pyvista.ImageData or Volume, optional
        A second volume in the same world, such as PET over CT.
    overlay_preset : str or Look, optional
        Its look. Default: chosen from its values; of a look that glows, only what glows is seen.
    **effects
        Other fields of `Scene`: surface, phase, scattering, shadow_reach, environment_visible,
        pixel_filter ...

    Returns
    -------
    Dressed
        The scene, its exposure, the name of the look, and notes.
    """
    volume, known, noted = _volume_and_facts(data)
    width = checks.whole("film width", size[0], least=1)
    height = checks.whole("film height", size[1], least=1)
    look = look_of(volume, preset, **known)

    def dressed_for(place: Camera) -> Dressed:
        found = dress(
            volume, place, look, chosen=preset is None, shift=shift, size=(width, height),
            whole=whole, **known,
        )  # fmt: skip
        if look.units == "labels":
            return as_solids(found, segmentation or _segmentation(data, volume))
        if segmentation is not None:
            found = with_segmentation(found, segmentation)
        return found if overlay is None else _overlaid(found, overlay, overlay_preset)

    dressed = dressed_for(camera or view_camera(volume))
    if camera is None:
        dressed = dressed_for(_framed(dressed, view or view_of_slab(look.view, dressed.points)))
    dressed = replace(dressed, notes=(*dressed.notes, *noted))
    changes = dict(effects)
    if transfer is not None:
        changes["transfer"] = transfer
    if lights is not None:
        changes["lights"] = tuple(lights)
    return replace(dressed, scene=replace(dressed.scene, **changes)) if changes else dressed


def _volume_and_facts(data: Any) -> tuple[Volume, dict[str, str], tuple[str, ...]]:
    """Volume; units and modality where a reader recorded them; notes on its components."""
    if isinstance(data, Volume):
        return data, {"units": "", "modality": ""}, ()
    from .vtk_bridge.single import single_volume

    volume, noted = single_volume(data)
    modal = "SEG" if segments(data) else modality(data)
    if volume.colours is not None:
        modal = "colours"
    return volume, {"units": units(data), "modality": modal}, noted


def _overlaid(dressed: Dressed, overlay: Any, preset: str | Look | None) -> Dressed:
    volume, known, _ = _volume_and_facts(overlay)
    return with_overlay(dressed, volume, preset, **known)


def _segmentation(data: Any, volume: Volume) -> Segmentation:
    """Segmentation of a label map that is rendered itself."""
    return Segmentation(volume, () if isinstance(data, Volume) else tuple(segments(data)))


def _framed(dressed: Dressed, view: View) -> Camera:
    """Camera on the part of the volume that the look shows."""
    width, height = dressed.scene.size
    return view_camera(
        dressed.scene.volume, view.view, azimuth=view.azimuth, elevation=view.elevation,
        roll=view.roll, zoom=view.zoom, aspect=width / height, corners=dressed.points,
    )  # fmt: skip


def render(
    data: Any,
    *,
    technique: str = "monte-carlo",
    occlusion: Occlusion | None = None,
    emission_absorption: EmissionAbsorption | None = None,
    samples: int | None = None,
    seconds: float | None = None,
    nrms: float | None = None,
    adaptive: bool = False,
    seed: int = 0,
    threads: int | None = None,
    backend: str = "auto",
    exposure: float | None = None,
    background: tuple[float, float, float] | None = BACKDROP,
    progress: Callable[[Progress], object] | None = None,
    abort: Callable[[], bool] | None = None,
    **scene: Any,
) -> Picture | OcclusionPicture | EmissionAbsorptionPicture:
    """Render a volume.

    Parameters
    ----------
    data : vtkImageData, pyvista.ImageData, Volume or Scene
    technique : {"monte-carlo", "occlusion", "emission-absorption"}
        Light transport; directional occlusion shading: quick, without noise, biased; emission and
        absorption: what VTK's own volume mappers show, with no light but a lamp at the eye.
    occlusion : Occlusion, optional
        Cone, mode and accuracy of technique "occlusion", which takes no samples, seconds or seed.
    emission_absorption : EmissionAbsorption, optional
        Steps, rays and shading of technique "emission-absorption"; it takes none of these either.
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
    backend : {"auto", "cpu", "cuda"}
        "auto": a CUDA device where there is one and numba-cuda is installed, else the CPU.
    exposure : float, optional
        Stops. Default: the look's; of emission and absorption 0, and colours are shown as they are.
    background : (r, g, b) or None
        sRGB colour behind the volume, or None for a transparent picture.
    progress, abort : callable, optional
        See `vtkmcvr.render_scene`.
    **scene
        `preset`, `size`, `camera`, `lights` and all else that `scene_of` takes.

    Returns
    -------
    Picture, OcclusionPicture or EmissionAbsorptionPicture

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
    check_settings(technique, occlusion=occlusion, emission_absorption=emission_absorption)
    if technique in NOISELESS:
        _check_unused(
            technique, samples=samples, seconds=seconds, nrms=nrms, adaptive=adaptive or None
        )
        result = render_noiseless(
            technique, dressed.scene, occlusion or emission_absorption, exposure,
            dressed.exposure, background, threads=threads, backend=backend, progress=progress,
            abort=abort,
        )  # fmt: skip
        return replace(result, recipe=_recipe(result, dressed, None, None, None))
    display = Display(dressed.exposure if exposure is None else exposure, background)
    picture = render_scene(
        dressed.scene, samples=samples, seconds=seconds, nrms=nrms, adaptive=adaptive, seed=seed,
        threads=threads, backend=backend, display=display, progress=progress, abort=abort,
    )  # fmt: skip
    return replace(picture, recipe=_recipe(picture, dressed, samples, seconds, nrms))


ACCURACY = {
    "occlusion": "Occlusion(directions=..., detail=...)",
    "emission-absorption": "EmissionAbsorption(step=..., rays=...)",
}


def _check_unused(technique: str, **options: float | None) -> None:
    for name, value in options.items():
        if value is not None:
            raise ValueError(
                f"technique {technique} has no {name} (got {value}); its accuracy is set by "
                f"{ACCURACY[technique]}"
            )


def _recipe(
    picture: Picture | OcclusionPicture | EmissionAbsorptionPicture,
    dressed: Dressed,
    samples: int | None,
    seconds: float | None,
    nrms: float | None,
) -> dict[str, Any]:
    """What was asked for, as plain JSON values; nothing of the volume's file or patient."""
    volume, camera = dressed.scene.volume, dressed.scene.camera
    return {
        "version": __version__,
        "technique": picture.technique,
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
        "segmentation": chosen_labels(dressed.segmentation),
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
