"""Pictures of small things through lenses, two eyes and all around, against geometry."""

import math

import numpy as np
import pytest
from scenes import medium, render, scene, volume

from vtkmcvr.scene import Camera, Lens, Stereo

OPAQUE = medium(1e5)


def grain(at, edge=0.05, thickness=None):
    """Opaque cube or plate of three edges' width around a point."""
    values = np.zeros((5, 5, 5), np.float32)
    values[1:4, 1:4, 1:4] = 1
    return volume(values, (edge, thickness or edge, edge), at)


def ahead(angle=40.0, **options):
    """Camera at the origin that looks along +y at distance 10."""
    return Camera((0, 0, 0), (0, 10, 0), view_angle=angle, **options)


def spots(alpha):
    """Centre (column, row) and second moments around it of what a picture shows, in pixels."""
    rows, columns = np.indices(alpha.shape) + 0.5
    total = alpha.sum()
    x, y = (columns * alpha).sum() / total, (rows * alpha).sum() / total
    moments = [((c - m) ** 2 * alpha).sum() / total for c, m in ((columns, x), (rows, y))]
    return (x, y), np.array(moments)


@pytest.mark.parametrize("depth", [6.0, 8.0, 10.0, 16.0])
def test_blur_has_the_size_of_the_circle_of_confusion(depth):
    # A grain at depth z, in focus at f = 10 through a lens of radius a, spreads over a disk of
    # radius a |z - f| / (f z) x pixels per unit at depth 1. The variance of a uniform disk of
    # radius r along an axis is r^2 / 4; grain and pixel (of the sharp picture) add their own
    a, f, height = 1.5, 10.0, 64
    per_unit = height / 2 / math.tan(math.radians(20))

    def moments(lens):
        plate = grain((0, depth, 0), thickness=1e-3)
        view = scene(plate, OPAQUE, ahead(lens=lens), (height, height))
        return spots(render(view, 1024).alpha)[1]

    radius = a * abs(depth - f) / (f * depth) * per_unit
    blur = moments(Lens(a, f)) - moments(None)
    # The grain is hit by 1000 to 8000 samples, whose second moment is known to 1 / sqrt(n)
    np.testing.assert_allclose(blur, radius**2 / 4, rtol=0.1, atol=0.05)


@pytest.mark.parametrize(("depth", "sign"), [(6.0, 1), (20.0, -1)])
def test_blur_has_the_shape_of_the_aperture(depth, sign):
    # Behind the focal plane the blur is the aperture, before it upside down. A triangle with a
    # corner on top has a linear density of rows, whose skewness is 2 sqrt(2) / 5 toward row 0
    plate = grain((0, depth, 0), thickness=1e-3)

    def moments(lens):
        alpha = render(scene(plate, OPAQUE, ahead(lens=lens), (64, 64)), 2048).alpha
        (_, middle), (_, second) = spots(alpha)
        third = (np.arange(64) + 0.5 - middle) ** 3 @ alpha.sum(axis=1) / alpha.sum()
        return np.array((second, third))

    # Grain and pixel, which are symmetric, add their variance
    second, third = moments(Lens(1.5, 10.0, blades=3)) - moments(None)
    # The grain is hit by some 1500 samples or more: 4.5 standard errors of 1 / sqrt(n)
    assert third / second**1.5 == pytest.approx(sign * 2 * math.sqrt(2) / 5, abs=0.1)


@pytest.mark.parametrize("scale", [None, 3.6], ids=["perspective", "parallel"])
def test_disparity_of_two_eyes(scale):
    # Eyes a distance e apart that converge at c: a point at depth z is apart by
    # e (1/c - 1/z) of its distance at depth 1 in perspective, e (z/c - 1) units in parallel
    angle, c, width, height = 6.0, 10.0, 160, 64
    e = 2 * c * math.tan(math.radians(angle) / 2)
    camera = ahead(parallel_scale=scale, stereo=Stereo("both", angle))
    for depth in (7.0, 10.0, 15.0):
        view = scene(grain((0.3, depth, 0.1)), OPAQUE, camera, (width, height))
        alpha = render(view, 64).alpha
        (left, _), (right, _) = (spots(half)[0] for half in np.hsplit(alpha, 2))
        if scale is None:
            expected = e * (1 / c - 1 / depth) * height / 2 / math.tan(math.radians(20))
        else:
            expected = e * (depth / c - 1) * height / 2 / scale
        # Far things lie further left for the left eye
        assert right - left == pytest.approx(expected, abs=0.06)


def test_left_and_right_are_the_halves_of_both():
    def alpha(eyes, width):
        camera = ahead(stereo=Stereo(eyes, 6.0))
        view = scene(
            grain((0.3, 7.0, 0.1), 0.4), OPAQUE, camera, (width, 48), sampler="independent"
        )
        return render(view, 64).alpha

    both = np.hsplit(alpha("both", 128), 2)
    for half, eyes in zip(both, ("left", "right"), strict=True):
        assert spots(half)[0] == pytest.approx(spots(alpha(eyes, 64))[0], abs=0.1)
    assert abs(spots(both[0])[0][0] - spots(both[1])[0][0]) > 1


@pytest.mark.parametrize(
    ("at", "column", "row"),
    [((0, 5, 0), 64, 32), ((5, 0, 0), 96, 32), ((-5, 0, 0), 32, 32), ((3, 3, 3 * 2**0.5), 80, 16)],
)
def test_panorama_shows_things_in_their_direction(at, column, row):
    # 360 degrees over 128 columns, 180 over 64 rows, ahead in the middle
    view = scene(grain(at), OPAQUE, ahead(panorama=True), (128, 64))
    centre, moments = spots(render(view, 64).alpha)
    assert centre == pytest.approx((column, row), abs=0.06)
    assert moments.max() < 2
