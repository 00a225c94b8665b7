"""Transfer function tables: fine enough for 16-bit data, exact at whole numbers of integer data."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .material import TransferFunction, TransferTable
from .volume import Volume
from .voxels import Voxels

# Table entries: at least, for float data, at most
FEWEST, FLOAT_ENTRIES, MOST = 4096, 16384, 2**17
# An opacity of 1 stands for this optical depth over the shorter of unit distance and smallest voxel
# edge: a transmittance of 2^-24, the resolution of float32 alpha.
OPAQUE_DEPTH = 24 * float(np.log(2.0))
# Extinction is at most this much over the smallest voxel edge, and over the diagonal, so that no
# walk stalls or takes for ever (HC-09). The second one matters where voxels are hundreds of times
# longer than they are thick.
DEEPEST_VOXEL, DEEPEST_VOLUME = 64.0, 2.0**20


@dataclass(frozen=True)
class Tables:
    """Transfer function sampled over the range of stored values.

    Channels are None where the transfer function does not have them.

    Attributes
    ----------
    sigma_t : (n,) float32, 1/world unit
        Its maximum over the gradient magnitudes, where it depends on them.
    colour : (n, 3) float32
    opacity_distance : float
        World units over which sigma_t becomes the opacity that the transfer function gives.
    emission, specular : (n, 3) float32, optional
    exponent, g : (n,) float32, optional
    per_scalar : float
        Entries per unit of the stored value; 0 for a constant volume.
    capped : bool
        Whether extinction was cut off at `DEEPEST_VOXEL`.
    pitch : float
        Scalars between entries.
    entries : int
        Of one row; with labels, tables hold several rows one after another.
    too_fine : bool
        Whether nodes lie closer than two entries even in the largest table.
    """

    sigma_t: NDArray[np.float32]
    colour: NDArray[np.float32]
    opacity_distance: float
    emission: NDArray[np.float32] | None
    specular: NDArray[np.float32] | None
    exponent: NDArray[np.float32] | None
    g: NDArray[np.float32] | None
    per_scalar: float
    capped: bool
    pitch: float
    entries: int
    too_fine: bool


def shortest_edge(volume: Volume) -> float:
    """Smallest voxel edge; not so small that `DEEPEST_VOXEL` would pass `DEEPEST_VOLUME`."""
    return max(float(volume.spacing.min()), 2 * volume.radius * DEEPEST_VOXEL / DEEPEST_VOLUME)


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


def build_tables(
    transfer: TransferFunction,
    voxels: Voxels,
    smallest_spacing: float,
    finest: float | None = None,
) -> Tables:
    """Sample the transfer function over the values of a volume.

    `finest` is the smallest distance of nodes that the table has to resolve; default: its own.
    """
    span = voxels.highest - voxels.lowest
    finest = (finest_step(transfer) if finest is None else finest) / voxels.unit
    n = table_entries(span, finest, voxels.integer)
    x = np.linspace(voxels.lowest, voxels.highest, n) * voxels.unit + voxels.offset
    sigma_t, capped = limited(_densest(transfer, x, smallest_spacing), transfer, smallest_spacing)
    # A table of scalar and gradient has colours of its own
    colour = np.zeros((2, 3)) if transfer.colour is None else transfer.colour(x)
    pitch = span / (n - 1)
    own = smallest_spacing if transfer.extinction is not None else transfer.unit_distance
    return Tables(
        sigma_t=sigma_t,
        colour=_table(colour),
        opacity_distance=own / max(transfer.density_scale, 1e-30),
        emission=_emission(transfer, x),
        specular=_specular(transfer, x),
        exponent=None if transfer.exponent is None else _table(transfer.exponent(x)),
        g=None if transfer.g is None else _table(transfer.g(x)),
        per_scalar=(n - 1) / span if span > 0 else 0.0,
        capped=capped,
        pitch=pitch * voxels.unit,
        entries=n,
        too_fine=bool(np.isfinite(finest) and finest < 2 * pitch),
    )


def finest_step(transfer: TransferFunction) -> float:
    """Smallest distance between the nodes of a transfer function."""
    curves = (
        transfer.opacity, transfer.extinction, transfer.colour, transfer.emission,
        transfer.specular, transfer.refraction_index, transfer.exponent, transfer.g,
    )  # fmt: skip
    finest = min((curve.finest_step for curve in curves if curve is not None), default=np.inf)
    if transfer.table is not None:
        low, high = transfer.table.scalar_range
        finest = min(finest, (high - low) / transfer.table.rgba.shape[1])
    return finest


def limited(
    sigma_t: NDArray, transfer: TransferFunction, smallest_spacing: float
) -> tuple[NDArray[np.float32], bool]:
    """Extinction times the density scale, cut off at `DEEPEST_VOXEL`; and whether it was."""
    sigma_t = sigma_t * transfer.density_scale
    ceiling = DEEPEST_VOXEL / smallest_spacing
    return _table(np.minimum(sigma_t, ceiling)), bool((sigma_t > ceiling).any())


def varying(table: NDArray[np.float32] | None) -> NDArray[np.float32] | None:
    """The table of a channel, or None where one number says it all."""
    return None if table is None or (table == table[0]).all() else table


def _table(values: NDArray) -> NDArray[np.float32]:
    return np.ascontiguousarray(values, np.float32)


def _densest(transfer: TransferFunction, x: NDArray, smallest_spacing: float) -> NDArray:
    """Extinction of scalars x, the largest over all gradient magnitudes."""
    if transfer.extinction is not None:
        return transfer.extinction(x)
    if transfer.opacity is not None:
        alpha = np.clip(transfer.opacity(x), 0.0, 1.0)
        return extinction_of(alpha, transfer.unit_distance, smallest_spacing)
    assert transfer.table is not None
    columns = extinction_of(
        transfer.table.rgba[..., 3].max(axis=0), transfer.unit_distance, smallest_spacing
    )
    low, pitch = column_positions(transfer.table)
    sigma_t = np.interp(x, low + pitch * np.arange(len(columns)), columns)
    # Columns between two entries of the table must not be missed
    wide = np.concatenate([sigma_t[:1], sigma_t, sigma_t[-1:]])
    return np.maximum(np.maximum(wide[:-2], wide[1:-1]), wide[2:])


def column_positions(table: TransferTable) -> tuple[float, float]:
    """Scalar of the first column of a table, and between columns."""
    low, high = table.scalar_range
    pitch = (high - low) / table.rgba.shape[1]
    return low + pitch / 2, pitch


def row_positions(table: TransferTable) -> tuple[float, float]:
    """Gradient magnitude of the first row of a table, and between rows."""
    low, high = table.gradient_range
    pitch = (high - low) / table.rgba.shape[0]
    return low + pitch / 2, pitch


def _emission(transfer: TransferFunction, x: NDArray) -> NDArray[np.float32] | None:
    if transfer.emission is None:
        return None
    emission = _table(transfer.emission(x) * transfer.emission_scale)
    return emission if emission.any() else None


def _specular(transfer: TransferFunction, x: NDArray) -> NDArray[np.float32] | None:
    """Reflectance at normal incidence."""
    if transfer.specular is not None:
        return _table(transfer.specular(x))
    if transfer.refraction_index is None:
        return None
    n = transfer.refraction_index(x)
    return _table(np.repeat((((n - 1) / (n + 1)) ** 2)[:, None], 3, axis=1))


def extinction_of(alpha: NDArray, unit_distance: float, smallest_spacing: float) -> NDArray:
    """sigma_t = -log1p(-a) / unit_distance, with a = 1 made finite."""
    opaque = OPAQUE_DEPTH / min(unit_distance, smallest_spacing)
    with np.errstate(divide="ignore"):
        sigma_t = -np.log1p(-alpha) / unit_distance
    return np.minimum(sigma_t, opaque)
