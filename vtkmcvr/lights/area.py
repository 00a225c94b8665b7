"""Lights with a surface. They block light, also with their dark side."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from .. import checks
from .base import Light, Vector, frame_along
from .patch import Patch
from .texture import Texture


@dataclass(frozen=True)
class AreaLight(Light):
    """Base of the lights with a surface.

    Every one has these parameters too.

    Parameters
    ----------
    radiance : colour
        Radiance of the emitting side.
    two_sided : bool
        Both sides emit; else the one that faces the target, of closed surfaces the outer one.
    visible : bool
        Camera rays see it.
    texture : Texture, optional
        Multiplies the radiance.
    """

    @property
    def patches(self) -> tuple[Patch, ...]:
        """Canonical surfaces that the light consists of."""
        raise NotImplementedError

    @property
    def area(self) -> float:
        """Area of the emitting surface, both sides where both emit."""
        sides = 2 if getattr(self, "two_sided") else 1  # noqa: B009 - a field of the subclasses
        return sides * sum(patch.area for patch in self.patches)

    def _check_emission(self) -> None:
        self._check(checks.colour, "radiance")
        texture = getattr(self, "texture")  # noqa: B009 - a field of the subclasses
        if texture is not None and not isinstance(texture, Texture):
            raise ValueError(f"light.texture must be a Texture, got {texture!r}")

    def _check_target(self) -> None:
        self._check(checks.vector, "centre", "target")
        self._check(checks.direction, "up")
        checks.direction("light.target - light.centre", self._toward())

    def _toward(self) -> Any:
        fields = vars(self)
        return np.subtract(fields["target"], fields["centre"])

    @property
    def frame(self) -> tuple[NDArray, NDArray, NDArray]:
        """Unit vectors (along the width, along the height, normal)."""
        return frame_along(np.array(checks.direction("n", self._toward())), vars(self)["up"])


@dataclass(frozen=True)
class RectangleLight(AreaLight):
    """Rectangle that emits evenly from the side that faces its target.

    Parameters
    ----------
    centre, target : 3 floats
        World coordinates; the normal points from centre to target.
    size : (width, height)
        World units, > 0.
    radiance, two_sided, visible, texture
        See `AreaLight`. The texture has its top row at the upper edge, seen from the front.
    up : 3 floats
        Direction of the height, as far as the normal leaves it.
    """

    centre: Vector
    target: Vector
    size: tuple[float, float]
    radiance: Vector | float = (1.0, 1.0, 1.0)
    up: Vector = (0.0, 0.0, 1.0)
    two_sided: bool = False
    visible: bool = False
    texture: Texture | None = None

    points: ClassVar = ("centre", "target")
    directions: ClassVar = ("up",)
    lengths: ClassVar = ("size",)

    def __post_init__(self) -> None:
        self._check_target()
        self._check_emission()
        for name, value in zip(("width", "height"), self.size, strict=True):
            checks.number(f"light {name}", value, above=0.0)

    @property
    def patches(self) -> tuple[Patch, ...]:
        """One rectangle."""
        half = (self.size[0] / 2, self.size[1] / 2, 0.0)
        return (Patch("rectangle", np.array(self.centre), np.array(self.frame), half),)


@dataclass(frozen=True)
class DiskLight(AreaLight):
    """Disk, or ring, that emits evenly from the side that faces its target.

    Parameters
    ----------
    centre, target : 3 floats
        World coordinates; the normal points from centre to target.
    radius : float
        World units, > 0.
    radiance, two_sided, visible, texture
        See `AreaLight`. The texture covers the square around the disk, top row up.
    inner_radius : float
        Radius of the hole of a ring, >= 0 and below `radius`.
    up : 3 floats
        Upper side of the texture.
    """

    centre: Vector
    target: Vector
    radius: float
    radiance: Vector | float = (1.0, 1.0, 1.0)
    inner_radius: float = 0.0
    up: Vector = (0.0, 0.0, 1.0)
    two_sided: bool = False
    visible: bool = False
    texture: Texture | None = None

    points: ClassVar = ("centre", "target")
    directions: ClassVar = ("up",)
    lengths: ClassVar = ("radius", "inner_radius")

    def __post_init__(self) -> None:
        self._check_target()
        self._check_emission()
        checks.number("light.radius", self.radius, above=0.0)
        checks.number("light.inner_radius", self.inner_radius, least=0.0)
        if self.inner_radius >= self.radius:
            raise ValueError(
                f"light.inner_radius must be below light.radius = {self.radius:g}, "
                f"got {self.inner_radius:g}"
            )

    @property
    def patches(self) -> tuple[Patch, ...]:
        """One disk."""
        size = (self.radius, self.inner_radius, 0.0)
        return (Patch("disk", np.array(self.centre), np.array(self.frame), size),)


@dataclass(frozen=True)
class SphereLight(AreaLight):
    """Sphere that emits evenly; two-sided, it also lights what is inside.

    Parameters
    ----------
    centre : 3 floats
        World coordinates.
    radius : float
        World units, > 0.
    radiance, two_sided, visible, texture
        See `AreaLight`. The texture is in latitude-longitude form, top row toward `up`.
    up : 3 floats
        Upper pole of the texture.
    """

    centre: Vector
    radius: float
    radiance: Vector | float = (1.0, 1.0, 1.0)
    up: Vector = (0.0, 0.0, 1.0)
    two_sided: bool = False
    visible: bool = False
    texture: Texture | None = None

    points: ClassVar = ("centre",)
    directions: ClassVar = ("up",)
    lengths: ClassVar = ("radius",)

    def __post_init__(self) -> None:
        self._check(checks.vector, "centre")
        self._check(checks.direction, "up")
        self._check_emission()
        checks.number("light.radius", self.radius, above=0.0)

    @property
    def frame(self) -> tuple[NDArray, NDArray, NDArray]:
        """Right-handed unit vectors, the last one toward the upper pole."""
        return frame_along(np.array(self.up), (0.0, 1.0, 0.0))

    @property
    def patches(self) -> tuple[Patch, ...]:
        """One sphere."""
        size = (self.radius, 0.0, 0.0)
        return (Patch("sphere", np.array(self.centre), np.array(self.frame), size),)


@dataclass(frozen=True)
class BoxLight(AreaLight):
    """Box whose six faces emit evenly.

    Parameters
    ----------
    centre : 3 floats
        World coordinates.
    size : 3 floats
        Edge lengths along the box's axes, world units, > 0.
    radiance, two_sided, visible, texture
        See `AreaLight`. Each face shows the whole texture.
    axis, up : 3 floats
        Directions of the third axis, and of the second as far as the third leaves it.
    """

    centre: Vector
    size: Vector
    radiance: Vector | float = (1.0, 1.0, 1.0)
    axis: Vector = (0.0, 0.0, 1.0)
    up: Vector = (0.0, 1.0, 0.0)
    two_sided: bool = False
    visible: bool = False
    texture: Texture | None = None

    points: ClassVar = ("centre",)
    directions: ClassVar = ("axis", "up")
    lengths: ClassVar = ("size",)

    def __post_init__(self) -> None:
        self._check(checks.vector, "centre", "size")
        self._check(checks.direction, "axis", "up")
        self._check_emission()
        for name, value in zip("xyz", self.size, strict=True):
            checks.number(f"light size along {name}", value, above=0.0)

    @property
    def frame(self) -> tuple[NDArray, NDArray, NDArray]:
        """Unit vectors along the box's axes."""
        return frame_along(np.array(self.axis), self.up)

    @property
    def patches(self) -> tuple[Patch, ...]:
        """Six rectangles that look outward."""
        axes, half = np.array(self.frame), np.array(self.size) / 2
        faces = []
        for k in range(3):
            for side in (-1.0, 1.0):
                u, v = (k + 1) % 3, (k + 2) % 3
                frame = np.array([axes[u], side * axes[v], side * axes[k]])
                middle = np.array(self.centre) + side * half[k] * axes[k]
                faces.append(
                    Patch("rectangle", middle, frame, (float(half[u]), float(half[v]), 0.0))
                )
        return tuple(faces)


