"""Label maps to look at: organs as smooth solids in their colours, shown, hidden, highlighted."""

from __future__ import annotations

import fnmatch
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .curves import ColourCurve, Curve
from .labels import Labels, whole_numbers
from .layers import Layer
from .material import Surface, TransferFunction
from .pictures.display import srgb_decode
from .reading.colours import spread_colour
from .recorded_facts import Segment, segments
from .volume import Volume

if TYPE_CHECKING:
    from vtkmodules.vtkCommonDataModel import vtkImageData

# Standard deviation of the blur that takes the steps off voxels, in voxel edges; how far colours
# reach beyond their labels to cover what it adds, in voxels
BLUR, REACH = 0.8, 3
# Value that stands for inside, where the surface lies, and how steep it is
INSIDE = 255
EDGE = (80.0, 0.0), (160.0, 0.95)
# Opacity per voxel edge of what is shown beside a highlight, and how much of its colour is left
FAINT, PALE = 0.03, 0.35
# sRGB primaries become colours that a surface can have
DARKEST, BRIGHTEST = 0.03, 0.85
SOLID = Surface(1.0, specular=0.04, exponent=30.0)
CLEAR = TransferFunction(Curve(((0.0, 0.0),)), ColourCurve(((0.0, 0.0, 0.0, 0.0),)))

Chosen = Sequence[str | int]


@dataclass(frozen=True, eq=False)
class Segmentation:
    """Labels on a grid, and what of them is to be seen.

    Parameters
    ----------
    volume : Volume
        Whole numbers; 0 is no label. Beside another volume, on its grid.
    segments : sequence of Segment
        Names and sRGB colours; labels without one are named by their number.
    show : sequence of str or int
        Names, with * and ? for any letters, or numbers: these become smooth solids. Empty: all.
    hide : sequence of str or int
        These are left out, from the volume beside as well. With nothing to show or to highlight,
        the volume beside gets no solids.
    highlight : sequence of str or int
        These are solid, and all others that are shown are faint.
    """

    volume: Volume
    segments: tuple[Segment, ...] = ()
    show: Chosen = ()
    hide: Chosen = ()
    highlight: Chosen = ()
    names: dict[int, Segment] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        values = whole_numbers("labels", self.volume.values)
        object.__setattr__(self, "segments", tuple(self.segments))
        named = {segment.value: segment for segment in self.segments}
        present = [int(value) for value in np.unique(values) if value]
        names = {
            value: named.get(value) or Segment(value, str(value), spread_colour(value))
            for value in present
        }
        object.__setattr__(self, "names", names)
        for part in ("show", "hide", "highlight"):
            object.__setattr__(self, part, self._numbers(part, getattr(self, part)))

    @classmethod
    def of(cls, image: vtkImageData, **chosen: Any) -> Segmentation:
        """Return the segmentation of a label map, such as `vtkmcvr.read_labels` returns.

        Parameters
        ----------
        image : vtkImageData
        **chosen
            `show`, `hide` and `highlight`.
        """
        from .vtk_bridge.volume import volume_of

        return cls(volume_of(image), tuple(segments(image)), **chosen)

    def _numbers(self, part: str, chosen: Chosen | str | int) -> tuple[int, ...]:
        words: Iterable[str | int] = [chosen] if isinstance(chosen, str | int) else chosen
        found: dict[int, None] = {}
        for word in words:
            matching = [v for v, segment in self.names.items() if _matches(segment, word)]
            known = [s.value for s in self.segments if _matches(s, word)]
            if not matching and not known:
                raise ValueError(
                    f"{part}: no label is called {word!r}; there are {_listed(self.names)}"
                )
            found |= dict.fromkeys(matching)
        return tuple(found)

    @property
    def shown(self) -> tuple[int, ...]:
        """Labels that become solids."""
        chosen = (*self.show, *self.highlight) if self.show else tuple(self.names)
        return tuple(value for value in self.names if value in chosen and value not in self.hide)

    @property
    def only_hides(self) -> bool:
        """Whether it only takes labels away from the volume beside."""
        return bool(self.hide) and not (self.show or self.highlight)

    def solids(self) -> Layer:
        """Return the shown labels as a volume of smooth solids."""
        occupancy, values = solid_arrays(self.volume.values, self.shown)
        inside = Volume(occupancy, self.volume.index_to_world)
        edge = float(self.volume.spacing.min())
        transfers = {value: self._transfer(value, edge) for value in self.shown}
        return Layer(inside, CLEAR, SOLID, labels=Labels(values, transfers))

    def mask(self) -> NDArray[np.uint8]:
        """Mask of the volume beside: without labels that are hidden, or shown as solids."""
        return without(self.volume.values, self.gone)

    @property
    def gone(self) -> tuple[int, ...]:
        """Labels that the volume beside is shown without."""
        hidden = tuple(value for value in self.names if value in self.hide)
        return hidden if self.only_hides else tuple(dict.fromkeys((*hidden, *self.shown)))

    def _transfer(self, value: int, edge: float) -> TransferFunction:
        faint = bool(self.highlight) and value not in self.highlight
        colour = paint(self.names[value].colour)
        opacity: tuple[tuple[float, ...], ...] = EDGE
        if faint:
            colour = tuple(PALE * c + (1 - PALE) * 0.7 for c in colour)
            opacity = tuple((x, y * FAINT / EDGE[1][1]) for x, y in EDGE)
        return TransferFunction(Curve(opacity), ColourCurve(((0.0, *colour),)), edge)


