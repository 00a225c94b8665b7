"""Scenes that differ in one quantity: three apertures, 1 to 16 lights (as Fig. 11 of the paper)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ..camera import Lens
from ..lights import CameraLight, Light, RectangleLight, irradiance_at, with_irradiance
from ..scene import Scene
from .variants import OTHER, SKIES, Variant

APERTURES, LIGHTS = "aperture", "number of lights"
# Radii over the distance to the focal point
RADII = {"pinhole": 0.0, "medium aperture": 0.01, "large aperture": 0.04}
NUMBERS = (1, 2, 4, 8, 16)
# Distance of the lights, and the edge of one alone, over the radius of the volume
FAR, EDGE = 2.6, 1.2
GOLDEN_ANGLE = math.pi * (3 - math.sqrt(5))


def families(scene: Scene) -> list[Variant]:
    """All members of all families; each needs a reference of its own."""
    return [*apertures(scene), *numbers_of_lights(scene)]


def apertures(scene: Scene) -> Iterator[Variant]:
    """The scene through three apertures, focused on the focal point."""
    camera = scene.camera
    if camera.panorama or camera.parallel_scale is not None:
        return
    for name, share in RADII.items():
        lens = Lens(share * camera.distance) if share else None
        yield Variant(APERTURES, name, OTHER, replace(scene, camera=replace(camera, lens=lens)))


def numbers_of_lights(scene: Scene) -> Iterator[Variant]:
    """1 to 16 rectangles that give as much light together, beside the sky that the scene has."""
    skies = tuple(light for light in scene.lights if isinstance(light, SKIES))
    for number in NUMBERS:
        lit = replace(scene, lights=(*skies, *_panels(scene, number)))
        name = f"{number} light{'s' if number > 1 else ''}"
        yield Variant(LIGHTS, name, OTHER, lit)


def _panels(scene: Scene, number: int) -> list[Light]:
    """Rectangles in a spiral over the hemisphere around the camera, of equal share and total area.

    Together they give the irradiance that the scene's own lights beside its sky give, or pi.
    """
    right, up, forward = scene.camera.frame
    centre, radius = scene.volume.centre, scene.volume.radius
    others = [
        light.seen_by(scene.camera) if isinstance(light, CameraLight) else light
        for light in scene.lights
        if not isinstance(light, SKIES)
    ]
    total = np.sum([irradiance_at(light, centre) for light in others], axis=0)
    total = total if np.any(total) else np.full(3, math.pi)
    edge = EDGE * radius / math.sqrt(number)
    panels: list[Light] = []
    for i in range(number):
        depth = 1 - (i + 0.5) / number
        across, angle = math.sqrt(1 - depth**2), i * GOLDEN_ANGLE + 2.0
        way = across * (math.cos(angle) * right + math.sin(angle) * up) - depth * forward
        panel = RectangleLight(tuple(centre + FAR * radius * way), tuple(centre), (edge, edge))
        panels.append(with_irradiance(panel, total / number, centre))
    return panels
