"""VTK objects <-> parts of a scene. Needs VTK 9.2 or newer and NumPy, no PyVista."""

from __future__ import annotations

from .camera import camera_of, default_camera, vtk_camera_of
from .components import Look, looks_of
from .image import array_of_image, image_of_arrays, image_of_picture, image_of_radiance
from .lights import default_headlight, light_of, lights_of
from .matrix import matrix_of
from .property import phase_of, refuse_mapper_features, surface_of, transfer_of
from .volume import VolumeCache, volume_of

__all__ = [
    "Look",
    "VolumeCache",
    "array_of_image",
    "camera_of",
    "default_camera",
    "default_headlight",
    "image_of_arrays",
    "image_of_picture",
    "image_of_radiance",
    "light_of",
    "lights_of",
    "looks_of",
    "matrix_of",
    "phase_of",
    "refuse_mapper_features",
    "surface_of",
    "transfer_of",
    "volume_of",
    "vtk_camera_of",
]
