"""What all lights have in common."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from .. import checks

if TYPE_CHECKING:
    from ..camera import Camera

Vector = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Light:
    """Base of all lights.

    Attributes
    ----------
    quantity : str
        Name of the field that says how bright the light is.
    """

    quantity: ClassVar[str] = "radiance"
    # Which fields a rigid motion and a change of scale act on
    points: ClassVar[tuple[str, ...]] = ()
    directions: ClassVar[tuple[str, ...]] = ()
    lengths: ClassVar[tuple[str, ...]] = ()

    @property
    def brightness(self) -> Vector:
        """Value of the light's quantity, linear RGB."""
        return getattr(self, self.quantity)

    def with_brightness(self, colour: Any) -> Any:
        """Return the same light with another value of its quantity."""
        return replace(self, **{self.quantity: tuple(np.broadcast_to(colour, 3).tolist())})

    def moved(self, rotation: NDArray, offset: NDArray, scale: float = 1.0) -> Any:
        """Return the light at rotation (scale p) + offset.

        Radiance, irradiance and intensity stay as they are.
        """
        changes: dict[str, Any] = {}
        for name in self.points:
            changes[name] = tuple((rotation @ np.multiply(getattr(self, name), scale)) + offset)
        for name in self.directions:
            changes[name] = tuple((rotation @ getattr(self, name)).tolist())
        for name in self.lengths:
            value = getattr(self, name)
            scaled = np.multiply(value, scale).tolist()
            changes[name] = tuple(scaled) if isinstance(value, tuple) else scaled
        return replace(self, **changes)

    def seen_by(self, camera: Camera) -> Light:
        """Return the light in world coordinates; most are there already."""
        return self

    def _check(self, kind: Any, *names: str) -> None:
        """Replace fields by what a check makes of them."""
        for name in names:
            object.__setattr__(self, name, kind(f"light.{name}", getattr(self, name)))


def frame_along(normal: NDArray, up: Vector) -> tuple[NDArray, NDArray, NDArray]:
    """Right-handed unit vectors (right, up, normal); up as far as the normal leaves it."""
    upward = np.array(checks.direction("light.up", up))
    if abs(normal @ upward) > 1 - 1e-9:
        upward = np.eye(3)[int(np.argmin(np.abs(normal)))]
    right = np.cross(upward, normal)
    right /= np.linalg.norm(right)
    return right, np.cross(normal, right), normal
