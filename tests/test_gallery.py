"""The gallery shows every look, in small pictures that the page names."""

import importlib.util
import re
from pathlib import Path

import pytest
from PIL import Image
from real_volumes import real_path

from vtkmcvr.cli import _parser
from vtkmcvr.presets import LOOKS

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "gallery.md"


@pytest.fixture(scope="module")
def gallery():
    spec = importlib.util.spec_from_file_location("gallery", ROOT / "examples" / "gallery.py")
    module = importlib.util.module_from_spec(spec)
    import sys

    sys.modules["gallery"] = module
    spec.loader.exec_module(module)
    return module


def test_every_look_is_there(gallery):
    assert {shot.look for shot in gallery.SHOTS} == set(LOOKS)
    assert len({shot.name or shot.look for shot in gallery.SHOTS}) == len(gallery.SHOTS)


def test_the_page_is_that_of_the_script(gallery):
    assert PAGE.read_text(encoding="utf-8") == gallery.page()


def test_pictures_are_there_small_and_not_empty():
    named = re.findall(r"\]\((images/gallery/[\w-]+\.jpg)\)", PAGE.read_text(encoding="utf-8"))
    assert len(named) == len(set(named)) >= len(LOOKS)
    for name in named:
        path = PAGE.parent / name
        assert path.stat().st_size < 60_000
        with Image.open(path) as picture:
            assert picture.size == (320, 320)
            darkest, brightest = picture.convert("L").getextrema()
            assert darkest < 40, name
            assert brightest > 120, name


def test_the_commands_are_understood(gallery):
    for line in re.findall(r"^    vtkmcvr (.*)$", PAGE.read_text(encoding="utf-8"), re.MULTILINE):
        words = [word.strip("'") for word in line.split()]
        args = _parser().parse_args(words)
        assert args.preset in LOOKS


def test_a_shot_is_taken_by_the_script(gallery, tmp_path):
    data = real_path("nifti/zstat1.nii.gz").parents[1]
    out = ["--only", "signed", "--samples", "1", "--threads", "1", "-o", str(tmp_path)]
    gallery.main(["--data", str(data), *out])
    assert (tmp_path / "images" / "gallery" / "signed.jpg").stat().st_size > 1000
    assert (tmp_path / "gallery.md").exists()
