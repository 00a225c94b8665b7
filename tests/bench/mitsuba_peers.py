"""Mitsuba 3 on a scene.json, in every variant that runs here on the CPU."""

from __future__ import annotations

import glob
import importlib.util
import json
import os
import re
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

REPOSITORY = Path(__file__).resolve().parents[2]
PEERS = Path(os.environ.get("VTKMCVR_PEERS", REPOSITORY.parent / "shared" / "peers"))
BUILDER = PEERS / "mitsuba_reference.py"
LOADER = REPOSITORY / "tests" / "peers" / "mitsuba_scene.py"
# Mitsuba 3.9 aborts with older ones
OLDEST_LLVM = 19
LLVM_PLACES = (
    "/usr/lib/*-linux-gnu/libLLVM*.so*", "/usr/lib/llvm-*/lib/libLLVM*.so*",
    "/usr/lib64/libLLVM*.so*", "/opt/homebrew/opt/llvm/lib/libLLVM*.dylib",
)  # fmt: skip

Image = NDArray[np.float64]


@dataclass
class Contender:
    """One renderer on one scene: renders (seed, samples), remembers images and seconds."""

    name: str
    render: Callable[[int, int], NDArray]
    images: list[Image] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    cpu_seconds: list[float] = field(default_factory=list)

    def turn(self, seed: int, samples: int) -> None:
        """Render once, timed."""
        start, cpu_start = time.perf_counter(), time.process_time()
        image = np.asarray(self.render(seed, samples), np.float64)
        self.seconds.append(time.perf_counter() - start)
        self.cpu_seconds.append(time.process_time() - cpu_start)
        # Pictures of one channel are those of three equal ones
        self.images.append(np.broadcast_to(image, (*image.shape[:2], 3)))

    @property
    def median(self) -> float:
        """Seconds of one turn."""
        return float(np.median(self.seconds))

    @property
    def mean(self) -> float:
        """Mean of all images."""
        return float(np.mean(self.images))

    @property
    def mean_error(self) -> float:
        """Standard error of `mean`."""
        # Noise of the channels of a pixel goes together
        variance = np.var(np.mean(self.images, axis=-1), axis=0, ddof=1) / len(self.images)
        return float(np.sqrt(variance.sum()) / variance.size)

    @property
    def nrms(self) -> float:
        """NRMS error of one image, from the spread of the turns."""
        noise = float(np.var(self.images, axis=0, ddof=1).mean())
        power = float((np.mean(self.images, axis=0) ** 2).mean()) - noise / len(self.images)
        return float(np.sqrt(noise / power))


def module(path: Path) -> Any:
    """Import a script by path."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None and spec.loader is not None
    result = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = result
    spec.loader.exec_module(result)
    return result


def missing() -> str:
    """Reason why there is nothing to compare with, or nothing."""
    if importlib.util.find_spec("mitsuba") is None:
        return "mitsuba is not installed"
    if not BUILDER.exists():
        return "the script that renders with Mitsuba is not in VTKMCVR_PEERS"
    return ""


def llvm() -> str | None:
    """File of an LLVM that Mitsuba can compile with: DRJIT_LIBLLVM_PATH, or the newest found."""
    named = os.environ.get("DRJIT_LIBLLVM_PATH")
    if named:
        return named
    found = [(_version(path), path) for place in LLVM_PLACES for path in glob.glob(place)]
    version, path = max(found, default=(0, ""))
    return path if version >= OLDEST_LLVM else None


def _version(path: str) -> int:
    numbers = re.findall(r"\d+", Path(path).name)
    return int(numbers[0]) if numbers else 0


def variants(grey: bool) -> list[str]:
    """Variants of Mitsuba that run here, the plainest first; one channel does for grey scenes."""
    path = llvm()
    if path is None:
        return ["scalar_rgb"]
    os.environ["DRJIT_LIBLLVM_PATH"] = path
    return ["scalar_rgb", "llvm_ad_rgb", *(["llvm_ad_mono"] if grey else [])]


def mitsubas(path: Path, grey: bool) -> list[Contender]:
    """Mitsuba on a scene.json, in each variant."""
    return [_mitsuba(path, variant) for variant in variants(grey)]


def _mitsuba(path: Path, variant: str) -> Contender:
    import mitsuba as mi

    mi.set_variant(variant)
    mi.set_log_level(mi.LogLevel.Error)
    scene = module(BUILDER).build(mi, json.loads(path.read_text()), 1)

    def render(seed: int, samples: int) -> NDArray:
        mi.set_variant(variant)
        return np.asarray(mi.render(scene, spp=samples, seed=seed))

    return Contender(f"mitsuba {variant}", render)
