import math

import numpy as np
import pytest
from scenes import frontal, medium, render, scene, slab, volume
from vtkmodules.vtkRenderingCore import vtkCamera

from vtkmcvr.kernels.camera import camera_ray, filtered_position
from vtkmcvr.kernels.jit import entry_point
from vtkmcvr.kernels.rng import start, uniform
from vtkmcvr.plan import plan
from vtkmcvr.scene import Camera, Lens, PixelFilter

f32 = np.float32
SIZE = (320, 200)
CENTRE = (10.0, 20.0, -5.0)
# So narrow that a ray starts at the very pixel centre
POINT = PixelFilter("box", 1e-9)


@entry_point
def draw_rays(camera, lens, column, row, n):
    out = np.empty((n, 6))
    for i in range(n):
        o, d, _ = camera_ray(camera, lens, column, row, start(6, i, 0))
        out[i, 0], out[i, 1], out[i, 2] = o
        out[i, 3], out[i, 4], out[i, 5] = d
    return out


@entry_point
def draw_filter(table, n):
    out = np.empty(n)
    for i in range(n):
        _, u = uniform(start(7, i, 0))
        out[i] = filtered_position(table, 10, u)
    return out


def packed_camera(camera, pixel_filter=POINT, size=SIZE):
    parts = plan(scene(slab(centre=CENTRE), camera=camera, size=size, pixel_filter=pixel_filter))
    return parts.packed.camera, parts.packed.lens


def film_position(camera, points, size=SIZE):
    """Column and row at which VTK shows world points."""
    other = vtkCamera()
    other.SetPosition(camera.position)
    other.SetFocalPoint(camera.focal_point)
    other.SetViewUp(camera.view_up)
    other.SetViewAngle(camera.view_angle)
    other.SetWindowCenter(*camera.window_centre)
    if camera.parallel_scale is not None:
        other.ParallelProjectionOn()
        other.SetParallelScale(camera.parallel_scale)
    other.SetClippingRange(0.1, 1000)
    m = other.GetCompositeProjectionTransformMatrix(size[0] / size[1], -1, 1)
    m = np.array([[m.GetElement(i, j) for j in range(4)] for i in range(4)])
    clip = np.c_[points, np.ones(len(points))] @ m.T
    ndc = clip[:, :2] / clip[:, 3:]
    return (ndc[:, 0] + 1) / 2 * size[0], (1 - ndc[:, 1]) / 2 * size[1]


CAMERAS = {
    "perspective": Camera((3, -40, 12), (9, 21, -4), (0.1, 0, 1), view_angle=35),
    "wide": Camera((9, 17, -4), (11, 24, -6), (0, 1, 0.3), view_angle=100),
    "shifted": Camera((3, -40, 12), (9, 21, -4), view_angle=20, window_centre=(0.3, -0.7)),
    "parallel": Camera((30, -4, 12), (9, 21, -4), parallel_scale=7),
    "shifted parallel": Camera(
        (30, -4, 12), (9, 21, -4), parallel_scale=7, window_centre=(-0.4, 0.25)
    ),
}


@pytest.mark.parametrize("camera", CAMERAS.values(), ids=CAMERAS)
def test_rays_meet_what_vtk_projects_to_their_film_position(camera):
    # Points in front of the camera, near the focal point
    points = np.add(camera.focal_point, np.random.default_rng(1).normal(size=(30, 3)))
    p, _ = packed_camera(camera)
    for point, x, y in zip(points - np.array(CENTRE), *film_position(camera, points), strict=True):
        origin = np.array(p.origin) + x * np.array(p.origin_x) + y * np.array(p.origin_y)
        heading = np.array(p.direction) + x * np.array(p.direction_x) + y * np.array(p.direction_y)
        heading /= np.linalg.norm(heading)
        offset = point - origin
        assert offset @ heading > 0
        assert np.linalg.norm(np.cross(offset, heading)) < 1e-9 * np.linalg.norm(offset)


@pytest.mark.parametrize("camera", CAMERAS.values(), ids=CAMERAS)
def test_rays_of_a_pixel_pass_through_its_centre(camera):
    p, lens = packed_camera(camera)
    o, d = np.hsplit(draw_rays(p, lens, 250, 30, 1)[0], 2)
    x, y = film_position(camera, (o + np.array(CENTRE) + 50 * d)[None])
    # float32 direction over 50 units, in pixels
    assert (x[0], y[0]) == pytest.approx((250.5, 30.5), abs=5e-3)
    assert np.linalg.norm(d) == pytest.approx(1, abs=1e-6)


