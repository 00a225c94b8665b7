"""The labels' part of the plan: one row of the transfer tables for each label that differs.

A mask is a label map too: what it leaves out has a row of zeros.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..effects import Effect
from ..labels import Labels
from ..material import Surface, TransferFunction
from ..phases import Phase
from ..scene import Scene
from ..tables import MOST, Tables, build_tables, finest_step, shortest_edge
from ..voxels import Voxels

# Label maps whose values span less than this are translated by a table
WIDEST_TABLE = 2**24
# Table entries of all rows, which kernels count in int32
MOST_ENTRIES = 2**31


@dataclass(frozen=True)
class Rows:
    """Rows of the transfer tables.

    Attributes
    ----------
    row : array (k, j, i), uint8 or uint16, or None
        None: the whole volume has row 0.
    transfers : tuple of TransferFunction or None
        By row; None is a row of zeros.
    effects : tuple of Effect
    """

    row: NDArray | None
    transfers: tuple[TransferFunction | None, ...]
    effects: tuple[Effect, ...]


def rows_of(transfer: TransferFunction, labels: Labels | None, mask: NDArray | None) -> Rows:
    """Rows of a volume's labels and mask."""
    transfers: list[TransferFunction | None] = [transfer]
    row, label_why = _label_rows(labels, transfers)
    hidden = None if mask is None else np.asarray(mask) == 0
    mask_why = "the scene has no mask"
    if hidden is not None:
        share = float(hidden.mean())
        mask_why = f"{share:.0%} of the voxels are hidden"
        if share == 0:
            hidden, mask_why = None, "the mask hides nothing"
    if hidden is not None:
        if None not in transfers:
            transfers.append(None)
        row = np.zeros(hidden.shape, np.uint16) if row is None else row
        row[hidden] = transfers.index(None)
    if row is not None:
        row = np.ascontiguousarray(row, np.uint8 if len(transfers) <= 256 else np.uint16)
    effects = (
        Effect("mask", hidden is not None, mask_why),
        Effect("labels", not label_why.startswith(("the", "no")), label_why),
    )
    return Rows(row, tuple(transfers), effects)


def _label_rows(
    labels: Labels | None, transfers: list[TransferFunction | None]
) -> tuple[NDArray | None, str]:
    """Rows of a label map, uint16, whose transfer functions are appended; and why."""
    if labels is None:
        return None, "the scene has no label map"
    rows = _row_by_label(labels, transfers)
    used = _translated(labels.values, rows)
    if not used.any():
        return None, "no voxel has a label with a transfer function of its own"
    count = len(np.unique(list(rows.values())))
    return used, f"{len(rows)} labels have transfer functions of their own, {count} in all"


def _row_by_label(labels: Labels, transfers: list[TransferFunction | None]) -> dict[int, int]:
    """Row of each label; equal transfer functions share one."""
    known = {id(transfers[0]): 0}
    rows = {}
    for label, transfer in labels.transfers.items():
        if id(transfer) not in known:
            known[id(transfer)] = len(transfers)
            transfers.append(transfer)
        rows[int(label)] = known[id(transfer)]
    return rows


def _translated(values: NDArray, rows: dict[int, int]) -> NDArray[np.uint16]:
    """Rows of all voxels; 0 for labels without one."""
    low, high = int(values.min()), int(values.max())
    if high - low < WIDEST_TABLE:
        table = np.zeros(high - low + 1, np.uint16)
        for label, row in rows.items():
            if low <= label <= high:
                table[label - low] = row
        return table[values if low == 0 else values.astype(np.int64) - low]
    out = np.zeros(values.shape, np.uint16)
    for label, row in rows.items():
        if low <= label <= high:
            out[values == label] = row
    return out


def stacked_tables(rows: Rows, scene: Scene, voxels: Voxels) -> Tables:
    """Tables of all rows, one after another; those of the volume alone without labels.

    A channel that only some transfer functions give has the scene's constant in the others' rows.
    """
    smallest = shortest_edge(scene.volume)
    if rows.row is None:
        return build_tables(scene.transfer, voxels, smallest)
    if len(rows.transfers) * MOST > MOST_ENTRIES:
        raise ValueError(
            f"{len(rows.transfers)} different transfer functions are too many for labels: at most "
            f"{MOST_ENTRIES // MOST} fit"
        )
    given = [transfer for transfer in rows.transfers if transfer is not None]
    if any(t.table is not None or t.gradient_opacity is not None for t in given):
        raise ValueError(
            "labels and masks take transfer functions of the scalar alone: leave out gradient "
            "opacity and the 2-D table"
        )
    finest = min(finest_step(transfer) for transfer in given)
    parts = [
        build_tables(scene.transfer if t is None else t, voxels, smallest, finest)
        for t in rows.transfers
    ]
    parts = [
        replace(part, sigma_t=np.zeros_like(part.sigma_t)) if t is None else part
        for part, t in zip(parts, rows.transfers, strict=True)
    ]
    surface = scene.surface or Surface()
    constants: dict[str, Any] = {
        "emission": (0.0, 0.0, 0.0),
        "specular": surface.specular,
        "exponent": surface.exponent,
        "g": constant_shape(scene.phase),
    }
    channels: dict[str, Any] = {
        name: _channel(parts, name, value) for name, value in constants.items()
    }
    return replace(
        parts[0],
        sigma_t=np.concatenate([part.sigma_t for part in parts]),
        colour=np.concatenate([part.colour for part in parts]),
        capped=any(part.capped for part in parts),
        too_fine=any(part.too_fine for part in parts),
        **channels,
    )


def _channel(parts: list[Tables], name: str, constant: Any) -> NDArray[np.float32] | None:
    """One optional channel of all rows; None where none has it."""
    tables = [getattr(part, name) for part in parts]
    if all(table is None for table in tables):
        return None
    width = len(parts[0].sigma_t)
    fill = np.broadcast_to(np.asarray(constant, np.float32), (width, *np.shape(constant)))
    return np.concatenate([fill if table is None else table for table in tables])


def constant_shape(phase: Phase) -> float:
    """The g or k of a phase function that has one, else 0."""
    return float(getattr(phase, "g", getattr(phase, "k", 0.0)))
