"""How much memory the process has taken."""

from __future__ import annotations

import sys


def peak_memory() -> int | None:
    """Most bytes of main memory that this process has held at a time; None where not known."""
    try:
        import resource
    except ImportError:  # Windows has no such module
        return None
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    # In bytes on macOS, in KiB elsewhere
    return most if sys.platform == "darwin" else 1024 * most
