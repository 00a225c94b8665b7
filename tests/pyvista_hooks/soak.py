"""Scripted editing of a live scene for a long time: no crash, and memory stays flat.

python tests/pyvista_hooks/soak.py [--minutes 30] [--edits N] [--json FILE]
"""

import argparse
import gc
import json
import time

import numpy as np
import pyvista as pv
from plotters import add, blob, look
from vtkmodules.vtkCommonDataModel import vtkPlane

# Edits after which memory is looked at for the first time: caches are full, and every combination
# of effects that the edits lead to has had its kernels loaded (the last one after some 180)
WARM_UP = 240


def resident():
    """Memory of this process, MiB."""
    with open("/proc/self/status") as file:
        line = next(line for line in file if line.startswith("VmRSS"))
    return int(line.split()[1]) / 1024


class Editor:
    """A scene, and a random edit of it at a time."""

    def __init__(self, seed=1):
        self.random = np.random.default_rng(seed)
        self.plotter = pv.Plotter(off_screen=True, window_size=(160, 120), lighting="none")
        self.lamp = pv.Light(position=(3, 4, 9), light_type="scene light")
        self.plotter.add_light(self.lamp)
        self.volume = add(self.plotter, blob(33))
        self.ball = self.plotter.add_mesh(pv.Sphere(radius=0.4, center=(1, 0, 0)), color="red")
        look(self.plotter)
        self.plane = vtkPlane()
        self.plane.SetNormal(1, 0, 0)
        self.plane.SetOrigin(-2, 0, 0)
        self.volume.mapper.AddClippingPlane(self.plane)
        self.plotter.mcvr.enable(samples=2**30, progressive=True, text=True)
        self.plotter.show(auto_close=False)
        self.edits = [
            self.turn, self.opacity, self.colour, self.light, self.clip, self.mesh, self.voxels,
            self.resize, self.toggle, self.settings,
        ]  # fmt: skip

    def edit(self):
        """One edit, and some frames."""
        self.edits[self.random.integers(len(self.edits))]()
        for _ in range(int(self.random.integers(1, 6))):
            self.plotter.render()
            time.sleep(0.005)

    def turn(self):
        for _ in range(4):
            look(self.plotter, tuple(6 * self.random.normal(size=3) + (0, 0, 7)))
            self.plotter.render()

    def opacity(self):
        function = self.volume.prop.GetScalarOpacity()
        function.RemoveAllPoints()
        for x in (0.0, 0.3, 0.6, 1.0):
            function.AddPoint(x, self.random.random() * x)

    def colour(self):
        function = self.volume.prop.GetRGBTransferFunction()
        function.AddRGBPoint(0.5, *self.random.random(3))

    def light(self):
        self.lamp.position = tuple(5 * self.random.normal(size=3))

    def clip(self):
        self.plane.SetOrigin(self.random.uniform(-1.5, 0.5), 0, 0)

    def mesh(self):
        self.ball.SetPosition(*self.random.normal(size=3))
        self.ball.prop.opacity = float(self.random.choice((0.5, 1.0)))

    def voxels(self):
        image = blob(33)
        image["density"] = np.roll(image["density"], int(self.random.integers(5)))
        self.volume.mapper.SetInputData(image)

    def resize(self):
        self.plotter.window_size = [int(n) for n in self.random.integers(60, 200, 2)]

    def toggle(self):
        self.plotter.mcvr.disable()
        self.plotter.render()
        self.plotter.mcvr.enable(samples=2**30, progressive=True, text=True)

    def settings(self):
        self.plotter.mcvr.enable(exposure=float(self.random.uniform(0, 3)))


def soak(seconds, least):
    """Edit for some time, at least `least` times. Returns what happened."""
    editor = Editor()
    memory, edits, end = [], 0, time.perf_counter() + seconds
    while time.perf_counter() < end or edits < least:
        editor.edit()
        edits += 1
        if edits >= WARM_UP and edits % 20 == 0:
            gc.collect()
            memory.append(resident())
    errors = [repr(view.error) for view in editor.plotter.mcvr._live.views if view.error]
    editor.plotter.close()
    return {"edits": edits, "memory_MiB": memory, "errors": errors}


def growth(memory):
    """Growth from the first third to the last, MiB; medians, since films come and go."""
    third = max(1, len(memory) // 3)
    return float(np.median(memory[-third:]) - np.median(memory[:third]))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=30)
    parser.add_argument(
        "--edits", type=int, default=2 * WARM_UP, help="at least"
    )
    parser.add_argument("--json")
    options = parser.parse_args()
    result = soak(60 * options.minutes, options.edits)
    result["growth_MiB"] = growth(result["memory_MiB"])
    if options.json:
        with open(options.json, "w") as file:
            json.dump(result, file)
    print(
        f"{result['edits']} edits, memory {result['memory_MiB'][0]:.0f} to "
        f"{result['memory_MiB'][-1]:.0f} MiB, growth {result['growth_MiB']:+.1f} MiB, "
        f"errors: {result['errors'] or 'none'}"
    )


if __name__ == "__main__":
    main()
