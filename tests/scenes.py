"""Small scenes, and what to ask of their pictures.

Each new set of effects compiles for seconds. `everything` has one set, whatever light is asked for:
lights that a test does not want are there, too dark to count.
"""

import numpy as np

from vtkmcvr.curves import ColourCurve, Curve
from vtkmcvr.film import error as film_error
from vtkmcvr.lights import (
    ConstantEnvironment,
    DirectionalLight,
    EnvironmentMap,
    PointLight,
    RectangleLight,
)
from vtkmcvr.rendering import render_scene
from vtkmcvr.scene import (
    Camera,
    HenyeyGreenstein,
    PixelFilter,
    Scene,
    Surface,
    TransferFunction,
    Volume,
)

BOX = PixelFilter("box", 0.5)
DARK = 1e-15
WHITE = ColourCurve([(0, 1, 1, 1)])


def volume(values, spacing=(1.0, 1.0, 1.0), centre=(0.0, 0.0, 0.0)):
    """Axis-aligned volume around a world position; values are [k, j, i]."""
    values = np.asarray(values)
    matrix = np.diag([*spacing, 1.0])
    last = np.array(values.shape[::-1]) - 1
    matrix[:3, 3] = np.array(centre) - last * np.array(spacing) / 2
    return Volume(values, matrix)


def slab(edges=(1.0, 1.0, 1.0), points=3, dtype=np.float32, centre=(0.0, 0.0, 0.0)):
    """Constant volume of value 1 with the given edge lengths along x, y and z."""
    values = np.ones((points, points, points), dtype)
    return volume(values, np.array(edges) / (points - 1), centre)


def blob(n=17, centre=(0.0, 0.0, 0.0), dtype=np.float32):
    """Soft lopsided ball: values from 0 to 1 with gradients everywhere."""
    z, y, x = np.mgrid[-1 : 1 : n * 1j, -1 : 1 : n * 1j, -1 : 1 : n * 1j]
    values = np.clip(1.1 - np.sqrt(x**2 + 1.5 * y**2 + z**2) + 0.1 * x * z, 0, 1)
    return volume(values.astype(dtype), (2 / (n - 1),) * 3, centre)


def noise(n=9, seed=1, centre=(0.0, 0.0, 0.0)):
    """Random volume of values from 0 to 1, two units wide."""
    values = np.random.default_rng(seed).random((n, n, n), np.float32)
    return volume(values, (2 / (n - 1),) * 3, centre)


def medium(sigma_t, colour=1.0):
    """Extinction proportional to the scalar, sigma_t at 1, of one colour."""
    colour = np.broadcast_to(colour, 3).tolist()
    return TransferFunction(
        None, ColourCurve([(0, *colour)]), extinction=Curve([(0, 0), (1, sigma_t)])
    )


def frontal(half_height=1.0, centre=(0.0, 0.0, 0.0), distance=5.0):
    """Parallel camera that looks along +y, with z up."""
    x, y, z = centre
    return Camera((x, y - distance, z), (x, y, z), parallel_scale=half_height)


def scene(vol=None, transfer=None, camera=None, size=(32, 32), **options):
    """Scene with a box filter; by default a blob seen from the front."""
    vol = blob() if vol is None else vol
    return Scene(
        vol,
        medium(3.0) if transfer is None else transfer,
        frontal(0.9, vol.centre) if camera is None else camera,
        size=size,
        **{"pixel_filter": BOX, **options},
    )


def everything(*lights, surface=None, phase=None, vol=None, **options):
    """Scene of one set of effects: all kinds of light, hybrid, coat, phase, shadows."""
    vol = blob() if vol is None else vol
    far = vol.centre + np.array((3e3, 2e3, 1e3))
    present = {type(light) for light in lights}
    dark = {
        ConstantEnvironment: ConstantEnvironment(DARK),
        EnvironmentMap: EnvironmentMap(np.full((1, 1, 3), DARK)),
        RectangleLight: RectangleLight(far, vol.centre, (1e-3, 1e-3), DARK),
        DirectionalLight: DirectionalLight((0, 0, -1), DARK),
    }
    if PointLight in present:
        del dark[DirectionalLight]
    added = [light for kind, light in dark.items() if kind not in present]
    return scene(
        vol,
        lights=(*lights, *added),
        surface=surface or Surface(gradient_factor=1e-3),
        phase=phase or HenyeyGreenstein(0.3),
        **options,
    )


def mean_and_error(picture, channel=1):
    """Mean radiance over the pixels, and its standard error from the film's own variance."""
    film = picture.film
    variance = film_error.variance(film)[..., channel]
    return film.mean[..., channel].mean(), np.sqrt(variance.sum()) / variance.size


def z_score(picture, other):
    """Difference of the mean radiance of two independent pictures in its standard errors."""
    (a, ea), (b, eb) = mean_and_error(picture), mean_and_error(other)
    return (a - b) / np.hypot(ea, eb)


def render(scene, samples=64, seed=1, **options):
    return render_scene(scene, samples=samples, seed=seed, **options)
