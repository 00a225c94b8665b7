"""Looks: transfer function, surface, lights, exposure and view that go together.

Each family has a table of its own: `ct`, `mr`, `nuclear`, `general`. A look in HU expects a CT in
Hounsfield units; `hu_offset` finds CTs that are stored with an offset and no tag that says so.
Other looks spread their nodes over the range of the data.
"""

from __future__ import annotations

from .catalogue import LOOKS, look_named
from .choice import choose_look
from .files import read_look, read_looks, write_look
from .fit import Dressed, dress
from .look import Look
from .statistics import hu_offset, threshold

__all__ = [
    "LOOKS", "Dressed", "Look", "choose_look", "dress", "hu_offset", "look_named", "read_look",
    "read_looks", "threshold", "write_look",
]  # fmt: skip
