"""Small plotters, whose pictures have few sets of effects: each compiles for seconds."""

import numpy as np
import pyvista as pv

SIZE = (96, 72)


def fog(n=13, edge=2.0):
    """Constant volume of value 1 around the origin."""
    spacing, origin = (edge / (n - 1),) * 3, (-edge / 2,) * 3
    image = pv.ImageData(dimensions=(n, n, n), spacing=spacing, origin=origin)
    image["density"] = np.ones(n**3, np.float32)
    return image


def blob(n=17):
    """Soft lopsided ball, values from 0 to 1."""
    axis = np.linspace(-1, 1, n)
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    values = np.clip(1.1 - np.sqrt(x**2 + 1.5 * y**2 + z**2) + 0.1 * x * z, 0, 1)
    image = pv.ImageData(dimensions=(n, n, n), spacing=(2 / (n - 1),) * 3, origin=(-1, -1, -1))
    image["density"] = values.ravel().astype(np.float32)
    return image


def plotter(window_size=SIZE, **options):
    """Off-screen plotter with one lamp."""
    result = pv.Plotter(off_screen=True, window_size=window_size, lighting="none", **options)
    for renderer in result.renderers:
        lamp = pv.Light(position=(3, 4, 9), focal_point=(0, 0, 0), light_type="scene light")
        renderer.add_light(lamp)
    return result


def add(target, image=None, **options):
    """Add a volume in plain grey, half transparent."""
    options = {"opacity": [0.0, 0.5], "cmap": "gray", "clim": (0, 1), **options}
    return target.add_volume(
        blob() if image is None else image, show_scalar_bar=False, opacity_unit_distance=0.5,
        **options,
    )  # fmt: skip


def look(target, position=(2.5, 3.0, 6.0), **camera):
    """Point the camera of the active renderer at the origin."""
    target.camera_position = [position, (0, 0, 0), (0, 1, 0)]
    for name, value in camera.items():
        setattr(target.camera, name, value)
    target.renderer.ResetCameraClippingRange()


def pixels(target, **options):
    """Screenshot of the scene as it is now, float (H, W, 3) from 0 to 255."""
    target.render()
    return target.screenshot(None, return_img=True, **options)[..., :3].astype(float)
