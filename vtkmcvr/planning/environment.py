"""Constant, gradient and mapped environments -> packed ones."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .. import packed
from ..lights import ConstantEnvironment, EnvironmentMap, GradientEnvironment, Light
from ..pack import f32, matrix, vector
from .light_tree import AROUND, LUMINANCE, Leaf


def pack_ambient(lights: list[Light]) -> packed.Ambient | None:
    """Constant and gradient together: the constant is a gradient of one colour."""
    constant, rise = np.zeros(3), np.zeros((3, 3))
    up = (0.0, 0.0, 1.0)
    for light in lights:
        if isinstance(light, ConstantEnvironment):
            constant = constant + light.brightness
        elif isinstance(light, GradientEnvironment):
            rise, up = light.scale * np.array([light.top, light.middle, light.bottom]), light.up
    top, middle, bottom = rise + constant
    if not (top.any() or middle.any() or bottom.any()):
        return None
    even = np.array_equal(top, middle) and np.array_equal(middle, bottom)
    gradient = packed.Gradient(vector(np.array(up)), vector(top), vector(bottom))
    return packed.Ambient(vector(middle), None if even else gradient)


def pack_map(light: EnvironmentMap) -> packed.Environment:
    """Distribution over texels: exact mean of the bilinear interpolant times solid angle."""
    pixels = np.ascontiguousarray(light.pixels * f32(light.scale), f32)
    rows = len(pixels)
    luminance = pixels.astype(np.float64) @ LUMINANCE
    tall = np.pad(luminance, ((1, 1), (0, 0)), mode="edge")
    blurred = (tall[:-2] + 6 * tall[1:-1] + tall[2:]) / 8
    blurred = (np.roll(blurred, 1, 1) + 6 * blurred + np.roll(blurred, -1, 1)) / 8
    edges = np.cos(np.pi * np.arange(rows + 1) / rows)
    weight = blurred * (edges[:-1] - edges[1:])[:, None]
    local_from_world = np.asarray(light.rotation).T
    return packed.Environment(
        pixels,
        _cdf(weight.sum(axis=1)),
        np.ascontiguousarray([_cdf(row) for row in weight], f32),
        np.ascontiguousarray(edges, f32),
        matrix(local_from_world),
        matrix(local_from_world.T),
    )


def _cdf(weight: NDArray) -> NDArray[np.float32]:
    """Cumulative distribution from 0 to exactly 1; even where all weights are 0."""
    total = weight.sum()
    steps = weight / total if total > 0 else np.full(len(weight), 1 / len(weight))
    cdf = np.concatenate([[0.0], np.cumsum(steps)])
    return np.ascontiguousarray(cdf / cdf[-1], f32)


def map_leaf(light: EnvironmentMap) -> Leaf:
    """What the choice of a light knows of a map."""
    mean = float((light.pixels.mean(axis=(0, 1)) @ LUMINANCE) * light.scale)
    return Leaf(AROUND, math.pi * max(mean, 1e-30))
