"""`vtkmcvr presets`."""

from __future__ import annotations

import argparse
from typing import Any


def add_presets(commands: Any) -> None:
    """Command `presets`."""
    presets = commands.add_parser("presets", help="list the looks")
    presets.set_defaults(command=_presets)


def _presets(args: argparse.Namespace) -> int:
    from ..presets import LOOKS

    for look in LOOKS.values():
        print(f"{look.name:<10} {look.about}")
    return 0
