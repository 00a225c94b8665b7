"""Scene -> picture by directional occlusion."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from time import perf_counter
from typing import Any

import numpy as np

from .. import backends, checks, packed
from ..lights import ConstantEnvironment
from ..material import Surface
from ..openings import openings_of
from ..pack import f32, vector
from ..phases import Isotropic
from ..plan import Plan, plan
from ..scene import Scene, Volume
from ..schedule import Progress, default_threads
from ..screen import Display
from .ambient import ambient_radiance
from .beams import beams_of
from .carry_out import Parts, sweep
from .explain import effects_of, most_extinction
from .medium import OPAQUE, Filling, volumes_of
from .picture import OcclusionPicture
from .raster import MARGIN, Raster, raster_of
from .resolve import resolve
from .settings import MOST_SLICES, Occlusion
from .single import Blurred, Published
from .sweep import Light
from .traced import Traced

# At detail 1: size of the raster's pixels and thickness of slices, in voxels
PIXEL, LAYER = 0.75, 0.4
# Voxels across the view below which a volume is small: there detail is up to `SMALLEST` times finer
SMALL, SMALLEST = 160, 0.6
# Pixels of a refined raster
MOST_PIXELS, MOST_FINE = 2**23, 8
# Pixels of a raster with its margin, of small films
FEWEST_LIMIT = 2**21


def render_occlusion(
    scene: Scene,
    occlusion: Occlusion | None = None,
    *,
    threads: int | None = None,
    backend: str = "auto",
    display: Display | None = None,
    progress: Callable[[Progress], object] | None = None,
    abort: Callable[[], bool] | None = None,
    recipe: dict[str, Any] | None = None,
) -> OcclusionPicture:
    """Render a scene by directional occlusion shading.

    Parameters
    ----------
    scene : Scene
        Volumes, transfer functions, cuts, masks, labels, camera, film, `aovs`; of its lights only
        how much they give.
    occlusion : Occlusion, optional
    threads : int, optional
        >= 1; changes no bit. Default: all CPUs that the process may use.
    backend : {"auto", "cpu", "cuda"}
        As for `vtkmcvr.render_scene`; pictures of both differ by roundings.
    display : Display, optional
    progress, abort : callable, optional
        As for `vtkmcvr.render_scene`, after each block of layers.
    recipe : dict, optional
        Kept with the picture.

    Returns
    -------
    OcclusionPicture

    Raises
    ------
    ValueError
        For a panorama or two eyes on one film, which have no view axis; for receivers, which slices
        do not know; for normals and shaded surfaces of several volumes.
    CudaError
        Where backend "cuda" was asked for and cannot be used, or fails; for a backdrop on it.
    """
    backends.checked(backend)
    occlusion = occlusion or Occlusion()
    threads = default_threads() if threads is None else checks.whole("threads", threads, least=1)
    _check_camera(scene)
    _check_parts(scene, occlusion)
    begin = perf_counter()
    planned, raster, fine = layout(scene, occlusion)
    parts = parts_of(scene, planned, raster, occlusion)
    openings = None
    if scene.backdrop is not None:
        openings = openings_of(scene.backdrop, scene.camera.frame[2], fine)

    def report(fraction: float) -> None:
        if progress is not None:
            progress(Progress(fraction, 1, perf_counter() - begin))

    hidden = None if openings is None else openings.packed
    done = sweep(backend, parts, threads, report, abort, hidden)
    film = done.film
    radiance = ambient_radiance(scene) if occlusion.radiance is None else occlusion.radiance
    film.radiance[:] *= np.asarray(radiance, f32)
    planes = resolve(film, fine, scene.pixel_filter)
    effects, notes = effects_of(scene, planned, occlusion, raster, fine, _axis(scene, occlusion))
    if done.note:
        notes = (*notes, done.note)
    return OcclusionPicture(
        planes, replace(planned, scene=scene, effects=effects, notes=notes), occlusion,
        display or Display(), perf_counter() - begin, "end" if done.ended else "user", threads,
        done.work, recipe=recipe or {}, backend=done.backend, device=done.device,
        behind=None if openings is None else openings.behind(),
    )  # fmt: skip


def _check_camera(scene: Scene) -> None:
    camera = scene.camera
    if camera.panorama:
        raise ValueError("a panorama has no slices across a view axis: use a perspective camera")
    if camera.stereo is not None and camera.stereo.eyes == "both":
        raise ValueError(
            "occlusion renders one eye at a time: Stereo(eyes='left'), then Stereo(eyes='right')"
        )


def _check_parts(scene: Scene, occlusion: Occlusion) -> None:
    """Refuse what slices would leave out in silence."""
    if scene.receivers:
        raise ValueError(
            "technique occlusion does not know receivers: leave them out, or use technique "
            "monte-carlo"
        )
    if scene.layers and (occlusion.shaded or "normal" in scene.aovs):
        raise ValueError(
            "technique occlusion knows the gradients of one volume only: leave out shaded=True "
            "and the aov normal, or the further volumes"
        )


def parts_of(scene: Scene, planned: Plan, raster: Raster, occlusion: Occlusion) -> Parts:
    """What a sweep takes, of a `layout`."""
    width, height = planned.scene.size
    return Parts(
        raster, _filling(planned, occlusion, raster), _light(scene, raster, occlusion),
        _shade(scene, planned, occlusion), _film((height, width), scene.aovs),
    )  # fmt: skip


def _film(shape: tuple[int, int], aovs: tuple[str, ...]) -> packed.OcclusionFilm:
    colour = (*shape, 3)
    return packed.OcclusionFilm(
        np.zeros(colour, f32), np.zeros(shape, f32), np.zeros(shape, f32), np.zeros(shape, f32),
        np.zeros(colour, f32) if "albedo" in aovs else None,
        np.zeros(colour, f32) if "normal" in aovs else None,
    )  # fmt: skip


def layout(scene: Scene, occlusion: Occlusion) -> tuple[Plan, Raster, int]:
    """Plan of the raster's film, raster, and how many of its pixels make one of the film's side."""
    camera = replace(scene.camera, lens=None)
    surface = scene.surface if occlusion.shaded else None
    if surface is None and (occlusion.shaded or "normal" in scene.aovs):
        surface = Surface(mode="brdf", specular=0.0)
    others = tuple(replace(layer, surface=None) for layer in scene.layers)
    # A plan without any light has no surfaces
    lights = () if surface is None else (ConstantEnvironment(),)
    bare = replace(
        scene, camera=camera, lights=lights, surface=surface, phase=Isotropic(), layers=others,
        **PLAIN,
    )  # fmt: skip
    planned = plan(bare)
    voxel = min(_voxel(volume) for volume in (scene.volume, *(v.volume for v in scene.layers)))
    raster = _fitting(planned, LAYER * voxel)
    across = (raster.far - raster.near) / voxel
    grain = voxel * float(np.clip(across / SMALL, SMALLEST, 1)) / occlusion.detail
    layer = LAYER * grain
    if occlusion.slices is not None and raster.count:
        layer = (raster.far - raster.near) / occlusion.slices
    elif raster.count and (raster.far - raster.near) / layer > MOST_SLICES:
        # Voxels thousands of times longer than they are thick, seen along their long side
        layer = (raster.far - raster.near) / MOST_SLICES
    fine = _refinement(scene, raster, grain)
    if occlusion.mode == "paper":
        fine = 1
    if fine > 1:
        width, height = scene.size
        planned = plan(replace(bare, size=(width * fine, height * fine)))
    return planned, _fitting(planned, layer), fine


def _fitting(planned: Plan, layer: float) -> Raster:
    """Raster with as wide a margin as fits: beside a film of 10 000 x 1 pixels that is little."""
    width, height = planned.scene.size
    most = max(FEWEST_LIMIT, 4 * width * height)
    margin = MARGIN
    raster = raster_of(planned, layer, margin)
    while raster.columns * raster.rows > most:
        margin /= 2
        raster = raster_of(planned, layer, margin)
    return raster


def _voxel(volume: Volume) -> float:
    """Size of detail in a volume, world units."""
    return min(float(np.prod(volume.spacing)) ** (1 / 3), 2 * float(volume.spacing.min()))


# Parts of a scene that only Monte Carlo has
PLAIN: dict[str, Any] = {
    "scattering": "single", "max_scatterings": None, "aovs": (), "backdrop": None,
}  # fmt: skip


def _refinement(scene: Scene, raster: Raster, grain: float) -> int:
    """How many times finer than the film's the raster's pixels are."""
    width, height = scene.size
    most = max(1, math.isqrt(MOST_PIXELS // (width * height)))
    return int(np.clip(math.ceil(raster.pixel / (PIXEL * grain) - 0.1), 1, min(most, MOST_FINE)))


def _filling(planned: Plan, occlusion: Occlusion, raster: Raster) -> Filling:
    most = most_extinction(raster) if occlusion.mode == "default" else math.inf
    return Filling(
        volumes_of(planned, most), occlusion.bleeding or None,
        OPAQUE if occlusion.skip else 0.0, occlusion.skip,
    )  # fmt: skip


def _light(scene: Scene, raster: Raster, occlusion: Occlusion) -> Light:
    half_angle = math.radians(occlusion.half_angle)
    colours = 3 if occlusion.bleeding else 1
    if occlusion.mode == "paper":
        return Published(raster, half_angle, occlusion.grid, occlusion.exact_distance)
    if occlusion.mode == "fast":
        reach = occlusion.blur_reach or 2 * float(np.prod(scene.volume.spacing)) ** (1 / 3)
        return Blurred(raster, half_angle, reach, colours)
    return Traced(
        raster, beams_of(raster, half_angle, occlusion.directions, _axis(scene, occlusion)), colours
    )


def _axis(scene: Scene, occlusion: Occlusion) -> tuple[float, float, float] | None:
    """Axis of the cone along columns, rows, and toward the viewer."""
    if occlusion.toward_light is None:
        return None
    right, up, forward = scene.camera.frame
    x, y, z = np.array([right, -up, -forward]) @ np.array(occlusion.toward_light)
    if z <= math.sin(math.radians(5)):
        raise ValueError(
            "toward_light must point to the viewer's side, at least 5 degrees out of the picture's "
            f"plane; {occlusion.toward_light} points {math.degrees(math.asin(z)):.0f} degrees out"
        )
    return float(x), float(y), float(z)


def _shade(scene: Scene, planned: Plan, occlusion: Occlusion) -> packed.Shade | None:
    surface, gloss = planned.packed.surface, planned.packed.gloss
    if surface is None or not (occlusion.shaded or "normal" in scene.aovs):
        return None
    right, up, forward = scene.camera.frame
    toward = occlusion.toward_light
    black = (f32(0), f32(0), f32(0))
    return packed.Shade(
        surface, vector(-forward if toward is None else np.array(toward)),
        np.bool_(toward is None), vector(right), vector(-up), vector(forward),
        black if gloss is None else gloss.specular, f32(1) if gloss is None else gloss.exponent,
        f32(occlusion.shaded),
    )  # fmt: skip
