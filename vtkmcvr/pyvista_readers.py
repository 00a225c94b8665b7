"""Volumes for `pyvista.read`, for those who ask for them."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pyvista

# PyVista's own readers of these lose the direction of the axes
FORMATS = (".nrrd", ".nhdr", ".nii", ".nii.gz", ".mha", ".mhd", ".dcm")


def override_pyvista_readers() -> None:
    """Let `pyvista.read` read medical volumes as `vtkmcvr.read` does, in this process.

    PyVista reads .nrrd, .nhdr, .nii, .nii.gz, .mha, .mhd and .dcm itself, but without the direction
    of the axes and with other axes than LPS. This changes what it returns, so it happens only when
    asked for, and until the process ends.
    """
    import pyvista

    options: dict[str, Any] = {}
    # PyVista 0.48 overrides without being told so
    if "override" in inspect.signature(pyvista.register_reader).parameters:
        options["override"] = True
    for extension in FORMATS:
        pyvista.register_reader(extension, read_volume, **options)


def read_volume(path: str, /, **options: Any) -> pyvista.ImageData:
    """Read a volume as `vtkmcvr.read` does; keyword arguments are its options."""
    from .readers import read

    return read(path, **options)
