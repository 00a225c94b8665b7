"""What a picture holds: what is seen, from a side where there is something to see."""

import numpy as np
import pytest

from vtkmcvr.curves import Curve
from vtkmcvr.front import scene_of
from vtkmcvr.presets.framing import seen_points, seen_voxels, view_of_slab
from vtkmcvr.scene import Volume
from vtkmcvr.studio import View

OPACITY = Curve(((0.5, 0.0), (1.0, 1.0)))


def boxed(low, high, shape=(40, 50, 60)):
    values = np.zeros(shape, np.float32)
    values[tuple(slice(a, b) for a, b in zip(low, high, strict=True))] = 1.0
    return Volume.from_grid(values, (2.0, 2.0, 2.0))


def test_points_hold_what_is_seen_but_no_specks():
    volume = boxed((6, 6, 8), (34, 44, 52))
    points = seen_points(volume, seen_voxels(volume, OPACITY, None))
    # World is (i, j, k); the box ends between its last voxel and the next one
    np.testing.assert_allclose(points.min(0) / 2, (8, 6, 6), atol=1.5)
    np.testing.assert_allclose(points.max(0) / 2, (51, 43, 33), atol=1.5)
    volume.values[0, 0, 0] = volume.values[38, 48, 58] = 1.0
    again = seen_points(volume, seen_voxels(volume, OPACITY, None))
    np.testing.assert_allclose(again.min(0), points.min(0), atol=2)
    np.testing.assert_allclose(again.max(0), points.max(0), atol=2)
    mask = np.zeros(volume.values.shape, np.uint8)
    assert seen_points(volume, seen_voxels(volume, OPACITY, mask)) is None


@pytest.mark.parametrize("view", [View(), View(azimuth=40, elevation=30), View("top", roll=20)])
def test_all_that_is_seen_is_in_the_picture_and_fills_it(view):
    volume = boxed((5, 20, 3), (25, 44, 20))
    scene = scene_of(volume, preset="solid", view=view, size=(120, 90)).scene
    camera = scene.camera
    k, j, i = np.nonzero(volume.values)
    points = np.stack([i, j, k], -1) * 2.0 - np.array(camera.position)
    right, up, forward = camera.frame
    depth = points @ forward
    half = np.tan(np.radians(camera.view_angle) / 2)
    across, high = points @ right / depth / (half * 120 / 90), points @ up / depth / half
    widest = max(np.abs(across).max(), np.abs(high).max())
    assert 0.85 < widest <= 1.0


def test_slabs_are_seen_from_their_broad_side():
    def seen(size):
        return np.array(list(np.ndindex(2, 2, 2))) * size

    assert view_of_slab(View(), seen((300, 200, 120))) == View()
    assert view_of_slab(View(), seen((300, 200, 30))).elevation < -40
    assert view_of_slab(View(elevation=12), seen((300, 200, 30))).elevation > 40
    assert view_of_slab(View(azimuth=20), seen((10, 200, 300))).azimuth > 40
    assert view_of_slab(View(), seen((300, 10, 300))) == View()
    assert view_of_slab(View("top"), seen((300, 200, 30))) == View("top")
    assert view_of_slab(View(), None) == View()
