"""A renderer -> the scene that it shows, and values by which a change is noticed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from vtkmodules.vtkRenderingCore import vtkActor, vtkRenderer, vtkVolume

from ..backdrop import Backdrop
from ..camera import PixelFilter
from ..layers import Layer
from ..phases import Phase
from ..pictures.display import srgb_decode
from ..receivers import MeshReceiver
from ..scene import Scene
from ..vtk_bridge.mesh import mesh_of
from ..vtk_bridge.property import one_phase_of
from ..vtk_bridge.props import identity
from ..vtk_bridge.scene import camera_of, matrix_of
from .around import Around, actor_key
from .film_place import Place
from .lighting import Environment, lights_key, scene_lights
from .looks import VolumeLooks
from .settings import LiveSettings

# Each ray belongs to one pixel, as a sample of VTK's multisampling does
PIXEL = PixelFilter("box", 0.5)


def camera_key(renderer: vtkRenderer) -> tuple[Any, ...]:
    """View of a renderer as values to compare; the clipping range is none of it."""
    camera = renderer.GetActiveCamera()
    return (
        camera.GetPosition(), camera.GetFocalPoint(), camera.GetViewUp(), camera.GetViewAngle(),
        camera.GetParallelProjection(), camera.GetParallelScale(), camera.GetWindowCenter(),
        camera.GetUseHorizontalViewAngle(), camera.GetFocalDisk(), camera.GetFocalDistance(),
    )  # fmt: skip


class SceneReader:
    """Scenes of one renderer; parts that have not changed are the same objects again."""

    def __init__(self) -> None:
        self._looks: dict[str, VolumeLooks] = {}
        self._meshes: dict[str, tuple[Any, MeshReceiver]] = {}
        self._environment = Environment()

    def key(
        self, renderer: vtkRenderer, place: Place, volumes: Sequence[vtkVolume], props: Around
    ) -> tuple[Any, ...]:
        """Everything that decides the picture of a renderer, as values to compare."""
        looks = self._known(volumes)
        return (
            camera_key(renderer), place, renderer.GetRenderWindow().GetTileViewport(),
            tuple(looks[identity(v)].key(v) for v in volumes), lights_key(renderer),
            # Those that VTK does not draw are hidden for each frame, which counts as a change
            tuple(map(actor_key, props.traced)), tuple(map(actor_key, props.veils)),
            tuple((identity(p), p.GetMTime(), p.GetRedrawMTime()) for p in props.drawn),
        )  # fmt: skip

    def scene(
        self,
        renderer: vtkRenderer,
        size: tuple[int, int],
        volumes: Sequence[vtkVolume],
        surfaces: Sequence[vtkActor],
        backdrop: Backdrop | None,
        settings: LiveSettings,
    ) -> Scene:
        """Scene of a renderer.

        Parameters
        ----------
        renderer : vtkRenderer
        size : (width, height)
            Of the film, pixels.
        volumes : sequence of vtkVolume
            At least one.
        surfaces : sequence of vtkActor
            Traced as receivers.
        backdrop : Backdrop, optional
            What VTK draws.
        settings : LiveSettings

        Raises
        ------
        TypeError, ValueError
            Where VTK has something that a scene cannot express.
        """
        first, *others = self._layers(volumes, settings)
        camera = camera_of(
            renderer.GetActiveCamera(), settings.lens, aspect=renderer.GetTiledAspectRatio()
        )
        lights = scene_lights(renderer, camera, first.volume, settings.lighting, self._environment)
        return Scene(
            first.volume, first.transfer, camera, lights, first.surface,
            self._phase(volumes, settings), scattering=settings.scattering, size=size,
            pixel_filter=PIXEL, clip=first.clip, crop=first.crop, mask=first.mask,
            labels=first.labels, layers=tuple(others), backdrop=backdrop,
            receivers=self._receivers(surfaces),
        )  # fmt: skip

    @staticmethod
    def _phase(volumes: Sequence[vtkVolume], settings: LiveSettings) -> Phase:
        # Without noise there is none
        counted = volumes[:1] if settings.noiseless else volumes
        return one_phase_of([volume.GetProperty() for volume in counted])

    def _layers(self, volumes: Sequence[vtkVolume], settings: LiveSettings) -> list[Layer]:
        known = self._known(volumes)
        linear = settings.technique != "emission-absorption"
        return [
            layer
            for v in volumes
            for layer in known[identity(v)].layers(v, settings.gradient_factor, linear)
        ]

    def _known(self, volumes: Sequence[vtkVolume]) -> dict[str, VolumeLooks]:
        """What is known of each volume; others are forgotten."""
        self._looks = {identity(v): self._looks.get(identity(v)) or VolumeLooks() for v in volumes}
        return self._looks

    def _receivers(self, surfaces: Sequence[vtkActor]) -> tuple[MeshReceiver, ...]:
        known = {}
        for actor in surfaces:
            data = actor.GetMapper().GetInput()
            colour = actor.GetProperty().GetDiffuseColor()
            smooth = actor.GetProperty().GetInterpolation() > 0
            matrix = matrix_of(actor.GetMatrix())
            key = (identity(data), data.GetMTime(), colour, smooth, matrix.tobytes())
            old = self._meshes.get(identity(actor))
            if old is None or old[0] != key:
                linear = tuple(srgb_decode(np.array(colour)).tolist())
                mesh = mesh_of(data, user_matrix=matrix, smooth=smooth, colour=linear)
                old = (key, mesh)
            known[identity(actor)] = old
        self._meshes = known
        return tuple(mesh for _, mesh in known.values())