def solid_arrays(labels: NDArray, shown: Chosen) -> tuple[NDArray[np.uint8], NDArray]:
    """Occupancy, 0 to 255, of labels that become solids; and the labels where it is not 0."""
    chosen = np.isin(labels, shown)
    return _blurred(chosen), _extended(np.where(chosen, labels, 0))


def without(labels: NDArray, gone: Chosen) -> NDArray[np.uint8]:
    """Mask that leaves labels out."""
    return (~np.isin(labels, gone)).astype(np.uint8)


def paint(colour: Sequence[float]) -> tuple[float, ...]:
    """Return the linear albedo of an sRGB colour, kept off black and off full saturation."""
    linear = srgb_decode(np.asarray(colour, np.float64))
    return tuple((DARKEST + (BRIGHTEST - DARKEST) * linear).tolist())


def _matches(segment: Segment, word: str | int) -> bool:
    if isinstance(word, int) or word.isdigit():
        return segment.value == int(word)
    return fnmatch.fnmatch(_plain(segment.name), _plain(word))


def _plain(name: str) -> str:
    return name.strip().lower().replace("_", " ")


def _listed(names: dict[int, Segment], most: int = 24) -> str:
    listed = [f"{value} {segment.name}" for value, segment in names.items()]
    more = f" and {len(listed) - most} more" if len(listed) > most else ""
    return ", ".join(listed[:most]) + more


def _blurred(shown: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """Occupancy, 0 to 255, blurred by about a voxel."""
    import SimpleITK

    image = SimpleITK.GetImageFromArray(shown.astype(np.float32) * INSIDE)
    # Recursive filters need a few voxels along each axis
    if min(shown.shape) >= 4:
        image = SimpleITK.SmoothingRecursiveGaussian(image, [BLUR] * 3)
    values = SimpleITK.GetArrayFromImage(image)
    return np.clip(np.rint(values), 0, INSIDE).astype(np.uint8)


def _extended(values: NDArray) -> NDArray:
    """Labels grown by a few voxels into where there is none."""
    grown = values.copy()
    for _ in range(REACH):
        empty = grown == 0
        for axis in range(3):
            for shift in (1, -1):
                beside = np.roll(grown, shift, axis)
                border = [slice(None)] * 3
                border[axis] = slice(0, 1) if shift == 1 else slice(-1, None)
                beside[tuple(border)] = 0
                fresh = empty & (beside != 0)
                grown = np.where(fresh, beside, grown)
                empty &= ~fresh
    return grown
