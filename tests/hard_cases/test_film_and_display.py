"""Hard cases of camera, film, display and transfer function tables (HC-51 to HC-71)."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scenes import WHITE, blob, frontal, medium, noise, render, scene, slab, volume
from techniques import SKY, by_monte_carlo, picture_by

from vtkmcvr import packed
from vtkmcvr.curves import Curve
from vtkmcvr.film.filter import gaussian_5x5
from vtkmcvr.kernels.jit import entry_point
from vtkmcvr.kernels.transfer import extinction
from vtkmcvr.pictures.denoise import knn
from vtkmcvr.pictures.display import srgb_decode, to_rgba8, tone_map
from vtkmcvr.plan import plan
from vtkmcvr.rendering import render_scene
from vtkmcvr.scene import Camera, Lens, TransferFunction

f32 = np.float32
PERSPECTIVE = Camera((0, -5, 0), (0, 0, 0), view_angle=20)


@by_monte_carlo
def test_hc51_aperture_0_is_a_pinhole(record, technique):
    lit = scene(blob(), lights=SKY, camera=PERSPECTIVE)
    other = replace(lit, camera=replace(PERSPECTIVE, lens=Lens(0.0)))
    a, b = (picture_by(technique, s, 4).radiance for s in (lit, other))
    record("HC-51", "aperture 0 against no lens", technique, 0, np.abs(a - b).max(), 0)


@pytest.mark.parametrize("exposure", [-1e4, -30.0, 0.0, 30.0, 1e4])
def test_hc56_any_exposure(record, exposure):
    # 1 - exp(-L 2^e), black stays black
    light = np.array([0.0, 1e-30, 1.0, 1e30])
    shown = tone_map(light, exposure)
    with np.errstate(divide="ignore"):
        logarithm = np.clip(np.log(light) + exposure * math.log(2), -700, 700)
    exact = np.where(light > 0, -np.expm1(-np.exp(logarithm)), 0)
    worst = float(np.abs(shown - exact).max())
    record("HC-56", f"tone curve at {exposure:g} stops", "display", 0, worst, 1e-12)
    assert shown[0] == 0


def test_hc57_negative_and_tiny_values(record):
    record("HC-57", "negative radiance", "display", 0, tone_map(np.array([-1.0]))[0], 0)
    tiny = float(tone_map(np.array([1e-8]))[0])
    record("HC-57", "tone curve of 1e-8", "display", 1e-8, tiny, 1e-15)
    grey = float(-np.log1p(-srgb_decode(np.array([100.0 / 255]))[0]))
    shown = to_rgba8(np.full((1, 1, 3), grey), None)
    record("HC-57", "8-bit value 100 comes back", "display", 100, shown[0, 0, 0], 0)


def test_hc58_pixels_are_uncorrelated(record):
    # Correlation of the errors of neighbours over 64 x 64 pixels: 0 within 4.5 / sqrt(4032)
    lit = scene(slab((2, 2, 2)), medium(1.0), frontal(0.9), (64, 64), lights=SKY)
    error = render(lit, 4).film.mean[..., 0]
    a, b = error[:, :-1].ravel(), error[:, 1:].ravel()
    got = float(np.corrcoef(a, b)[0, 1])
    tolerance = 4.5 / math.sqrt(4032)
    record("HC-58", "correlation of neighbours", "monte-carlo single", 0, got, tolerance)


@pytest.mark.parametrize("shape", [(1, 1, 3), (1, 7, 3), (9, 8, 3)])
def test_hc59_a_constant_stays_under_the_gaussian(record, shape):
    worst = np.abs(gaussian_5x5(np.full(shape, 0.3)) - 0.3).max()
    record("HC-59", f"Gaussian of a constant, {shape[:2]}", "display", 0, worst, 1e-15)


@pytest.mark.parametrize("light", [0.0, 0.3, 1e30])
@pytest.mark.parametrize("shape", [(1, 1), (9, 8)])
def test_hc60_a_constant_stays_under_knn(record, shape, light):
    image = np.full((*shape, 3), light, f32)
    smooth, _ = knn(image, np.ones(shape, f32), np.full_like(image, np.inf))
    worst = np.abs(smooth - image).max()
    record("HC-60", f"KNN of {light:g}, {shape}", "display", 0, worst, 1e-6 * light)


@by_monte_carlo
def test_hc61_the_same_seed_gives_the_same_bits(record, technique):
    lit = scene(blob(), lights=SKY)
    first = picture_by(technique, lit, 5, seed=7)
    again = render_scene(first.plan, samples=5, seed=7, threads=1)
    difference = np.abs(first.film.mean - again.film.mean).max()
    record("HC-61", "same seed, other threads", technique, 0, difference, 0)
    other = picture_by(technique, lit, 5, seed=8)
    assert (first.film.mean != other.film.mean).any()


# Transfer functions


@entry_point
def look_up(transfer, scalars):
    out = np.empty(len(scalars), np.float32)
    for i in range(len(scalars)):
        out[i] = extinction(transfer, scalars[i])
    return out


NODES = {
    "vertical edge": [(0.0, 1), (0.5, 1), (0.5, 3), (1.0, 3)],
    "single node": [(0.2, 7)],
    "unsorted": [(1.0, 5), (0.0, 1), (0.5, 2)],
    "value at the last node": [(0.0, 0), (1.0, 4)],
    "beyond both ends": [(-5.0, 1), (9.0, 15)],
}


@pytest.mark.parametrize("name", NODES)
def test_hc70_tables_follow_their_nodes(record, name):
    curve = Curve(NODES[name])
    vol = volume(np.linspace(0, 1, 27, dtype=f32).reshape(3, 3, 3))
    parts = plan(scene(vol, TransferFunction(None, WHITE, extinction=curve))).packed
    # All but the one table entry that the edge is in
    x = np.concatenate([np.linspace(0, 0.499, 50), np.linspace(0.501, 1, 50)]).astype(f32)
    worst = np.abs(look_up(parts.transfer, x) - curve(x)).max()
    record("HC-70", f"extinction, {name}", "table", 0, worst, 1e-5 * max(y for _, y in NODES[name]))


def test_hc70_scalars_beyond_the_table_take_its_ends(record):
    # Interpolation may pass the ends of the data by a rounding
    transfer = plan(scene(noise(), medium(3.0))).packed.transfer
    assert isinstance(transfer, packed.Transfer)
    low, high = (float(x) for x in look_up(transfer, f32([-1.0, noise().values.max()])))
    ends = 3.0 * noise().values.min(), 3.0 * noise().values.max()
    record("HC-70", "scalar below the data", "table", ends[0], low, 1e-6)
    record("HC-70", "scalar at the end of the data", "table", ends[1], high, 1e-5)
