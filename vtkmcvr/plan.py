"""Scene -> packed scene: which effects run, with reasons. Only this builds packed tuples."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from . import packed
from .kernels.majorant import cell_majorants, mark_empty_cubes, range_maxima
from .plan_lights import pack_lights
from .scene import Camera, PixelFilter, Scene
from .tables import DEEPEST_VOXEL, Tables, build_tables
from .voxels import Voxels, voxels_of

f32, f64 = np.float32, np.float64
# Transmittance below which Russian roulette may end a shadow ray; 1 would be delta tracking, which
# takes 1.4 times as long at equal error on a CT head (tests/bench/bench_looks.py).
ROULETTE = 0.3
FILTER_ENTRIES = 257
NOWHERE = -1e9


@dataclass(frozen=True)
class Effect:
    """One optional part of the simulation: whether it runs, and why."""

    name: str
    on: bool
    reason: str


@dataclass(frozen=True, eq=False)
class Plan:
    """What will be simulated, ready for kernels.

    Attributes
    ----------
    scene : Scene
    packed : vtkmcvr.packed.Scene
    effects : tuple of Effect
    notes : tuple of str
        What was changed or limited on the way, never silently.
    """

    scene: Scene
    packed: packed.Scene
    effects: tuple[Effect, ...]
    notes: tuple[str, ...]

    def explain(self) -> str:
        """Every effect, on or off, with its reason; then the notes."""
        width = max(len(effect.name) for effect in self.effects)
        lines = [f"{e.name:<{width}}  {'on ' if e.on else 'off'}  {e.reason}" for e in self.effects]
        return "\n".join([*lines, *(f"note: {note}" for note in self.notes)])

    @property
    def empty(self) -> bool:
        """Whether nothing in the volume can scatter or absorb."""
        return not bool((self.packed.medium.majorant > 0).any())


def plan(scene: Scene) -> Plan:
    """Pack a scene and give every effect its reason.

    Parameters
    ----------
    scene : Scene

    Returns
    -------
    Plan
    """
    voxels = voxels_of(scene.volume)
    tables = build_tables(scene.transfer, voxels, float(scene.volume.spacing.min()))
    medium = _medium(scene, voxels, tables)
    lens, lens_why = _lens(scene.camera)
    surface, gloss, surface_why, gloss_why = _surface(scene, voxels, tables)
    phase = packed.Phase(f32(scene.phase_g)) if abs(scene.phase_g) >= 1e-3 else None
    lights = pack_lights(scene)
    lit = lights.any
    shadows = (
        packed.Shadows(f32(min(scene.shadow_reach, 1e30))) if lit and scene.shadow_reach else None
    )
    ratio = packed.RatioTracking(f32(ROULETTE)) if shadows and scene.ratio_tracking else None
    transfer = packed.Transfer(
        tables.sigma_t, tables.colour, f32(voxels.lowest), f32(tables.per_scalar)
    )
    result = packed.Scene(
        medium, transfer, _camera(scene), lens, surface, gloss, phase, shadows, ratio,
        lights.ambient, lights.environment, lights.rectangles, lights.delta_lights, lights.choice,
        np.bool_(scene.environment_visible and bool(lights.ambient or lights.environment)),
    )  # fmt: skip
    effects = (
        _empty_space(medium),
        Effect("surface shading", surface is not None, surface_why),
        Effect("specular coat", gloss is not None, gloss_why),
        _phase_effect(phase),
        *lights.effects,
        _shadow_effect(scene, lit, ratio),
        Effect("depth of field", lens is not None, lens_why),
        _background_effect(scene, result),
    )
    return Plan(scene, result, effects, _notes(voxels, tables))


def _vector(v: NDArray) -> packed.Vector:
    return f32(v[0]), f32(v[1]), f32(v[2])


def _vector64(v: NDArray) -> packed.Vector64:
    return f64(v[0]), f64(v[1]), f64(v[2])


def _matrix(m: NDArray) -> packed.Matrix:
    return _vector(m[0]), _vector(m[1]), _vector(m[2])


def _matrix64(m: NDArray) -> packed.Matrix64:
    return _vector64(m[0]), _vector64(m[1]), _vector64(m[2])


def _medium(scene: Scene, voxels: Voxels, tables: Tables) -> packed.Medium:
    """Voxels with the majorants of this transfer function; no voxel is read."""
    majorant = np.empty(voxels.cell_lowest.shape, f32)
    cell_majorants(
        voxels.cell_lowest, voxels.cell_highest, range_maxima(tables.sigma_t),
        f32(voxels.lowest), f32(tables.per_scalar), majorant,
    )  # fmt: skip
    mark_empty_cubes(majorant)
    lo, hi = _active_box(majorant, voxels.cell, np.array(scene.volume.shape) - 1)
    index_from_world = np.linalg.inv(scene.volume.index_to_world[:3, :3])
    return packed.Medium(
        voxels.values, majorant, f32(voxels.cell), f32(1.0 / voxels.cell),
        _vector(lo), _vector(hi), _matrix(index_from_world),
    )  # fmt: skip


def _active_box(majorant: NDArray, cell: int, last: NDArray) -> tuple[NDArray, NDArray]:
    """Index box around all cells with extinction; a far point where there are none."""
    occupied = np.argwhere(majorant > 0)[:, ::-1]
    if not len(occupied):
        return np.full(3, NOWHERE), np.full(3, NOWHERE)
    return occupied.min(0) * cell, np.minimum((occupied.max(0) + 1) * cell, last)


def _camera(scene: Scene) -> packed.Camera:
    camera, (width, height) = scene.camera, scene.size
    right, up, forward = camera.frame
    x_shift, y_shift = camera.window_centre
    # Film (x, y) in pixels -> view coordinates a = -1 + x_shift + 2 x / width, b = 1 + y_shift - 2
    # y / height
    if camera.parallel_scale is None:
        extent = math.tan(math.radians(camera.view_angle) / 2)
    else:
        extent = camera.parallel_scale
    across, along = right * extent * width / height, up * extent
    corner = (x_shift - 1) * across + (y_shift + 1) * along
    steps = (2 / width * across, -2 / height * along)
    position = np.subtract(camera.position, scene.volume.centre)
    still = np.zeros(3)
    if camera.parallel_scale is None:
        vectors = (position, still, still, forward + corner, *steps)
    else:
        vectors = (position + corner, *steps, forward, still, still)
    origin, origin_x, origin_y, direction, direction_x, direction_y = map(_vector64, vectors)
    return packed.Camera(
        origin, origin_x, origin_y, direction, direction_x, direction_y,
        _matrix64(np.linalg.inv(scene.volume.index_to_world[:3, :3])),
        _vector64((np.array(scene.volume.shape) - 1) / 2),
        _filter_table(scene.pixel_filter),
    )  # fmt: skip


def _filter_table(pixel_filter: PixelFilter) -> NDArray[np.float32]:
    """Inverse distribution of the filter at evenly spaced probabilities, in pixels."""
    reach = 3.0 if pixel_filter.kind == "gaussian" else 1.0
    x = np.linspace(-reach, reach, 4097)
    density = {
        "gaussian": np.exp(-x * x / 2),
        "box": np.ones_like(x),
        "tent": 1 - np.abs(x),
    }[pixel_filter.kind]
    cdf = np.concatenate([[0.0], np.cumsum((density[1:] + density[:-1]) / 2)])
    quantiles = np.interp(np.linspace(0, 1, FILTER_ENTRIES), cdf / cdf[-1], x)
    return np.ascontiguousarray(quantiles * pixel_filter.width, f32)


def _lens(camera: Camera) -> tuple[packed.Lens | None, str]:
    if camera.lens is None:
        return None, "the camera has no lens: a pinhole"
    if camera.lens.radius == 0:
        return None, "aperture radius is 0: a pinhole"
    if camera.parallel_scale is not None:
        return None, "a parallel projection has no lens"
    right, up, forward = camera.frame
    focus = camera.lens.focus_distance or camera.distance
    lens = packed.Lens(
        f32(camera.lens.radius), f32(focus), _vector(right), _vector(up), _vector(forward)
    )
    return lens, f"aperture radius {camera.lens.radius:g}, sharp at distance {focus:g}"


def _surface(
    scene: Scene, voxels: Voxels, tables: Tables
) -> tuple[packed.Surface | None, packed.Gloss | None, str, str]:
    surface = scene.surface
    no_gloss = "no surfaces"
    if surface is None:
        return None, None, "the scene has no surface: no gradients", no_gloss
    if surface.gradient_factor == 0 and not surface.always:
        return None, None, "gradient factor is 0: no gradients", no_gloss
    to_world = np.linalg.inv(scene.volume.index_to_world[:3, :3]).T
    largest = voxels.largest_gradient(np.ascontiguousarray(to_world))
    if largest == 0:
        return None, None, "the volume is constant: no gradients", no_gloss
    result = packed.Surface(
        tables.opacity, _matrix(to_world), f32(1 / largest),
        f32(25 * surface.gradient_factor**3), np.bool_(surface.always),
    )  # fmt: skip
    why = "at every gradient" if surface.always else f"gradient factor {surface.gradient_factor:g}"
    if max(surface.specular) == 0:  # type: ignore[arg-type]
        return result, None, why, "specular reflectance is 0: Lambert"
    gloss = packed.Gloss(_vector(np.array(surface.specular)), f32(surface.exponent))
    return result, gloss, why, f"Fresnel blend, Blinn exponent {surface.exponent:g}"


def _empty_space(medium: packed.Medium) -> Effect:
    share = float(np.mean(medium.majorant <= 0))
    if share == 1:
        return Effect("medium", False, "the transfer function makes the whole volume transparent")
    return Effect(
        "medium", True, f"delta tracking; {share:.0%} of the macrocells are empty and skipped"
    )


def _phase_effect(phase: packed.Phase | None) -> Effect:
    if phase is None:
        return Effect("anisotropic phase", False, "g is 0: isotropic")
    return Effect("anisotropic phase", True, f"Henyey-Greenstein, g = {phase.g:g}")


def _shadow_effect(scene: Scene, lit: bool, ratio: packed.RatioTracking | None) -> Effect:
    if not lit:
        return Effect("shadows", False, "no lights: no shadow rays")
    if scene.shadow_reach == 0:
        return Effect("shadows", False, "shadow reach is 0")
    how = "ratio tracking" if ratio else "delta tracking, seen or not"
    reach = "" if math.isinf(scene.shadow_reach) else f", up to {scene.shadow_reach:g}"
    return Effect("shadows", True, how + reach)


def _background_effect(scene: Scene, result: packed.Scene) -> Effect:
    if result.environment_visible:
        return Effect("visible environment", True, "camera rays that miss the volume see it")
    why = "no environment" if scene.environment_visible else "the scene hides it: transparent there"
    return Effect("visible environment", False, why)


def _notes(voxels: Voxels, tables: Tables) -> tuple[str, ...]:
    notes = []
    if voxels.not_finite:
        notes.append(f"{voxels.not_finite} voxels are NaN or infinite: transparent")
    if voxels.offset:
        notes.append(f"values are kept relative to {voxels.offset:g} to fit float32")
    if tables.capped:
        notes.append(
            f"extinction was cut off at {DEEPEST_VOXEL:g} optical depths per smallest voxel edge"
        )
    if tables.too_fine:
        notes.append(
            f"transfer function nodes lie closer than the table resolves ({tables.pitch:g})"
        )
    return tuple(notes)
