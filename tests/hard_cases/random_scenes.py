"""Scenes of any shape, drawn by hypothesis: what a user may legally ask for, at its extremes.

A scene keeps one of a few sets of effects, so that kernels are compiled a few times only; all else,
from the type of the scalars to the light inside the volume, is drawn.
"""

from __future__ import annotations

import math

import numpy as np
from hypothesis import assume
from hypothesis import strategies as st

from vtkmcvr.curves import ColourCurve, Curve
from vtkmcvr.lights import (
    ConstantEnvironment,
    DirectionalLight,
    EnvironmentMap,
    PointLight,
    RectangleLight,
)
from vtkmcvr.scene import (
    Camera,
    HenyeyGreenstein,
    PixelFilter,
    Scene,
    Surface,
    TransferFunction,
    Volume,
)

# One of each that the kernels read as it is, and what is converted
KERNEL_TYPES = ["u1", "i2", "u2", "f4"]
OTHER_TYPES = ["i1", "?", "u4", "i4", "i8", "u8", "f8", "f2", ">i2", ">u2", ">f4", ">f8", ">i4"]
FLOATS = ["f4", "f8", ">f4", ">f8"]
G = 0.9999


def unit_vectors():
    """Directions, many of them along an axis, with zeros of either sign."""
    axes = [(1.0, 0.0, -0.0), (-0.0, -1.0, 0.0), (0.0, -0.0, 1.0), (0.0, 0.0, -1.0)]
    any_ = st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: np.linalg.norm(v) > 0.1)
    return st.one_of(st.sampled_from(axes), any_).map(lambda v: np.divide(v, np.linalg.norm(v)))


def powers(low, high):
    """Numbers from 10^low to 10^high, even in their logarithm."""
    return st.floats(low, high).map(lambda e: 10.0**e)


@st.composite
def axes(draw):
    """Index-to-world map of directions: turned, sheared, of either handedness, anisotropic."""
    angles = draw(st.tuples(*[st.sampled_from([0.0, 0.3, math.pi / 2, 2.0])] * 2))
    (a, b), (c, d) = ((math.cos(x), math.sin(x)) for x in angles)
    turn = np.array([[a, -b, 0], [b, a, 0], [0, 0, 1]]) @ [[1, 0, 0], [0, c, -d], [0, d, c]]
    shear = np.eye(3)
    shear[0, 1], shear[1, 2] = draw(st.tuples(*[st.sampled_from([0.0, 0.4, -1.0])] * 2))
    hand = draw(st.sampled_from([1.0, -1.0]))
    spacing = draw(powers(-6, 6)) * np.array([draw(powers(-3, 0)), hand, 1.0])
    return turn @ shear * spacing


@st.composite
def values(draw, types, constant=True):
    """Voxels of any type, shape and range."""
    shape = draw(
        st.one_of(
            st.tuples(*[st.integers(2, 9)] * 3),
            st.sampled_from([(2, 2, 2), (2, 2, 200), (150, 2, 2), (2, 60, 2), (40, 3, 17)]),
        )
    )
    dtype = np.dtype(draw(st.sampled_from(types)))
    raw = np.random.default_rng(draw(st.integers(0, 99))).random(shape)
    if constant and draw(st.integers(0, 3)) == 0:
        raw[:] = raw.flat[0]
    if dtype.kind == "b":
        return raw > 0.5
    if dtype.kind in "iu":
        limits = np.iinfo(dtype)
        low, high = draw(st.sampled_from([(0, 100), (int(limits.min), int(limits.max))]))
        return (low + raw * (float(high) - low) * 0.999).astype(dtype)
    exponent = 4 if dtype.itemsize == 2 else 30
    scaled = draw(powers(-exponent, exponent)) * raw + draw(st.sampled_from([0.0, -0.5, 1.0]))
    scaled = scaled.astype(dtype)
    if draw(st.integers(0, 3)) == 0:
        scaled.flat[draw(st.integers(0, scaled.size - 1))] = draw(
            st.sampled_from([math.nan, math.inf, -math.inf])
        )
    return scaled


def stored(draw, array):
    """The same values in another layout: reversed, transposed, strided, read-only."""
    layout = draw(st.sampled_from(["C", "F", "strided", "reversed", "read-only"]))
    if layout == "F":
        return np.asfortranarray(array)
    if layout == "strided":
        return np.repeat(array, 2, axis=2)[:, :, ::2]
    if layout == "reversed":
        return np.ascontiguousarray(array[::-1])[::-1]
    array = array.copy()
    array.flags.writeable = layout != "read-only"
    return array


@st.composite
def volumes(draw, types=tuple(KERNEL_TYPES + OTHER_TYPES), constant=True):
    """A volume anywhere."""
    matrix = np.eye(4)
    matrix[:3, :3] = draw(axes())
    matrix[:3, 3] = np.array(draw(unit_vectors())) * draw(st.sampled_from([0.0, 1.0, 1e7]))
    return Volume(stored(draw, draw(values(list(types), constant))), matrix)


