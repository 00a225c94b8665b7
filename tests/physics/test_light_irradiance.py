"""What lights send to a voxel and to a Lambert surface, against closed forms.

z-scores are compared with 4.5: by Bonferroni over the (fewer than 80) comparisons of this file,
chance exceeds it in less than 80 x 6.8e-6 = 6e-4 of all choices of seeds. The seeds are fixed.
"""

import math

import numpy as np
import pytest
from scenes import frontal, mean_and_error, medium, render, scene, slab, volume

from vtkmcvr.lights import (
    BoxLight,
    CylinderLight,
    DirectionalLight,
    DiskLight,
    EnvironmentMap,
    GradientEnvironment,
    PointLight,
    RectangleLight,
    SphereLight,
)
from vtkmcvr.scene import Surface

# A voxel-sized medium at the origin, 0.02 wide: distances of 1 vary by 1 % over it, evenly around 1
VOXEL = slab((0.02, 0.02, 0.02))
ALPHA = -math.expm1(-50 * 0.02)
# This ramp is a Lambert surface with normal -y, at its face y = -1: paths end 1/256 deep on average
RAMP = volume(
    np.broadcast_to(np.linspace(1, 2, 9, dtype=np.float32)[:, None], (9, 9, 9)), (0.25,) * 3
)
AIM = np.array((0.0, -1 + 1 / 256, 0.0))
# All kinds at once, too dark and too far to count, so that one kernel serves all lights
DARK = (
    RectangleLight((3e3, 0, 0), (0, 0, 0), (1e-3, 1e-3), 1e-15),
    RectangleLight((0, 0, 1e-3), (0, 0, 1), (1e-9, 1e-9), 1e-15),
    DiskLight((0, 3e3, 0), (0, 0, 0), 1e-3, 1e-15),
    SphereLight((0, 0, 3e3), 1e-3, 1e-15),
    CylinderLight((0, 3e3, 0), (0, 3e3, 1), 1e-3, 1e-15),
    DirectionalLight((0, 1, 0), 1e-15),
    EnvironmentMap(np.full((1, 1, 3), 1e-15)),
)

a, b, r, h = 0.5, 0.3, 0.4, 1.0
SOLID_ANGLES = {
    "rectangle": (
        RectangleLight((0, 0, h), (0, 0, 0), (2 * a, 2 * b)),
        4 * math.asin(a * b / math.sqrt((a * a + h * h) * (b * b + h * h))),
    ),
    "disk": (DiskLight((0, 0, h), (0, 0, 0), r), 2 * math.pi * (1 - h / math.hypot(h, r))),
    "ring": (
        DiskLight((0, 0, h), (0, 0, 0), 2 * r, inner_radius=r),
        2 * math.pi * (h / math.hypot(h, r) - h / math.hypot(h, 2 * r)),
    ),
    "sphere": (SphereLight((0, 0, h), r), 2 * math.pi * (1 - math.sqrt(1 - r * r))),
    "sphere around": (SphereLight((0, 0, 0.2), 1, two_sided=True), 4 * math.pi),
    "long tube around": (
        # All but the two open ends
        CylinderLight((0, 0, -2), (0, 0, 2), 1, two_sided=True),
        4 * math.pi - 2 * 2 * math.pi * (1 - 2 / math.sqrt(5)),
    ),
    "box": (
        # Face-on, a box is its nearest face
        BoxLight((0, 0, h + 0.5), (2 * a, 2 * b, 1.0)),
        4 * math.asin(a * b / math.sqrt((a * a + h * h) * (b * b + h * h))),
    ),
}


@pytest.mark.parametrize("how", ["light", "scatter", "mis"])
@pytest.mark.parametrize("name", SOLID_ANGLES)
def test_voxel_scatters_the_share_of_directions_that_the_light_fills(name, how):
    light, solid_angle = SOLID_ANGLES[name]
    lit = scene(
        VOXEL, medium(50.0), frontal(0.009, distance=0.5), lights=(light, *DARK),
        shadow_reach=1e-9, light_sampling=how,
    )  # fmt: skip
    mean, error = mean_and_error(render(lit, 128))
    expected = ALPHA * solid_angle / (4 * math.pi)
    assert error < 0.03 * expected
    # The inverse square of the distance averages to 1 + (0.01 / h)^2 over the voxel
    assert abs(mean - expected) < 4.5 * error + 3e-4 * expected


