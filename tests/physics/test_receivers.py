"""Receivers under light with a known answer, and shadows that they cast and receive.

z-scores are compared with 4.5, as in test_media.py: chance exceeds it in less than 50 x 6.8e-6 of
all choices of seeds. The seeds are fixed.
"""

import math

import numpy as np
import pytest
from scenes import (
    DARK,
    blob,
    mean_and_error,
    medium,
    noise,
    render,
    scene,
    slab,
    volume,
    z_score,
)
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkFiltersSources import vtkSphereSource

from vtkmcvr.cutting import Plane
from vtkmcvr.film.error import variance
from vtkmcvr.lights import ConstantEnvironment, DirectionalLight, RectangleLight
from vtkmcvr.receivers import BoxReceiver, MeshReceiver, PlaneReceiver, SphereReceiver
from vtkmcvr.scene import Camera

SKY = ConstantEnvironment(1.0)
NOTHING = medium(0.0)
FLOOR = PlaneReceiver((0, 0, -1), (0, 0, 1), colour=(0.6, 0.3, 0.9))
TURN = np.array([[0.6, 0, -0.8], [0, 1, 0], [0.8, 0, 0.6]])


def above(half_height=0.1, aim=(0.0, 0.0, -1.0), height=6.0):
    """Parallel camera that looks down."""
    x, y, z = aim
    return Camera((x, y, z + height), aim, view_up=(0, 1, 0), parallel_scale=half_height)


def lit(lights, receivers, transfer=NOTHING, camera=None, vol=None, **options):
    """Two sets of effects for most tests: a sun; sky and rectangle, dark where none is wanted."""
    present = {type(light) for light in lights}
    dark = {
        ConstantEnvironment: ConstantEnvironment(DARK),
        RectangleLight: RectangleLight((3e3, 2e3, 1e3), (0, 0, 0), (1e-3, 1e-3), DARK),
    }
    sun = DirectionalLight in present
    added = [light for kind, light in dark.items() if kind not in present and not sun]
    return scene(
        blob(33) if vol is None else vol, transfer, camera or above(), lights=(*lights, *added),
        receivers=receivers, sampler="independent", **options,
    )  # fmt: skip


def rectangle_irradiance(point, normal, centre, u, v, radiance, blocked=None, n=400):
    """Irradiance of a rectangle with edges u and v, by the midpoint rule in float64."""
    s = (np.arange(n) + 0.5) / n - 0.5
    source = np.asarray(centre) + s[:, None, None] * u + s[None, :, None] * v
    facing = np.cross(u, v)
    area = np.linalg.norm(facing)
    w = source - point
    r2 = (w * w).sum(-1)
    cos = np.maximum(w @ normal, 0) * np.abs(w @ facing) / area / r2
    if blocked is not None:
        cos = cos * ~blocked(source)
    return radiance * (cos / r2).mean() * area


@pytest.mark.parametrize("colour", [0.0, 0.5, 1.0])
def test_open_plane_under_a_sky_has_its_colour(colour):
    floor = PlaneReceiver((0, 0, -1), (0, 0, 1), colour=colour)
    picture = render(lit((SKY,), floor, camera=above(3.0)), samples=16)
    assert (picture.alpha == 1).all()
    np.testing.assert_allclose(picture.radiance, colour, atol=1e-5)
    np.testing.assert_allclose(picture.depth, 6, atol=1e-5)


@pytest.mark.parametrize("place", [(0.0, 0.0), (2.0, -1.0)])
def test_plane_under_an_area_light_has_the_irradiance_of_quadrature(place):
    lamp = RectangleLight((0.5, 0.3, 1.2), (0.2, 0, -1), (1.5, 0.8), 7.0, up=(0, 1, 0))
    right, up, _ = lamp.frame
    point = np.array((*place, -1.0))
    e = rectangle_irradiance(
        point, (0, 0, 1.0), lamp.centre, right * 1.5, up * 0.8, 7.0
    )  # fmt: skip
    camera = above(1e-3, tuple(point))
    picture = render(lit((lamp,), FLOOR, camera=camera), samples=256)
    for channel, colour in enumerate(FLOOR.colour):
        mean, error = mean_and_error(picture, channel)
        assert error < 0.01 * mean
        assert abs(mean - colour * e / math.pi) < 4.5 * error


