"""Puts this folder on the path, so that every test can import `scenes`; records of hard cases.

With the environment variable VTKMCVR_NUMERICS, a file name, a run that passes leaves what its tests
recorded there, for `hard_cases/numerics_page.py` to put it on the page.
"""

import faulthandler
import json
import os
from pathlib import Path

import pytest

ROWS = pytest.StashKey[list]()
WATCHDOG_SECONDS = 300


def pytest_configure(config):
    config.stash[ROWS] = []


@pytest.fixture
def record(request):
    """Assert that a value is the expected one, within a tolerance, and note it for the page."""

    def check(case, what, technique, expected, got, tolerance, backend="cpu"):
        row = {
            "case": case, "what": what, "technique": technique, "backend": backend,
            "expected": float(expected), "got": float(got), "tolerance": float(tolerance),
        }  # fmt: skip
        request.config.stash[ROWS].append(row)
        assert abs(row["got"] - row["expected"]) <= row["tolerance"], row

    return check


@pytest.fixture
def watchdog():
    """End the whole run, with a traceback, where a kernel does not come back."""
    faulthandler.dump_traceback_later(WATCHDOG_SECONDS, exit=True)
    yield
    faulthandler.cancel_dump_traceback_later()


def pytest_sessionfinish(session, exitstatus):
    target = os.environ.get("VTKMCVR_NUMERICS")
    rows = session.config.stash[ROWS]
    if target and exitstatus == 0 and rows:
        keys = ("case", "what", "technique", "backend")
        rows = sorted(rows, key=lambda row: tuple(row[key] for key in keys))
        lines = ",\n".join(json.dumps(row) for row in rows)
        Path(target).write_text(f"[\n{lines}\n]\n", encoding="utf-8")
