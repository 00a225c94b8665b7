"""Paths in step make the picture of paths one by one, whatever the scene calls for."""

import numpy as np
import pytest
from numba import config
from scenes import noise, scene
from test_packets import in_step_and_one_by_one

from vtkmcvr.curves import ColourCurve, Curve
from vtkmcvr.cutting import Plane, Sphere
from vtkmcvr.lights import (
    ConstantEnvironment,
    CylinderLight,
    DiskLight,
    EnvironmentMap,
    GradientEnvironment,
    PointLight,
    RectangleLight,
    SphereLight,
)
from vtkmcvr.phases import HenyeyGreenstein
from vtkmcvr.receivers import PlaneReceiver, SphereReceiver
from vtkmcvr.scene import Camera, Lens, Surface, TransferFunction

pytestmark = pytest.mark.skipif(config.DISABLE_JIT, reason="without it, paths go one by one")

SHAPES = (
    RectangleLight((0, -1.3, 0.4), (0, 0, 0), (1, 1), 9.0), SphereLight((0, -1, 2), 0.3, 9.0),
    DiskLight((2, -2, 2), (0, 0, 0), 1.0, 2.0), CylinderLight((2, 2, 2), (2, 2, 3), 0.2, 2.0),
)  # fmt: skip
SHINY = TransferFunction(
    Curve([(0, 0), (1, 0.3)]), ColourCurve([(0, 0.9, 0.5, 0.2), (1, 0.2, 0.5, 0.9)]),
    specular=ColourCurve([(0, 0, 0, 0), (1, 0.3, 0.3, 0.3)]), exponent=Curve([(0, 5), (1, 90)]),
)  # fmt: skip
# What other parts of stages are for; the surfaces are those of a gradient that noise has
SCENES = {
    "lamps of all shapes": {"lights": SHAPES},
    "five lights": {"lights": (*SHAPES, RectangleLight((3, 3, 3), (0, 0, 0), (1, 1), 9.0))},
    "one light": {"lights": (PointLight((1, -2, 2), 9.0, direction=(-1, 2, -2), cone_angle=40),)},
    "map": {"lights": (EnvironmentMap(np.random.default_rng(2).random((5, 8, 3))),)},
    "coat by scalar": {"transfer": SHINY, "lights": SHAPES[:2]},
    "threshold": {"surface": Surface(0.7, mode="threshold", threshold=0.2), "lights": SHAPES[:1]},
    "receivers": {
        "lights": (ConstantEnvironment(1.0),),
        "receivers": (PlaneReceiver((0, 0, -1), (0, 0, 1)), SphereReceiver((1, 0, 0.5), 0.5)),
    },
    "cut": {"lights": SHAPES[:2], "clip": (Plane((0, 0, 0), (1, -1, 0)), Sphere((0, 0, 0), 1.0))},
    "albedo and normals": {"lights": (ConstantEnvironment(1.0),), "aovs": ("albedo", "normal")},
    "seen around": {
        "lights": (GradientEnvironment(1.0, 0.5, 0.1), SHAPES[1]),
        "environment_visible": True,
    },
    "lens": {
        "lights": (ConstantEnvironment(1.0),),
        "camera": Camera((0, -5, 0), (0, 0, 0), view_angle=30, lens=Lens(0.1)),
    },
    "no shadows": {"lights": SHAPES[:2], "shadow_reach": 0.0},
    "shadows seen or not": {"lights": SHAPES[:2], "ratio_tracking": False},
    "independent samples": {"lights": SHAPES[:2], "sampler": "independent"},
}


@pytest.mark.parametrize(
    ("name", "scattering"),
    [
        (name, scattering)
        for name in SCENES
        for scattering in ("single", "multiple")
        # Multiple scattering knows no reach of shadows
        if (name, scattering) != ("no shadows", "multiple")
    ],
)
def test_all_that_goes_in_step_is_as_one_by_one(name, scattering):
    options = {"surface": Surface(0.7), "phase": HenyeyGreenstein(0.4), **SCENES[name]}
    step, single = in_step_and_one_by_one(
        scene(noise(), scattering=scattering, size=(24, 20), **options), 4
    )
    np.testing.assert_array_equal(step.count, single.count)
    assert step.rejected.sum() == single.rejected.sum() == 0
    assert single.mean.any()
    for plane in ("mean", "albedo", "normal"):
        ours, theirs = getattr(step, plane), getattr(single, plane)
        assert (ours is None) == (theirs is None)
        if ours is not None:
            # A rounding turns one decision in some hundreds; many events have many decisions
            same = np.isclose(ours, theirs, rtol=1e-3, atol=1e-5).all(-1).mean()
            assert same > (0.98 if scattering == "single" else 0.94)
            assert ours.mean() == pytest.approx(theirs.mean(), rel=0.03)
