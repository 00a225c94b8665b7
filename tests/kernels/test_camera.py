import math

import numpy as np
import pytest
from scenes import frontal, medium, render, scene, slab, volume
from scipy import stats
from vtkmodules.vtkCommonTransforms import vtkPerspectiveTransform
from vtkmodules.vtkRenderingCore import vtkCamera

from vtkmcvr.kernels.camera import film_position as sampled_position
from vtkmcvr.kernels.camera import filtered_position, ray_through
from vtkmcvr.kernels.jit import entry_point
from vtkmcvr.kernels.rng import start, uniform
from vtkmcvr.plan import plan
from vtkmcvr.scene import Camera, Lens, PixelFilter, Stereo

f32 = np.float32
SIZE = (320, 200)
CENTRE = (10.0, 20.0, -5.0)
# So narrow that a ray starts at the very pixel centre
POINT = PixelFilter("box", 1e-9)


@entry_point
def draw_rays(camera, lens, column, row, n):
    out = np.empty((n, 6))
    for i in range(n):
        x, y, rng = sampled_position(camera, column, row, start(6, i, 0))
        o, d, _ = ray_through(camera, lens, column, x, y, rng)
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


def lens_camera(radius, focus=None, **options):
    lens = Lens(radius, focus, **options)
    return Camera((10, 0, -5), CENTRE, view_angle=90, lens=lens)


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


def test_parallel_projection_blurs_alike_all_over_the_film():
    # The lens moves with the ray: the circle of confusion at depth z has radius a |z - f| / f
    a, f, n, z = 0.8, 20.0, 5000, 30.0
    camera = Camera((10, 0, -5), CENTRE, parallel_scale=8, lens=Lens(a, f))
    p, lens = packed_camera(camera)
    for column, row in ((160, 100), (0, 199)):
        rays = draw_rays(p, lens, column, row, n)
        middle = draw_rays(p, None, column, row, 1)[0]
        # All rays start in the plane of the lens, which faces +y
        at_z = rays[:, :3] + rays[:, 3:] * (z / rays[:, 4:5])
        apart = np.linalg.norm(at_z - (middle[:3] + z * middle[3:]), axis=1)
        radius = a * (z - f) / f
        # The largest of n squares, uniform in [0, 1]: above 1 - 9 / n but for a chance of e^-9
        assert radius * math.sqrt(1 - 9 / n) < apart.max() < radius + 1e-5 * z


def aperture(blades, rotation, n=40_000):
    """Points of a unit aperture, (right, up)."""
    p, lens = packed_camera(lens_camera(1.0, 20.0, blades=blades, rotation=rotation))
    rays = draw_rays(p, lens, 160, 100, n)
    # The view is along +y with z up
    return rays[:, [0, 2]] - np.array(p.origin)[[0, 2]]


@pytest.mark.parametrize(("blades", "rotation"), [(3, 0.0), (5, 11.0), (6, -30.0), (64, 2.0)])
def test_polygonal_aperture_is_evenly_filled(blades, rotation):
    n = 40_000
    points = aperture(blades, rotation, n)
    angles = np.radians(90 + rotation + 360 / blades * (np.arange(blades) + 0.5))
    normals = np.stack([np.cos(angles), np.sin(angles)])
    apothem = math.cos(math.pi / blades)
    outward = (points @ normals).max(axis=1) / apothem
    assert outward.max() < 1 + 1e-5
    # Uniform in area: the square of the size of the similar polygon through a point is uniform in
    # [0, 1]; its mean lies within 4.5 standard errors of 1/2, its largest within 20 / n of 1
    assert abs((outward**2).mean() - 0.5) < 4.5 / math.sqrt(12 * n)
    assert (outward**2).max() > 1 - 20 / n
    # As many points in each triangle: chi-square with blades - 1 degrees of freedom
    counts = np.bincount((points @ normals).argmax(axis=1), minlength=blades)
    statistic = ((counts - n / blades) ** 2 / (n / blades)).sum()
    assert statistic < stats.chi2.ppf(1 - 1e-5, blades - 1)
    # The area, by the share of points in a square that fits into the polygon
    area = blades / 2 * math.sin(2 * math.pi / blades)
    share = (np.abs(points) < 0.3).all(axis=1).mean()
    assert abs(share - 0.36 / area) < 4.5 * math.sqrt(0.36 / area / n)


def test_a_corner_of_the_aperture_is_on_top_and_turns_counter_clockwise():
    assert aperture(3, 0.0)[:, 1].max() == pytest.approx(1, abs=0.02)
    assert aperture(3, 0.0)[:, 1].min() == pytest.approx(-0.5, abs=1e-3)
    assert aperture(3, 90.0)[:, 0].min() == pytest.approx(-1, abs=0.02)


