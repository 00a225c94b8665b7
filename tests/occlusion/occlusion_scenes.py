"""Scenes with known answers for occlusion, and real volumes with the transfer functions of docs."""

import math
import os
from pathlib import Path

import numpy as np
from scenes import BOX, scene, volume

from vtkmcvr.curves import ColourCurve, Curve
from vtkmcvr.material import TransferFunction
from vtkmcvr.occlusion import render_occlusion
from vtkmcvr.scene import Camera, PixelFilter

DATA = Path(os.environ.get("VTKMCVR_DATA", "../shared/data"))
POINT = PixelFilter("box", 0.5)


def frontal(half_height=1.0, distance=50.0, centre=(0.0, 0.0, 0.0)):
    x, y, z = centre
    return Camera((x, y - distance, z), (x, y, z), parallel_scale=half_height)


def block(depth, width, sigma_t=1.0, spacing=1.0, albedo=1.0):
    """Homogeneous block, its front face at y = 0, seen along +y; scalars are extinction."""
    shape = (round(width / spacing) + 1, round(depth / spacing) + 1, round(width / spacing) + 1)
    vol = volume(np.full(shape, 1.0, np.float32), (spacing,) * 3, (0.0, depth / 2, 0.0))
    return vol, medium(sigma_t, albedo)


def medium(sigma_t, albedo=1.0):
    colour = np.broadcast_to(albedo, 3).tolist()
    return TransferFunction(
        None, ColourCurve([(0, *colour)]), extinction=Curve([(0, 0), (1, sigma_t)])
    )


def half_space_scene(sigma_t=1.0, size=(9, 9), **options):
    vol, transfer = block(24.0, 120.0, sigma_t)
    return scene(vol, transfer, frontal(8.0), size=size, pixel_filter=BOX, **options)


def half_space(theta):
    c = math.cos(math.radians(theta))
    return 0.5 if theta == 0 else 1 - math.log(2 / (1 + c)) / (1 - c)


def penumbra(occlusion):
    """Width of the penumbra of a half-plane from 60 to 95 % of the light, voxels.

    An opaque half-plane at z < 1, 15 to 18 voxels in front of a thin receiver, of which the eye
    sees the part at z > 1. Rays that lean over the plane sink on their way: its front face, at 18,
    is what they must clear. Returns the width found, the exact one, and the most light anywhere.
    """
    n = 97
    values = np.zeros((n, 41, n), np.float32)
    values[: n // 2 + 1, 8:10, :] = 50.0
    values[:, 25, :] = 0.02
    camera = Camera((0, -500, 0), (0, 0, 0), (0, 0, 1), parallel_scale=30.0)
    lit = scene(volume(values), medium(1.0), camera, size=(3, 80), pixel_filter=BOX)
    picture = render_occlusion(lit, occlusion)
    z = 30 * (1 - (np.arange(80) + 0.5) / 40)
    seen = (z > 2) & (z < 24)
    light = picture.radiance[seen, 1, 1] / picture.alpha[seen, 1]
    # Exact share of the cone's solid angle that passes the edge, by quadrature
    cosine = math.cos(math.radians(occlusion.half_angle))
    c = 1 - (np.arange(400) + 0.5) / 400 * (1 - cosine)
    turn = np.cos((np.arange(400) + 0.5) / 400 * 2 * math.pi)
    reach = 18.0 * np.sqrt(1 / c**2 - 1)[:, None] * turn
    exact = np.array([(reach > 1 - x).mean() for x in z[seen]])
    found, expected = (np.interp((-0.95, -0.6), -each, z[seen]) for each in (light, exact))
    return found[0] - found[1], expected[0] - expected[1], light.max()