def test_half_plane_casts_the_penumbra_of_quadrature():
    # A thin plate with its edge at x = 0, half-way between a square lamp and the floor
    lamp = RectangleLight((0, 0, 1), (0, 0, -1), (1.0, 1.0), 9.0, up=(0, 1, 0))
    plate = PlaneReceiver((-50, 0, 0), (0, 0, 1), (100, 100), (0, 1, 0))
    camera = Camera((0, 0, -0.5), (0, 0, -1), view_up=(0, 1, 0), parallel_scale=1.0)
    picture = render(lit((lamp,), (FLOOR, plate), camera=camera, size=(32, 8)), samples=400)
    # The film is 8 units wide, [-4, 4], and two high: compare the profile around y = 0
    film = picture.film
    rows = slice(3, 5)
    error = np.sqrt(variance(film)[rows, :, 1].sum(0)) / 2
    found = film.mean[rows, :, 1].mean(0)
    for column in range(10, 22):
        expected = []
        for x in -4 + (column + (np.arange(8) + 0.5) / 8) / 4:
            for y in (-0.1875, -0.0625, 0.0625, 0.1875):
                point = np.array((x, y, -1.0))
                expected.append(rectangle_irradiance(
                    point, (0, 0, 1.0), (0, 0, 1), np.array((1.0, 0, 0)), np.array((0, 1.0, 0)),
                    9.0, lambda s, x=x: (s[..., 0] + x) / 2 < 0, 60,
                ))  # fmt: skip
        e = np.mean(expected) * FLOOR.colour[1] / math.pi
        # 1 % for the quadrature over the pixel
        assert abs(found[column] - e) < 4.5 * error[column] + 0.01 * e + 1e-6
    # Umbra beyond half a lamp's width, no shadow on the other side
    assert found[13] < 1e-12
    assert found[12] < 0.05 * found[18] and found[18] > 0


def test_hard_shadow_of_a_directional_light_has_an_edge():
    sun = DirectionalLight((1, 0, -1), 2.0)
    block = BoxReceiver((0, 0, -0.5), (1, 4, 1))
    # Light at 45 degrees past the upper edge x = 1/2, z = 0 reaches the floor at x = 3/2
    camera = Camera((1.5, 0, 5), (1.5, 0, -1), view_up=(0, 1, 0), parallel_scale=0.25)
    picture = render(lit((sun,), (FLOOR, block), camera=camera), samples=4)
    x = 1.25 + (np.arange(32) + 0.5) / 64
    bright = FLOOR.colour[1] * 2 * math.sqrt(0.5) / math.pi
    expected = np.where(x > 1.5, bright, 0.0)
    np.testing.assert_allclose(picture.radiance[..., 1], np.tile(expected, (32, 1)), atol=1e-5)


def test_shadow_reach_lets_far_receivers_cast_none():
    sun = DirectionalLight((0, 0, -1), math.pi)
    roof = PlaneReceiver((0, 0, 0.5), (0, 0, 1), (4, 4))
    camera = Camera((0, 0, 0), (0, 0, -1), view_up=(0, 1, 0), parallel_scale=0.2)
    for reach, seen in ((1.4, 1), (1.6, 0), (0, 1)):
        dark = lit((sun,), (FLOOR, roof), camera=camera, shadow_reach=reach)
        picture = render(dark, samples=2)
        np.testing.assert_allclose(picture.radiance[..., 1], seen * FLOOR.colour[1], atol=1e-5)


def test_volume_casts_its_transmittance_on_the_floor():
    sun = DirectionalLight((0, 0, -1), math.pi)
    camera = Camera((0, 0, -0.9), (0, 0, -1), view_up=(0, 1, 0), parallel_scale=0.5)
    shade = lit((sun,), FLOOR, medium(1.2, 0.0), camera, slab((2, 2, 1)))
    mean, error = mean_and_error(render(shade, samples=64), 0)
    assert error < 0.01
    assert abs(mean - FLOOR.colour[0] * math.exp(-1.2)) < 4.5 * error


