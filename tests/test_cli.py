"""The command line as a user meets it: pictures, JSON, and one clear sentence for bad input."""

import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from vtkmcvr.cli import main
from vtkmcvr.phantom import head_phantom

SMALL = ["--size", "24x18", "--samples", "2", "--threads", "1"]


@pytest.fixture(scope="module")
def volume_file(tmp_path_factory):
    """A small CT as NRRD, with 12 degrees of turn in its direction matrix."""
    import SimpleITK as sitk

    head = head_phantom(24)
    image = sitk.GetImageFromArray(head.values)
    image.SetSpacing(head.spacing)
    image.SetOrigin(head.origin)
    c, s = np.cos(np.radians(12)), np.sin(np.radians(12))
    image.SetDirection((c, -s, 0, s, c, 0, 0, 0, 1))
    path = tmp_path_factory.mktemp("volume") / "head.nrrd"
    sitk.WriteImage(image, str(path))
    return path


@pytest.mark.parametrize("suffix", [".png", ".npz", ".vti", ".exr"])
def test_render_writes_every_kind_of_picture(volume_file, tmp_path, suffix):
    if suffix == ".exr":
        pytest.importorskip("OpenEXR")
    out = tmp_path / f"picture{suffix}"
    assert main(["render", str(volume_file), "-o", str(out), *SMALL]) == 0
    assert out.stat().st_size > 100
    assert list(tmp_path.iterdir()) == [out]


def test_npz_holds_the_public_arrays(volume_file, tmp_path):
    out = tmp_path / "picture.npz"
    main(["render", str(volume_file), "-o", str(out), *SMALL])
    with np.load(out) as arrays:
        assert arrays["radiance"].shape == (18, 24, 3)
        assert arrays["alpha"].shape == (18, 24)
        assert {"rgba", "depth", "standard_error", "recipe"} <= set(arrays)


def test_json_holds_what_was_measured(volume_file, tmp_path):
    facts_file = tmp_path / "facts.json"
    out = str(tmp_path / "picture.png")
    assert main(["render", str(volume_file), "-o", out, *SMALL, "--json", str(facts_file)]) == 0
    facts = json.loads(facts_file.read_text())
    assert facts["samples"] == 2 and facts["stopped_by"] == "samples" and facts["seed"] == 0
    assert facts["size"] == [24, 18]
    assert facts["paths_per_second"] > 0 and facts["seconds"] > 0 and facts["nrms"] > 0
    assert facts["effects"]["depth of field"] == {
        "on": False,
        "reason": "the camera has no lens: a pinhole",
    }
    volume = facts["volume"]
    assert volume["dimensions"] == [24, 24, 24]
    assert volume["spacing"] == pytest.approx(head_phantom(24).spacing)
    assert volume["range"] == [
        int(head_phantom(24).values.min()),
        int(head_phantom(24).values.max()),
    ]
    assert facts["version"]


def test_seconds_stop_a_render(volume_file, tmp_path, capsys):
    out = str(tmp_path / "p.png")
    options = ["--size", "24x18", "--seconds", "0.3"]
    assert main(["render", str(volume_file), "-o", out, *options]) == 0
    assert "stopped by seconds" in capsys.readouterr().out


def test_demo_prints_picture_plan_and_cost(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["demo", "--size", "24x18", "--samples", "1"]) == 0
    text = capsys.readouterr().out
    assert str(tmp_path / "vtkmcvr-demo.png") in text
    assert "surface shading" in text and "M paths/s" in text and "no patient" in text
    assert (tmp_path / "vtkmcvr-demo.png").exists()


def test_demo_takes_any_volume(volume_file, tmp_path, capsys):
    out = str(tmp_path / "p.png")
    assert main(["demo", "--input", str(volume_file), "-o", out, *SMALL]) == 0
    assert "surface shading" in capsys.readouterr().out


def test_denoised_picture_says_so_and_replays(volume_file, tmp_path, capsys):
    out, facts = tmp_path / "p.png", tmp_path / "facts.json"
    options = ["--denoise", "knn", "--bits", "16", "--json", str(facts)]
    assert main(["render", str(volume_file), "-o", str(out), *SMALL, *options]) == 0
    assert "denoised by knn, error not known" in capsys.readouterr().out
    told = json.loads(facts.read_text())
    assert told["denoised"]["method"] == "knn"
    assert told["nrms"] is None and told["nrms_before_denoising"] > 0
    again = tmp_path / "again.png"
    command = ["replay", str(out), "--input", str(volume_file), "-o", str(again), "--bits", "16"]
    assert main(command) == 0
    assert "the same bits" in capsys.readouterr().out
    import SimpleITK as sitk

    one, other = (sitk.GetArrayFromImage(sitk.ReadImage(str(path))) for path in (out, again))
    assert one.dtype == np.uint16
    np.testing.assert_array_equal(one, other)


def test_demo_replays_from_its_own_file(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["demo", "--size", "24x18", "--samples", "1"]) == 0
    assert main(["replay", "vtkmcvr-demo.png", "-o", "again.npz"]) == 0
    assert "the same bits" in capsys.readouterr().out


