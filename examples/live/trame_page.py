"""A page that shows a volume and a mesh in physically based light, refined while you look at it.

python examples/live/trame_page.py [--port 8080] [--samples 256]

Needs `pip install "vtkmcvr[viewer]"`.
"""

import argparse
import asyncio

import numpy as np
import pyvista as pv
from trame.app import get_server
from trame.ui.vuetify3 import SinglePageLayout
from trame.widgets import vuetify3
from trame_pyvista.ui import plotter_ui

import vtkmcvr


def synthetic_head(size=96):
    """The synthetic CT head as PyVista would hold it."""
    head = vtkmcvr.head_phantom(size)
    image = pv.ImageData(
        dimensions=head.values.shape[::-1], spacing=head.spacing, origin=head.origin
    )
    image["HU"] = np.ravel(head.values)
    return image


def scene(samples):
    """Plotter with a head and a needle."""
    image = synthetic_head()
    plotter = pv.Plotter(off_screen=True, window_size=(640, 480))
    plotter.set_background("black")
    plotter.add_volume(
        image, cmap="bone", clim=(-100, 1400), opacity=[0, 0, 0.25, 0.6, 0.9], shade=True,
        show_scalar_bar=False, opacity_unit_distance=4,
    )  # fmt: skip
    centre = np.array(image.center)
    place = centre + np.array((70, -70, 20))
    needle = pv.Cylinder(center=place, direction=(1, -1, 0.3), radius=2, height=140)
    plotter.add_mesh(needle, color="gold", smooth_shading=True)
    plotter.camera_position = [centre + np.array((150, -520, 120)), centre, (0, 0, 1)]
    # The one line
    plotter.mcvr.enable(samples=samples, progressive=True, text=True)
    return plotter


def page(server, plotter):
    """Page with PyVista's own view, and how far the picture is."""
    state = server.state
    state.words = "..."

    async def watch(**_):
        while True:
            await asyncio.sleep(0.2)
            with state:
                done = " (done)" if plotter.mcvr.done else ""
                state.words = f"{plotter.mcvr.samples} samples{done}"

    server.controller.on_server_ready.add_task(watch)
    with SinglePageLayout(server) as layout:
        layout.title.set_text("vtkmcvr")
        with layout.toolbar:
            vuetify3.VSpacer()
            vuetify3.VChip("{{ words }}", id="words")
        with layout.content:
            plotter_ui(plotter, mode="server", add_menu=False)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--port", type=int, default=8080)
    parser.add_argument("--samples", type=int, default=256)
    options, _ = parser.parse_known_args()
    server = get_server(client_type="vue3")
    plotter = scene(options.samples)
    page(server, plotter)
    server.start(port=options.port, open_browser=False, show_connection_info=False)


if __name__ == "__main__":
    main()
