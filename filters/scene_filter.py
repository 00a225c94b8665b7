"""Base of filters that render a volume: the scene as parameters, the film as output."""

from __future__ import annotations

import dataclasses
from typing import Any

from vtkmodules.vtkCommonCore import VTK_FLOAT
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkImageData, vtkPolyData
from vtkmodules.vtkRenderingCore import vtkCamera, vtkLightCollection, vtkVolumeProperty
from vtkmodules.vtkRenderingVolume import vtkVolumeMapper

from vtkmcvr import checks
from vtkmcvr.layers import Layer
from vtkmcvr.lights import ConstantEnvironment, EnvironmentMap, Light
from vtkmcvr.receivers import Receiver
from vtkmcvr.scene import Camera, Lens, PixelFilter, Scene, Volume, known_aovs
from vtkmcvr.vtk_cutting import clip_of, cropping_of
from vtkmcvr.vtk_labels import mask_of
from vtkmcvr.vtk_lights import members
from vtkmcvr.vtk_mesh import MeshCache
from vtkmcvr.vtk_scene import (
    VolumeCache,
    camera_of,
    default_camera,
    default_headlight,
    lights_of,
    looks_of,
    phase_of,
    refuse_mapper_features,
)

from .base import WHOLE_EXTENT, ImageFilter
from .parameters import Parameter, one_of, optional

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
    """Volume -> film; a subclass renders the `scene` of its input in `produce`.

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

    def __init__(self, **settings: Any) -> None:
        self._volumes = VolumeCache()
        self._meshes = MeshCache()
        super().__init__(**{"volume_property": vtkVolumeProperty(), **settings})

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

    def scene(self, image: vtkImageData) -> Scene:
        """Return the scene of an image; the same volume object while the image is unchanged."""
        look, *more = looks_of(
            image, self.volume_property, scalars=self.scalars,
            gradient_factor=self.gradient_factor, volume=self._volumes.volume,
        )  # fmt: skip
        volume = look.volume
        cuts = self._cuts(image, volume)
        width, height = self.film_size
        camera = self.camera or default_camera(volume, width / height)
        if isinstance(camera, vtkCamera):
            camera = camera_of(camera, self.lens, aspect=width / height)
        elif self.lens is not None:
            camera = dataclasses.replace(camera, lens=self.lens)
        return Scene(
            volume,
            look.transfer,
            camera,
            self._scene_lights(camera),
            look.surface,
            phase_of(self.volume_property),
            scattering=self.scattering,
            max_scatterings=self.max_scatterings if self.scattering == "multiple" else None,
            size=self.film_size,
            pixel_filter=self.pixel_filter,
            aovs=self.aovs,
            receivers=self._meshes.receivers(self.receivers),
            layers=tuple(
                Layer(other.volume, other.transfer, other.surface, **cuts) for other in more
            ),
            **cuts,
        )

    def _cuts(self, image: vtkImageData, volume: Volume) -> dict[str, Any]:
        """Fields of a scene that the mapper gives."""
        mapper = self.mapper
        if mapper is None:
            return {}
        refuse_mapper_features(mapper)
        mask, labels = mask_of(mapper, self.volume_property)
        return {
            "clip": clip_of(mapper), "crop": cropping_of(mapper, image, volume),
            "mask": mask, "labels": labels,
        }  # fmt: skip

    def _scene_lights(self, camera: Camera) -> tuple[Light, ...]:
        around: list[Light] = [ConstantEnvironment(self.ambient)] if any(self.ambient) else []
        if self.environment is not None:
            around.append(self.environment)
        if self.lights is not None:
            return (*lights_of(self.lights, camera), *around)
        return tuple(around) or (default_headlight(camera),)
