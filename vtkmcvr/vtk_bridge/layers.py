"""Image, property, mapper and place of one volume -> layers of a scene."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkRenderingCore import vtkVolumeProperty
from vtkmodules.vtkRenderingVolume import vtkVolumeMapper

from ..layers import Layer
from ..pictures.display import srgb_decode
from ..scene import Volume
from .colours import linear_labels, linear_transfer
from .components import looks_of
from .cutting import clip_of, cropping_of
from .labels import MaskCache, mask_of
from .property import refuse_mapper_features
from .volume import VolumeCache

COLOURS = ("linear", "display")


class LayerReader:
    """Layers of one volume; `Volume` and mask are the same objects while they are unchanged."""

    def __init__(self) -> None:
        self._volumes = VolumeCache()
        self._masks = MaskCache()
        self._placed: dict[int, tuple[Volume, bytes, Volume]] = {}

    def layers(
        self,
        image: vtkImageData,
        volume_property: vtkVolumeProperty,
        mapper: vtkVolumeMapper | None = None,
        *,
        matrix: NDArray[np.float64] | None = None,
        mask: vtkImageData | None = None,
        mask_type: str = "auto",
        scalars: str | None = None,
        gradient_factor: float = 0.5,
        colours: str = "linear",
    ) -> tuple[Layer, ...]:
        """Layers of a volume, one for each of its independent components.

        Parameters
        ----------
        image, volume_property
        mapper : vtkVolumeMapper, optional
            Its clipping planes, cropping regions and mask cut the volume.
        matrix : array (4, 4), optional
            Applied after the image's own map.
        mask : vtkImageData, optional
            Instead of the mapper's.
        mask_type : {"auto", "mask", "labels"}
            Of `mask`, see `MaskCache.mask`.
        scalars : str, optional
            Name of the array.
        gradient_factor : float
            Of surfaces, see `surface_of`.
        colours : {"linear", "display"}
            What numbers of colours are: reflectances, or what a display shows, which are decoded.

        Raises
        ------
        TypeError, ValueError
            Where there is something that a scene cannot express.
        """
        looks = looks_of(
            image, volume_property, scalars=scalars, gradient_factor=gradient_factor,
            volume=self._volumes.volume,
        )  # fmt: skip
        decoded = colours == "display"
        placed = self._place([look.volume for look in looks], matrix, decoded)
        cuts = self._cuts(mapper, volume_property, mask, mask_type)
        if decoded and cuts["labels"] is not None:
            cuts["labels"] = linear_labels(cuts["labels"])
        return tuple(
            Layer(
                volume, linear_transfer(look.transfer) if decoded else look.transfer, look.surface,
                crop=None if mapper is None else cropping_of(mapper, image, look.volume), **cuts,
            )
            for look, volume in zip(looks, placed, strict=True)
        )  # fmt: skip

    def _cuts(
        self,
        mapper: vtkVolumeMapper | None,
        volume_property: vtkVolumeProperty,
        image: vtkImageData | None,
        kind: str,
    ) -> dict[str, Any]:
        clip: tuple[Any, ...] = ()
        mask = labels = None
        if mapper is not None:
            refuse_mapper_features(mapper)
            clip = clip_of(mapper)
        if image is not None:
            mask, labels = self._masks.mask(image, volume_property, kind)
        elif mapper is not None:
            mask, labels = mask_of(mapper, volume_property, self._masks)
        return {"clip": clip, "mask": mask, "labels": labels}

    def _place(
        self, volumes: list[Volume], matrix: NDArray[np.float64] | None, decoded: bool
    ) -> list[Volume]:
        """Volumes where the matrix puts them, with linear colours; those of the last call again."""
        turn = np.eye(4) if matrix is None else matrix
        key = turn.tobytes() + bytes([decoded])
        known = {}
        for volume in volumes:
            old = self._placed.get(id(volume))
            if old is None or old[0] is not volume or old[1] != key:
                old = (volume, key, _placed(volume, turn, decoded))
            known[id(volume)] = old
        self._placed = known
        return [found for _, _, found in known.values()]


def _placed(volume: Volume, matrix: NDArray[np.float64], decoded: bool) -> Volume:
    colours = volume.colours
    in_bytes = decoded and colours is not None and colours.dtype == np.uint8
    if not in_bytes and np.array_equal(matrix, np.eye(4)):
        return volume
    if in_bytes:
        assert colours is not None
        colours = srgb_decode(colours.astype(np.float32) / 255)
    return Volume(volume.values, matrix @ volume.index_to_world, colours)
