"""How much memory the process has taken."""

from __future__ import annotations

import sys
from pathlib import Path

STATUS = Path("/proc/self/status")


def peak_memory() -> int | None:
    """Most bytes of main memory that this program has held at a time; None where not known."""
    own = _high_water_mark()
    return _resource_usage() if own is None else own


def _high_water_mark() -> int | None:
    # Linux' resource usage goes on across exec: it would tell of the program that started this one
    try:
        lines = STATUS.read_text().splitlines()
    except OSError:
        return None
    kib = [int(line.split()[1]) for line in lines if line.startswith("VmHWM:")]
    return 1024 * kib[0] if kib else None


def _resource_usage() -> int | None:
    try:
        import resource
    except ImportError:  # Windows has no such module
        return None
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    # In bytes on macOS, in KiB elsewhere
    return most if sys.platform == "darwin" else 1024 * most
