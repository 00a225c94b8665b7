"""What `pyvista.read` calls for the formats of this package, found by its entry points."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pyvista


def read_volume(path: str, /, **options: Any) -> pyvista.ImageData:
    """Read a volume as `vtkmcvr.read` does; keyword arguments are its options."""
    from .readers import read

    return read(path, **options)