@pytest.mark.parametrize("blades", [1, 2, 65, -3, 2.5])
def test_impossible_apertures_are_named(blades):
    with pytest.raises(ValueError, match=r"lens\.blades"):
        Lens(1.0, blades=blades)


# Panorama


def test_panorama_sees_every_direction_where_it_belongs():
    camera = Camera((9, 17, -4), (11, 24, -6), (0, 1, 0.3), panorama=True)
    p, _ = packed_camera(camera)
    right, up, forward = camera.frame
    width, height = SIZE
    for column in (0, 40, 160, 240, 319):
        for row in (0, 99, 199):
            ray = draw_rays(p, None, column, row, 1)[0]
            longitude = 2 * math.pi * ((column + 0.5) / width - 0.5)
            latitude = math.pi * (0.5 - (row + 0.5) / height)
            level = math.cos(latitude)
            expected = (
                level * math.cos(longitude) * forward
                + level * math.sin(longitude) * right
                + math.sin(latitude) * up
            )
            np.testing.assert_allclose(ray[3:], expected, atol=1e-6)
            np.testing.assert_allclose(ray[:3] + CENTRE, camera.position, atol=1e-12)


def test_panorama_goes_with_neither_lens_nor_parallel_nor_stereo():
    _, lens = packed_camera(Camera((0, 0, 0), (0, 1, 0), lens=Lens(1.0), panorama=True))
    assert lens is None
    for other in ({"parallel_scale": 2.0}, {"stereo": Stereo()}):
        with pytest.raises(ValueError, match=r"panorama or (parallel|stereo)"):
            Camera((0, 0, 0), (0, 1, 0), panorama=True, **other)


# Stereo


def stereo_position(camera, points, right_eye, size):
    """As `film_position`, with the stereo shear that VTK puts before its projection."""
    view = vtkPerspectiveTransform()
    aspect = size[0] / size[1]
    if camera.parallel_scale is None:
        view.Perspective(camera.view_angle, aspect, 0.1, 1000)
    else:
        h = camera.parallel_scale
        view.Ortho(-h * aspect, h * aspect, -h, h, 0.1, 1000)
    view.Stereo((1 if right_eye else -1) * camera.stereo.angle / 2, camera.distance)
    view.SetupCamera(camera.position, camera.focal_point, camera.view_up)
    m = view.GetMatrix()
    m = np.array([[m.GetElement(i, j) for j in range(4)] for i in range(4)])
    clip = np.c_[points, np.ones(len(points))] @ m.T
    ndc = clip[:, :2] / clip[:, 3:]
    return (ndc[:, 0] + 1) / 2 * size[0], (1 - ndc[:, 1]) / 2 * size[1]


@pytest.mark.parametrize("scale", [None, 7.0], ids=["perspective", "parallel"])
@pytest.mark.parametrize("eyes", ["left", "right", "both"])
def test_eyes_are_those_of_vtk(eyes, scale):
    camera = Camera(
        (3, -40, 12), (9, 21, -4), view_angle=35, parallel_scale=scale, stereo=Stereo(eyes, 5.0)
    )
    p, _ = packed_camera(camera)
    both = eyes == "both"
    size = (SIZE[0] // 2, SIZE[1]) if both else SIZE
    for right_eye in {"left": [False], "right": [True], "both": [False, True]}[eyes]:
        for column, row in ((3, 7), (100, 150), (159, 199)):
            shift = size[0] if both and right_eye else 0
            o, d = np.hsplit(draw_rays(p, None, column + shift, row, 1)[0], 2)
            points = o + np.array(CENTRE) + np.array([[20.0], [50.0], [90.0]]) * d
            x, y = stereo_position(camera, points, right_eye, size)
            # float32 direction over 90 units, in pixels
            np.testing.assert_allclose(x, column + 0.5, atol=1e-2)
            np.testing.assert_allclose(y, row + 0.5, atol=1e-2)


def test_side_by_side_needs_an_even_width():
    with pytest.raises(ValueError, match="even film width, got 33"):
        packed_camera(Camera((0, -5, 0), (0, 0, 0), stereo=Stereo()), size=(33, 20))


@pytest.mark.parametrize("bad", [{"eyes": "up"}, {"angle": 0.0}, {"convergence": -1.0}])
def test_impossible_eyes_are_named(bad):
    with pytest.raises(ValueError, match=f"stereo.{next(iter(bad))}"):
        Stereo(**bad)
