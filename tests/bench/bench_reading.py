"""A CT of 1000 slices: the time of `vtkmcvr.read` by that of SimpleITK alone, in one run.

    python tests/bench/bench_reading.py [SLICES] [REPEATS]

Both read the same files, which the system keeps in memory. The smallest of the repeats counts,
because other work on the machine only ever adds time. SimpleITK sorts and decodes only; we also
judge the geometry and keep the smallest type.
"""

from __future__ import annotations

import json
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "reading"))

TARGET = 1.15


def synthetic_ct(folder: Path, slices: int) -> Path:
    """Write slices of 512 x 512 with 12 of 16 bits, as scanners do."""
    from made_dicom import write_slice

    noise = np.random.default_rng(1).integers(0, 4096, (8, 512, 512)).astype(np.uint16)
    for k in range(slices):
        write_slice(
            folder / f"{k:05}.dcm", noise[k % 8], [0.0, 0.0, 0.5 * k], BitsStored=12, HighBit=11,
            RescaleIntercept=-1024, ImageOrientationPatient=[1, 0, 0, 0, 1, 0],
            PixelSpacing=[0.7, 0.7], InstanceNumber=k + 1,
        )  # fmt: skip
    return folder


def with_simpleitk(folder: Path) -> np.ndarray:
    """Read as the SimpleITK manual shows."""
    import SimpleITK

    reader = SimpleITK.ImageSeriesReader()
    reader.SetFileNames(reader.GetGDCMSeriesFileNames(str(folder)))
    return SimpleITK.GetArrayFromImage(reader.Execute())


def with_vtkmcvr(folder: Path) -> np.ndarray:
    """Read as our manual shows."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    from vtkmcvr.readers import read_vtk

    image = read_vtk(folder)
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(image.GetDimensions()[::-1])


def seconds(read: Callable[[Path], np.ndarray], folder: Path) -> tuple[float, float]:
    """Return the time of one read, and the time that CPUs worked on it."""
    start, worked = time.perf_counter(), time.process_time()
    read(folder)
    return time.perf_counter() - start, time.process_time() - worked


def main(slices: int, repeats: int) -> dict[str, float]:
    """Measure, print and return seconds and ratio."""
    with tempfile.TemporaryDirectory() as place:
        folder = synthetic_ct(Path(place) / "ct", slices)
        same = np.array_equal(with_simpleitk(folder), with_vtkmcvr(folder))
        # One after the other, so that a disturbance hits both.
        pairs = [
            (seconds(with_vtkmcvr, folder), seconds(with_simpleitk, folder)) for _ in range(repeats)
        ]
    ours, theirs = (np.min(times, axis=0) for times in zip(*pairs, strict=True))
    facts = {
        "slices": slices,
        "vtkmcvr_seconds": round(float(ours[0]), 3),
        "simpleitk_seconds": round(float(theirs[0]), 3),
        "ratio": round(float(ours[0] / theirs[0]), 3),
        "ratio_of_cpu_time": round(float(ours[1] / theirs[1]), 3),
        "target": TARGET,
        "same_values": same,
    }
    print(json.dumps(facts, indent=2))
    return facts


if __name__ == "__main__":
    given = [int(text) for text in sys.argv[1:]]
    main(given[0] if given else 1000, given[1] if len(given) > 1 else 3)
