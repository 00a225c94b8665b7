"""A study's files: `cost.json`, and the reference and maps of errors beside it."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..safe_files import replacing
from .ladder import Reference

RESULTS, REFERENCE, ERRORS = "cost.json", "reference.npz", "errors"
# Pixels along an edge of a stored map of errors, at most
MAP = 240
# Error that float16 holds
LARGEST = 6e4


def load_results(folder: Path | None) -> dict[str, Any] | None:
    """Results of an earlier run, or None."""
    if folder is None or not (folder / RESULTS).exists():
        return None
    try:
        results = json.loads((folder / RESULTS).read_text(encoding="utf-8"))
    except ValueError as error:
        raise ValueError(f"{folder / RESULTS} is no result of a study: {error}") from None
    return results if isinstance(results, dict) else None


def save_results(folder: Path | None, results: dict[str, Any]) -> None:
    """Write results; the file is whole at any moment."""
    if folder is None:
        return
    folder.mkdir(parents=True, exist_ok=True)
    with replacing(folder / RESULTS, ".json") as temporary:
        text = json.dumps(results, indent=1, allow_nan=False)
        temporary.write_text(text + "\n", encoding="utf-8")


def load_reference(folder: Path | None) -> Reference | None:
    """Reference of an earlier run, or None."""
    if folder is None or not (folder / REFERENCE).exists():
        return None
    with np.load(folder / REFERENCE) as file:
        return Reference(
            file["radiance"], file["variance"], int(file["samples"]), float(file["seconds"])
        )


def save_reference(folder: Path | None, reference: Reference) -> None:
    """Write the reference; the file is whole at any moment."""
    if folder is None:
        return
    folder.mkdir(parents=True, exist_ok=True)
    with replacing(folder / REFERENCE, ".npz") as temporary:
        np.savez_compressed(
            temporary, radiance=reference.radiance, variance=reference.variance,
            samples=reference.samples, seconds=reference.seconds,
        )  # fmt: skip


def error_plane(radiance: NDArray, reference: Reference) -> NDArray[np.float16]:
    """RMS error of the channels over the RMS of the reference, in blocks of at most `MAP` a side.

    The noise of the reference is in it.
    """
    square = ((radiance - reference.radiance) ** 2).mean(-1)
    edge = min(-(-max(square.shape) // MAP), *square.shape)
    if edge > 1:
        height, width = (n // edge * edge for n in square.shape)
        cut = square[:height, :width].reshape(height // edge, edge, width // edge, edge)
        square = cut.mean(axis=(1, 3))
    scaled = square / reference.power if reference.power > 0 else np.zeros_like(square)
    return np.sqrt(np.minimum(scaled, LARGEST**2)).astype(np.float16)


def save_error(folder: Path | None, key: str, plane: NDArray[np.float16]) -> None:
    """Write a map of errors."""
    if folder is None:
        return
    (folder / ERRORS).mkdir(parents=True, exist_ok=True)
    with replacing(_error_file(folder, key), ".npy") as temporary:
        np.save(temporary, plane)


def load_error(folder: Path | None, key: str) -> NDArray[np.float16] | None:
    """Map of errors of a variant, or None."""
    if folder is None or not _error_file(folder, key).exists():
        return None
    return np.load(_error_file(folder, key))


def _error_file(folder: Path, key: str) -> Path:
    return folder / ERRORS / (re.sub(r"[^a-z0-9]+", "-", key.lower()).strip("-") + ".npy")
