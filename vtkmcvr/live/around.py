"""What stands around the volumes of a renderer, and who draws it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple, cast

from vtkmodules.vtkRenderingCore import vtkActor, vtkProp, vtkRenderer

from ..vtk_bridge.matrix import matrix_of
from ..vtk_bridge.props import identity, is_mesh, is_plain_surface, opaque_props, translucent_props


class Around(NamedTuple):
    """Props around the volumes.

    Attributes
    ----------
    traced : list of vtkActor
        Surfaces that are receivers of the scene.
    drawn : list of vtkProp
        Opaque, drawn by VTK.
    veils : list of vtkActor
        Translucent meshes: layers of the backdrop.
    over : list of vtkProp
        Translucent props whose layers cannot be read: VTK blends them over the volumes.
    """

    traced: list[vtkActor]
    drawn: list[vtkProp]
    veils: list[vtkActor]
    over: list[vtkProp]

    @property
    def backdrop(self) -> bool:
        """Whether there is any backdrop to look at."""
        return bool(self.drawn or self.veils)

    @property
    def hidden(self) -> list[vtkProp]:
        """What VTK does not draw, because it is in the picture of the volumes."""
        return [*self.traced, *self.veils]

    @property
    def limits(self) -> str:
        """What cannot be drawn as it should, in words."""
        if not self.over:
            return ""
        kinds = sorted({_kind(prop) for prop in self.over})
        return (
            f"translucent props of kind {', '.join(kinds)} are blended over the volumes, also "
            "where they lie behind: add their data as meshes of one block, or make them opaque"
        )


def around(renderer: vtkRenderer, trace: bool, apart_from: Sequence[vtkActor]) -> Around:
    """Visible props of a renderer but its volumes and some actors.

    Parameters
    ----------
    renderer : vtkRenderer
    trace : bool
        Whether plain surfaces are traced.
    apart_from : sequence of vtkActor
    """
    opaque = opaque_props(renderer, apart_from)
    translucent = translucent_props(renderer, apart_from)
    traced = [prop for prop in opaque if trace and is_plain_surface(prop)]
    veils = [prop for prop in translucent if is_mesh(prop)]
    return Around(
        cast(list[vtkActor], traced), [prop for prop in opaque if prop not in traced],
        cast(list[vtkActor], veils), [prop for prop in translucent if prop not in veils],
    )  # fmt: skip


def actor_key(actor: vtkActor) -> tuple[Any, ...]:
    """What an actor looks like, as values to compare; whether it is hidden is none of it."""
    mapper: Any = actor.GetMapper()
    if mapper.GetNumberOfInputConnections(0):
        mapper.GetInputAlgorithm().Update()
    data, texture = mapper.GetInput(), actor.GetTexture()
    return (
        identity(actor), identity(data), data.GetMTime(), actor.GetProperty().GetMTime(),
        mapper.GetMTime(), texture and (identity(texture), texture.GetMTime()),
        matrix_of(actor.GetMatrix()).tobytes(),
    )  # fmt: skip


def _kind(prop: vtkProp) -> str:
    mapper = prop.GetMapper() if isinstance(prop, vtkActor) else None
    return type(prop if mapper is None else mapper).__name__
