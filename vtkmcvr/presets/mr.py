"""Looks of MR, whose values have no unit: positions are shares of the data's range."""

from __future__ import annotations

from ..material import Surface
from ..studio import Studio, View
from .look import Look

LOOKS = (
    Look(
        "mr-head",
        "head or body of an MR from outside, opaque",
        "relative",
        ((0.08, 0.0), (0.16, 0.25), (0.30, 0.70), (1.0, 0.85)),
        (
            (0.08, 0.74, 0.38, 0.27),
            (0.35, 0.80, 0.46, 0.34),
            (0.70, 0.86, 0.64, 0.52),
            (1.0, 0.92, 0.86, 0.80),
        ),
        surface=Surface(1.0, specular=0.03, exponent=15.0),
        studio=Studio(key=6.0, fill=0.65, softness=1.6),
        exposure=0.4,
        view=View(azimuth=25.0),
    ),
    Look(
        "mr-brain",
        "brain of an MR without its skull",
        "relative",
        ((0.15, 0.0), (0.28, 0.25), (0.45, 0.75), (1.0, 0.92)),
        (
            (0.15, 0.62, 0.30, 0.26),
            (0.45, 0.80, 0.56, 0.50),
            (0.75, 0.88, 0.74, 0.66),
            (1.0, 0.94, 0.88, 0.82),
        ),
        surface=Surface(1.0, specular=0.05, exponent=35.0),
        studio=Studio(key=6.5, fill=0.55),
        exposure=0.4,
        view=View(azimuth=-55.0, elevation=20.0),
    ),
    Look(
        "mr-angio",
        "vessels of an MR or CT angiography: the brightest values",
        "relative",
        ((0.28, 0.0), (0.40, 0.25), (0.60, 0.75), (1.0, 0.92)),
        (
            (0.28, 0.66, 0.10, 0.06),
            (0.50, 0.82, 0.16, 0.08),
            (1.0, 0.93, 0.50, 0.30),
        ),
        surface=Surface(0.97, specular=0.06, exponent=60.0),
        studio=Studio(key=6.5, fill=0.6),
        exposure=0.5,
    ),
)
