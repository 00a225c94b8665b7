"""Kernels in lanes neither read nor write beside the arrays that they are given."""

import subprocess
import sys
from pathlib import Path

import pytest
from numba import config

pytestmark = [
    pytest.mark.skipif(config.DISABLE_JIT, reason="lanes exist in compiled code only"),
    pytest.mark.skipif(sys.platform == "win32", reason="guard pages are made by mmap and mprotect"),
]
KINDS = ("uint8", "int16", "uint16", "float32")
PROGRAM = Path(__file__).parent / "guard_pages.py"


@pytest.mark.parametrize(
    "what",
    [
        [*(f"positions:{kind}" for kind in KINDS), "walks:int16", "pictures"],
        pytest.param([f"walks:{kind}" for kind in KINDS], marks=pytest.mark.slow),
    ],
    ids=["quick", "all types"],
)
def test_nothing_beside_the_arrays_is_touched(what):
    """In a process of its own, which a kernel that strays would end."""
    done = subprocess.run(
        [sys.executable, "-X", "faulthandler", str(PROGRAM), *what], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("nothing beside the arrays") == len(what)
