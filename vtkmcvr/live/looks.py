"""What a vtkVolume is made of -> volumes, looks and cuts, kept while nothing in VTK has changed."""

from __future__ import annotations

from typing import Any

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkRenderingCore import vtkVolume

from ..layers import Layer
from ..scene import Volume
from ..vtk_bridge.colours import in_linear_light, linear_labels
from ..vtk_bridge.cutting import clip_of, cropping_of
from ..vtk_bridge.labels import LabelTimes, MaskCache, mask_of
from ..vtk_bridge.props import identity
from ..vtk_bridge.scene import Look, VolumeCache, looks_of, matrix_of, refuse_mapper_features
from ..vtk_bridge.volume import check_image
from ..vtk_bridge.volume import scalars_of as array_name_of


class VolumeLooks:
    """The layers of one vtkVolume; the same objects while what they come from is unchanged."""

    def __init__(self) -> None:
        self._volumes, self._masks, self._labels = VolumeCache(), MaskCache(), LabelTimes()
        self._looks: tuple[Look, ...] = ()
        self._layers: tuple[Layer, ...] = ()
        self._look_key: tuple[Any, ...] | None = None
        self._key: tuple[Any, ...] | None = None

    def layers(
        self, prop: vtkVolume, gradient_factor: float, linear: bool = True
    ) -> tuple[Layer, ...]:
        """Layers of a vtkVolume, one for each of its independent components.

        Parameters
        ----------
        prop : vtkVolume
        gradient_factor : float
            Of surfaces, where the property has shading on.
        linear : bool
            Whether colours are those of reflectances in linear light, or as VTK displays them.

        Raises
        ------
        TypeError, ValueError
            Where its data, functions or mapper are of a kind that is not supported.
        """
        key = (*self.key(prop), gradient_factor, linear)
        if key != self._key:
            self._layers = self._translated(prop, gradient_factor, linear)
            # Asking for functions that were never set makes them, which counts as a change
            self._key = (*self.key(prop), gradient_factor, linear)
        return self._layers

    def key(self, prop: vtkVolume) -> tuple[Any, ...]:
        """Everything about a vtkVolume that decides its picture, as values to compare."""
        return *volume_key(prop), self._labels.of(prop.GetProperty())

    def _translated(
        self, prop: vtkVolume, gradient_factor: float, linear: bool
    ) -> tuple[Layer, ...]:
        mapper, image = mapper_of(prop), image_of(prop)
        refuse_mapper_features(mapper)
        cuts = {"clip": clip_of(mapper)}
        mask, labels = mask_of(mapper, prop.GetProperty(), self._masks)
        if linear and labels is not None:
            labels = linear_labels(labels)
        looks = self._placed_looks(prop, image, gradient_factor, linear)
        return tuple(
            Layer(
                look.volume, look.transfer, look.surface, mask=mask, labels=labels,
                crop=cropping_of(mapper, image, look.volume), **cuts,
            )
            for look in looks
        )  # fmt: skip

    def _placed_looks(
        self, prop: vtkVolume, image: vtkImageData, gradient_factor: float, linear: bool
    ) -> tuple[Look, ...]:
        how = (gradient_factor, linear)
        key = (image, image.GetMTime(), look_time(prop), matrix_key(prop), *how)
        if key != self._look_key:
            looks = looks_of(
                image, prop.GetProperty(), scalars=scalars_of(prop),
                gradient_factor=gradient_factor, volume=self._volumes.volume,
            )  # fmt: skip
            matrix = matrix_of(prop.GetMatrix())
            self._looks = tuple(
                _placed(in_linear_light(look) if linear else look, matrix) for look in looks
            )
            # Reading a look may have made functions that were never set
            self._look_key = (image, image.GetMTime(), look_time(prop), matrix_key(prop), *how)
        return self._looks


def volume_key(prop: vtkVolume) -> tuple[Any, ...]:
    """Everything about a vtkVolume but functions of labels, as values to compare."""
    mapper, image = mapper_of(prop), image_of(prop)
    mask = getattr(mapper, "GetMaskInput", lambda: None)()
    crop = (mapper.GetCroppingRegionPlanes(), mapper.GetCroppingRegionFlags())
    return (
        identity(prop), identity(image), image.GetMTime(), scalars_of(prop), look_time(prop),
        matrix_key(prop), mapper.GetBlendMode(), mapper.GetCropping() and crop, plane_key(mapper),
        mask and (identity(mask), mask.GetMTime(), mapper.GetMaskType()),
    )  # fmt: skip


def mapper_of(prop: vtkVolume) -> Any:
    """Mapper of a volume: a vtkVolumeMapper, or another one that `check_image` will refuse."""
    return prop.GetMapper()


def image_of(prop: vtkVolume) -> vtkImageData:
    """Up-to-date image of a volume; a TypeError that says what to do for any other data."""
    mapper = mapper_of(prop)
    if mapper.GetNumberOfInputConnections(0):
        mapper.GetInputAlgorithm().Update()
    image = mapper.GetDataSetInput() if hasattr(mapper, "GetDataSetInput") else mapper.GetInput()
    check_image(image)
    return image


def scalars_of(prop: vtkVolume) -> str | None:
    """Name of the array that the mapper takes; None: the active one."""
    return array_name_of(mapper_of(prop))


def look_time(prop: vtkVolume) -> int:
    """Time at which the property or one of its functions has changed."""
    own = prop.GetProperty()
    times = [own.GetMTime()]
    if own.GetTransferFunctionMode() == 1 and own.GetTransferFunction2D() is not None:
        times.append(own.GetTransferFunction2D().GetMTime())
    return max(times)


def matrix_key(prop: vtkVolume) -> bytes:
    """Place of the volume in the world."""
    return matrix_of(prop.GetMatrix()).tobytes()


def plane_key(mapper: Any) -> tuple[Any, ...]:
    """Clipping planes of a mapper."""
    planes = mapper.GetClippingPlanes()
    if planes is None:
        return ()
    items = [planes.GetItem(i) for i in range(planes.GetNumberOfItems())]
    return tuple((p.GetOrigin(), p.GetNormal()) for p in items)


def _placed(look: Look, matrix: np.ndarray) -> Look:
    if np.array_equal(matrix, np.eye(4)):
        return look
    volume = look.volume
    moved = Volume(volume.values, matrix @ volume.index_to_world, volume.colours)
    return look._replace(volume=moved)
