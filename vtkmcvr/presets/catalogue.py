"""All looks, by name."""

from __future__ import annotations

from . import ct, general, mr, nuclear
from .look import Look

LOOKS = {look.name: look for family in (ct, mr, nuclear, general) for look in family.LOOKS}


def look_named(name: str) -> Look:
    """Look by name; unknown names are answered with the list."""
    if name not in LOOKS:
        raise ValueError(
            f"preset is one of {', '.join(LOOKS)}, or a file of looks (.json, .xml, .mrml, .vp); "
            f"got {name!r}"
        )
    return LOOKS[name]
