"""A second volume over a dressed one, such as PET over CT."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..layers import Layer
from ..volume import Volume
from .fit import Dressed, fit_look, look_of
from .framing import seen_points, seen_voxels
from .look import Look


def with_overlay(
    dressed: Dressed,
    volume: Volume,
    preset: str | Look | None = None,
    *,
    units: str = "",
    modality: str = "",
) -> Dressed:
    """Add a volume that has its own grid, place and look; extinctions add.

    Of a look that glows only what glows is seen, so that it hides nothing of the first volume.

    Parameters
    ----------
    dressed : Dressed
    volume : Volume
    preset, units, modality
        As for `dress`.
    """
    look = _glowing(look_of(volume, preset, units=units, modality=modality))
    fit = fit_look(look, volume, units)
    transfer = look.transfer(fit.shift, fit.factor, float(volume.spacing.min()))
    assert transfer.opacity is not None
    layer = Layer(volume, transfer, look.surface)
    points = [dressed.points, seen_points(volume, seen_voxels(volume, transfer.opacity, None))]
    known = [p for p in points if p is not None]
    first, last = (fit.shift + fit.factor * look.opacity[end][0] for end in (0, -1))
    told = f"overlay in look {look.name}: seen from {first:.5g} to {last:.5g}"
    return replace(
        dressed,
        scene=replace(dressed.scene, layers=(*dressed.scene.layers, layer)),
        notes=(*dressed.notes, told, *fit.notes),
        points=np.concatenate(known) if known else None,
    )


def _glowing(look: Look) -> Look:
    """Return a look whose opacity begins where its emission does."""
    if look.emission is None:
        return look
    dark = [x for x, *rgb in look.emission if not any(rgb[:3])]
    if not dark:
        return look
    start = max(dark)
    return replace(look, opacity=((start, 0.0), *(n for n in look.opacity if n[0] > start)))
