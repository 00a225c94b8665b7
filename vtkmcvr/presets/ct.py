"""Looks of CT in HU.

Positions come from what tissues measure: air -1000; lung -950 to -700, with vessels and walls up to
0; fat -120 to -60; water 0; muscle and blood 35 to 70; organs with contrast agent 80 to 180;
vessels with it 150 to 500; spongy bone 150 to 400; compact bone 500 to 1900; metal above 2500.
"""

from __future__ import annotations

from ..material import Surface
from ..studio import Studio, View
from .look import Look

LOOKS = (
    Look(
        "ct-bone",
        "bone of a CT, soft tissue transparent",
        "HU",
        ((150.0, 0.0), (260.0, 0.12), (450.0, 0.75), (1200.0, 0.94)),
        (
            (150.0, 0.55, 0.24, 0.14),
            (280.0, 0.80, 0.60, 0.40),
            (600.0, 0.92, 0.84, 0.70),
            (1500.0, 0.95, 0.92, 0.86),
        ),
        surface=Surface(0.95, specular=0.04, exponent=25.0),
        studio=Studio(key=6.5, fill=0.55),
        exposure=0.4,
        body=0.0,
    ),
    Look(
        "ct-skin",
        "skin of a CT, opaque",
        "HU",
        ((-650.0, 0.0), (-400.0, 0.25), (-150.0, 0.85), (100.0, 0.95)),
        (
            (-650.0, 0.78, 0.40, 0.27),
            (-100.0, 0.80, 0.43, 0.30),
            (300.0, 0.82, 0.60, 0.45),
        ),
        surface=Surface(1.0, specular=0.03, exponent=12.0),
        studio=Studio(key=6.0, fill=0.7, softness=1.6),
        exposure=0.5,
        view=View(azimuth=25.0),
        body=0.0,
    ),
    Look(
        "ct-soft",
        "muscles, organs and bones of a CT, skin and fat taken off",
        "HU",
        (
            (-40.0, 0.0), (0.0, 0.02), (30.0, 0.30), (80.0, 0.65), (200.0, 0.8), (1200.0, 0.95),
        ),
        (
            (-40.0, 0.90, 0.62, 0.36),
            (10.0, 0.76, 0.30, 0.20),
            (60.0, 0.70, 0.19, 0.13),
            (130.0, 0.76, 0.27, 0.18),
            (220.0, 0.88, 0.66, 0.48),
            (600.0, 0.94, 0.89, 0.79),
        ),
        surface=Surface(0.97, specular=0.05, exponent=25.0),
        studio=Studio(key=6.5, fill=0.6),
        exposure=0.6,
        view=View(azimuth=25.0),
        body=7.0,
    ),
    Look(
        "ct-vessels",
        "vessels and organs with contrast agent, bone pale behind them",
        "HU",
        ((110.0, 0.0), (160.0, 0.06), (220.0, 0.45), (400.0, 0.8), (1200.0, 0.9)),
        (
            (110.0, 0.60, 0.16, 0.10),
            (180.0, 0.80, 0.13, 0.07),
            (300.0, 0.85, 0.30, 0.18),
            (450.0, 0.90, 0.76, 0.60),
            (1000.0, 0.95, 0.92, 0.86),
        ),
        surface=Surface(0.95, specular=0.05, exponent=40.0),
        studio=Studio(key=6.5, fill=0.55),
        exposure=0.5,
        body=3.0,
    ),
    Look(
        "ct-lung",
        "lungs: tissue thin as mist, vessels and walls dense",
        "HU",
        (
            (-960.0, 0.0), (-900.0, 0.004), (-800.0, 0.015), (-680.0, 0.08), (-520.0, 0.40),
            (-400.0, 0.45), (-330.0, 0.0),
        ),
        (
            (-950.0, 0.93, 0.55, 0.46),
            (-800.0, 0.92, 0.52, 0.43),
            (-650.0, 0.86, 0.30, 0.22),
            (-350.0, 0.80, 0.20, 0.13),
        ),
        surface=Surface(0.9, specular=0.04, exponent=20.0),
        studio=Studio(key=7.0, fill=0.7),
        exposure=0.9,
        body=12.0,
    ),
    Look(
        "ct-airways",
        "air in the body: windpipe, bronchi, sinuses, bowel",
        "HU",
        ((-1024.0, 0.9), (-980.0, 0.85), (-935.0, 0.4), (-905.0, 0.02), (-880.0, 0.0)),
        ((-1000.0, 0.45, 0.72, 0.85), (-900.0, 0.40, 0.62, 0.78)),
        surface=Surface(0.95, specular=0.05, exponent=40.0),
        studio=Studio(key=6.5, fill=0.6),
        exposure=0.5,
        body=6.0,
    ),
    Look(
        "ct-heart",
        "heart and great vessels, best with contrast agent; the chest wall taken off",
        "HU",
        (
            (-30.0, 0.0), (0.0, 0.05), (40.0, 0.45), (130.0, 0.7), (400.0, 0.85), (1200.0, 0.95),
        ),
        (
            (-30.0, 0.90, 0.60, 0.32),
            (20.0, 0.74, 0.28, 0.19),
            (70.0, 0.70, 0.16, 0.11),
            (200.0, 0.84, 0.22, 0.13),
            (350.0, 0.90, 0.55, 0.36),
            (600.0, 0.95, 0.88, 0.78),
        ),
        surface=Surface(0.97, specular=0.06, exponent=45.0),
        studio=Studio(key=6.5, fill=0.55),
        exposure=0.5,
        view=View(azimuth=20.0, elevation=8.0),
        body=38.0,
    ),
)  # fmt: skip
