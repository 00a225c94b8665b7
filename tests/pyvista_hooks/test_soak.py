"""A short run of the soak script; `soak.py --minutes 30` is the long one."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).with_name("soak.py")


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="reads the memory in use from /proc")
def test_edits_neither_fail_nor_leak(tmp_path):
    # In a process of its own: what other tests leave behind comes and goes in a worker's memory
    report = tmp_path / "soak.json"
    run = [sys.executable, SCRIPT, "--minutes", "0.3", "--edits", "480", "--json", report]
    subprocess.run(run, check=True, timeout=600)
    result = json.loads(report.read_text())
    assert result["errors"] == []
    # A leak of one film and its pictures (1.6 MiB) in each of the 160 edits between the medians of
    # the first and the last third would be 250 MiB
    assert result["growth_MiB"] < 30