def test_floor_is_seen_through_the_volume():
    # Alpha is 1 everywhere; the floor is behind exp(-tau), lit through the same tau
    sun = DirectionalLight((0, 0, -1), math.pi)
    picture = render(lit((sun,), FLOOR, medium(0.8, 0.0), above(0.5), slab((2, 2, 1))), samples=64)
    assert (picture.alpha == 1).all()
    mean, error = mean_and_error(picture, 2)
    assert abs(mean - FLOOR.colour[2] * math.exp(-1.6)) < 4.5 * error


def test_receiver_hides_the_volume_behind_it():
    wall = PlaneReceiver((0, 0, 2), (0, 0, 1), (9, 9), colour=0.25)
    picture = render(lit((SKY,), wall, medium(50.0), above(0.5)), samples=4)
    np.testing.assert_allclose(picture.radiance, 0.25, atol=1e-5)
    np.testing.assert_allclose(picture.depth, 3, atol=1e-5)


BOX = {"colour": 0.7, "centre": (0.8, -0.8, -0.5), "size": (0.7, 0.5, 0.5)}


def box_mesh(centre, size, axes, **look):
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    points = np.array(centre) + corners * np.array(size) / 2 @ np.asarray(axes).T
    quads = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    return MeshReceiver(points, np.array(triangles), **look)


def looking(**options):
    """Oblique view of the floor with blobs, under a lamp and a sky."""
    lamp = RectangleLight((2, -2, 3), (0, 0, 0), (1, 1), 6.0)
    camera = Camera((1.5, -4, 2.5), (0, 0, -0.4), parallel_scale=1.3)
    return lit((lamp, ConstantEnvironment(0.3)), camera=camera, transfer=medium(2.0), **options)


def ball_mesh(centre, radius, resolution, **look):
    source = vtkSphereSource()
    source.SetRadius(radius)
    source.SetThetaResolution(resolution)
    source.SetPhiResolution(resolution)
    source.Update()
    mesh = source.GetOutput()
    points = vtk_to_numpy(mesh.GetPoints().GetData()).astype(float) + centre
    normals = vtk_to_numpy(mesh.GetPointData().GetNormals()).astype(float)
    triangles = vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return MeshReceiver(points, triangles, normals, **look)


def test_mesh_of_a_box_is_the_box():
    one = render(looking(receivers=(FLOOR, BoxReceiver(axes=TURN, **BOX))), samples=64, seed=1)
    mesh = box_mesh(axes=TURN, **BOX)
    other = render(looking(receivers=(FLOOR, mesh)), samples=64, seed=2)
    assert abs(z_score(one, other)) < 4.5
    a, b = one.film, other.film
    error = np.sqrt((variance(a) + variance(b))[..., 1])
    z = (a.mean - b.mean)[..., 1] / np.maximum(error, 1e-3)
    assert np.abs(z).max() < 6
    # The box is there and casts a shadow
    bare = render(looking(receivers=(FLOOR,)), samples=64, seed=3)
    apart = (a.mean - bare.film.mean)[..., 1] / np.maximum(error, 1e-3)
    assert np.mean(apart**2) > 4 * np.mean(z**2)


def test_fine_mesh_of_a_sphere_is_the_sphere():
    place = {"centre": (0.8, -0.8, -0.5), "radius": 0.4}
    one = render(looking(receivers=(FLOOR, SphereReceiver(colour=0.7, **place))), seed=1)
    mesh = ball_mesh(resolution=150, colour=0.7, **place)
    other = render(looking(receivers=(FLOOR, mesh)), samples=64, seed=2)
    assert abs(z_score(one, other)) < 4.5
    a, b = one.film, other.film
    error = np.sqrt((variance(a) + variance(b))[..., 1])
    assert np.abs((a.mean - b.mean)[..., 1] / np.maximum(error, 3e-3)).max() < 6


