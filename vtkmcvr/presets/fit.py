"""A look fitted to a volume: where its nodes land, and what is told about it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..curves import Curve
from ..scene import Camera, Scene, Volume
from ..segmentation import Segmentation
from ..studio import Studio, studio_lights
from .body import DENSER_THAN, body_mask, worth_hiding
from .catalogue import LOOKS, look_named
from .choice import choose_look
from .depth import depth_through_centre
from .files import names_file, read_look
from .framing import seen_points, seen_voxels
from .look import Look
from .statistics import finite_sample, hu_offset, object_threshold, spread

# What stands for the ends of the range where a CT look meets values that are not HU: air and dense
# bone
AIR_HU, DENSE_HU = -1000.0, 1500.0
# Uptake that stands for the 99.9th percentile where PET is not in SUV
HIGH_SUV = 10.0


@dataclass(frozen=True)
class Dressed:
    """A look fitted to a volume.

    Attributes
    ----------
    scene : Scene
    exposure : float
        Stops.
    preset : str
        Name of the look.
    notes : tuple of str
        What was chosen and noticed on the way.
    points : array (n, 3), optional
        World points that a picture of what is seen should hold. None: nothing is seen.
    segmentation : Segmentation, optional
        Whose labels are solids, or are left out.
    studio : Studio
        The look's light, which the scene's lights are where the camera stands now.
    """

    scene: Scene
    exposure: float
    preset: str
    notes: tuple[str, ...]
    points: NDArray | None = None
    segmentation: Segmentation | None = None
    studio: Studio = field(default_factory=Studio)


@dataclass(frozen=True)
class Fit:
    """Positions x of a look's nodes are values shift + factor x of the data.

    `units` are those of the data, where fitting has found them.
    """

    shift: float
    factor: float
    notes: tuple[str, ...] = ()
    units: str = ""


def dress(
    volume: Volume,
    camera: Camera,
    preset: str | Look | None = None,
    *,
    units: str = "",
    modality: str = "",
    shift: float | None = None,
    size: tuple[int, int] = (800, 600),
    whole: bool = False,
    chosen: bool | None = None,
) -> Dressed:
    """Scene of a volume in a look.

    Parameters
    ----------
    volume : Volume
    camera : Camera
    preset : str or Look, optional
        Default: chosen from the values.
    units, modality : str
        "HU", "SUV"; "CT", "MR", "PT", where the reader knows them.
    shift : float, optional
        Number to add to the values to get HU. Default: detected.
    size : (width, height)
    whole : bool
        Also show what a CT look leaves out: the table, what lies close under the skin.
    chosen : bool, optional
        Whether to tell that the look was chosen from the values. Default: without `preset`.

    Returns
    -------
    Dressed
        The first note tells the look, its range and the optical depth through the centre.
    """
    look = look_of(volume, preset, units=units, modality=modality)
    fit = fit_look(look, volume, units, shift)
    transfer = look.transfer(fit.shift, fit.factor, float(volume.spacing.min()))
    assert transfer.opacity is not None
    mask, hidden = (None, ()) if whole else _body(look, fit, volume, transfer.opacity)
    seen = seen_voxels(volume, transfer.opacity, mask)
    scene = Scene(
        volume,
        transfer,
        camera,
        studio_lights(look.studio, volume, camera),
        surface=look.surface,
        phase=look.phase,
        scattering=look.scattering,
        max_scatterings=look.max_scatterings if look.scattering == "multiple" else None,
        size=size,
        mask=mask,
    )
    if chosen is None:
        chosen = preset is None
    told = _told(look, scene, fit.units or units, chosen=chosen, empty=not seen.any())
    return Dressed(
        scene, look.exposure, look.name, (told, *fit.notes, *hidden), seen_points(volume, seen),
        studio=look.studio,
    )  # fmt: skip


def look_of(
    volume: Volume, preset: str | Look | None, *, units: str = "", modality: str = ""
) -> Look:
    """Return the look that is asked for, or the one that suits the values."""
    if isinstance(preset, Look):
        return preset
    if preset is not None and preset not in LOOKS and names_file(preset):
        return read_look(preset)
    return look_named(preset or choose_look(volume.values, units, modality))


def fit_look(look: Look, volume: Volume, units: str = "", shift: float | None = None) -> Fit:
    """Place the nodes of a look in the values of a volume.

    Where values are not in the look's units, percentiles stand for them and a note says so.
    """
    if look.units == "HU":
        return _fit_hu(look, volume.values, units, shift)
    if look.units == "data":
        return Fit(0.0, 1.0)
    if look.units == "SUV" and units == "SUV":
        return Fit(0.0, 1.0)
    low, high = spread(volume.values)
    if look.units == "SUV":
        note = f"the values are not SUV: {look.name} takes {high:g}, their 99.9th percentile, as 10"
        return Fit(0.0, max(high, 1e-30) / HIGH_SUV, (note,))
    if look.units == "threshold":
        flat = not np.ptp(finite_sample(volume.values))
        # Of values that are all equal none is an object
        low, high = (high, high + 1) if flat else (object_threshold(volume.values), high)
    if look.units == "signed":
        sample = finite_sample(volume.values)
        # The least integer has no absolute value of its type
        low, high = 0.0, float(np.percentile(np.abs(sample.astype(float)), 99.9)) or 1.0
    return Fit(low, max(high - low, 1e-30))


def _fit_hu(look: Look, values: NDArray, units: str, shift: float | None) -> Fit:
    if shift is not None:
        return Fit(-shift, 1.0)
    found = 0.0 if units == "HU" else hu_offset(values)
    if found == 0.0:
        return Fit(0.0, 1.0, units="HU")
    if found is not None:
        note = f"values look like HU stored with an offset: {found:+g} is added for the look"
        return Fit(-found, 1.0, (note,))
    low, high = spread(values)
    factor = (high - low) / (DENSE_HU - AIR_HU)
    note = (
        f"the values do not look like HU, which {look.name} expects: {low:g} is taken as air and "
        f"{high:g}, their 99.9th percentile, as dense bone; --shift (shift=) sets them by hand"
    )
    return Fit(low - factor * AIR_HU, factor, (note,))


def _body(
    look: Look, fit: Fit, volume: Volume, opacity: Curve
) -> tuple[NDArray | None, tuple[str, ...]]:
    """Mask of what a CT look shows of a body, where that hides anything; and the note on it."""
    if look.body is None or look.units != "HU":
        return None, ()
    mask = body_mask(volume, fit.shift + fit.factor * DENSER_THAN, look.body)
    if mask is None or not worth_hiding(mask[::2, ::2, ::2], seen_voxels(volume, opacity, None)):
        return None, ()
    what = f"more than {look.body:g} mm below the skin" if look.body else "the body, no table"
    return mask, (f"{look.name} shows {what}; --whole (whole=True) shows all",)


def _told(look: Look, scene: Scene, units: str, *, chosen: bool, empty: bool) -> str:
    """Return the one line about a look on a volume."""
    sample = finite_sample(scene.volume.values)
    nodes = [x for x, *_ in scene.transfer.opacity.nodes] if scene.transfer.opacity else [0.0]
    unit = f" {units}" if units else " (no units)"
    how = "chosen from the values" if chosen else "as asked"
    line = (
        f"look {look.name}, {how}: values {sample.min():.5g} to {sample.max():.5g}{unit}, seen "
        f"from {nodes[0]:.5g} to {nodes[-1]:.5g}, optical depth through the centre "
        f"{depth_through_centre(scene):.3g}"
    )
    return f"{line}; no value lies there, so there is nothing to see" if empty else line