def rectangle_factor(a, b, h):
    """Irradiance over radiance under the middle of a rectangle that is parallel to the surface."""
    x, y = a / h, b / h
    u, v = math.hypot(1, x), math.hypot(1, y)
    return 2 * (x / u * math.atan(y / u) + y / v * math.atan(x / v))


IRRADIANCES = {
    "rectangle": (
        RectangleLight(AIM - (0, h, 0), AIM, (2 * a, 2 * b), 2.0),
        2 * rectangle_factor(a, b, h),
    ),
    "near rectangle": (
        RectangleLight(AIM - (0, 0.1, 0), AIM, (2 * a, 2 * b), 2.0),
        2 * rectangle_factor(a, b, 0.1),
    ),
    "disk": (DiskLight(AIM - (0, h, 0), AIM, r), math.pi * r * r / (r * r + h * h)),
    "ring": (
        DiskLight(AIM - (0, h, 0), AIM, 2 * r, inner_radius=r),
        math.pi * (4 * r * r / (4 * r * r + h * h) - r * r / (r * r + h * h)),
    ),
    "sphere": (SphereLight(AIM - (0, h, 0), r), math.pi * r * r / h**2),
    "oblique sphere": (
        # Wholly above the horizon: sphere of sin^2 = r^2 / d^2, times the cosine of its middle
        SphereLight(AIM - (1, 1, 0), r),
        math.pi * r * r / 2 * math.sqrt(0.5),
    ),
    "sphere at the horizon": (
        # Nusselt's analogue: the upper half, 30 degrees high, projects to a segment of the disk
        SphereLight(np.add(AIM, (1, 0, 0)), 0.5),
        math.pi / 6 - math.sqrt(3) / 4,
    ),
    "point": (PointLight(np.subtract(AIM, (1, 2, 0)), 3.0), 3.0 * 2 / 5**1.5),
    "spot": (
        PointLight(AIM - (0, 2, 0), 3.0, direction=(1, 1, 0), cone_angle=60, exponent=4),
        3.0 / 4 * math.cos(math.pi / 4) ** 4,
    ),
    "directional": (DirectionalLight((0, 3, 4), 2.0), 2 * 0.6),
    "white above": (GradientEnvironment(1.0, 1.0, 0.0, up=(0, -1, 0)), math.pi),
    "gradient": (
        # 2 pi integral of (1 - t) m + t T, t the elevation over pi/2, times sin cos: the mean of t
        # with weight 2 sin cos is 1/2
        GradientEnvironment(3.0, 1.0, 9.0, up=(0, -1, 0)),
        math.pi * 2.0,
    ),
    "gradient on its side": (
        # Nusselt's analogue again, integrated by `side_irradiance`
        GradientEnvironment(1.0, 0.0, 1.0, up=(0, 0, 1)),
        None,
    ),
}


def side_irradiance():
    """Irradiance of |elevation| / (pi / 2) on a wall, by a fine midpoint rule."""
    n = 2000
    y, z = np.meshgrid(*(((np.arange(n) + 0.5) / n * 2 - 1),) * 2)
    inside = y * y + z * z < 1
    return float(np.sum(np.abs(np.arcsin(z[inside])) / (math.pi / 2)) * 4 / n**2)


@pytest.mark.parametrize("name", IRRADIANCES)
def test_lambert_surface_reflects_the_irradiance(name):
    light, irradiance = IRRADIANCES[name]
    irradiance = side_irradiance() if irradiance is None else irradiance
    dark = [
        one for one in DARK if type(one) is not type(light) or one.brightness != light.brightness
    ]
    # Lambert surface of albedo 0.6: radiance 0.6 E / pi; seen within 0.01 of the aim
    lit = scene(
        RAMP, medium(256.0, 0.6), frontal(0.01), lights=(light, *dark),
        surface=Surface(mode="brdf", specular=0.0), shadow_reach=1e-9,
    )  # fmt: skip
    mean, error = mean_and_error(render(lit, 256))
    expected = 0.6 * irradiance / math.pi
    assert error < 0.02 * expected
    # Paths end up to 0.02 away from the aim, evenly around it
    assert abs(mean - expected) < 4.5 * error + 5e-3 * expected
