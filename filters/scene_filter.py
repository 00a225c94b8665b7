"""Base of filters that render a volume: the scene as parameters, the film as output."""

from __future__ import annotations

import dataclasses
from typing import Any, Self

from vtkmodules.vtkCommonCore import VTK_FLOAT
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkImageData, vtkPolyData
from vtkmodules.vtkRenderingCore import (
    vtkActor,
    vtkCamera,
    vtkLightCollection,
    vtkRenderer,
    vtkVolume,
    vtkVolumeProperty,
)
from vtkmodules.vtkRenderingVolume import vtkVolumeMapper

from vtkmcvr import checks
from vtkmcvr.layers import Layer
from vtkmcvr.lights import ConstantEnvironment, EnvironmentMap, Light
from vtkmcvr.phases import Phase
from vtkmcvr.receivers import Receiver
from vtkmcvr.scene import Camera, Lens, PixelFilter, Scene, Volume, known_aovs
from vtkmcvr.studio import Studio, studio_lights
from vtkmcvr.vtk_bridge.environment import Environment, environment_of_image
from vtkmcvr.vtk_bridge.layers import COLOURS, LayerReader
from vtkmcvr.vtk_bridge.lights import members
from vtkmcvr.vtk_bridge.mesh import MeshCache, look_of_actor
from vtkmcvr.vtk_bridge.property import one_phase_of
from vtkmcvr.vtk_bridge.scene import (
    camera_of,
    default_camera,
    default_headlight,
    lights_of,
    matrix_of,
)
from vtkmcvr.vtk_bridge.volume import scalars_of

from .base import WHOLE_EXTENT, ImageFilter
from .parameters import Parameter, one_of, optional, sequence_of
from .renderer_contents import fill, settings_of
from .scene_inputs import PORTS, Inputs

IDENTITY = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


def _film_size(value: Any) -> tuple[int, int]:
    width, height = value
    return checks.whole("film width", width, least=1), checks.whole("film height", height, least=1)


def _lights(value: Any) -> Any:
    return value if isinstance(value, vtkLightCollection) else members(value)


def _receivers(value: Any) -> tuple[Any, ...]:
    found = (value,) if isinstance(value, vtkPolyData | Receiver) else tuple(value)
    for item in found:
        one_of("each receiver", vtkPolyData, Receiver)(item)
    return found


