"""The page of numerics is what the tests recorded, and names every hard case."""

import ast
import re
from pathlib import Path

import numerics_page
import pytest
from register import ALL, ELSEWHERE, NOT_HERE

HERE = Path(__file__).parent
PAGE = (numerics_page.DOCS / "numerics.md").read_text(encoding="utf-8")


def functions(path):
    module = ast.parse(path.read_text(encoding="utf-8"))
    return {node.name for node in module.body if isinstance(node, ast.FunctionDef)}


def named_here():
    """Hard cases with tests of their name in this folder."""
    names = set().union(*(functions(path) for path in HERE.glob("test_*.py")))
    return {f"HC-{m[1]}" for name in names if (m := re.match(r"test_hc(\d\d)_", name))}


def test_page_shows_what_was_recorded():
    assert numerics_page.page(PAGE, numerics_page.rows()) == PAGE


def test_every_recorded_value_is_within_its_tolerance():
    rows = numerics_page.rows()
    assert len(rows) > 200
    for row in rows:
        assert abs(row["got"] - row["expected"]) <= row["tolerance"], row


def test_every_hard_case_is_tested_or_refused():
    assert not named_here() & set(NOT_HERE)
    assert named_here() | set(ELSEWHERE) | set(NOT_HERE) == set(ALL)


@pytest.mark.parametrize("case", ELSEWHERE)
def test_tests_elsewhere_exist(case):
    path, name = ELSEWHERE[case].split("::")
    assert name in functions(HERE.parents[1] / path)


def test_every_hard_case_is_on_the_page():
    missing = [case for case in ALL if case not in PAGE]
    assert not missing
