"""Do the same for many slices at once, with progress."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor, as_completed
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from .options import ReadOptions


def for_each(
    work: Callable[[Any], Any], items: Iterable[Any], options: ReadOptions, text: str
) -> list[Any]:
    """Return `work(item)` of each item in order, on the threads and with the progress of `options`.

    The first error ends the work; what has not begun is not begun.
    """
    items = list(items)
    threads = min(options.threads or usable_cpus(), len(items))
    if threads < 2:
        results = []
        for done, item in enumerate(items, start=1):
            results.append(work(item))
            options.progress(done / len(items), text)
        return results
    with ThreadPoolExecutor(threads) as pool:
        futures = [pool.submit(work, item) for item in items]
        try:
            for done, future in enumerate(as_completed(futures), start=1):
                future.result()
                options.progress(done / len(items), text)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
        return [future.result() for future in futures]


def usable_cpus() -> int:
    """Return the number of CPUs that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
