"""Transfer function tables: fine enough for 16-bit data, exact at whole numbers of integer data."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .scene import TransferFunction
from .voxels import Voxels

# Table entries: at least, for float data, at most
FEWEST, FLOAT_ENTRIES, MOST = 4096, 16384, 2**17
# An opacity of 1 stands for this optical depth over the shorter of unit distance and smallest voxel
# edge: a transmittance of 2^-24, the resolution of float32 alpha.
OPAQUE_DEPTH = 24 * float(np.log(2.0))
# Extinction is at most this much over the smallest voxel edge, so that no walk stalls (HC-09).
DEEPEST_VOXEL = 64.0


@dataclass(frozen=True)
class Tables:
    """Transfer function sampled over the range of stored values.

    Attributes
    ----------
    sigma_t : (n,) float32, 1/world unit
    colour : (n, 3) float32
    opacity : (n,) float32, [0, 1], before the unit distance
    per_scalar : float
        Entries per unit of the stored value; 0 for a constant volume.
    capped : bool
        Whether extinction was cut off at `DEEPEST_VOXEL`.
    pitch : float
        Scalars between entries.
    too_fine : bool
        Whether nodes lie closer than two entries even in the largest table.
    """

    sigma_t: NDArray[np.float32]
    colour: NDArray[np.float32]
    opacity: NDArray[np.float32]
    per_scalar: float
    capped: bool
    pitch: float
    too_fine: bool


def table_entries(span: float, finest_step: float, integer: bool) -> int:
    """Number of entries over a span of values whose nodes are at least `finest_step` apart."""
    if span <= 0:
        return 2
    wanted = max(FEWEST if integer else FLOAT_ENTRIES, min(4 * span / finest_step, MOST))
    if not integer:
        return int(wanted) + 1
    # Whole number of entries per unit, so that every integer is an entry
    per_unit = max(1, int(np.ceil(wanted / span)))
    return int(span) * per_unit + 1


def build_tables(transfer: TransferFunction, voxels: Voxels, smallest_spacing: float) -> Tables:
    """Sample the transfer function over the values of a volume."""
    span = voxels.highest - voxels.lowest
    density = transfer.opacity if transfer.opacity is not None else transfer.extinction
    assert density is not None
    finest = min(density.finest_step, transfer.colour.finest_step)
    n = table_entries(span, finest, voxels.integer)
    x = np.linspace(voxels.lowest, voxels.highest, n) + voxels.offset
    colour = np.ascontiguousarray(transfer.colour(x), np.float32)
    if transfer.opacity is not None:
        alpha = np.clip(transfer.opacity(x), 0.0, 1.0)
        sigma_t = _extinction_of(alpha, transfer.unit_distance, smallest_spacing)
    else:
        sigma_t = density(x)
        alpha = -np.expm1(-sigma_t * smallest_spacing)
    sigma_t = sigma_t * transfer.density_scale
    ceiling = DEEPEST_VOXEL / smallest_spacing
    pitch = span / (n - 1)
    return Tables(
        sigma_t=np.minimum(sigma_t, ceiling).astype(np.float32),
        colour=colour,
        opacity=alpha.astype(np.float32),
        per_scalar=(n - 1) / span if span > 0 else 0.0,
        capped=bool((sigma_t > ceiling).any()),
        pitch=pitch,
        too_fine=bool(np.isfinite(finest) and finest < 2 * pitch),
    )


def _extinction_of(alpha: NDArray, unit_distance: float, smallest_spacing: float) -> NDArray:
    """sigma_t = -log1p(-a) / unit_distance, with a = 1 made finite."""
    opaque = OPAQUE_DEPTH / min(unit_distance, smallest_spacing)
    with np.errstate(divide="ignore"):
        sigma_t = -np.log1p(-alpha) / unit_distance
    return np.minimum(sigma_t, opaque)
