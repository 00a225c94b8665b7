"""What reflects light: surfaces, phase function, order of scattering; nothing where none comes."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

from .. import packed
from ..effects import Effect
from ..scene import Scene
from .phase import pack_phase
from .receivers import glossy
from .transport import pack_scattering, scattering_effect
from .volume import PackedVolume, shared_phase

WHY = "no light to reflect"
SURFACES = ("surface shading", "specular coat")


class Scatterers(NamedTuple):
    """Packed parts that are of no use in the dark, and their effects."""

    volumes: list[PackedVolume]
    coated: bool
    phase: packed.Phase | None
    scattering: packed.Scattering | None
    effects: tuple[Effect, Effect]  # phase function, multiple scattering


def pack_scatterers(
    scene: Scene, volumes: list[PackedVolume], receivers: packed.Receivers | None, lit: bool
) -> Scatterers:
    """Pack them; `lit`: some light shines."""
    scattering = pack_scattering(scene)
    glows = any(v.transfer.emission is not None for v in volumes)
    reflects = lit or (scattering is not None and glows)
    if not reflects:
        volumes = [_unlit(volume, "normal" in scene.aovs) for volume in volumes]
    volumes, shapes = shared_phase(scene, volumes)
    phase, phase_effect = pack_phase(scene.phase, shapes)
    if reflects:
        coated = any(v.gloss is not None for v in volumes) or glossy(receivers)
        effects = phase_effect, scattering_effect(scattering)
        return Scatterers(volumes, coated, phase, scattering, effects)
    volumes = [replace(v, transfer=v.transfer._replace(phase=None)) for v in volumes]
    both = _off(phase_effect, ""), _off(scattering_effect(scattering), "")
    return Scatterers(volumes, False, None, None, both)


def _unlit(volume: PackedVolume, normals: bool) -> PackedVolume:
    """Return the volume without its surfaces; bare ones where somebody asks for normals."""
    transfer = volume.transfer._replace(specular=None, exponent=None)
    if normals:
        return replace(volume, transfer=transfer, gloss=None)
    effects = tuple(
        _off(effect, ": no gradients") if effect.name in SURFACES else effect
        for effect in volume.effects
    )
    return replace(volume, transfer=transfer, surface=None, gloss=None, effects=effects)


def _off(effect: Effect, consequence: str) -> Effect:
    return Effect(effect.name, False, WHY + consequence) if effect.on else effect