@st.composite
def transfers(draw, volume):
    """Nodes anywhere: coincident, unsorted, outside of the data, all zero, denormal to extreme."""
    finite = volume.values[np.isfinite(volume.values)].astype(float)
    low, high = (finite.min(), finite.max()) if finite.size else (0.0, 1.0)
    span = high - low or 1.0
    places = st.sampled_from([-1.0, 0.0, 0.3, 0.3 + 1e-9, 0.5, 0.5, 1.0, 7.0]).map(
        lambda x: low + span * x
    )
    size = float(np.linalg.norm(volume.corners[0] - volume.corners[-1]))
    amounts = st.sampled_from([0.0, 5e-324, 1e-30, 0.1, 1.0, 30.0, 1e12]).map(lambda s: s / size)
    opacities = st.sampled_from([0.0, 1e-9, 0.5, 1 - 1e-9, 1.0])
    by_opacity = draw(st.booleans())
    curve = Curve(
        draw(st.lists(st.tuples(places, opacities if by_opacity else amounts), min_size=1,
                      max_size=5)),
        clamp=draw(st.booleans()),
    )  # fmt: skip
    albedo = ColourCurve(
        [(low, *draw(st.sampled_from([(1, 1, 1), (0, 0, 0), (0.9, 0.5, 0)]))), (high, 1, 0.5, 0.2)]
        if span > 0
        else [(low, 1, 1, 1)]
    )
    if by_opacity:
        return TransferFunction(curve, albedo, unit_distance=size * draw(powers(-6, 1)))
    return TransferFunction(None, albedo, extinction=curve)


@st.composite
def cameras(draw, volume):
    """Perspective or parallel, outside, on a corner, or inside; narrow to wide."""
    toward = np.array(draw(unit_vectors()))
    up = np.roll(toward, 1) + np.array((0.1, 0.2, -0.3))
    away = volume.radius * draw(st.sampled_from([1e-3, 0.5, 3.0, 1e5]))
    target = volume.centre if draw(st.booleans()) else volume.corners[draw(st.integers(0, 7))]
    position = target - toward * away
    # A volume of micrometres ten thousand kilometres off: two such points may be the same number
    assume((position != target).any())
    if draw(st.booleans()):
        scale = volume.radius * draw(st.sampled_from([1e-3, 0.5, 3.0]))
        return Camera(position, target, up, parallel_scale=scale)
    return Camera(position, target, up, view_angle=draw(st.sampled_from([1e-3, 40.0, 179.0])))


def sizes():
    """Film sizes, degenerate ones among them."""
    return st.sampled_from([(1, 1), (1, 40), (6, 5), (300, 1), (12, 12)])


@st.composite
def plain_scenes(draw):
    """Any scalars under an even sky: single scattering, no surfaces."""
    volume = draw(volumes())
    return Scene(
        volume, draw(transfers(volume)), draw(cameras(volume)),
        lights=(ConstantEnvironment(draw(st.sampled_from([1.0, 1e-20, 1e20]))),),
        size=draw(sizes()), pixel_filter=PixelFilter("box", 0.5),
    )  # fmt: skip


@st.composite
def lights(draw, volume):
    """One of each kind, from dim to blinding, some inside the volume."""
    radiance = st.sampled_from([1e-20, 1.0, 1e20])
    near = volume.centre + volume.radius * np.array(draw(unit_vectors())) * 0.5
    far = volume.centre + volume.radius * np.array((300.0, 200.0, 100.0))
    edge = volume.radius * draw(st.sampled_from([1e-9, 1e-3]))
    delta = draw(
        st.sampled_from(
            [DirectionalLight(tuple(draw(unit_vectors())), 1.0), PointLight(near, volume.radius**2)]
        )
    )
    return (
        ConstantEnvironment(draw(radiance)),
        EnvironmentMap(np.random.default_rng(1).random((3, 6, 3)) * draw(radiance)),
        RectangleLight(far, volume.centre, (edge, edge), draw(radiance) / (edge / volume.radius)),
        delta,
    )


@st.composite
def rich_scenes(draw, scattering="single"):
    """All effects of `scenes.everything` at their ends, on float volumes that are not constant."""
    volume = draw(volumes(FLOATS, constant=False))
    surface = Surface(
        draw(st.sampled_from([1e-3, 0.5, 1.0])),
        mode=draw(st.sampled_from(["hybrid", "brdf", "threshold"])),
        threshold=draw(st.sampled_from([0.0, 0.5, 1.0])),
        specular=draw(st.sampled_from([1e-9, 0.04, 1.0])),
        exponent=draw(st.sampled_from([0.0, 1.0, 30.0, 1e6])),
        coat=draw(st.sampled_from(["blinn", "ggx"])),
    )
    return Scene(
        volume, draw(transfers(volume)), draw(cameras(volume)), draw(lights(volume)), surface,
        HenyeyGreenstein(draw(st.sampled_from([-G, -0.3, 1e-6, 0.7, G]))),
        scattering=scattering, size=draw(sizes()), pixel_filter=PixelFilter("box", 0.5),
    )  # fmt: skip
