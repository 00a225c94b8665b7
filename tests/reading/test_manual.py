"""docs/reading.md says what the readers do."""

from __future__ import annotations

import ast
import inspect
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from made_dicom import NORMAL, positions, write_series, write_slice
from made_volumes import REPOSITORY, VOXELS, error_of, nrrd_text, save
from pydicom.datadict import tag_for_keyword

from vtkmcvr.readers import read_vtk
from vtkmcvr.reading import choice
from vtkmcvr.reading.options import IGNORABLE

MANUAL = (REPOSITORY / "docs" / "reading.md").read_text(encoding="utf-8")
AXIAL = [1, 0, 0, 0, 1, 0]


def table(first_column: str) -> dict[str, str]:
    lines = MANUAL.split(f"| {first_column} |", 1)[1].split("\n\n")[0].splitlines()[2:]
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
    return {row[0]: row[1] for row in cells}


def test_options_are_those_of_the_reader() -> None:
    names = [name.strip("`") for name in table("option")]
    assert names == list(inspect.signature(read_vtk).parameters)[1:]


def test_what_can_be_ignored() -> None:
    assert {k.strip('`"'): v for k, v in table("`ignore=`").items()} == IGNORABLE


def test_formats_are_those_of_the_readers() -> None:
    named = set(" ".join(table("format").values()).split())
    known = {suffix for suffixes, _ in choice.READERS for suffix in suffixes}
    known |= {*choice.VTK_SUFFIXES, ".hdr", ".dcm", ".zip"} - {".img.gz", ".hdr.gz", ".bin"}
    listed = {word.strip(",") for word in named if word.startswith(".")}
    assert listed == known - {".img.gz", ".hdr.gz", ".bin"}


def attributes_in(path: Path) -> set[str]:
    """DICOM keywords among the texts of a module; attributes are asked for by no other means."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    texts = {node.value for node in ast.walk(tree) if isinstance(node, ast.Constant)}
    return {text for text in texts if isinstance(text, str) and text and tag_for_keyword(text)}


def test_attributes_that_are_looked_at() -> None:
    used: set[str] = set()
    for path in (REPOSITORY / "vtkmcvr" / "reading").glob("*.py"):
        used |= attributes_in(path)
    assert MANUAL.split("<!-- attributes -->")[1].split() == sorted(used)
    assert not {"PatientName", "PatientID", "PatientBirthDate", "StudyDescription"} & used


# Cases of refusal


def moved(k: int, by: float) -> list[list[float]]:
    places = positions(5)
    places[k] = list(np.array(places[k]) + by * NORMAL)
    return places


def with_slice(folder: Path, **attributes: object) -> Path:
    write_series(folder)
    place = attributes.pop("place", positions(6)[5])
    write_slice(folder / "x", attributes.pop("pixels", VOXELS[0]), place, **attributes)
    return folder


def cut(path: Path, count: int) -> Path:
    path.write_bytes(path.read_bytes()[:-count])
    return path


def written(path: Path, data: bytes) -> Path:
    path.write_bytes(data)
    return path


def doubled(folder: Path) -> Path:
    return with_slice(folder, place=positions(1)[0])


def interleaved(folder: Path) -> Path:
    return with_slice(folder, place=positions(1)[0], ImageType=["DERIVED", "SECONDARY"])


def echoes(folder: Path) -> Path:
    each = (4.0,) * 3 + (9.0,) * 3
    return write_series(folder, VOXELS[[0, 1, 2, 0, 1, 2]], positions(3) * 2, EchoTime=each)


def truncated_pixels(folder: Path) -> Path:
    write_series(folder)
    cut(folder / "4-97", 20)
    return folder


PLACE = {"space": "LPS", "space_directions": "(1,0,0) (0,1,0) (0,0,1)"}
CASES: dict[str, tuple[Callable[[Path], Path], dict]] = {
    "missing slice": (
        lambda p: write_series(p / "a", VOXELS[:4], [positions(5)[k] for k in (0, 1, 3, 4)]), {},
    ),
    "uneven step": (lambda p: write_series(p / "a", places=moved(4, 0.5)), {}),
    "doubled slice": (lambda p: doubled(p / "a"), {}),
    "mixed orientations": (lambda p: with_slice(p / "a", ImageOrientationPatient=AXIAL), {}),
    "interleaved image types": (lambda p: interleaved(p / "a"), {}),
    "several echoes": (lambda p: echoes(p / "a"), {}),
    "sizes differ": (lambda p: with_slice(p / "a", pixels=VOXELS[0, :3]), {}),
    "no position": (lambda p: with_slice(p / "a", place=None), {}),
    "one slice": (lambda p: write_series(p / "a", VOXELS[:1]), {}),
    "no such series": (lambda p: write_series(p / "a"), {"series": 9}),
    "truncated pixels": (lambda p: truncated_pixels(p / "a"), {}),
    "flat image": (lambda p: save(p / "a.nrrd", VOXELS[:1]), {}),
    "truncated file": (
        lambda p: written(p / "a.nrrd", (nrrd_text(**PLACE) + VOXELS.tobytes())[:300]), {},
    ),
    "data file elsewhere": (
        lambda p: written(p / "a.nhdr", nrrd_text(data_file="../x.raw", **PLACE)), {},
    ),
    "raw without layout": (lambda p: written(p / "a.raw", b"x"), {}),
    "unknown time step": (lambda p: save(p / "a.nii"), {"time": 7}),
}  # fmt: skip


def test_every_refusal_of_the_manual_has_a_case() -> None:
    assert list(table("case")) == list(CASES)


@pytest.mark.parametrize("case", CASES)
def test_refusal_is_worded_as_in_the_manual(tmp_path: Path, case: str) -> None:
    make, options = CASES[case]
    assert table("case")[case] in error_of(make(tmp_path), **options)
