"""Scenes with known answers for occlusion, and real volumes with the transfer functions of docs."""

import math
import os
from pathlib import Path

import numpy as np
from scenes import BOX, scene, volume

from vtkmcvr.curves import ColourCurve, Curve
from vtkmcvr.material import TransferFunction
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
