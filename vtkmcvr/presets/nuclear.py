"""Looks of nuclear medicine, in SUV where the file gives it."""

from __future__ import annotations

from ..studio import Studio
from .look import Look

LOOKS = (
    Look(
        "pet-fusion",
        "PET: the body as mist, high uptake glowing; alone or over a CT or MR",
        "SUV",
        ((0.3, 0.0), (0.8, 0.004), (2.0, 0.010), (3.5, 0.06), (6.0, 0.30), (12.0, 0.6)),
        (
            (0.3, 0.55, 0.60, 0.75),
            (2.0, 0.45, 0.45, 0.60),
            (3.0, 0.45, 0.16, 0.05),
            (6.0, 0.50, 0.25, 0.05),
            (12.0, 0.60, 0.50, 0.20),
        ),
        surface=None,
        studio=Studio(key=5.0, rim=3.0, fill=0.5),
        exposure=0.6,
        emission=(
            (2.0, 0.0, 0.0, 0.0),
            (3.5, 0.30, 0.03, 0.0),
            (6.0, 1.0, 0.25, 0.02),
            (12.0, 1.0, 0.75, 0.25),
        ),
        emission_scale=2.5,
    ),
)
