"""A study's files: `cost.json` and the reference beside it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from ..safe_files import replacing
from .ladder import Reference

RESULTS, REFERENCE = "cost.json", "reference.npz"


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
