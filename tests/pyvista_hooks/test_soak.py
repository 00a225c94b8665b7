"""A short run of the soak script; `soak.py --minutes 30` is the long one."""

import sys

import pytest
from soak import growth, soak


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="reads the memory in use from /proc")
def test_edits_neither_fail_nor_leak():
    result = soak(seconds=20, least=220)
    assert result["errors"] == []
    # A leak of one film and its pictures (1.6 MiB) in each of the edits between would be 150 MiB
    assert growth(result["memory_MiB"]) < 30
