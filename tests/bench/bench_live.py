"""Latency of a live picture: after a move of the camera, and of events while refining.

python tests/bench/bench_live.py [--size 256] [--window 800x600] [--seconds 5]

Off screen, so that no window manager counts. A move is a new camera and one frame: reading the
scene, depth of meshes, first estimate, drawing. An event is a turn of the event loop, with the
timer's look at the refiner and the drawing of what it has made. Most turns have nothing to draw:
those with a frame are listed apart, with what this package does in them, and beside them frames of
the same window in which VTK draws the meshes and a picture, and nothing is refined.
"""

import argparse
import json
import time

import numpy as np
import pyvista as pv

import vtkmcvr

MOVES = 24


def scene(edge, window, mesh):
    head = vtkmcvr.head_phantom(edge)
    image = pv.ImageData(
        dimensions=head.values.shape[::-1], spacing=head.spacing, origin=head.origin
    )
    image["HU"] = np.ravel(head.values)
    plotter = pv.Plotter(off_screen=True, window_size=window)
    plotter.add_volume(
        image, cmap="bone", clim=(-100, 1500), opacity=[0, 0, 0.15, 0.5, 0.8, 0.95], shade=True,
        show_scalar_bar=False, opacity_unit_distance=4.0,
    )  # fmt: skip
    if mesh:
        place = np.array(image.center) + np.array((60, -60, 0))
        ball = pv.Sphere(radius=image.length / 9, center=place)
        plotter.add_mesh(ball, color="gold", smooth_shading=True)
    turn(plotter, image, 0.0)
    return plotter, image


def turn(plotter, image, angle):
    centre = np.array(image.center)
    away = 1.15 * image.length * np.array((np.sin(angle), -np.cos(angle), 0.2))
    plotter.camera_position = [centre + away, centre, (0, 0, 1)]


def moves(plotter, image):
    """Seconds of each frame after a move of the camera."""
    taken = []
    for step in range(MOVES):
        turn(plotter, image, 0.1 * (step + 1))
        begin = time.perf_counter()
        plotter.render()
        taken.append(time.perf_counter() - begin)
    return taken


def events(plotter, seconds):
    """Seconds of each turn of the event loop while the picture is refined, of frames, own share."""
    live = plotter.mcvr._live
    turns, frames, own = [], [], watched(live.views[0])
    end = time.perf_counter() + seconds
    while time.perf_counter() < end:
        begin = time.perf_counter()
        time.sleep(0.001)
        live.look_on()
        drawn = live.waiting
        if drawn:
            plotter.render()
        turns.append(time.perf_counter() - begin)
        if drawn:
            frames.append(turns[-1])
    return turns, frames, own


def watched(view):
    """List that gets the seconds which a view spends in each frame."""
    taken, frame = [], view._frame

    def timed():
        begin = time.perf_counter()
        frame()
        taken.append(time.perf_counter() - begin)

    view._frame = timed
    return taken


def idle_frames(plotter, count=20):
    """Seconds of frames in which nothing is read, refined or swapped."""
    plotter.mcvr._live._refiner.drop(plotter.mcvr._live.views[0])
    taken = []
    for _ in range(count):
        begin = time.perf_counter()
        plotter.render()
        taken.append(time.perf_counter() - begin)
    return taken


def spread(seconds):
    """Median, 95 % and longest, in milliseconds."""
    return {
        "median": round(1e3 * float(np.median(seconds)), 2),
        "95 %": round(1e3 * float(np.percentile(seconds, 95)), 2),
        "most": round(1e3 * max(seconds), 2),
    }


def measure(options, mesh):
    window = [int(n) for n in options.window.split("x")]
    plotter, image = scene(options.size, window, mesh)
    plotter.mcvr.enable(samples=2**30, progressive=True, text=True)
    plotter.show(auto_close=False)
    begin = time.perf_counter()
    while plotter.mcvr.samples < 1 and time.perf_counter() - begin < 300:
        # Kernels are being compiled
        time.sleep(0.1)
        plotter.render()
    moves(plotter, image)
    taken = moves(plotter, image)
    turns, frames, own = events(plotter, options.seconds)
    samples = plotter.mcvr.samples
    result = {
        "mesh": mesh, "first_estimate_ms": spread(taken), "event_ms": spread(turns),
        "frame_ms": spread(frames), "own_share_ms": spread(own), "frames": len(frames),
        "idle_frame_ms": spread(idle_frames(plotter)), "samples_meanwhile": samples,
    }  # fmt: skip
    plotter.close()
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", type=int, default=256, help="edge of the volume, voxels")
    parser.add_argument("--window", default="800x600")
    parser.add_argument("--seconds", type=float, default=5.0, help="to refine")
    options = parser.parse_args()
    print(json.dumps([measure(options, mesh) for mesh in (False, True)], indent=2))


if __name__ == "__main__":
    main()
