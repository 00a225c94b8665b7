import os
import re
import subprocess
import sys

import pytest

from vtkmcvr import warming
from vtkmcvr.cli import main
from vtkmcvr.pack import structure
from vtkmcvr.presets import LOOKS


@pytest.fixture
def compiled(monkeypatch):
    """Plans that would be compiled."""
    plans = []
    monkeypatch.setattr(warming, "_compile", lambda planned: plans.append(planned) or 0.0)
    return plans


def test_looks_share_kernels_which_are_compiled_once(compiled):
    count = warming.warm_up(["int16"])
    assert count == len(compiled) == len({structure(planned.packed) for planned in compiled})
    assert 1 < count < len(LOOKS) / 2
    # The look for label maps makes bytes of its own
    kinds = {planned.packed.medium.values.dtype.name for planned in compiled}
    assert kinds == {"int16", "uint8"}


def test_command_warms_up_what_it_is_told_to(compiled, capsys):
    assert main(["warmup", "--types", "uint8,float32", "--presets", "solid", "--aovs"]) == 0
    assert [planned.packed.medium.values.dtype for planned in compiled] == ["uint8", "float32"]
    assert all(planned.packed.normal_map is not None for planned in compiled)
    assert "2 sets of kernels" in capsys.readouterr().out


@pytest.mark.parametrize("bad", [["--types", "int64"], ["--presets", "x-ray"]])
def test_bad_names_are_refused(bad, compiled, capsys):
    assert main(["warmup", *bad]) == 2
    assert bad[1] in capsys.readouterr().err
    assert not compiled


@pytest.mark.slow
def test_a_new_process_loads_what_was_compiled_ahead(tmp_path):
    command = [sys.executable, "-m", "vtkmcvr", "warmup", "--types=int16", "--presets=ct-bone"]
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}

    def seconds():
        out = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
        return sum(float(x) for x in re.findall(r": ([\d.]+) s", out.stdout))

    assert seconds() > 5 * max(seconds(), 0.2)