@dataclass(frozen=True)
class CylinderLight(AreaLight):
    """Tube that emits evenly.

    Parameters
    ----------
    start, end : 3 floats
        Ends of its axis, world coordinates.
    radius : float
        World units, > 0.
    radiance, two_sided, visible, texture
        See `AreaLight`. The texture goes around the tube, top row at `end`; caps show all of it.
    capped : bool
        Disks that emit outward close the ends.
    """

    start: Vector
    end: Vector
    radius: float
    radiance: Vector | float = (1.0, 1.0, 1.0)
    capped: bool = False
    two_sided: bool = False
    visible: bool = False
    texture: Texture | None = None

    points: ClassVar = ("start", "end")
    lengths: ClassVar = ("radius",)

    def __post_init__(self) -> None:
        self._check(checks.vector, "start", "end")
        self._check_emission()
        checks.number("light.radius", self.radius, above=0.0)
        checks.direction("light.end - light.start", np.subtract(self.end, self.start))

    @property
    def frame(self) -> tuple[NDArray, NDArray, NDArray]:
        """Right-handed unit vectors, the last one from start to end."""
        along = np.subtract(self.end, self.start)
        return frame_along(np.array(checks.direction("axis", along)), (0.0, 1.0, 0.0))

    @property
    def patches(self) -> tuple[Patch, ...]:
        """One tube, and its caps."""
        axes, start, end = np.array(self.frame), np.array(self.start), np.array(self.end)
        half = float(np.linalg.norm(end - start)) / 2
        tube = Patch("cylinder", (start + end) / 2, axes, (self.radius, 0.0, half))
        if not self.capped:
            return (tube,)
        size, turned = (self.radius, 0.0, 0.0), axes * [[1.0], [-1.0], [-1.0]]
        return tube, Patch("disk", start, turned, size), Patch("disk", end, axes, size)
