"""Colours chosen on a display -> reflectances in linear light."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np

from ..curves import ColourCurve
from ..labels import Labels
from ..pictures.display import srgb_decode
from ..scene import TransferFunction, Volume
from .components import Look

# Nodes, about, of a colour function in linear light
COLOURS = 512


def in_linear_light(look: Look) -> Look:
    """Look whose colours, chosen on a display as they are, have become reflectances.

    The picture is encoded for the display at its end, which gives the colours back.
    """
    volume = look.volume
    if volume.colours is not None and volume.colours.dtype == np.uint8:
        linear = srgb_decode(volume.colours.astype(np.float32) / 255)
        return look._replace(volume=Volume(volume.values, volume.index_to_world, linear))
    return look._replace(transfer=linear_transfer(look.transfer))


def linear_transfer(transfer: TransferFunction) -> TransferFunction:
    """Transfer function whose colours have become reflectances."""
    if transfer.table is not None:
        rgba = np.dstack([srgb_decode(transfer.table.rgba[..., :3]), transfer.table.rgba[..., 3]])
        return replace(transfer, table=replace(transfer.table, rgba=rgba))
    assert transfer.colour is not None
    return replace(transfer, colour=linear_colours(transfer.colour))


def linear_labels(labels: Labels) -> Labels:
    """Labels whose transfer functions' colours have become reflectances."""
    transfers = {k: None if t is None else linear_transfer(t) for k, t in labels.transfers.items()}
    return Labels(labels.values, transfers)


def linear_colours(curve: ColourCurve) -> ColourCurve:
    """Colour curve in linear light of one in sRGB: its nodes, with more between them if few."""
    nodes = [np.array(node) for node in curve.nodes]
    parts = max(1, COLOURS // len(nodes))
    rows = [nodes[0][:4]]
    for one, other in itertools.pairwise(nodes):
        if parts > 1 and other[0] > one[0]:
            x = np.linspace(one[0], other[0], parts + 1)[1:-1]
            rows.extend(np.column_stack([x, curve(x)]))
        rows.append(other[:4])
    table = np.array(rows)
    table[:, 1:] = srgb_decode(table[:, 1:])
    return ColourCurve(tuple(map(tuple, table.tolist())), curve.clamp)
