"""Cameras and lights placed around a volume."""

import numpy as np
import pytest

from vtkmcvr.lights import RectangleLight
from vtkmcvr.scene import Volume
from vtkmcvr.studio import VIEWS, Studio, studio_lights, view_camera

VOLUME = Volume.from_grid(np.zeros((20, 30, 40), np.uint8), (1.0, 2.0, 1.5), (10.0, -5.0, 3.0))


def projected(camera, points, aspect):
    """Film coordinates in [-1, 1] of world points."""
    right, up, forward = camera.frame
    toward = points - np.array(camera.position)
    extent = np.tan(np.radians(camera.view_angle) / 2) * (toward @ forward)
    return toward @ right / extent / aspect, toward @ up / extent


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize("aspect", [0.4, 1.0, 2.5])
def test_the_volume_fills_the_view_and_fits(view, aspect):
    camera = view_camera(VOLUME, view, azimuth=33, elevation=-20, roll=15, aspect=aspect)
    x, y = projected(camera, VOLUME.corners, aspect)
    assert max(np.abs(x).max(), np.abs(y).max()) == pytest.approx(1 / 1.02, abs=1e-6)


def test_front_shows_the_patients_left_on_the_right():
    camera = view_camera(VOLUME, "front")
    right, up, forward = camera.frame
    np.testing.assert_allclose(right, [1, 0, 0], atol=1e-12)  # LPS: +x is the patient's left
    np.testing.assert_allclose(up, [0, 0, 1], atol=1e-12)
    np.testing.assert_allclose(forward, [0, 1, 0], atol=1e-12)


def test_azimuth_and_elevation_move_the_camera_right_and_up():
    centre = VOLUME.centre
    moved = np.array(view_camera(VOLUME, azimuth=30).position) - centre
    assert moved[0] > 0 and moved[1] < 0
    raised = np.array(view_camera(VOLUME, elevation=30).position) - centre
    assert raised[2] > 0


def test_zoom_two_shows_half_the_height():
    wide, close = view_camera(VOLUME), view_camera(VOLUME, zoom=2)
    half = [np.tan(np.radians(c.view_angle) / 2) for c in (wide, close)]
    assert half[0] / half[1] == pytest.approx(2)


def test_a_part_of_the_volume_can_fill_the_view():
    part = VOLUME.centre + np.array([[-1, -1, -1], [1, 1, 1.0]])
    camera = view_camera(VOLUME, corners=part)
    np.testing.assert_allclose(camera.focal_point, VOLUME.centre)
    assert camera.distance < view_camera(VOLUME).distance / 10
    x, y = projected(camera, part, 4 / 3)
    assert max(np.abs(x).max(), np.abs(y).max()) == pytest.approx(1 / 1.02)


def test_lights_face_the_volume_with_the_irradiance_asked_for():
    studio = Studio(key=4.0, rim=0.0, fill=0.2, softness=0.2, warm=(1.0, 1.0, 1.0))
    lights = studio_lights(studio, VOLUME, view_camera(VOLUME))
    (key,) = [light for light in lights if isinstance(light, RectangleLight)]
    toward = VOLUME.centre - np.array(key.centre)
    distance = np.linalg.norm(toward)
    assert key.frame[2] @ toward == pytest.approx(distance)
    irradiance = key.radiance[0] * key.size[0] * key.size[1] / distance**2
    assert irradiance == pytest.approx(4.0)


@pytest.mark.parametrize("bad", [{"view": "above"}, {"zoom": 0}, {"azimuth": float("nan")}])
def test_bad_views_are_named(bad):
    with pytest.raises(ValueError, match=f"{next(iter(bad))}"):
        view_camera(VOLUME, **bad)
