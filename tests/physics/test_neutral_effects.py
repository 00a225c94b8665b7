"""An effect that is there and changes nothing leaves the mean of the picture as it is.

Kernels are compiled without what a scene does not call for; here it is called for, in vain. So the
two pictures take different code, and different random numbers, to the same light.
"""

from dataclasses import replace

import numpy as np
import pytest
from scenes import DARK, blob, frontal, medium, scene, z_score

from vtkmcvr import (
    BoxReceiver,
    Camera,
    ColourCurve,
    ConstantEnvironment,
    Curve,
    DirectionalLight,
    EnvironmentMap,
    HenyeyGreenstein,
    Labels,
    Layer,
    Lens,
    Plane,
    RectangleLight,
    Surface,
    Texture,
)
from vtkmcvr.plan import plan
from vtkmcvr.rendering import render_scene

pytestmark = pytest.mark.slow

SUN = (DirectionalLight((0.3, 1, -1), 2.0),)
PLAIN = scene(blob(), medium(4.0, 0.7), frontal(0.9), size=(24, 24), lights=SUN)
# Equal to float32, but not the same: one that is would switch labels off
LIKE = medium(4.0 * (1 + 1e-9), 0.7)
FAR = (900.0, 900.0, 900.0)


def with_transfer(**changes):
    return {"transfer": replace(PLAIN.transfer, **changes)}


# Effect of the plan -> what calls for it in vain
NEUTRAL = {
    "surface shading": {"surface": Surface(gradient_factor=1e-3)},
    "specular coat": {"surface": Surface(gradient_factor=1e-3, specular=0.5)},
    "anisotropic phase": {"phase": HenyeyGreenstein(1.01e-3)},
    "emission": with_transfer(emission=ColourCurve([(0, DARK, DARK, DARK)])),
    "gradient classification": with_transfer(gradient_opacity=Curve([(0, 1 - 1e-6), (99, 1)])),
    "clipping": {"clip": (Plane(FAR, (-1, 0, 0)),)},
    "labels": {"labels": Labels(np.arange(17**3).reshape(17, 17, 17) % 2, {1: LIKE})},
    "more volumes": {"layers": (Layer(blob(9), medium(1e-9)),)},
    "receivers": {"receivers": (BoxReceiver(FAR, (1, 1, 1)),)},
    "constant environment": {"lights": (*SUN, ConstantEnvironment(DARK))},
    "environment map": {"lights": (*SUN, EnvironmentMap(np.full((2, 4, 3), DARK)))},
    "area lights": {"lights": (*SUN, RectangleLight(FAR, (0, 0, 0), (1, 1), DARK))},
    "light textures": {
        "lights": (
            *SUN,
            RectangleLight(FAR, (0, 0, 0), (1, 1), DARK, texture=Texture(np.ones((2, 2, 3)))),
        )
    },
    "first-hit AOVs": {"aovs": ("albedo", "normal")},
    "even samples": {"sampler": "sobol"},
    "depth of field": {
        "camera": Camera((0, -5, 0), (0, 0, 0), view_angle=20, lens=Lens(1e-6))
    },
}  # fmt: skip


@pytest.fixture(scope="module")
def plain():
    """Pictures of the scene without any of them, for the two cameras."""
    cameras = {False: PLAIN.camera, True: Camera((0, -5, 0), (0, 0, 0), view_angle=20)}
    return {
        lensed: picture_of(replace(PLAIN, camera=camera), 1) for lensed, camera in cameras.items()
    }


def picture_of(some, seed):
    return render_scene(replace(some, sampler="independent"), samples=400, seed=seed)


@pytest.mark.parametrize("name", NEUTRAL)
def test_effect_in_vain_has_the_mean_of_the_scene_without_it(name, plain):
    some = replace(PLAIN, **{"sampler": "independent", **NEUTRAL[name]})
    planned = plan(some)
    assert name in {effect.name for effect in planned.effects if effect.on}
    picture = render_scene(planned, samples=400, seed=2)
    without = plain[name == "depth of field"]
    assert name not in {effect.name for effect in without.plan.effects if effect.on}
    # 230 000 paths each: means are known to some 0.3 %; 4.5 standard errors for 16 comparisons
    assert abs(z_score(picture, without)) < 4.5


def test_a_change_of_two_percent_would_be_seen(plain):
    brighter = replace(PLAIN, lights=(DirectionalLight((0.3, 1, -1), 2.04),))
    assert abs(z_score(picture_of(brighter, 2), plain[False])) > 4.5
