"""The page of accuracy has the numbers of its JSON, and no others."""

import copy
import json
import re
import sys
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[1] / "docs"
sys.path.insert(0, str(Path(__file__).parent / "bench"))

from accuracy_page import page, seconds_to  # noqa: E402

from vtkmcvr.costs import summary  # noqa: E402


@pytest.fixture(scope="module")
def facts():
    return json.loads((DOCS / "accuracy.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def text():
    return (DOCS / "accuracy.md").read_text(encoding="utf-8")


def test_page_is_what_the_numbers_say(facts, text):
    assert text == page(facts)


def test_another_number_would_be_noticed(facts, text):
    # Each of these stands somewhere on the page
    for path in (
        ("volumes", "engine", "full", "cpu_seconds"),
        ("volumes", "CT head", "full", "one_second", "nrms"),
        ("volumes", "MR head", "full", "predicted", "samples"),
        ("volumes", "CT thorax", "half", "gain", "ratio"),
        ("fall", "independent", "exponent"),
        ("machine", "processor"),
    ):
        changed = copy.deepcopy(facts)
        part = changed
        for key in path[:-1]:
            part = part[key]
        part[path[-1]] = part[path[-1]] * 2
        assert page(changed) != text, path


def test_the_first_screen_answers(facts, text):
    screen = text.split("## ")[0]
    assert len(screen.splitlines()) < 30
    volumes = facts["volumes"]
    assert len(volumes) >= 5
    for target in (0.1, 0.01):
        asked = [seconds_to(found, target) for found in volumes.values()]
        assert f"{summary.seconds(min(asked))} to {summary.seconds(max(asked))}" in screen
    for word in ("10 %", "1 %", "One second", "Effects", "no shadows", "Occlusion", "is enough"):
        assert word in screen
    assert facts["machine"]["processor"] in screen and f"{facts['threads']} threads" in screen
    assert facts["threads"] == 2


def test_every_figure_is_there_and_every_measurement_on_the_page(facts, text):
    figures = re.findall(r"!\[[^\]]+\]\((images/[\w-]+\.png)\)", text)
    assert len(figures) >= 7
    for figure in figures:
        assert (DOCS / figure).read_bytes().startswith(b"\x89PNG")
    for entry in facts["study"]["measured"].values():
        assert f"| {entry['name']} |" in text
    groups = {entry["group"] for entry in facts["study"]["measured"].values()}
    assert groups >= {
        "scene", "without an effect", "denoiser", "sampler", "directions", "shadow rays",
        "collisions", "scattering", "occlusion", "aperture", "number of lights",
    }  # fmt: skip
    assert "## Beside Mitsuba" in text and len(facts["peers"]) == 3


def test_pictures_of_both_renderers_agree(facts):
    # Difference of the means in standard errors, three turns each: a t of 2 to 4 degrees of freedom
    for found in facts["peers"].values():
        assert abs(found["mean_z"]) < 10
