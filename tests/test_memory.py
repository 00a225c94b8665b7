"""Peak memory of a whole run, in a process of its own."""

import json
import os
import subprocess
import sys

import pytest

from vtkmcvr.cli import main
from vtkmcvr.memory import peak_memory

MIB = 2**20
RUN = """
import json, sys
import numpy as np
import vtkmcvr
from vtkmcvr.memory import peak_memory

def ball(n):
    x = np.linspace(-1, 1, n, dtype=np.float32)
    values = np.empty((n, n, n), np.uint16)
    for k in range(n):
        radius = np.sqrt(x[k] ** 2 + x[:, None] ** 2 + x ** 2)
        values[k] = np.clip(3000 - 2500 * radius, 0, 4095)
    return vtkmcvr.Volume.from_grid(values, (1.0, 1.0, 1.0))

def picture_of(n, size):
    return vtkmcvr.render(
        ball(n), preset="solid", size=size, samples=1, threads=2, backend="cpu"
    )

picture = picture_of(16, (8, 6))
before = peak_memory()
if sys.argv[1:] == ["whole"]:
    picture = picture_of(512, (800, 600))
parts = [*picture.film, *picture.film.batches]
film = sum(part.nbytes for part in parts if hasattr(part, "nbytes"))
print(json.dumps({"before": before, "peak": peak_memory(), "film": film,
                  "volume": picture.plan.scene.volume.values.nbytes,
                  "vtk": "vtkmodules" in sys.modules}))
"""


def measured(*how):
    # No threads of linear algebra, whose buffers depend on the machine
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    out = subprocess.run(
        [sys.executable, "-c", RUN, *how], capture_output=True, text=True, check=True,
        env=environment,
    )  # fmt: skip
    return json.loads(out.stdout)


@pytest.mark.slow
@pytest.mark.skipif(peak_memory() is None, reason="this system does not tell peak memory")
def test_picture_of_512_cubed_takes_a_quarter_more_than_its_volume_and_film():
    # Kernels are compiled by a process of its own, whose compiler takes memory too
    measured()
    found = measured("whole")
    assert found["volume"] == 2 * 512**3
    # Beyond what the program itself takes once it has made a picture: interpreter, compiled kernels
    assert found["peak"] - found["before"] < 1.25 * found["volume"] + found["film"]
    # With all of that
    assert found["peak"] < 1.25 * found["volume"] + found["film"] + 150e6


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere a program's peak is its own anyway")
def test_memory_of_the_program_that_started_this_one_is_not_counted():
    big = """
import subprocess, sys
held = bytearray(300 * 2**20)
held[::4096] = bytes([1]) * len(held[::4096])
small = "from vtkmcvr.memory import peak_memory; print(peak_memory())"
print(subprocess.run([sys.executable, "-c", small], capture_output=True, text=True).stdout)
"""
    out = subprocess.run([sys.executable, "-c", big], capture_output=True, text=True, check=True)
    assert int(out.stdout) < 200 * MIB


def test_arrays_are_rendered_without_vtk():
    assert not measured()["vtk"]


@pytest.mark.skipif(peak_memory() is None, reason="this system does not tell peak memory")
def test_command_says_how_much_memory_it_took(tmp_path, capsys):
    facts = tmp_path / "facts.json"
    command = ["demo", "--size", "8x6", "--samples", "1", "-o", str(tmp_path / "p.png")]
    assert main([*command, "--json", str(facts)]) == 0
    assert "MiB of memory at most" in capsys.readouterr().out
    assert json.loads(facts.read_text())["peak_memory"] > 50 * MIB
