"""How long the first picture of a new scene takes, with compilation and from the cache."""

import json
import os
import subprocess
import sys
import tempfile

PROGRAM = """
import json, time
start = time.perf_counter()
import vtkmcvr
volume = vtkmcvr.head_phantom(64)
loaded = time.perf_counter()
picture = vtkmcvr.render(volume, size=(800, 600), samples=1, backend="cuda")
print(json.dumps({
    "import_and_phantom": loaded - start, "render": time.perf_counter() - loaded,
    "device": picture.device,
}))
"""


def first_picture():
    """Seconds of `vtkmcvr.render` in a process of its own, first with an empty cache."""
    with tempfile.TemporaryDirectory() as cache:
        environment = {**os.environ, "NUMBA_CACHE_DIR": cache, "CUDA_CACHE_DISABLE": "1"}
        runs = [
            json.loads(
                subprocess.run(
                    [sys.executable, "-c", PROGRAM], env=environment, check=True,
                    capture_output=True, text=True,
                ).stdout.splitlines()[-1]
            )
            for _ in range(2)
        ]  # fmt: skip
    return {
        "compiled_seconds": runs[0]["render"],
        "cached_seconds": runs[1]["render"],
        "import_seconds": runs[1]["import_and_phantom"],
        "wanted_seconds": {"compiled": 5, "cached": 1},
    }
