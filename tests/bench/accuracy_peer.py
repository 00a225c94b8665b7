"""Mitsuba beside vtkmcvr on the same baked grid, in turns."""

from __future__ import annotations

import json
import math
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from accuracy_measure import THREADS, Facts
from accuracy_volumes import on_axes, scene_named
from mitsuba_peers import LOADER, Contender, mitsubas, module

from vtkmcvr.lights import ConstantEnvironment
from vtkmcvr.plan import plan
from vtkmcvr.rendering import render_scene
from vtkmcvr.scene import Scene, Volume

SIZE = (96, 72)
THEIR_SAMPLES, OUR_SAMPLES, TURNS = 8, 64, 3


def beside_mitsuba(name: str, volume: Volume) -> Facts:
    """Seconds and errors of both on a volume's extinction and albedo, baked at its points."""
    scene = scene_named(name, on_axes(volume), SIZE)
    with tempfile.TemporaryDirectory() as folder:
        racers = _contenders(bake(scene, Path(folder)))
        for racer, _ in racers:
            racer.render(0, 1)
        for turn in range(TURNS):
            for racer, samples in racers:
                racer.turn(1 + turn, samples)
    rows = [_row(racer, samples) for racer, samples in racers]
    theirs, ours = racers[0][0], racers[-1][0]
    z = (ours.mean - theirs.mean) / math.hypot(ours.mean_error, theirs.mean_error)
    return {"size": list(SIZE), "mean_z": z, "turns": TURNS, "rows": rows}


def bake(scene: Scene, folder: Path) -> Path:
    """scene.json with grids of extinction and albedo."""
    volume, transfer, camera = scene.volume, scene.transfer, scene.camera
    values = np.asarray(volume.values, np.float64)
    assert transfer.opacity is not None and transfer.colour is not None
    sigma_t = -np.log1p(-transfer.opacity(values.ravel())) / transfer.unit_distance
    np.save(folder / "sigma_t.npy", sigma_t.reshape(values.shape).astype(np.float32))
    colour = transfer.colour(values.ravel()).reshape(*values.shape, 3)
    np.save(folder / "albedo.npy", colour.astype(np.float32))
    spec = {
        "sigma_t": str(folder / "sigma_t.npy"), "albedo": str(folder / "albedo.npy"),
        "spacing": volume.spacing.tolist(), "origin": volume.index_to_world[:3, 3].tolist(),
        "phase": {"g": 0}, "max_depth": 2, "size": list(SIZE),
        "camera": {
            "position": camera.position, "focal_point": camera.focal_point,
            "view_up": camera.view_up, "view_angle": camera.view_angle,
        },
        "lights": [_light(light) for light in scene.lights],
    }  # fmt: skip
    path = folder / "scene.json"
    path.write_text(json.dumps(spec))
    return path


def _light(light: Any) -> Facts:
    radiance = np.broadcast_to(light.radiance, 3).tolist()
    if isinstance(light, ConstantEnvironment):
        return {"type": "constant", "radiance": radiance}
    return {
        "type": "rectangle", "center": light.centre, "target": light.target, "up": light.up,
        "size": light.size, "radiance": radiance,
    }  # fmt: skip


def _contenders(path: Path) -> list[tuple[Contender, int]]:
    ours = plan(module(LOADER).load_scene(path))
    return [
        *((theirs, THEIR_SAMPLES) for theirs in mitsubas(path, grey=False)),
        (
            Contender(
                "vtkmcvr",
                lambda seed, n: render_scene(ours, samples=n, seed=seed, threads=THREADS).radiance,
            ),
            OUR_SAMPLES,
        ),
    ]


def _row(racer: Contender, samples: int) -> Facts:
    """Least time of the turns; noise of one sample per pixel, by the spread of the turns."""
    spent = min(racer.cpu_seconds) / THREADS
    noise = racer.nrms * math.sqrt(samples)
    return {
        "name": racer.name, "samples": samples, "cpu_seconds": spent, "nrms": racer.nrms,
        "paths_per_second": SIZE[0] * SIZE[1] * samples / spent,
        "seconds_to_10_percent": spent / samples * (noise / 0.1) ** 2,
    }  # fmt: skip
