"""Objects that VTK objects are made of, of whose changes these send no event."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from vtkmodules.vtkCommonCore import vtkCollection, vtkObject
from vtkmodules.vtkRenderingCore import vtkActor, vtkRenderer, vtkVolume, vtkVolumeProperty
from vtkmodules.vtkRenderingVolume import vtkVolumeMapper

RGB_CHANNELS = 3
# Those that `vtkmcvr.labels` takes
MOST_LABELS = 65533


def members_of(owner: vtkObject, components: int) -> Iterator[vtkObject]:
    """Yield the members of an object, and theirs.

    Parameters
    ----------
    owner : vtkObject
    components : int
        Of the volumes that a property is for: it makes functions that it is asked for.
    """
    for kind, members in _MEMBERS.items():
        if isinstance(owner, kind):
            yield from members(owner, components)


def _items(collection: vtkCollection, components: int = 0) -> Iterator[vtkObject]:
    for index in range(collection.GetNumberOfItems()):
        yield collection.GetItemAsObject(index)


def _functions(look: vtkVolumeProperty, components: int) -> Iterator[vtkObject]:
    """Functions of a property: of its first components, and of labels."""
    for component in range(components):
        if component and not look.GetIndependentComponents():
            break
        if look.HasGradientOpacity(component):
            yield look.GetStoredGradientOpacity(component)
        table = look.GetTransferFunction2D(component)
        if table is not None:
            yield table
        yield look.GetScalarOpacity(component)
        if look.GetColorChannels(component) == RGB_CHANNELS:
            yield look.GetRGBTransferFunction(component)
        else:
            yield look.GetGrayTransferFunction(component)
    yield from _label_functions(look)


def _label_functions(look: vtkVolumeProperty) -> Iterator[vtkObject]:
    left = look.GetNumberOfLabels()
    for label in range(MOST_LABELS):
        if left <= 0:
            return
        found = [f for f in (look.GetLabelColor(label), look.GetLabelScalarOpacity(label)) if f]
        left -= bool(found)
        yield from found


def _of_volume(prop: vtkVolume, components: int) -> Iterator[vtkObject]:
    for part in (prop.GetProperty(), prop.GetMapper()):
        if part is not None:
            yield part
            yield from members_of(part, components)


def _surroundings(renderer: vtkRenderer, components: int) -> Iterator[vtkObject]:
    """Camera, lights and textures of a renderer."""
    if renderer.IsActiveCameraCreated():
        yield renderer.GetActiveCamera()
    yield renderer.GetLights()
    yield from _items(renderer.GetLights())
    for texture in (renderer.GetEnvironmentTexture(), renderer.GetBackgroundTexture()):
        if texture is not None:
            yield texture


def _cuts(mapper: vtkVolumeMapper, components: int) -> Iterator[vtkObject]:
    """Clipping planes and mask of a mapper."""
    planes = mapper.GetClippingPlanes()
    if planes is not None:
        yield planes
        yield from _items(planes)
    mask = getattr(mapper, "GetMaskInput", lambda: None)()
    if mask is not None:
        yield mask


_MEMBERS: dict[type, Callable[[Any, int], Iterator[vtkObject]]] = {
    vtkVolumeProperty: _functions,
    vtkVolumeMapper: _cuts,
    vtkVolume: _of_volume,
    vtkActor: lambda actor, components: iter((actor.GetProperty(),)),
    vtkRenderer: _surroundings,
    vtkCollection: _items,
}
