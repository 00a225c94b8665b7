"""PTX of kernels for any architecture, without a device, with source lines of instructions."""

import re
import subprocess
from collections import Counter
from pathlib import Path
from types import SimpleNamespace

from numba import cuda
from numba.cuda import dispatcher

FILE = re.compile(r'\s*\.file\s+(\d+) "(.*?)"')
PLACE = re.compile(r"\s*\.loc\s+(\d+) (\d+)")
DOUBLE = re.compile(r"\s+(?:@!?%p\d+ )?([a-z0-9_.]*\.f64[a-z0-9_.]*)")
# Where the optimiser made one instruction of several
MERGED = "merged"
# Moves, loads and stores of doubles cost no more than those of two floats
NO_ARITHMETIC = ("mov", "ld", "st", "selp")


def pretend(monkeypatch, capability):
    """Answer numba-cuda's question for the device, and have it note source lines."""
    device = SimpleNamespace(compute_capability=capability)
    monkeypatch.setattr(dispatcher, "get_current_device", lambda: device)
    begin = dispatcher.CUDADispatcher.__init__

    def noting(self, function, targetoptions, *rest, **options):
        begin(self, function, {**targetoptions, "lineinfo": True}, *rest, **options)

    monkeypatch.setattr(dispatcher.CUDADispatcher, "__init__", noting)


def ptx_of(kernel, types, capability):
    """PTX of a plain function as a kernel."""
    ptx, _ = cuda.compile_ptx(kernel, types, cc=capability, fastmath=True, lineinfo=True)
    return ptx


def doubles(ptx):
    """Arithmetic in float64: how many instructions, by source file."""
    files, here, found = {}, MERGED, Counter()
    for line in ptx.splitlines():
        if match := FILE.match(line):
            files[match[1]] = Path(match[2]).name
    for line in ptx.splitlines():
        if match := PLACE.match(line):
            here = files[match[1]] if match[2] != "0" else MERGED
        elif (match := DOUBLE.match(line)) and not match[1].startswith(NO_ARITHMETIC):
            found[here] += 1
    return found


def assembled(ptx, arch, folder, *options):
    """Registers and spilt bytes of a kernel, by ptxas of the wheel that has NVVM too.

    None without it, or where another NVVM was found that is newer.
    """
    import nvidia

    programs = [path for root in nvidia.__path__ for path in Path(root).rglob("bin/ptxas")]
    if not programs:
        return None
    (folder / "kernel.ptx").write_text(ptx)
    done = subprocess.run(
        [programs[0], "-v", f"-arch={arch}", *options, folder / "kernel.ptx",
         "-o", folder / "kernel.cubin"],
        capture_output=True, text=True,
    )  # fmt: skip
    if "Unsupported .version" in done.stderr:
        return None
    assert done.returncode == 0, done.stderr
    return tuple(
        int(re.search(pattern, done.stderr)[1])
        for pattern in (r"Used (\d+) registers", r"(\d+) bytes spill stores")
    )
