"""A grid's layers shared out among threads, for kernels that run without the interpreter's lock."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from .reading.parallel import usable_cpus

# Items below which starting threads takes longer than the work
WORTH_THREADS = 2**18


def in_slabs(work: Callable[[int, int], object], layers: int, items: int) -> None:
    """Call `work(first, end)` for slabs of layers that together are all of them.

    `items` is how much work there is in all: little of it is done in one slab.
    """
    threads = min(usable_cpus(), layers) if items >= WORTH_THREADS else 1
    if threads == 1:
        work(0, layers)
        return
    ends = np.linspace(0, layers, threads + 1).astype(int).tolist()
    with ThreadPoolExecutor(threads) as pool:
        # Errors of any of them are raised here
        list(pool.map(work, ends[:-1], ends[1:]))