class SceneFilter(ImageFilter):
    """Volumes -> film; a subclass renders the scene of its inputs.

    Input 0: vtkImageData, one for each volume; where they overlap, their extinctions add. Input 1,
    optional: mask or label map on the grid of the first volume, see `mask_type`. Input 2, optional:
    panorama of the light around, as `vtkHDRReader` gives it. Input 3, optional: vtkPolyData, opaque
    surfaces that receive and cast shadows.

    Parameters
    ----------
    **settings
        Parameters by name.
    """

    film_size = Parameter((800, 600), _film_size, "(width, height) in pixels.")
    scalars = Parameter(
        None, optional(one_of("scalars", str)), "Name of the array to render. None: the active one."
    )
    volume_property = Parameter(
        None, one_of("volume_property", vtkVolumeProperty),
        "vtkVolumeProperty: opacity, colour, shading. At first a new one, as VTK makes it.",
    )  # fmt: skip
    camera = Parameter(
        None, optional(one_of("camera", vtkCamera, Camera)),
        "vtkCamera or vtkmcvr.scene.Camera. None: all of the volume, seen along -z.",
    )  # fmt: skip
    lights = Parameter(
        None, optional(_lights),
        "vtkLightCollection or sequence of vtkLight or vtkmcvr.lights.Light. None: VTK's "
        "headlight, unless `ambient` or `environment` gives light.",
    )  # fmt: skip
    studio = Parameter(
        None, optional(one_of("studio", Studio)),
        "vtkmcvr.studio.Studio: key light, rim light and fill around the camera, instead of "
        "`lights`, or None.",
    )  # fmt: skip
    ambient = Parameter(
        (0.0, 0.0, 0.0), lambda v: checks.colour("ambient", v),
        "Radiance from every direction, a number or linear RGB, >= 0.",
    )  # fmt: skip
    environment = Parameter(
        None, optional(one_of("environment", EnvironmentMap)), "EnvironmentMap or None."
    )
    lens = Parameter(
        None, optional(one_of("lens", Lens)), "Lens for depth of field. None: a pinhole."
    )
    gradient_factor = Parameter(
        0.5, lambda v: checks.number("gradient_factor", v, least=0.0, most=1.0),
        "How much of the volume is surfaces where the property has shading on, [0, 1].",
    )  # fmt: skip
    scattering = Parameter(
        "single", lambda v: checks.choice("scattering", v, ("single", "multiple")),
        '"single": one scattering event between light and camera; "multiple": many.',
    )  # fmt: skip
    max_scatterings = Parameter(
        None, optional(lambda v: checks.whole("max_scatterings", v, least=1)),
        'Most events of "multiple", >= 1. None: no limit.',
    )  # fmt: skip
    mapper = Parameter(
        None, optional(one_of("mapper", vtkVolumeMapper)),
        "vtkVolumeMapper whose clipping planes, cropping regions and mask cut the volume, or None.",
    )  # fmt: skip
    props = Parameter(
        (), sequence_of("props", vtkVolume),
        "vtkVolume of each connection of port 0, instead of `volume_property` and `mapper`: its "
        "property, matrix, and the cuts and array of its mapper. Its mapper's input is not used.",
    )  # fmt: skip
    mask_type = Parameter(
        "auto", lambda v: checks.choice("mask_type", v, ("auto", "mask", "labels")),
        'What port 1 has: a "mask", or "labels" with the property\'s functions by label. "auto": '
        "labels where the property has such functions.",
    )  # fmt: skip
    colours = Parameter(
        "linear", lambda v: checks.choice("colours", v, COLOURS),
        'What the numbers of colours mean: "linear" reflectances, or "display": as seen on a '
        "display (sRGB), which gives them back as they look.",
    )  # fmt: skip
    actors = Parameter(
        (), sequence_of("actors", vtkActor),
        "vtkActor of each connection of port 3: its matrix, and the colour of its property.",
    )  # fmt: skip
    renderer = Parameter(
        None, optional(one_of("renderer", vtkRenderer)),
        "vtkRenderer that gives camera, lights and environment where `camera` and `lights` are "
        "None, or None.",
    )  # fmt: skip
    environment_visible = Parameter(
        False, bool, "Whether the environment is seen behind the volume."
    )
    receivers = Parameter(
        (), _receivers,
        "vtkPolyData, vtkmcvr.receivers.Receiver, or a sequence of them: opaque surfaces that "
        "receive and cast shadows.",
    )  # fmt: skip
    pixel_filter = Parameter(
        PixelFilter(), one_of("pixel_filter", PixelFilter), "Reconstruction filter of the film."
    )
    aovs = Parameter(
        (), known_aovs,
        'Some of "albedo" and "normal", which the film then records of first collisions.',
    )  # fmt: skip

    inputs = PORTS
    # What a filter of a renderer does with meshes, phase functions and colours
    takes_meshes = True
    scatters = True
    renderer_colours = "display"
    outputs = ("vtkImageData", "vtkTable")

    def __init__(self, **settings: Any) -> None:
        self._volumes: dict[int, LayerReader] = {}
        self._meshes = MeshCache()
        self._sky: tuple[Any, EnvironmentMap] | None = None
        self._environment = Environment()
        super().__init__(**{"volume_property": vtkVolumeProperty(), **settings})

    @classmethod
    def from_renderer(cls, renderer: vtkRenderer, **settings: Any) -> Self:
        """Filter of what a renderer shows: volumes, surfaces, camera, lights, environment.

        It is connected to what the mappers are, and follows edits of all these objects; for
        props that come or go make it anew. The film has the renderer's size and its colours are
        those of a display, unless `settings` say otherwise. The background is the tone mapping's:
        `ToneMapFilter.from_renderer`.

        Parameters
        ----------
        renderer : vtkRenderer
            With visible volumes. Of its meshes, surfaces of one opaque colour become receivers;
            others are left out, and the log says so.
        **settings
            Parameters by name.

        Raises
        ------
        ValueError
            Where it has no visible volume.
        TypeError
            For volumes of a kind that no scene has.
        """
        own = {"colours": cls.renderer_colours, **settings_of(renderer)}
        return fill(cls(**{**own, **settings}), renderer)

    def RequestInformation(self, request: Any, inputs: Any, outputs: Any) -> int:
        """Announce the film."""
        width, height = self.film_size
        info = outputs.GetInformationObject(0)
        info.Set(WHOLE_EXTENT, (0, width - 1, 0, height - 1, 0, 0), 6)
        info.Set(vtkDataObject.ORIGIN(), (0.0, 0.0, 0.0), 3)
        info.Set(vtkDataObject.SPACING(), (1.0, 1.0, 1.0), 3)
        info.Set(vtkDataObject.DIRECTION(), IDENTITY, 9)
        vtkDataObject.SetPointDataActiveScalarInfo(info, VTK_FLOAT, 4)
        return 1

    def scene(self, image: vtkImageData, *more: vtkImageData, **other: Any) -> Scene:
        """Scene of images, and of `mask`, `environment` and `meshes` of `Inputs`.

        Parts that are unchanged since the last call are the same objects.
        """
        return self.scene_of_inputs(Inputs((image, *more), **other))

    def scene_of_inputs(self, inputs: Inputs) -> Scene:
        """Return the scene of what arrives at the ports."""
        first, *others = self._layers(inputs)
        volume = first.volume
        camera = self._camera(volume)
        return Scene(
            volume,
            first.transfer,
            camera,
            self._scene_lights(volume, camera, inputs.environment),
            first.surface,
            self._phase(),
            scattering=self.scattering,
            max_scatterings=self.max_scatterings if self.scattering == "multiple" else None,
            environment_visible=self.environment_visible,
            size=self.film_size,
            pixel_filter=self.pixel_filter,
            aovs=self.aovs,
            receivers=self._receivers(inputs.meshes),
            layers=tuple(others),
            clip=first.clip, crop=first.crop, mask=first.mask, labels=first.labels,
        )  # fmt: skip

    def _phase(self) -> Phase:
        looks = [prop.GetProperty() for prop in self.props] or [self.volume_property]
        return one_phase_of(looks if self.scatters else looks[:1])

    def _layers(self, inputs: Inputs) -> list[Layer]:
        count = len(inputs.volumes)
        if self.props and len(self.props) != count:
            raise ValueError(
                f"props are one vtkVolume for each of {count} inputs, got {len(self.props)}"
            )
        self._volumes = {k: self._volumes.get(k) or LayerReader() for k in range(count)}
        found = [
            layer
            for index, image in enumerate(inputs.volumes)
            for layer in self._volumes[index].layers(
                image, **self._look(index), mask=None if index else inputs.mask,
                mask_type=self.mask_type, gradient_factor=self.gradient_factor,
                colours=self.colours,
            )
        ]  # fmt: skip
        self._dependencies.components(1 + len(found) - count)
        return found

    def _look(self, index: int) -> dict[str, Any]:
        """How the image of a connection looks, as `LayerReader.layers` takes it."""
        if not self.props:
            return {
                "volume_property": self.volume_property, "mapper": self.mapper,
                "scalars": self.scalars,
            }  # fmt: skip
        prop = self.props[index]
        mapper: Any = prop.GetMapper()
        return {
            "volume_property": prop.GetProperty(), "mapper": mapper,
            "matrix": matrix_of(prop.GetMatrix()),
            "scalars": self.scalars if mapper is None else scalars_of(mapper) or self.scalars,
        }  # fmt: skip

    def _camera(self, volume: Volume) -> Camera:
        width, height = self.film_size
        camera = self.camera
        if camera is None and self.renderer is not None and self.renderer.IsActiveCameraCreated():
            camera = self.renderer.GetActiveCamera()
        if isinstance(camera, vtkCamera):
            return camera_of(camera, self.lens, aspect=width / height)
        camera = camera or default_camera(volume, width / height)
        return camera if self.lens is None else dataclasses.replace(camera, lens=self.lens)

    def _receivers(self, meshes: tuple[vtkPolyData, ...]) -> tuple[Receiver, ...]:
        if self.actors and len(self.actors) != len(meshes):
            raise ValueError(
                f"actors are one vtkActor for each of {len(meshes)} meshes, got {len(self.actors)}"
            )
        looks = {index: look_of_actor(actor) for index, actor in enumerate(self.actors)}
        return self._meshes.receivers((*meshes, *self.receivers), looks)

    def _scene_lights(
        self, volume: Volume, camera: Camera, panorama: vtkImageData | None
    ) -> tuple[Light, ...]:
        if self.studio is not None:
            return studio_lights(self.studio, volume, camera)
        around: list[Light] = [ConstantEnvironment(self.ambient)] if any(self.ambient) else []
        sky = self._sky_of(panorama)
        if sky is not None:
            around.append(sky)
        if self.lights is not None:
            return (*lights_of(self.lights, camera), *around)
        if self.renderer is not None:
            around = [*lights_of(self.renderer.GetLights(), camera), *around]
        return tuple(around) or (default_headlight(camera),)

    def _sky_of(self, panorama: vtkImageData | None) -> EnvironmentMap | None:
        """Environment: the parameter's, that of port 2, or the renderer's."""
        if self.environment is not None:
            return self.environment
        if panorama is None:
            return None if self.renderer is None else self._environment.of(self.renderer)
        key = (panorama, panorama.GetMTime(), panorama.GetUpdateTime())
        if self._sky is None or self._sky[0] != key:
            self._sky = key, environment_of_image(panorama)
        return self._sky[1]
