"""Looks of other data: materials, fields, labels."""

from __future__ import annotations

from ..material import Surface
from ..phases import HenyeyGreenstein
from ..studio import Studio, View
from .look import Look

LOOKS = (
    Look(
        "solid",
        "anything: opaque above the threshold that best splits the values in two",
        "threshold",
        ((-0.06, 0.0), (0.06, 0.75), (1.0, 0.95)),
        (
            (-0.06, 0.62, 0.52, 0.44),
            (0.30, 0.74, 0.68, 0.60),
            (1.0, 0.88, 0.86, 0.84),
        ),
        unit_distance=0.8,
        surface=Surface(0.95, specular=0.05, exponent=40.0),
        exposure=0.3,
        view=View(azimuth=25.0, elevation=12.0),
    ),
    Look(
        "microct",
        "micro-CT or industrial CT: material opaque, pores and air clear",
        "threshold",
        ((-0.10, 0.0), (0.02, 0.55), (0.30, 0.92), (1.0, 0.98)),
        (
            (-0.10, 0.50, 0.46, 0.42),
            (0.20, 0.68, 0.64, 0.58),
            (0.60, 0.82, 0.74, 0.60),
            (1.0, 0.94, 0.84, 0.62),
        ),
        surface=Surface(0.98, specular=0.12, exponent=90.0, coat="ggx"),
        studio=Studio(key=7.0, rim=3.5, fill=0.45),
        exposure=0.3,
        view=View(azimuth=30.0, elevation=25.0),
    ),
    Look(
        "signed",
        "values of both signs: high ones warm, low ones cold, those near 0 clear",
        "signed",
        ((-1.0, 0.9), (-0.45, 0.5), (-0.32, 0.0), (0.32, 0.0), (0.45, 0.5), (1.0, 0.9)),
        (
            (-1.0, 0.20, 0.62, 0.92),
            (-0.35, 0.08, 0.22, 0.70),
            (0.35, 0.75, 0.13, 0.05),
            (1.0, 0.96, 0.80, 0.25),
        ),
        surface=Surface(0.95, specular=0.05, exponent=40.0),
        exposure=0.4,
        view=View(azimuth=25.0, elevation=15.0),
    ),
    Look(
        "cloud",
        "mist, smoke, fields without surfaces: light is scattered many times",
        "relative",
        ((0.08, 0.0), (0.25, 0.05), (0.50, 0.22), (1.0, 0.60)),
        (
            (0.08, 0.90, 0.94, 0.985),
            (0.50, 0.96, 0.97, 0.985),
            (1.0, 0.985, 0.98, 0.97),
        ),
        surface=None,
        studio=Studio(
            key=6.5,
            rim=3.0,
            fill=0.08,
            softness=0.6,
            warm=(1.0, 0.80, 0.58),
            cool=(0.45, 0.66, 1.0),
        ),
        exposure=0.2,
        phase=HenyeyGreenstein(0.3),
        scattering="multiple",
        max_scatterings=24,
        view=View(azimuth=25.0, elevation=30.0),
    ),
    Look(
        "labels",
        "a label map: each label solid, in the colour that the file gives it",
        "labels",
        ((0.35, 0.0), (0.65, 0.95)),
        ((0.0, 0.7, 0.7, 0.7),),
        surface=Surface(1.0, specular=0.04, exponent=30.0),
        studio=Studio(key=6.0, fill=0.6),
        exposure=0.3,
        view=View(azimuth=15.0, elevation=5.0),
    ),
)
