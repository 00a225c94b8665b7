"""The table of features: no row without a test that exists, no item twice, none forgotten."""

import ast
import re
from functools import cache
from itertools import chain
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[1]
PAGE = REPOSITORY / "docs" / "features.md"
REST = "## Not here, and why"
ITEM = re.compile(r"(?:[A-JZ]|3[A-G]|HC-)\d+")
TEST = re.compile(r"`(tests/[\w/]+\.py)::(\w+)`")
# Statements of the paper by letter, and hard cases
PAPER = {"A": 7, "B": 6, "C": 4, "D": 5, "E": 8, "F": 7, "G": 2, "H": 2, "I": 3, "J": 4}
HARD = chain(range(1, 23), range(30, 47), range(50, 63), range(70, 72))
EXPECTED = {f"{letter}{i}" for letter, n in PAPER.items() for i in range(1, n + 1)} | {
    f"HC-{i:02}" for i in HARD
}


def rows(text):
    """Cells of all table rows, without heads and rules."""
    lines = [line for line in text.splitlines() if line.startswith("|")]
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
    return [row for row in cells if row[0] not in ("", "item") and not row[0].startswith("-")]


CLAIMS, REFUSALS = map(rows, PAGE.read_text(encoding="utf-8").split(REST))


@cache
def functions_of(path):
    """Test functions of a file, and whether each is marked slow."""
    module = ast.parse((REPOSITORY / path).read_text(encoding="utf-8"))
    marks = [ast.unparse(node) for node in module.body if isinstance(node, ast.Assign)]
    all_slow = "pytestmark = pytest.mark.slow" in marks
    return {
        node.name: all_slow or "pytest.mark.slow" in map(ast.unparse, node.decorator_list)
        for node in module.body
        if isinstance(node, ast.FunctionDef)
    }


@pytest.mark.parametrize("row", CLAIMS, ids=lambda row: row[0])
def test_every_row_names_tests_that_exist(row):
    item, words, here, proof = row
    assert ITEM.fullmatch(item)
    assert words
    assert here
    named = TEST.findall(proof)
    assert named, "no row without a test"
    assert not TEST.sub("", proof).replace("(slow)", "").strip(" ,"), "a test is `path::name`"
    for path, name in named:
        assert name.startswith("test_")
        assert name in functions_of(path)
    # What `make test` leaves out says so
    assert "(slow)" in proof or not all(functions_of(path)[name] for path, name in named)


def test_no_item_is_claimed_twice():
    items = [row[0] for row in CLAIMS]
    assert len(items) == len(set(items))


def test_every_statement_and_hard_case_is_on_the_page():
    refused = {item for row in REFUSALS for item in ITEM.findall(row[0])}
    assert EXPECTED <= {row[0] for row in CLAIMS} | refused


def test_what_is_not_here_has_a_reason():
    assert len(REFUSALS) > 5
    for row in REFUSALS:
        assert len(row) == 3
        assert all(row)
