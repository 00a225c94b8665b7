"""The page for users of VTK claims nothing without a test that exists."""

import re
from pathlib import Path

from test_features import TEST, functions_of, rows

PAGE = Path(__file__).resolve().parents[1] / "docs" / "vtk.md"
HEADS = ("port", "VTK", "what")


def test_every_row_names_tests_that_exist():
    text = PAGE.read_text(encoding="utf-8")
    claims = [row for row in rows(text) if row[0] not in HEADS]
    assert len(claims) > 30
    for row in claims:
        named = TEST.findall(row[-1])
        assert named, row
        for path, name in named:
            slow = functions_of(path)[name]
            assert slow == bool(re.search(rf"{name}` \(slow\)", row[-1])), (path, name)
