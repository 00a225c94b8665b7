"""Options of the command line that decide what is read, and sequences of 4-D data."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest

from vtkmcvr.cli import main
from vtkmcvr.commands.sequence import frame_path, write_movie

sys.path.insert(0, str(Path(__file__).resolve().parent / "reading"))

from made_dicom import positions, write_series
from made_volumes import VOXELS, save

SMALL = ["--size", "16x12", "--samples", "1", "--threads", "1", "--quiet"]


def cine(folder: Path, steps: int = 3) -> Path:
    """A bright block that grows from step to step."""
    pixels = np.full((steps, 6, 12, 12), -1000, np.int16)
    for step in range(steps):
        pixels[step, :, 3 : 5 + 2 * step, 3:9] = 1500
    each = tuple(float(40 * step) for step in range(steps) for _ in range(6))
    return write_series(folder, pixels.reshape(-1, 12, 12), positions(6) * steps, TriggerTime=each)


def test_every_time_step_becomes_a_picture(tmp_path: Path) -> None:
    source = cine(tmp_path / "in")
    out = tmp_path / "out"
    out.mkdir()
    facts = tmp_path / "facts.json"
    command = ["render", str(source), "-o", str(out / "a.npz"), "--time", "all", *SMALL]
    assert main([*command, "--json", str(facts)]) == 0
    assert sorted(path.name for path in out.iterdir()) == ["a-0.npz", "a-1.npz", "a-2.npz"]
    alphas = []
    for path in sorted(out.iterdir()):
        with np.load(path) as arrays:
            alphas.append(float(arrays["alpha"].mean()))
    assert alphas[0] < alphas[1] < alphas[2]
    frames = json.loads(facts.read_text())["frames"]
    assert [frame["time"] for frame in frames] == [0.0, 0.04, 0.08]
    assert len({frame["preset"] for frame in frames}) == 1


@pytest.mark.parametrize("suffix", [".gif", ".webp"])
def test_time_steps_become_a_movie(tmp_path: Path, suffix: str) -> None:
    from PIL import Image

    source = cine(tmp_path / "in")
    path = tmp_path / f"a{suffix}"
    assert main(["render", str(source), "-o", str(path), "--time", "all", *SMALL]) == 0
    with Image.open(path) as movie:
        assert movie.n_frames == 3
        assert movie.size == (16, 12)
    assert sorted(entry.name for entry in tmp_path.iterdir()) == [path.name, "in"]


def test_mp4_is_written_or_its_package_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = cine(tmp_path / "in", 2)
    path = tmp_path / "a.mp4"
    status = main(["render", str(source), "-o", str(path), "--time", "all", *SMALL])
    if status:
        assert 'pip install "vtkmcvr[movie]"' in capsys.readouterr().err
        assert not path.exists()
    else:
        assert path.stat().st_size > 100


def test_names_of_frames() -> None:
    assert frame_path(Path("o/a.png"), 7, 120) == Path("o/a-007.png")
    assert frame_path(Path("o/a%04d.png"), 7, 120) == Path("o/a0007.png")
    with pytest.raises(ValueError, match="one number such as %03d"):
        frame_path(Path("o/a%s%s.png"), 7, 120)


def test_a_movie_that_cannot_be_written_leaves_nothing(tmp_path: Path) -> None:
    frames = [np.zeros((4, 4, 3), np.uint8)]
    with pytest.raises(FileNotFoundError, match="there is no folder"):
        write_movie(tmp_path / "none" / "a.gif", frames, 0.1)


def test_one_time_step_and_series(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source = cine(tmp_path / "in")
    assert main(["info", str(source), "--time", "2"]) == 0
    assert "volume 2 of 0 to 2 read" in capsys.readouterr().out
    assert main(["info", str(source), "--time", "3"]) == 2
    assert "there is no volume with time=3" in capsys.readouterr().err
    assert main(["info", str(source), "--time", "all"]) == 2
    assert main(["info", str(source), "--series", "9"]) == 2
    assert "allowed are 4 (CT, 18 slices)" in capsys.readouterr().err


def test_series_are_listed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_series(tmp_path / "a", SeriesDescription="Thorax B30f")
    facts = tmp_path / "list.json"
    assert main(["info", str(tmp_path / "a"), "--list", "--json", str(facts)]) == 0
    out = capsys.readouterr().out
    assert "4 CT   5 slices of 6 x 7" in out
    assert "Thorax B30f" in out
    assert json.loads(facts.read_text())["series"][0]["uid"] == "1.2.3.4"


def test_advice_in_messages_works_on_the_command_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    places = positions(6)
    source = write_series(tmp_path / "a", places=places[:3] + places[4:])
    assert main(["info", str(source)]) == 2
    assert "give resample=True" in capsys.readouterr().err
    assert main(["info", str(source), "--resample"]) == 0
    assert "7 x 6 x 6" in capsys.readouterr().out
    doubled = write_series(tmp_path / "b", VOXELS[[0, 1, 2, 3, 0]], places[:4] + places[:1])
    assert main(["info", str(doubled), "--ignore", "duplicates", "--ignore", "sizes"]) == 0
    raw = tmp_path / "a.raw"
    raw.write_bytes(VOXELS.tobytes())
    options = ["--raw", "7x6x5:int16", "--spacing", "0.5,1,2"]
    assert main(["info", str(raw), *options]) == 0
    assert "0.5 1 2" in capsys.readouterr().out
    assert main(["info", str(save(tmp_path / "a.nrrd")), "--units", "suv"]) == 2
    assert "units='suv' is for PET in DICOM" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        main(["info", str(raw), "--spacing", "1,2"])