def test_info_and_presets(volume_file, tmp_path, capsys):
    facts = tmp_path / "info.json"
    assert main(["info", str(volume_file), "--json", str(facts)]) == 0
    assert json.loads(facts.read_text())["dimensions"] == [24, 24, 24]
    assert "24 x 24 x 24" in capsys.readouterr().out
    assert main(["presets"]) == 0
    assert "ct-bone" in capsys.readouterr().out


def test_lens_environment_and_flip(volume_file, tmp_path):
    out = str(tmp_path / "p.png")
    sky = tmp_path / "sky.exr"
    openexr = pytest.importorskip("OpenEXR")
    pixels = np.full((8, 16, 3), 0.5, np.float32)
    header = {"compression": openexr.ZIP_COMPRESSION, "type": openexr.scanlineimage}
    with openexr.File(header, {"RGB": pixels}) as file:
        file.write(str(sky))
    options = ["--aperture", "3", "--environment", str(sky), "--flip", "k"]
    assert main(["render", str(volume_file), "-o", out, *SMALL, *options]) == 0


BAD_INPUT = {
    "missing file": (["render", "nowhere.nrrd", "-o", "p.png"], "nowhere.nrrd"),
    "unknown preset": (["render", "VOLUME", "-o", "p.png", "--preset", "x"], "preset is one of"),
    "picture type": (["render", "VOLUME", "-o", "p.jpg"], ".png, .exr, .npz, .vti"),
    "negative samples": (["render", "VOLUME", "-o", "p.png", "--samples", "-3"], "samples"),
    "no time": (["render", "VOLUME", "-o", "p.png", "--seconds", "0"], "seconds"),
    "zero-size film": (["render", "VOLUME", "-o", "p.png", "--size", "0x9"], "film width"),
    "no threads": (["render", "VOLUME", "-o", "p.png", "--threads", "0"], "threads"),
    "view": (["render", "VOLUME", "-o", "p.png", "--view", "up"], "view is one of"),
    "NaN camera": (["render", "VOLUME", "-o", "p.png", "--azimuth", "nan"], "azimuth"),
    "no folder": (["render", "VOLUME", "-o", "none/p.png", *SMALL], "none"),
    "bits": (["render", "VOLUME", "-o", "p.exr", "--bits", "16", *SMALL], "bits is for .png"),
    "replay of nothing": (["replay", "nowhere.png", "-o", "p.png"], "there is no picture"),
    "replay to a type": (["replay", "nowhere.png", "-o", "p.gif"], ".png, .exr, .npz, .vti"),
    "flip": (["render", "VOLUME", "-o", "p.png", "--flip", "z"], "i, j, k"),
}


@pytest.mark.parametrize("case", BAD_INPUT)
def test_bad_input_is_one_sentence(case, volume_file, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    arguments, expected = BAD_INPUT[case]
    arguments = [str(volume_file) if a == "VOLUME" else a for a in arguments]
    assert main(arguments) == 2
    error = capsys.readouterr().err
    assert expected in error and error.startswith("vtkmcvr: ")
    assert error.count("\n") == 1 and "Traceback" not in error
    assert not list(tmp_path.iterdir())


def test_not_volumes(tmp_path, capsys):
    import SimpleITK as sitk

    sitk.WriteImage(sitk.Image([8, 8], sitk.sitkUInt8), str(tmp_path / "flat.nrrd"))
    sitk.WriteImage(sitk.Image([8, 8, 8], sitk.sitkVectorUInt8, 5), str(tmp_path / "five.nrrd"))
    (tmp_path / "text.nrrd").write_text("not a volume")
    (tmp_path / "empty").mkdir()
    for name in ("flat.nrrd", "five.nrrd", "text.nrrd", "empty"):
        assert main(["render", str(tmp_path / name), "-o", str(tmp_path / "p.png")]) == 2
        error = capsys.readouterr().err
        assert (error.count("\n") == 1 and name in error) or "component" in error, error
        assert not (tmp_path / "p.png").exists()


@pytest.mark.skipif(os.name == "nt", reason="SIGINT is POSIX")
def test_interrupt_keeps_the_picture(volume_file, tmp_path):
    out = tmp_path / "p.png"
    command = [sys.executable, "-m", "vtkmcvr", "render", str(volume_file), "-o", str(out)]
    process = subprocess.Popen(
        [*command, "--size", "64x48", "--samples", "100000000"],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    time.sleep(6)
    while process.poll() is None:
        process.send_signal(signal.SIGINT)
        time.sleep(10)
    text = process.communicate()[0]
    assert "stopped by user" in text, text
    assert out.exists()


def test_import_is_light():
    """Nothing heavy before it is used: no numba, VTK, PyVista or SimpleITK."""
    code = (
        "import sys, vtkmcvr, vtkmcvr.cli\n"
        "heavy = {'numba', 'vtkmodules', 'pyvista', 'SimpleITK', 'numpy'} & set(sys.modules)\n"
        "assert not heavy, heavy"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_a_reader_that_has_seen_enough_is_no_error():
    run = subprocess.Popen(
        [sys.executable, "-m", "vtkmcvr", "presets"], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    run.stdout.close()
    assert run.stderr.read() == b""
    assert run.wait(60) == 141
    run.stderr.close()
