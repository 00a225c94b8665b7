"""A medium between receivers, as Mitsuba 3 renders it: once scattered, and without a limit."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from dataclasses import replace

import mitsuba_receivers as peer
import numpy as np
import pytest
from test_mitsuba import PASS_SAMPLES, PASSES, Image, agree, render_ours, sparse_medium, statistics

from vtkmcvr.curves import ColourCurve, Curve
from vtkmcvr.lights import ConstantEnvironment, RectangleLight
from vtkmcvr.receivers import BoxReceiver, MeshReceiver, PlaneReceiver, SphereReceiver
from vtkmcvr.scene import Camera, PixelFilter, Scene, TransferFunction, Volume

pytestmark = pytest.mark.slow


def cube_mesh(centre, half, **look):
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    quads = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    return MeshReceiver(np.array(centre) + corners * half, np.array(triangles), **look)


def our_scene(sigma_t, **options):
    volume = Volume.from_grid(sigma_t, peer.SPACING)
    matrix = volume.index_to_world.copy()
    matrix[:3, 3] -= volume.centre
    top = float(sigma_t.max())
    transfer = TransferFunction(
        None, ColourCurve([(0, *(peer.ALBEDO,) * 3)]), extinction=Curve([(0, 0), (top, top)])
    )
    ball, cube, floor, lamp = peer.BALL, peer.CUBE, peer.FLOOR, peer.LAMP
    side = 2 * floor["half"]
    return Scene(
        Volume(sigma_t, matrix), transfer,
        Camera(peer.POSITION, peer.FOCAL_POINT, view_angle=peer.VIEW_ANGLE),
        lights=(
            ConstantEnvironment(peer.SKY),
            RectangleLight(
                lamp["centre"], (0, 0, 0), (lamp["edge"],) * 2, lamp["radiance"],
                up=(0, 0.6, 0.8), visible=True,
            ),
        ),
        receivers=(
            PlaneReceiver((0, 0, floor["z"]), (0, 0, 1), (side, side), colour=floor["colour"]),
            SphereReceiver(ball["centre"], ball["radius"], colour=ball["colour"]),
            cube_mesh(cube["centre"], cube["half"], colour=cube["colour"]),
        ),
        environment_visible=True, size=peer.SIZE, pixel_filter=PixelFilter("box", 0.5), **options,
    )  # fmt: skip


def render_theirs(sigma_t, folder, max_depth):
    if importlib.util.find_spec("mitsuba") is None:
        pytest.skip("mitsuba is not installed")
    np.save(folder / "sigma_t.npy", sigma_t)
    command = [sys.executable, peer.__file__, folder / "sigma_t.npy", folder / "out.npz"]
    command += [str(PASSES), str(PASS_SAMPLES), str(max_depth)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr
    with np.load(folder / "out.npz") as arrays:
        return Image(arrays["image"], arrays["standard_error"])


@pytest.mark.parametrize("scattering", ["single", "multiple"])
def test_same_image_as_mitsuba_with_shapes_around_the_medium(scattering, tmp_path):
    sigma_t = sparse_medium()
    # Mitsuba counts the path from the camera as the first of 2; roulette is ours alone
    theirs = render_theirs(sigma_t, tmp_path, 2 if scattering == "single" else -1)
    scene = our_scene(sigma_t, scattering=scattering)
    ours = render_ours(scene)
    assert agree(ours, theirs), statistics(ours, theirs)
    # A comparison that lets these pass would be worth nothing
    floor, ball, cube = scene.receivers
    moved = replace(ball, centre=np.add(ball.centre, (0.5, 0, 0)))
    box = BoxReceiver(peer.CUBE["centre"], np.multiply(peer.CUBE["half"], 2.1), colour=cube.colour)
    for wrong in ((floor, moved, cube), (floor, ball, box)):
        image = render_ours(replace(scene, receivers=wrong))
        assert not agree(image, theirs), statistics(image, theirs)
