"""What every picture can do, whatever it was made by: be displayed, converted and saved."""

from __future__ import annotations

import os
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self, cast

import numpy as np
from numpy.typing import NDArray

from ..screen import Display
from . import files as picture_files

if TYPE_CHECKING:
    import pyvista

    from .noiseless import NoiselessPicture
    from .picture import Picture

SUFFIXES = (".png", ".exr", ".npz", ".vti")


class Displayed:
    """A picture under a display; subclasses are dataclasses and say what is in it."""

    display: Display

    def show(self, display: Display, bits: int = 8) -> NDArray[Any]:
        """Display picture under another display, (H, W, 4), uint8, or uint16 for 16 bits."""
        raise NotImplementedError

    def arrays(self) -> dict[str, NDArray]:
        """All arrays by public name."""
        raise NotImplementedError

    def saved_recipe(self) -> dict[str, Any]:
        """What a file of it says about how it was made."""
        raise NotImplementedError

    @property
    def rgba(self) -> NDArray[np.uint8]:
        """Display picture, (H, W, 4): tone-mapped sRGB with straight alpha."""
        return self.show(self.display)

    def with_display(self, display: Display | None = None, **changes: Any) -> Self:
        """The same film under another display, or with parts of it changed; traces no ray.

        Examples
        --------
        >>> brighter = picture.with_display(exposure=1.0)
        """
        return replace(cast(Any, self), display=replace(display or self.display, **changes))

    def to_pyvista(self) -> pyvista.ImageData:
        """Image of W x H x 1 points with all arrays; `rgba` is active."""
        from ..pyvista_hooks.convert import to_pyvista

        return to_pyvista(cast("Picture | NoiselessPicture", self))

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        """Return `rgba`, for NumPy."""
        return np.asarray(self.rgba, dtype)

    def save(self, path: str | os.PathLike, *, bits: int = 8) -> Path:
        """Write .png (display picture) or .exr, .npz, .vti (float radiance and AOVs).

        Each holds the recipe, which `vtkmcvr.replay` reads. Radiance is linear and premultiplied by
        alpha, as EXR has it; a PNG has straight alpha, see `vtkmcvr.pictures.display.to_rgba8`.

        Parameters
        ----------
        path : path-like
        bits : {8, 16}
            Of a .png.
        """
        target = check_suffix(path)
        suffix = target.suffix.lower()
        if bits != 8 and suffix != ".png":
            raise ValueError(f"bits is for .png; {target.name} has floats")
        recipe = self.saved_recipe()
        if suffix == ".png":
            text = {picture_files.RECIPE: picture_files.recipe_json(recipe)}
            picture_files.write_png(target, self.show(self.display, bits), text)
        elif suffix == ".npz":
            picture_files.write_npz(target, self.arrays(), recipe)
        elif suffix == ".vti":
            picture_files.write_vti(target, self.arrays(), recipe)
        else:
            planes = {name: array for name, array in self.arrays().items() if name != "rgba"}
            picture_files.write_exr(target, planes, recipe)
        return target

    def _repr_png_(self) -> bytes:
        """Show itself in a notebook."""
        with tempfile.TemporaryDirectory() as folder:
            return self.save(Path(folder) / "picture.png").read_bytes()


def check_suffix(path: str | os.PathLike) -> Path:
    """Path to save a picture to, or a ValueError that lists the file types."""
    target = Path(path)
    if target.suffix.lower() not in SUFFIXES:
        raise ValueError(f"a picture is saved as {', '.join(SUFFIXES)}; got {target.name!r}")
    return target
