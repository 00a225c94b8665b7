"""Looks: transfer function, surface, lights and exposure that go together.

A look in HU expects a CT in Hounsfield units; `hu_offset` finds CTs that are stored with an offset
and no tag that says so. A relative look spreads its nodes over the range of the data.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .curves import ColourCurve, Curve
from .scene import Camera, Scene, Surface, TransferFunction, Volume
from .studio import Studio, studio_lights

Nodes = tuple[tuple[float, ...], ...]

# Offsets with which scanners and archives store HU as unsigned numbers, and where soft tissue then
# peaks
STORED_OFFSETS = (1000, 1024)
SOFT_TISSUE_HU, SOFT_TISSUE_WINDOW = 40.0, (-60.0, 140.0)


@dataclass(frozen=True)
class Look:
    """One way to show a kind of volume.

    Attributes
    ----------
    name, about : str
    units : {"HU", "relative"}
        What node positions mean: Hounsfield units, or 0 to 1 over the data's range up to its 99.9th
        percentile.
    opacity : nodes (x, a)
        Opacity per `unit_distance`.
    colour : nodes (x, r, g, b)
        Linear RGB.
    unit_distance : float
        mm for HU looks; in voxels for relative looks, which may come in any unit of length.
    surface : Surface
    studio : Studio
        Lights, placed around camera and volume.
    exposure : float
        Stops.
    """

    name: str
    about: str
    units: str
    opacity: Nodes
    colour: Nodes
    unit_distance: float
    surface: Surface
    studio: Studio
    exposure: float = 0.0


LOOKS = {
    look.name: look
    for look in (
        Look(
            "ct-bone",
            "bone of a CT, soft tissue transparent",
            "HU",
            ((150.0, 0.0), (260.0, 0.12), (450.0, 0.75), (1200.0, 0.94)),
            (
                (150.0, 0.42, 0.16, 0.09),
                (300.0, 0.68, 0.46, 0.28),
                (600.0, 0.86, 0.76, 0.60),
                (1500.0, 0.92, 0.88, 0.80),
            ),
            1.0,
            Surface(0.95, specular=0.04, exponent=25.0),
            Studio(),
        ),
        Look(
            "ct-skin",
            "skin of a CT, opaque",
            "HU",
            ((-650.0, 0.0), (-400.0, 0.25), (-150.0, 0.85), (100.0, 0.95)),
            (
                (-650.0, 0.70, 0.36, 0.24),
                (-100.0, 0.72, 0.42, 0.29),
                (300.0, 0.80, 0.62, 0.48),
            ),
            1.0,
            Surface(1.0, specular=0.03, exponent=12.0),
            Studio(key=6.0, fill=0.7),
            exposure=0.5,
        ),
        Look(
            "mr-head",
            "head of an MR, values relative to the data's range",
            "relative",
            ((0.10, 0.0), (0.22, 0.10), (0.40, 0.55), (1.0, 0.80)),
            (
                (0.10, 0.45, 0.20, 0.13),
                (0.35, 0.66, 0.43, 0.33),
                (0.70, 0.80, 0.70, 0.60),
                (1.0, 0.90, 0.86, 0.80),
            ),
            1.0,
            Surface(1.0, specular=0.03, exponent=15.0),
            Studio(),
        ),
        Look(
            "solid",
            "anything: opaque above the threshold that best splits the values in two",
            "relative",
            ((-0.06, 0.0), (0.06, 0.75), (1.0, 0.95)),
            (
                (-0.06, 0.50, 0.40, 0.33),
                (0.30, 0.62, 0.57, 0.50),
                (1.0, 0.80, 0.80, 0.80),
            ),
            0.8,
            Surface(0.9, specular=0.05, exponent=40.0),
            Studio(),
        ),
    )
}


@dataclass(frozen=True)
class Dressed:
    """A look fitted to a volume: the scene and what was noticed on the way."""

    scene: Scene
    exposure: float
    preset: str
    notes: tuple[str, ...]


def look_named(name: str) -> Look:
    """Look by name; unknown names are answered with the list."""
    if name not in LOOKS:
        raise ValueError(f"preset is one of {', '.join(LOOKS)}; got {name!r}")
    return LOOKS[name]


def choose_look(values: NDArray, units: str = "") -> str:
    """Name of the default look: `ct-bone` for values that are or look like HU, else `solid`."""
    if units == "HU" or hu_offset(values) is not None:
        return "ct-bone"
    return "solid"


def hu_offset(values: NDArray) -> float | None:
    """Number to add to values to get HU: 0, -1000 or -1024 for HU stored unsigned, None: not HU.

    HU is told by air near -1000. Unsigned HU is told by air near 0 and the peak of soft tissue
    (about 40 HU) above it, which also tells the two offsets apart.
    """
    sample = values[::2, ::2, ::2].ravel()
    sample = sample[np.isfinite(sample)]
    if not sample.size:
        return None
    low, high = float(sample.min()), float(sample.max())
    if -4000 <= low <= -500 and 200 < high < 60000:
        return 0.0
    if low < -100 or high < 1500 or high > 60000:
        return None
    counts, edges = np.histogram(sample, bins=np.arange(700, 1400, 8))
    peak = edges[int(np.argmax(counts))] + 4.0
    tissue = float(np.mean((sample >= 900) & (sample < 1200)))
    air = float(np.mean(sample < 300))
    offset = min(STORED_OFFSETS, key=lambda o: abs(peak - o - SOFT_TISSUE_HU))
    inside = SOFT_TISSUE_WINDOW[0] <= peak - offset <= SOFT_TISSUE_WINDOW[1]
    return -float(offset) if inside and tissue > 0.03 and air > 0.1 else None


def dress(
    volume: Volume,
    camera: Camera,
    preset: str | None = None,
    *,
    units: str = "",
    shift: float | None = None,
    size: tuple[int, int] = (800, 600),
) -> Dressed:
    """Scene of a volume in a look.

    Parameters
    ----------
    volume : Volume
    camera : Camera
    preset : str, optional
        Name of a look. Default: chosen from the values.
    units : str
        "HU" when the reader knows the values to be HU.
    shift : float, optional
        Number to add to the values to get HU. Default: detected.
    size : (width, height)

    Returns
    -------
    Dressed
    """
    name = preset or choose_look(volume.values, units)
    look = look_named(name)
    if look.units == "HU":
        transfer, notes = _hu_transfer(look, volume, units, shift)
    else:
        transfer, notes = _relative_transfer(look, volume)
    if preset is None:
        notes = (f"preset {name} chosen from the values", *notes)
    scene = Scene(
        volume,
        transfer,
        camera,
        studio_lights(look.studio, volume, camera),
        surface=look.surface,
        size=size,
    )
    return Dressed(scene, look.exposure, name, notes)


def _hu_transfer(
    look: Look, volume: Volume, units: str, shift: float | None
) -> tuple[TransferFunction, tuple[str, ...]]:
    notes: tuple[str, ...] = ()
    if shift is None:
        shift = 0.0 if units == "HU" else hu_offset(volume.values)
        if shift is None:
            shift = 0.0
            notes = (f"the values do not look like HU, which {look.name} expects; give a shift",)
        elif shift:
            notes = (
                f"values look like HU stored with an offset: {shift:+g} is added for the look",
            )
    return _transfer(look, look.unit_distance, shift=-shift), notes


def _relative_transfer(look: Look, volume: Volume) -> tuple[TransferFunction, tuple[str, ...]]:
    values = volume.values[::2, ::2, ::2]
    finite = values[np.isfinite(values)].astype(np.float64)
    if not finite.size:
        finite = np.zeros(1)
    low, high = float(finite.min()), float(np.percentile(finite, 99.9))
    if high <= low:
        high = low + 1.0
    if look.name == "solid":
        low = threshold(finite)
    unit = look.unit_distance * float(volume.spacing.min())
    note = f"{look.name} spans values {low:g} to {high:g}"
    return _transfer(look, unit, shift=low, factor=max(high - low, 1e-30)), (note,)


def _transfer(
    look: Look, unit_distance: float, shift: float = 0.0, factor: float = 1.0
) -> TransferFunction:
    """Nodes x of the look become shift + factor x."""

    def moved(nodes: Nodes) -> Nodes:
        return tuple((shift + factor * x, *rest) for x, *rest in nodes)

    return TransferFunction(
        Curve(moved(look.opacity)), ColourCurve(moved(look.colour)), unit_distance
    )


def threshold(values: NDArray) -> float:
    """Threshold that splits values into two classes of least variance (Otsu 1979)."""
    counts, edges = np.histogram(values, bins=256)
    middle = (edges[1:] + edges[:-1]) / 2
    below, above = np.cumsum(counts), np.cumsum(counts[::-1])[::-1]
    mean_below = np.cumsum(counts * middle) / np.maximum(below, 1)
    mean_above = (np.cumsum((counts * middle)[::-1]) / np.maximum(above[::-1], 1))[::-1]
    between = below[:-1] * above[1:] * (mean_below[:-1] - mean_above[1:]) ** 2
    best = np.flatnonzero(between == between.max())
    return float(edges[1 + int(best[len(best) // 2])])
