"""PyVista's own volume examples with one line added, beside VTK's pictures of them.

python examples/pyvista_side_by_side.py [PICTURE.png [CT]]

Left: as PyVista draws them; right: with `plotter.mcvr.enable(...)`. Without a CT file the synthetic
head stands in for the downloads of PyVista's documentation.
"""

import sys
from collections.abc import Callable

import numpy as np
import pyvista as pv
from PIL import Image

import vtkmcvr

SIZE = (400, 300)
SAMPLES = 32
BONE = {
    "cmap": "bone", "clim": (-100, 1500), "opacity": [0, 0, 0.15, 0.5, 0.8, 0.95], "shade": True,
    "opacity_unit_distance": 4.0, "show_scalar_bar": False,
}  # fmt: skip


def synthetic_head(size: int = 128) -> pv.ImageData:
    """The synthetic CT head as PyVista would hold it."""
    head = vtkmcvr.head_phantom(size)
    image = pv.ImageData(
        dimensions=head.values.shape[::-1], spacing=head.spacing, origin=head.origin
    )
    image["HU"] = np.ravel(head.values)
    return image


def facing(plotter: pv.Plotter, image: pv.ImageData, side: float = 0.45) -> None:
    """Look at the face, from a little aside and above."""
    centre = np.array(image.center)
    distance = 1.15 * image.length
    plotter.camera_position = [
        centre + distance * np.array((side, -0.85, 0.25)), centre, (0, 0, 1),
    ]  # fmt: skip


def ct(plotter: pv.Plotter, image: pv.ImageData) -> None:
    """Volume rendering of a CT."""
    plotter.add_volume(image, **BONE)
    facing(plotter, image)


def ct_and_mesh(plotter: pv.Plotter, image: pv.ImageData) -> None:
    """A CT with meshes: a needle goes into it, a ring is around it."""
    ct(plotter, image)
    centre, radius = np.array(image.center), image.length / 4
    axis = np.array((0.93, -0.3, 0.2))
    needle = pv.Cylinder(
        center=centre + radius * axis, direction=axis, radius=radius / 30, height=radius
    )
    plotter.add_mesh(needle, color="gold", smooth_shading=True)
    ring = pv.ParametricTorus(ringradius=1.05 * radius, crosssectionradius=radius / 25)
    ring = ring.translate(centre + np.array((0, 0, radius / 3)))
    plotter.add_mesh(ring, color="tomato", smooth_shading=True)


def translucent_meshes(plotter: pv.Plotter, image: pv.ImageData) -> None:
    """A CT in a translucent shell of many colours, with a translucent plane through both."""
    ct(plotter, image)
    centre, radius = np.array(image.center), image.length / 4
    shell = pv.Sphere(radius=0.7 * radius, center=centre + radius * np.array((0.6, -0.6, 0)))
    shell["height"] = shell.points[:, 2]
    plotter.add_mesh(
        shell, cmap="viridis", opacity=0.45, smooth_shading=True, show_scalar_bar=False
    )
    plane = pv.Plane(center=centre, direction=(0, 1, 0), i_size=2.4 * radius, j_size=2.4 * radius)
    plotter.add_mesh(plane, color="orange", opacity=0.4)


def several_volumes(plotter: pv.Plotter, image: pv.ImageData) -> None:
    """Two volumes in one place: a CT, and a hot spot inside it."""
    plotter.add_volume(image, **{**BONE, "opacity": [0, 0, 0.05, 0.15, 0.3, 0.5]})
    spot = pv.ImageData(dimensions=(48, 48, 48))
    spot.spacing = (image.length / 280,) * 3
    place = np.array(image.center) + image.length * np.array((0.04, -0.08, 0.1))
    spot.origin = place - 23.5 * np.array(spot.spacing)
    distance = np.linalg.norm(spot.points - spot.center, axis=1) / (24 * spot.spacing[0])
    spot["uptake"] = np.clip(1.2 - distance, 0, 1)
    plotter.add_volume(
        spot, cmap="hot", opacity="linear", opacity_unit_distance=6.0, shade=False,
        show_scalar_bar=False,
    )  # fmt: skip
    facing(plotter, image)


def clipped(plotter: pv.Plotter, image: pv.ImageData) -> None:
    """A CT, of which a plane has cut away one side."""
    volume = plotter.add_volume(image, **BONE)
    widget = plotter.add_volume_clip_plane(volume, normal=(-1, 0.6, 0), origin=image.center)
    widget.Off()
    facing(plotter, image, 0.7)


def opacity_mapping(plotter: pv.Plotter, image: pv.ImageData) -> None:
    """A named opacity ramp instead of an array, a colour map instead of grey."""
    plotter.add_volume(
        image, cmap="coolwarm", clim=(-600, 900), opacity="sigmoid_9", shade=False,
        show_scalar_bar=False, opacity_unit_distance=12.0,
    )  # fmt: skip
    facing(plotter, image)


EXAMPLES: tuple[Callable[[pv.Plotter, pv.ImageData], None], ...] = (
    ct, ct_and_mesh, translucent_meshes, several_volumes, clipped, opacity_mapping,
)  # fmt: skip


def pair(example: Callable[..., None], image: pv.ImageData, samples: int) -> np.ndarray:
    """VTK's picture and ours, side by side."""
    plotter = pv.Plotter(off_screen=True, window_size=SIZE)
    plotter.set_background("#15171c")
    example(plotter, image)
    theirs = plotter.screenshot(None, return_img=True)
    plotter.mcvr.enable(samples=samples, lighting="studio", seed=1)
    plotter.render()
    ours = plotter.screenshot(None, return_img=True)
    print(f"{example.__name__}: {plotter.mcvr.samples} samples, error {plotter.mcvr.error:.1%}")
    plotter.close()
    return np.hstack([theirs, ours])


def save_small(image: Image.Image, path: str) -> None:
    """Write as many colours as a palette holds, dithered: a third of the size."""
    palette = image.quantize(256, method=Image.Quantize.FASTOCTREE)
    image.quantize(palette=palette, dither=Image.Dither.FLOYDSTEINBERG).save(path, optimize=True)


def main(picture: str = "side_by_side.png", volume: str | None = None) -> None:
    image = vtkmcvr.read(volume) if volume else synthetic_head()
    rows = [pair(example, image, SAMPLES) for example in EXAMPLES]
    save_small(Image.fromarray(np.vstack(rows)), picture)


if __name__ == "__main__":
    main(*sys.argv[1:])
