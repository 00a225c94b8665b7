"""The scene that effects are added to, and the scene with each of them."""

from dataclasses import replace

import numpy as np

import vtkmcvr

BASELINE = "baseline"
# Voxels of a label map's blocks
BLOCK = 32


def baseline(dressed):
    """Transfer function and key light of a look: phase function, one area light, a pinhole."""
    key = dressed.scene.lights[1]
    return replace(dressed.scene, lights=(key,), surface=None)


def with_effects(dressed):
    """Group, name and scene of every effect."""
    scene = baseline(dressed)
    volume, transfer, camera = scene.volume, scene.transfer, scene.camera
    (key,) = scene.lights
    sky, _, rim = dressed.scene.lights
    surface = dressed.scene.surface
    radius, centre = volume.radius, np.array(volume.centre)
    lens = vtkmcvr.Lens(0.06 * radius)
    forward = camera.frame[2]

    def add(group, name, **changes):
        return group, name, replace(scene, **changes)

    return [
        ("", BASELINE, scene),
        add("camera", "thin lens", camera=replace(camera, lens=lens)),
        add("lights", "no shadows", shadow_reach=0.0),
        add("lights", "constant environment", lights=(sky, key)),
        add("lights", "environment map", lights=(studio_map(), key)),
        add("lights", "2 lights", lights=(key, rim)),
        add("lights", "64 lights", lights=many(64, key, scene)),
        add("lights", "64 lights, no shadows", lights=many(64, key, scene), shadow_reach=0.0),
        add("material", "hybrid surfaces", surface=surface),
        add("material", "surfaces only", surface=replace(surface, mode="brdf")),
        add("material", "surfaces only, GGX", surface=replace(surface, mode="brdf", coat="ggx")),
        add("scene", "clip plane", clip=(vtkmcvr.Plane(tuple(centre), tuple(forward)),)),
        add("scene", "2 labels", labels=labels(volume, transfer)),
        add("scene", "floor", receivers=(floor(scene),)),
        add("scene", "floor of 5 000 triangles", receivers=(tiles(scene, 50),)),
        add("scene", "floor of 500 000 triangles", receivers=(tiles(scene, 500),)),
        add("transport", "multiple scattering", scattering="multiple"),
        add("transport", "shadows seen or not", ratio_tracking=False),
        add("transport", "one global majorant", estimator="woodcock"),
        add("film", "albedo and normal", aovs=("albedo", "normal")),
        add("film", "independent samples", sampler="independent"),
        ("together", "the look as it is", dressed.scene),
    ]  # fmt: skip


def many(n, key, scene):
    """n rectangles on a half sphere about the key light, together as bright as it."""
    centre, radius = np.array(scene.volume.centre), scene.volume.radius
    pole = np.subtract(key.centre, centre)
    pole /= np.linalg.norm(pole)
    right = np.cross(pole, scene.camera.frame[1])
    right /= np.linalg.norm(right)
    up = np.cross(right, pole)
    lights = []
    for i in range(n):
        z, phi = (i + 0.5) / n, (np.pi * (3 - np.sqrt(5))) * i
        ring = np.sqrt(1 - z * z)
        way = ring * np.cos(phi) * right + ring * np.sin(phi) * up + z * pole
        place = tuple(centre + 2.6 * radius * way)
        light = vtkmcvr.RectangleLight(place, tuple(centre), (0.3 * radius,) * 2)
        share = (1.0, 0.3, 2.0, 0.7)[i % 4] / n
        lights.append(vtkmcvr.with_irradiance(light, 6.0 * share, centre))
    return tuple(lights)


def studio_map():
    """Dim sky with a small bright sun, 128 x 64 texels."""
    pixels = np.full((64, 128, 3), 0.3, np.float32)
    pixels[12:16, 20:26] = (120.0, 110.0, 95.0)
    return vtkmcvr.EnvironmentMap(pixels)


def labels(volume, transfer):
    """Blocks of two labels with the same opacity and two colours."""
    k, j, i = (np.arange(n) // BLOCK for n in volume.values.shape)
    blocks = (k[:, None, None] + j[:, None] + i) % 2 + 1
    red = replace(transfer, colour=vtkmcvr.ColourCurve([(0.0, 0.7, 0.3, 0.2)]))
    return vtkmcvr.Labels(blocks.astype(np.uint8), {1: transfer, 2: red})


def floor(scene):
    """Square below the volume, as the camera sees it, 8 radii wide."""
    centre = np.array(scene.volume.centre)
    _, up, forward = scene.camera.frame
    lowest = float((scene.volume.corners @ up).min())
    place = centre + (lowest - centre @ up) * up
    edges = (8 * scene.volume.radius,) * 2
    return vtkmcvr.PlaneReceiver(tuple(place), tuple(up), edges, tuple(forward), colour=0.5)


def tiles(scene, n):
    """Square of 2 n n triangles in the place of the floor, 8 radii wide."""
    plane = floor(scene)
    up, right = np.array(scene.camera.frame[1]), scene.camera.frame[0]
    along = np.linspace(-4, 4, n + 1) * scene.volume.radius
    x, y = (grid.reshape(-1, 1) for grid in np.meshgrid(along, along))
    points = np.array(plane.centre) + x * right + y * np.cross(up, right)
    corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).reshape(-1, 1)
    triangles = corner + np.array([[0, 1, n + 2], [0, n + 2, n + 1]]).reshape(1, 6)
    return vtkmcvr.MeshReceiver(points, triangles.reshape(-1, 3), colour=0.5)
