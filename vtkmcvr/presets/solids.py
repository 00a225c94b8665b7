"""Dressed volumes whose labels are shown as solids."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..labels import check_grid
from ..layers import Layer
from ..segmentation import Segmentation
from .fit import Dressed
from .framing import seen_points


def as_solids(dressed: Dressed, segmentation: Segmentation) -> Dressed:
    """Show a label map itself: all labels that are to be seen, and nothing else."""
    solids = segmentation.solids()
    scene = replace(
        dressed.scene, volume=solids.volume, transfer=solids.transfer, surface=solids.surface,
        labels=solids.labels, mask=None,
    )  # fmt: skip
    told = f"look {dressed.preset}: {len(segmentation.shown)} of {len(segmentation.names)} labels"
    return replace(
        dressed, scene=scene, notes=(told,), points=_points(solids), segmentation=segmentation
    )


def with_segmentation(dressed: Dressed, segmentation: Segmentation) -> Dressed:
    """Show chosen labels as solids in their volume, and leave out hidden ones."""
    scene = dressed.scene
    check_grid("the segmentation", segmentation.volume.values, scene.volume.values.shape)
    mask = segmentation.mask()
    if scene.mask is not None:
        mask = mask * (scene.mask != 0)
    if segmentation.only_hides:
        told = f"{len(segmentation.hide)} of {len(segmentation.names)} labels are hidden"
        return replace(
            dressed, scene=replace(scene, mask=mask), notes=(*dressed.notes, told),
            segmentation=segmentation,
        )  # fmt: skip
    told = f"{len(segmentation.shown)} of {len(segmentation.names)} labels are solids"
    solids = segmentation.solids()
    points = [c for c in (dressed.points, _points(solids)) if c is not None]
    return replace(
        dressed,
        scene=replace(scene, mask=mask, layers=(*scene.layers, solids)),
        notes=(*dressed.notes, told),
        points=np.concatenate(points) if points else None,
        segmentation=segmentation,
    )


def _points(solids: Layer) -> NDArray[np.float64] | None:
    return seen_points(solids.volume, solids.volume.values[::2, ::2, ::2] > 0)
