"""From stored DICOM pixels to values: rescaled, padding made transparent, in a compact type."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

import numpy as np

from .dicom_packed import stored_type
from .dicom_pixels import PLAIN_COLOURS, read_frames
from .errors import VolumeReadError
from .parallel import for_each

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from .dicom_headers import Frame
    from .options import ReadOptions

IDENTITY_RESCALE = (1.0, 0.0)
# Air, and the lowest value that scanners give it.
AIR_HU, LOWEST_HU = -1000.0, -1024.0
# Padding this close to the lowest value, as a share of the range, is left as it is.
NEAR_LOWEST = 0.01
Limits = tuple[float, float]


def check_rescale(frames: Sequence[Frame], label: str) -> None:
    """Refuse a rescale slope of 0.

    Raises
    ------
    VolumeReadError
        If a slope is 0.
    """
    if any(frame.rescale is not None and frame.rescale[0] == 0.0 for frame in frames):
        raise VolumeReadError(
            f"{label}: a rescale slope of 0 would give every pixel the same value; "
            "export the series again."
        )


def read_values(
    frames: Sequence[Frame], label: str, options: ReadOptions
) -> tuple[NDArray[Any], list[str]]:
    """Read slices as values.

    Parameters
    ----------
    frames : sequence of Frame
        Slices of one volume in their order, all of one size.
    label : str
        How to name the series in an error.
    options : ReadOptions
        Threads and progress.

    Returns
    -------
    values : ndarray, shape (slices, rows, columns) or (slices, rows, columns, components)
        slope x stored + intercept, each slice by its own, in int16 or uint16 where that is
        exact, else int32 or float32. Padding is the lowest value, in HU that of air.
    notes : list of str
        What was done to the values.

    Raises
    ------
    VolumeReadError
        If pixels are missing or cannot be decoded.
    """
    stack = _Stack(frames)
    read_frames(frames, label, options, stack.put)
    if stack.pixels is None:
        raise VolumeReadError(f"{label}: the series has no pixels; export it again.")
    rescales = [frame.rescale or IDENTITY_RESCALE for frame in frames]
    limits = [
        _rescaled(part, rescale)
        for part, rescale in zip(stack.limits, rescales, strict=True)
        if part is not None
    ]
    floor, noted = _floor(stack, rescales, limits)
    lowest = min([low for low, _ in limits] + ([] if floor is None else [floor]), default=0.0)
    highest = max((high for _, high in limits), default=0.0)
    values = _converted(stack, rescales, (lowest, highest), floor, options)
    if values.dtype != stack.pixels.dtype:
        noted.append(f"stored as {stack.pixels.dtype}, kept as {values.dtype}")
    return values, noted


class _Stack:
    """Stored pixels as they arrive from the decoding threads, with their extremes."""

    def __init__(self, frames: Sequence[Frame]):
        self.frames = frames
        self.pixels: NDArray[Any] | None = None
        self.limits: list[Limits | None] = [None] * len(frames)
        self.padded: list[NDArray[np.bool_] | None] = [None] * len(frames)
        self.lock = threading.Lock()
        header = frames[0].file
        if header.pixels.samples == 1 and header.pixels.photometric in PLAIN_COLOURS:
            kinds = {stored_type(frame.file) for frame in frames}
            shape = (len(frames), header.rows, header.columns)
            self.pixels = np.empty(shape, np.result_type(*kinds))

    def put(self, number: int, plane: NDArray[Any]) -> None:
        """Take one slice."""
        pixels = self._array_for(plane)
        pixels[number] = plane
        valid = self._without_padding(number, plane)
        if valid.size:
            self.limits[number] = float(valid.min()), float(valid.max())

    def _array_for(self, plane: NDArray[Any]) -> NDArray[Any]:
        """Return the array of all slices, whose form in part only the decoder knows."""
        with self.lock:
            unknown = self.pixels is None or (
                plane.dtype.kind == "f" and self.pixels.dtype.kind != "f"
            )
            if unknown:
                self.pixels = np.empty((len(self.frames), *plane.shape), plane.dtype)
            assert self.pixels is not None
            if plane.shape != self.pixels.shape[1:]:
                raise ValueError("the decoded pixels do not fit the header")
            return self.pixels

    def _without_padding(self, number: int, plane: NDArray[Any]) -> NDArray[Any]:
        header = self.frames[number].file
        if header.padding is None or plane.ndim != 2 or plane.dtype.kind == "f":
            finite = np.isfinite(plane) if plane.dtype.kind == "f" else None
            return plane if finite is None else plane[finite]
        first, last = sorted(_as_stored(value, plane.dtype) for value in header.padding)
        padded = (plane >= first) & (plane <= last)
        if not padded.any():
            return plane
        self.padded[number] = padded
        return plane[~padded]


def _as_stored(value: int, kind: np.dtype[Any]) -> int:
    """Return a padding value as the pixels show it; headers mix up signed and unsigned."""
    bits = 8 * kind.itemsize
    wrapped = value % (1 << bits)
    return wrapped - (1 << bits) if kind.kind == "i" and wrapped >= 1 << (bits - 1) else wrapped


def _rescaled(limits: Limits, rescale: tuple[float, float]) -> Limits:
    ends = sorted(rescale[0] * value + rescale[1] for value in limits)
    return ends[0], ends[1]


def _floor(
    stack: _Stack, rescales: list[tuple[float, float]], limits: list[Limits]
) -> tuple[float | None, list[str]]:
    """Return the value that padding gets, or None to leave it, and a note."""
    count = sum(int(padded.sum()) for padded in stack.padded if padded is not None)
    if not count or not limits:
        return None, []
    header = stack.frames[0].file
    assert header.padding is not None
    lowest, highest = min(low for low, _ in limits), max(high for _, high in limits)
    assert stack.pixels is not None
    stored = [_as_stored(value, stack.pixels.dtype) for value in header.padding]
    padding = _rescaled((min(stored), max(stored)), rescales[0])
    floor = lowest
    if header.modality == "CT" and rescales[0][1] < 0:
        floor = min(max(lowest, LOWEST_HU), AIR_HU)
    if abs(padding[0] - floor) <= NEAR_LOWEST * (highest - lowest) and padding[0] == padding[1]:
        return None, []
    return floor, [f"{count} padding voxels (value {padding[0]:g}) set to {floor:g}"]


def _converted(
    stack: _Stack, rescales: list[tuple[float, float]], limits: Limits, floor: float | None,
    options: ReadOptions,
) -> NDArray[Any]:  # fmt: skip
    pixels = stack.pixels
    assert pixels is not None
    if pixels.ndim == 4 or pixels.dtype.kind == "f":
        return pixels
    kind = _compact_type(pixels.dtype, rescales, limits)
    # Same width: whole steps can be added in place, and wrap around to the right value.
    whole = kind.kind in "iu" and all(slope == 1.0 for slope, _ in rescales)
    in_place = kind.itemsize == pixels.dtype.itemsize and whole
    values = pixels.view(kind) if in_place else np.empty(pixels.shape, kind)

    def convert(number: int) -> None:
        slope, intercept = rescales[number]
        if in_place and intercept:
            size = 1 << (8 * kind.itemsize)
            unsigned = values[number].view(f"u{kind.itemsize}")
            unsigned += unsigned.dtype.type(int(intercept) % size)
        elif not in_place:
            wide = np.int64 if whole else np.float64
            values[number] = pixels[number] * wide(slope) + wide(intercept)
        padded = stack.padded[number]
        if floor is not None and padded is not None:
            values[number][padded] = floor

    for_each(convert, range(len(pixels)), options, "rescaling")
    return values


def _compact_type(
    stored: np.dtype[Any], rescales: list[tuple[float, float]], limits: Limits
) -> np.dtype[Any]:
    if not all(slope.is_integer() and intercept.is_integer() for slope, intercept in rescales):
        return np.dtype(np.float32)
    kinds = [stored] if stored.itemsize == 1 else []
    for kind in (*kinds, np.dtype(np.int16), np.dtype(np.uint16), np.dtype(np.int32)):
        if np.iinfo(kind).min <= limits[0] and limits[1] <= np.iinfo(kind).max:
            return kind
    return np.dtype(np.float64 if stored.itemsize == 8 else np.float32)
