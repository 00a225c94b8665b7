"""What a renderer shows -> connections and parameters of a filter that renders scenes."""

from __future__ import annotations

import logging
from typing import Any, TypeVar

from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkRenderingCore import vtkActor, vtkProp, vtkRenderer, vtkVolume
from vtkmodules.vtkRenderingVolume import vtkVolumeMapper

from vtkmcvr.vtk_bridge.props import (
    is_plain_surface,
    opaque_props,
    props_of,
    translucent_props,
    volumes_of,
)

from .scene_inputs import MESHES, VOLUME

logger = logging.getLogger("vtkmcvr")

Filter = TypeVar("Filter", bound=Any)


def settings_of(renderer: vtkRenderer) -> dict[str, Any]:
    """Parameters of a filter of a renderer, without what belongs to connections."""
    own: dict[str, Any] = {"renderer": renderer}
    size = renderer.GetSize()
    if all(size):
        own["film_size"] = tuple(size)
    if any(prop.IsA("vtkSkybox") and prop.GetVisibility() for prop in props_of(renderer)):
        own["environment_visible"] = True
    return own


def fill(algorithm: Filter, renderer: vtkRenderer) -> Filter:
    """Connect a filter to the mappers of a renderer's volumes and surfaces."""
    volumes = [_checked(volume) for volume in volumes_of(renderer)]
    if not volumes:
        raise ValueError("the renderer has no visible volume with a mapper: add a vtkVolume to it")
    for volume in volumes:
        algorithm.AddInputConnection(VOLUME, volume.GetMapper().GetInputConnection(0, 0))
    algorithm.props = tuple(volumes)
    surfaces, others = _surfaces(renderer, algorithm.takes_meshes)
    for actor in surfaces:
        algorithm.AddInputConnection(MESHES, actor.GetMapper().GetInputConnection(0, 0))
    algorithm.actors = tuple(surfaces)
    if others:
        logger.warning(
            "%s leaves out %d props of the renderer: it takes %s",
            type(algorithm).__name__, len(others),
            "opaque vtkPolyData surfaces of one colour" if algorithm.takes_meshes else "no meshes",
        )  # fmt: skip
    return algorithm


def _checked(volume: vtkVolume) -> vtkVolume:
    mapper: Any = volume.GetMapper()
    if volume.IsA("vtkMultiVolume"):
        raise TypeError(
            "a vtkMultiVolume is not supported: add each of its volumes to the renderer as a "
            "vtkVolume of its own"
        )
    if not isinstance(mapper, vtkVolumeMapper):
        raise TypeError(
            f"a volume is drawn by a vtkVolumeMapper of vtkImageData, got {mapper.GetClassName()}; "
            "resample it onto a regular grid first, for instance with vtkResampleToImage"
        )
    if not mapper.GetNumberOfInputConnections(0):
        raise ValueError(f"the {mapper.GetClassName()} of a volume has no input")
    return volume


def _surfaces(renderer: vtkRenderer, wanted: bool) -> tuple[list[Any], list[vtkProp]]:
    """Visible actors that can be traced, and the other props."""
    surfaces: list[Any] = []
    _update_actors(renderer)
    others = translucent_props(renderer)
    for prop in opaque_props(renderer):
        if prop.IsA("vtkSkybox"):
            continue
        plain = wanted and is_plain_surface(prop) and _polygons(prop)
        (surfaces if plain else others).append(prop)
    return surfaces, others


def _update_actors(renderer: vtkRenderer) -> None:
    """Let actors have their data, without which there is nothing to see of them."""
    for prop in props_of(renderer):
        mapper = prop.GetMapper() if isinstance(prop, vtkActor) else None
        if mapper is not None and mapper.GetNumberOfInputConnections(0):
            mapper.GetInputAlgorithm().Update()


def _polygons(prop: Any) -> bool:
    mapper = prop.GetMapper()
    connected = mapper.GetNumberOfInputConnections(0) > 0
    return connected and isinstance(mapper.GetInput(), vtkPolyData)
