"""Which props of a renderer are volumes to be traced, and which stand around them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, cast

from vtkmodules.vtkCommonDataModel import vtkDataSet, vtkPolyData
from vtkmodules.vtkRenderingCore import (
    VTK_SURFACE,
    vtkActor,
    vtkProp,
    vtkProp3D,
    vtkRenderer,
    vtkVolume,
)

# Others, of glyphs, blocks or splats, draw what is not in their input
PLAIN_MAPPERS = ("vtkPolyDataMapper", "vtkOpenGLPolyDataMapper", "vtkDataSetMapper")


def identity(thing: Any) -> str:
    """Name of a VTK object, the same as long as it exists; Python's own may change."""
    return thing.__this__


def props_of(renderer: vtkRenderer) -> Iterator[vtkProp]:
    """View props of a renderer, in its order."""
    props = renderer.GetViewProps()
    for index in range(props.GetNumberOfItems()):
        yield cast(vtkProp, props.GetItemAsObject(index))


def volumes_of(renderer: vtkRenderer) -> list[vtkVolume]:
    """Visible volumes with a mapper."""
    return [
        prop
        for prop in props_of(renderer)
        if isinstance(prop, vtkVolume) and prop.GetVisibility() and prop.GetMapper() is not None
    ]


def opaque_props(renderer: vtkRenderer, apart_from: Sequence[Any] = ()) -> list[vtkProp]:
    """Visible props with opaque geometry, without volumes, overlays and some actors."""
    return [prop for prop in _drawn(renderer, apart_from) if prop.HasOpaqueGeometry()]


def translucent_props(renderer: vtkRenderer, apart_from: Sequence[Any] = ()) -> list[vtkProp]:
    """Visible props with translucent geometry, without volumes, overlays and some actors."""
    return [prop for prop in _drawn(renderer, apart_from) if prop.HasTranslucentPolygonalGeometry()]


def _drawn(renderer: vtkRenderer, apart_from: Sequence[Any] = ()) -> Iterator[vtkProp]:
    """Visible props in the world, without volumes and some actors."""
    for prop in props_of(renderer):
        if isinstance(prop, vtkProp3D) and not isinstance(prop, vtkVolume) and prop.GetVisibility():
            if prop not in apart_from:
                yield prop


def is_mesh(prop: vtkProp) -> bool:
    """Whether a prop is one data set of points and cells, as its own mapper draws it."""
    mapper = prop.GetMapper() if isinstance(prop, vtkActor) else None
    if mapper is None or mapper.GetClassName() not in PLAIN_MAPPERS:
        return False
    return isinstance(mapper.GetInput(), vtkDataSet)


def is_plain_surface(prop: vtkProp) -> bool:
    """Whether a prop is a surface of one colour, which can be traced."""
    if not isinstance(prop, vtkActor) or prop.GetMapper() is None:
        return False
    mapper, look = prop.GetMapper(), prop.GetProperty()
    data = mapper.GetInput()
    if not isinstance(data, vtkPolyData) or not data.GetNumberOfPolys() + data.GetNumberOfStrips():
        return False
    arrays = data.GetPointData().GetScalars() or data.GetCellData().GetScalars()
    coloured = mapper.GetScalarVisibility() and (arrays is not None or mapper.GetArrayName())
    textured = prop.GetTexture() is not None or look.GetNumberOfTextures()
    return look.GetRepresentation() == VTK_SURFACE and not coloured and not textured