def test_row_0_is_on_top_and_column_0_is_left():
    values = np.zeros((9, 9, 9), np.float32)
    values[5:, :, :4] = 1  # large z, small x
    alpha = render(scene(volume(values, (0.25,) * 3)), samples=4).alpha
    quarters = [alpha[:14, :14], alpha[:14, 18:], alpha[18:, :14], alpha[18:, 18:]]
    assert [bool(q.any()) for q in quarters] == [True, False, False, False]


@pytest.mark.parametrize(
    ("kind", "width", "deviation", "reach"),
    # A Gaussian cut off at 3 sigma has a standard deviation of 0.9866 sigma
    [("box", 0.5, 0.5 / math.sqrt(3), 0.5), ("tent", 1.0, 1 / math.sqrt(6), 1.0),
     ("gaussian", 0.5, 0.5 * 0.98658, 1.5)],
)  # fmt: skip
def test_film_positions_follow_the_filter(kind, width, deviation, reach):
    n = 200_000
    camera, _ = packed_camera(frontal(), PixelFilter(kind, width))
    x = draw_filter(camera.filter, n) - 10.5
    assert np.abs(x).max() <= reach + 1e-6
    # 4.5 standard errors of mean and (Gaussian or narrower) standard deviation; 1e-3 for the table
    assert abs(x.mean()) < 4.5 * deviation / math.sqrt(n)
    assert abs(x.std() - deviation) < 4.5 * deviation / math.sqrt(2 * n) + 1e-3 * deviation


# Lens


def lens_camera(radius, focus=None):
    return Camera((10, 0, -5), CENTRE, view_angle=90, lens=Lens(radius, focus_distance=focus))


@pytest.mark.parametrize(("column", "row"), [(160, 100), (0, 0), (319, 150)])
@pytest.mark.parametrize("z", [5.0, 20.0, 60.0])
def test_circle_of_confusion(z, column, row):
    # In the plane at depth z the rays of one film point fill a disk of radius a |z - f| / f around
    # the pinhole's ray, at the centre as in the corners (HC-50); in the focal plane a point
    a, f, n = 0.8, 20.0, 20_000
    camera, lens = packed_camera(lens_camera(a, f))
    rays = draw_rays(camera, lens, column, row, n)
    pinhole, _ = packed_camera(lens_camera(0))
    middle = draw_rays(pinhole, None, column, row, 1)[0]
    forward = np.array((0.0, 1.0, 0.0))

    def at_depth(o, d):
        t = (z - (o - np.array(camera.origin)) @ forward) / (d @ forward)
        return o + t[..., None] * d

    apart = at_depth(rays[:, :3], rays[:, 3:]) - at_depth(middle[:3], middle[3:])
    r = np.linalg.norm(apart, axis=1)
    radius = a * abs(z - f) / f
    assert r.max() < radius + 1e-5 * z
    # Evenly filled: r^2 / R^2 is uniform, mean 1/2 and standard deviation 1/sqrt(12)
    if radius > 0:
        assert abs((r**2 / radius**2).mean() - 0.5) < 4.5 / math.sqrt(12 * n) + 1e-4
        assert np.abs(apart.mean(axis=0)).max() < 4.5 * radius / 2 / math.sqrt(n) + 1e-5 * z


def test_lens_focuses_on_the_focal_point_by_default():
    _, lens = packed_camera(lens_camera(0.5))
    assert lens.focus_distance == pytest.approx(20.0)


def test_aperture_0_is_the_pinhole_to_the_bit():
    def film(lens):
        camera = Camera((0, -6, 0), (0, 0, 0), lens=lens)
        return render(scene(camera=camera), samples=8).film

    for a, b in zip(film(None), film(Lens(0.0, 2.0)), strict=True):
        np.testing.assert_array_equal(a, b)


def test_plate_in_the_focal_plane_is_sharp_to_the_corners():
    # Stripes 0.5 wide at the focal distance 4 under 90 degrees, 8 units of view over 32 pixels: a
    # pixel is one half stripe, all opaque or all clear but for the soft edge; out of focus they mix
    x = np.arange(129)
    stripes = ((x // 8) % 2).astype(np.float32)
    values = np.zeros((129, 3, 129), np.float32)
    values[:] = stripes
    vol = volume(values, (1 / 16, 1e-3, 1 / 16))

    def spread(focus):
        camera = Camera((0, -4, 0), (0, 0, 0), view_angle=90, lens=Lens(1.2, focus))
        alpha = render(scene(vol, medium(3e4), camera), samples=64).alpha
        return np.concatenate([alpha[:4, :4].ravel(), alpha[-4:, -4:].ravel()]).std()

    assert spread(4.0) > 0.4
    assert spread(2.5) < 0.2
