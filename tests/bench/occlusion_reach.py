"""How much of what beams meet is ever read: what leaving the rest out could save.

Each addition to a beam, in any layer, goes to a ray; something comes of it where the eye sees a
pixel that the ray passes later. Two counts of such additions: `seen`, by what the eye really sees
of the later layers, which only a second sweep for the eye alone would know; and `open`, by all view
rays that have not ended yet and have medium before them, beside any of which the rule of HC-91
keeps light. Counted by blocks of layers, for every few beams and blocks.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vtkmcvr.occlusion import Occlusion, render_occlusion
from vtkmcvr.occlusion.sweep import Block
from vtkmcvr.occlusion.traced import Traced
from vtkmcvr.scene import Scene

BEAMS, BLOCKS = 5, 4


class _Counted(Traced):
    """Beams that note, block by block, what was filled, what the eye sees, and where they are."""

    notes: list

    def through(self, block: Block, *rest):
        segments = np.repeat(block.visible.flags > 0, 16, axis=2)
        seen = ((block.layers.seen > 0) & segments).any(axis=0)
        filled = np.repeat(block.filled.flags > 0, 16, axis=2).sum(axis=0)
        places = self.places[self.first[:, block.start]]
        self.notes.append((filled, seen, places))
        return super().through(block, *rest)


def moved(a: NDArray, by: NDArray) -> NDArray:
    """A plane moved by rows and columns; nothing comes in."""
    out = np.zeros_like(a)
    rows, columns = a.shape
    y, x = (int(v) for v in by)
    if abs(y) < rows and abs(x) < columns:
        out[max(y, 0) : rows + min(y, 0), max(x, 0) : columns + min(x, 0)] = a[
            max(-y, 0) : rows - max(y, 0), max(-x, 0) : columns - max(x, 0)
        ]
    return out


def shares(scene: Scene, occlusion: Occlusion) -> dict[str, float]:
    """Shares of the additions to beams that matter."""
    notes = _noted(scene, occlusion)
    seen = [n[1] for n in notes]
    # View rays that see anything in this block or behind it
    still = np.logical_or.accumulate(seen[::-1])[::-1]
    total = dict.fromkeys(("all", "seen", "open"), 0.0)
    for beam in range(0, len(notes[0][2]), BEAMS):
        places = [n[2][beam] for n in notes]
        for start in range(0, len(notes), BLOCKS):
            filled = notes[start][0]
            reached, passed = np.zeros_like(seen[0]), np.zeros_like(seen[0])
            for later in range(start, len(notes)):
                back = places[start] - places[later]
                reached |= moved(seen[later], back)
                passed |= moved(still[start], back)
            total["all"] += float(filled.sum())
            total["seen"] += float(filled[reached].sum())
            total["open"] += float(filled[passed].sum())
    return {k: total[k] / total["all"] for k in ("seen", "open")}


def _noted(scene: Scene, occlusion: Occlusion) -> list:
    """What the blocks of a picture hold."""
    from vtkmcvr.occlusion import rendering

    _Counted.notes = []
    usual, rendering.Traced = rendering.Traced, _Counted
    try:
        render_occlusion(scene, occlusion, threads=2, backend="cpu")
    finally:
        rendering.Traced = usual
    return _Counted.notes
