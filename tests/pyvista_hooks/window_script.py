"""Run in a window of an X server: drags the mouse by events, and prints what happened as JSON."""

import json
import sys
import time

import pyvista as pv
from plotters import add, blob, look


def main():
    target = pv.Plotter(window_size=(320, 240), lighting="none")
    target.add_light(pv.Light(position=(3, 4, 9), light_type="scene light"))
    volume = add(target, blob())
    look(target)
    target.mcvr.enable(samples=64)
    seen, gaps, last = [], [], [time.perf_counter()]

    def watch(*_):
        now = time.perf_counter()
        gaps.append(now - last[0])
        last[0] = now
        if not seen or seen[-1] != target.mcvr.samples:
            seen.append(target.mcvr.samples)

    target.show(interactive_update=True, auto_close=False)
    interactor = target.iren.interactor
    interactor.AddObserver("TimerEvent", watch)
    watching = interactor.CreateRepeatingTimer(10)
    finish(target, interactor)
    first = list(seen)
    # A drag of the left button: each move is a new view with a first estimate of its own
    before, views = target.mcvr._live.views[0].restarts, []
    interactor.SetEventInformation(160, 120, 0, 0)
    interactor.InvokeEvent("LeftButtonPressEvent")
    for step in range(8):
        interactor.SetEventInformation(160 + 4 * step, 120, 0, 0)
        begin = time.perf_counter()
        interactor.InvokeEvent("MouseMoveEvent")
        views.append(time.perf_counter() - begin)
    interactor.InvokeEvent("LeftButtonReleaseEvent")
    restarted = target.mcvr._live.views[0].restarts - before
    after_drag = target.mcvr.samples
    gaps.clear()
    last[0] = time.perf_counter()
    finish(target, interactor)
    gap, text = max(gaps), target.mcvr._live.views[0].shown.words
    image = target.screenshot(sys.argv[1], return_img=True)
    interactor.DestroyTimer(watching)
    restarts, frames = with_widgets(target, interactor, volume)
    result = {
        "first": first, "restarted": restarted, "after_drag": after_drag, "done": target.mcvr.done,
        "views": views, "gap": gap, "text": text, "mean": float(image.mean()),
        "widgets": {"restarts": restarts, "frames": frames, "done": target.mcvr.done},
    }  # fmt: skip
    target.close()
    print(json.dumps(result))


def with_widgets(target, interactor, volume, idle=0.5):
    """Restarts after a plane widget has come, and frames in `idle` seconds beside an open chart."""
    target.add_volume_clip_plane(volume, interaction_event="always")
    finish(target, interactor)
    before = target.mcvr._live.views[0].restarts
    target.render()
    finish(target, interactor)
    restarts = target.mcvr._live.views[0].restarts - before
    target.mcvr.add_opacity_editor(volume)
    # Its curve has fewer points than PyVista's
    target.render()
    finish(target, interactor)
    frames, end = [], time.perf_counter() + idle
    tag = target.render_window.AddObserver("EndEvent", lambda *_: frames.append(None))
    while time.perf_counter() < end:
        interactor.ProcessEvents()
        time.sleep(0.002)
    target.render_window.RemoveObserver(tag)
    return restarts, len(frames)


def finish(target, interactor, seconds=120):
    """Handle events until the picture is done."""
    end = time.perf_counter() + seconds
    while not target.mcvr.done and time.perf_counter() < end:
        interactor.ProcessEvents()
        time.sleep(0.002)


if __name__ == "__main__":
    main()