def test_coat_of_a_receiver_is_that_of_the_brdf():
    # Mirror direction of a lamp: glossy receivers are brighter there; others stay Lambert's
    glossy = PlaneReceiver((0, 0, -1), (0, 0, 1), colour=0.4, specular=0.3, exponent=200.0)
    far = PlaneReceiver((0, 0, -90), (0, 0, 1), colour=0.4)
    lamp = RectangleLight((0, 3, 2), (0, 0, -1), (0.5, 0.5), 20.0)
    mirrored = Camera((0, -3, 2), (0, 0, -1), parallel_scale=0.05)
    shiny = render(lit((lamp,), (glossy, far), camera=mirrored), samples=64)
    matt = render(lit((lamp,), (FLOOR, far), camera=mirrored), samples=64)
    assert shiny.radiance[..., 1].mean() > 3 * matt.radiance[..., 1].mean()
    # A sky of 1 gives at most 1 back, at any angle; without a coat the colour itself
    closed = render(lit((SKY,), (glossy, far), camera=mirrored), samples=64)
    assert 0.4 < closed.radiance.mean() < 1
    plain = PlaneReceiver((0, 0, -1), (0, 0, 1), colour=0.4)
    coated_elsewhere = PlaneReceiver((0, 0, -90), (0, 0, 1), specular=0.5)
    picture = render(lit((SKY,), (plain, coated_elsewhere), camera=mirrored), samples=16)
    np.testing.assert_allclose(picture.radiance, 0.4, atol=1e-5)


def test_white_furnace_with_white_receivers_stays_white():
    # Albedo 1 of medium and surfaces, unlimited scattering, light 1 from everywhere
    floor = PlaneReceiver((0, 0, -0.6), (0, 0.1, 1), colour=1.0)
    ball = SphereReceiver((0.4, -0.3, 0.1), 0.3, colour=1.0)
    mesh = box_mesh((-0.5, 0, 0), (0.3, 0.4, 0.5), TURN, colour=1.0)
    furnace = scene(
        noise(9), medium(1.5), lights=(SKY,), receivers=(floor, ball, mesh),
        scattering="multiple", environment_visible=True,
    )  # fmt: skip
    picture = render(furnace, samples=64)
    np.testing.assert_allclose(picture.radiance, 1, atol=1e-4)


def test_clip_plane_opens_the_floor_to_light():
    sun = DirectionalLight((0, 0, -1), math.pi)
    camera = Camera((0, 0, -0.9), (0, 0, -1), view_up=(0, 1, 0), parallel_scale=0.5)
    dark = lit((sun,), FLOOR, medium(50.0, 0.0), camera, slab((2, 2, 1)),
               clip=Plane((0, 0, 0), (1, 0, 0)))  # fmt: skip
    picture = render(dark, samples=4)
    np.testing.assert_allclose(picture.radiance[:, :16, 0], FLOOR.colour[0], atol=1e-5)
    assert not picture.radiance[:, 16:].any()


def test_receivers_far_from_the_origin_look_the_same():
    def picture(*centre):
        x, y, z = centre
        lamp = RectangleLight((x + 2, y - 2, z + 3), centre, (1, 1), 6.0)
        camera = Camera((x + 1.5, y - 4, z + 2.5), (x, y, z - 0.4), parallel_scale=1.3)
        floor = PlaneReceiver((x, y, z - 1), (0, 0, 1), colour=0.5)
        mesh = box_mesh((x + 0.2, y + 0.1, z - 0.3), (1.2, 0.8, 0.5), TURN)
        return render(
            lit((lamp,), (floor, mesh), medium(2.0), camera, blob(centre=centre)), samples=16
        )

    here, there = picture(0, 0, 0), picture(2**20, -(2**21), 2**19)
    # Powers of two move all numbers without rounding but for the last bits of the camera's rays
    assert np.abs(here.radiance - there.radiance).max() < 0.3
    assert abs(here.radiance.mean() - there.radiance.mean()) < 2e-3


def test_empty_volume_still_shows_its_receivers():
    picture = render(lit((SKY,), FLOOR, vol=volume(np.zeros((3, 3, 3)))), samples=2)
    assert picture.plan.empty
    assert (picture.alpha == 1).all()
