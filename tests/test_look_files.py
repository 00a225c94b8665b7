"""Looks from files: round trip, 3D Slicer's formats, hostile files."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkRenderingCore import vtkColorTransferFunction, vtkVolumeProperty

from vtkmcvr.cli import main
from vtkmcvr.phantom import head_phantom
from vtkmcvr.presets import LOOKS, dress, read_look, read_looks, write_look
from vtkmcvr.scene import Volume
from vtkmcvr.studio import view_camera
from vtkmcvr.vtk_bridge.look import look_of_property, property_of_look

# As 3D Slicer writes them, with made-up numbers
SCALAR, GRADIENT = "6 -3000 0 200 0.1 1000 0.8", "4 0 1 255 1"
COLOUR = "12 -3000 0 0 0 200 1 0.5 0.25 1000 1 1 1"
XML = f"""<MRML version="Slicer4.4.0">
  <VolumeProperty id="a" name="CT-Mine" interpolation="1" shade="1" diffuse="0.9" ambient="0.1"
   specular="0.2" specularPower="10" scalarOpacity="{SCALAR}" gradientOpacity="{GRADIENT}"
   colorTransfer="{COLOUR}" effectiveRange="0 1"/>
  <VolumeProperty id="b" name="MR-Mine" shade="0" scalarOpacity="{SCALAR}"
   gradientOpacity="4 0 0 40 1" colorTransfer="{COLOUR}"/>
  <VolumeArchetypeStorage id="c"/>
</MRML>"""
LINES = "\n".join(
    ["1 => interpolation", "1", "0.9", "0.1", "0.2", "10", SCALAR, GRADIENT, COLOUR, ""]
)
JSON = {
    "@schema": "volume-property-schema-v1.0.0.json#",
    "volumeProperties": [
        {
            "components": [
                {
                    "shade": True, "scalarOpacityUnitDistance": 2.5,
                    "lighting": {
                        "ambient": 0.1, "diffuse": 0.9, "specular": 0.2, "specularPower": 10.0
                    },
                    "scalarOpacity": {"points": [
                        {"x": -3000, "y": 0}, {"x": 200, "y": 0.1}, {"x": 1000, "y": 0.8}
                    ]},
                    "rgbTransferFunction": {"points": [
                        {"x": -3000, "color": [0, 0, 0]}, {"x": 200, "color": [1, 0.5, 0.25]},
                        {"x": 1000, "color": [1, 1, 1]},
                    ]},
                }
            ]
        }
    ],
}  # fmt: skip


@pytest.mark.parametrize("name", LOOKS)
def test_every_look_survives_json(tmp_path, name):
    path = tmp_path / "look.json"
    write_look(LOOKS[name], path)
    assert read_look(path) == LOOKS[name]


def files_of_slicer(folder):
    (folder / "presets.xml").write_text(XML)
    (folder / "CT-Mine.vp").write_text(LINES)
    (folder / "CT-Mine.vp.json").write_text(json.dumps(JSON))
    return f"{folder}/presets.xml#CT-Mine", folder / "CT-Mine.vp", folder / "CT-Mine.vp.json"


def test_presets_of_slicer_in_all_its_formats(tmp_path):
    xml, lines, plain = map(read_look, files_of_slicer(tmp_path))
    assert xml == lines
    for look in (xml, plain):
        assert (look.name, look.units) == ("CT-Mine", "HU")
        assert look.opacity == ((-3000, 0), (200, 0.1), (1000, 0.8))
        # sRGB 0.5 and 0.25 in linear light (IEC 61966-2-1)
        np.testing.assert_allclose(look.colour[1], (200, 1, 0.21404, 0.05088), atol=1e-5)
        assert look.surface.exponent == 40.0
        assert look.surface.specular[0] == pytest.approx(8 * 0.2 / 42)
    assert (xml.unit_distance, plain.unit_distance) == (1.0, 2.5)
    other = read_look(tmp_path / "presets.xml", "MR-Mine")
    assert (other.units, other.surface, xml.gradient_opacity) == ("data", None, None)
    assert other.gradient_opacity == ((0, 0), (40, 1))


def test_several_looks_have_to_be_named(tmp_path):
    files_of_slicer(tmp_path)
    assert len(read_looks(tmp_path / "presets.xml")) == 2
    with pytest.raises(ValueError, match=r"holds 2 looks, name one.*CT-Mine, MR-Mine"):
        read_look(tmp_path / "presets.xml")
    with pytest.raises(ValueError, match="there is no 'CT-Yours'"):
        read_look(tmp_path / "presets.xml", "CT-Yours")


def test_an_imported_look_fits_hu_as_our_own(tmp_path):
    xml, *_ = files_of_slicer(tmp_path)
    stored = (np.clip(head_phantom(48).values, -1024, None) + 1024).astype(np.uint16)
    volume = Volume.from_grid(stored)
    scene = dress(volume, view_camera(volume), read_look(xml), size=(8, 6)).scene
    assert scene.transfer.opacity(1024.0 + 200.0) == pytest.approx(0.1)


HOSTILE = {
    "a.xml": "<MRML><VolumeProperty", "b.xml": "<MRML/>", "c.xml": "",
    "d.xml": '<!DOCTYPE x [<!ENTITY a "b">]><MRML>&a;</MRML>',
    "e.xml": XML.replace("6 -3000", "7 -3000"), "f.xml": XML.replace("0.8", "nan"),
    "g.xml": XML.replace("0.8", "8"), "h.xml": XML.replace("200 0.1", "200 x"),
    "i.xml": XML.replace(SCALAR, ""), "j.xml": XML.replace('Power="10"', 'Power="inf"'),
    "a.vp": "1\n1\n", "b.vp": LINES.replace("10\n6", "ten\n6"), "a.json": "[" * 100_000,
    "b.json": "{}", "c.json": '{"format": "vtkmcvr look 1", "look": 3}',
    "d.json": '{"format": "vtkmcvr look 1", "look": {"type": "os.System"}}',
    "e.json": '{"volumeProperties": [{"components": [{"scalarOpacity": 3}]}]}',
    "f.json": '{"volumeProperties": []}',
    "g.json": '{"format": "vtkmcvr look 1", "look": {"type": "presets.look.Look", "name": 3}}',
}  # fmt: skip


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_files_get_one_clear_sentence(tmp_path, name, capsys):
    path = tmp_path / name
    path.write_text(HOSTILE[name])
    with pytest.raises(ValueError, match="holds no look") as caught:
        read_looks(path)
    assert str(path) in str(caught.value)
    assert len(str(caught.value)) < 500
    assert main(["presets", str(path)]) == 2
    assert "Traceback" not in capsys.readouterr().err


@settings(max_examples=60, deadline=None)
@given(st.text(alphabet="0123456789. e-x\n=>", max_size=120))
def test_lines_of_any_text_are_read_or_refused(text):
    from vtkmcvr.presets.slicer import look_from_lines

    lines = LINES.splitlines()
    lines[6] = text
    try:
        look = look_from_lines("\n".join(lines), "x")
    except ValueError:
        return
    assert all(np.isfinite(x) and 0 <= a <= 1 for x, a, *_ in look.opacity)


def test_a_look_from_a_volume_property():
    opacity, steps, colour = (
        vtkPiecewiseFunction(), vtkPiecewiseFunction(), vtkColorTransferFunction()
    )  # fmt: skip
    opacity.AddPoint(10, 0.0)
    opacity.AddPoint(50, 0.5, 0.3, 0.2)
    colour.AddRGBPoint(10, 0.1, 0.2, 0.3)
    steps.AddPoint(0, 0.0)
    steps.AddPoint(9, 1.0)
    made = vtkVolumeProperty()
    made.SetScalarOpacity(opacity)
    made.SetColor(colour)
    made.SetGradientOpacity(steps)
    made.SetScalarOpacityUnitDistance(3.0)
    made.SetScatteringAnisotropy(0.4)
    look = look_of_property(made, "mine")
    assert (look.name, look.units, look.unit_distance) == ("mine", "data", 3.0)
    assert look.opacity == ((10, 0, 0.5, 0), (50, 0.5, 0.3, 0.2))
    assert look.colour[0][:4] == (10, 0.1, 0.2, 0.3)
    assert [node[:2] for node in look.gradient_opacity] == [(0, 0), (9, 1)]
    assert look.surface is None
    assert look.phase.g == pytest.approx(0.4)
    volume = Volume.from_grid(np.linspace(0, 60, 27).reshape(3, 3, 3))
    transfer = dress(volume, view_camera(volume), look, size=(8, 6)).scene.transfer
    assert transfer.opacity(50.0) == 0.5
    assert transfer.gradient_opacity(9.0) == 1.0


def test_a_property_of_a_look_for_an_image():
    from vtkmcvr.vtk_bridge.property import surface_of, transfer_of

    head = head_phantom(24)
    image = vtkImageData()
    image.SetDimensions(*head.values.shape[::-1])
    stored = (np.clip(head.values, -1024, None) + 1024).astype(np.uint16)
    image.GetPointData().SetScalars(numpy_to_vtk(stored.ravel(), deep=True))
    made = property_of_look("ct-bone", image)
    volume = Volume.from_grid(stored)
    scene = dress(volume, view_camera(volume), "ct-bone", size=(8, 6)).scene
    x = np.linspace(0, 3000, 99)
    np.testing.assert_allclose(transfer_of(made).opacity(x), scene.transfer.opacity(x), atol=1e-9)
    np.testing.assert_allclose(transfer_of(made).colour(x), scene.transfer.colour(x), atol=1e-9)
    back = surface_of(made)
    assert back.exponent == pytest.approx(scene.surface.exponent)
    np.testing.assert_allclose(back.specular, scene.surface.specular, rtol=1e-6)


def test_command_lists_exports_and_imports(tmp_path, capsys):
    assert main(["presets"]) == 0
    listed = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in listed] == list(LOOKS)
    assert all(look.about in line for look, line in zip(LOOKS.values(), listed, strict=True))
    xml, *_ = files_of_slicer(tmp_path)
    out = tmp_path / "mine.json"
    assert main(["presets", xml, "-o", str(out)]) == 0
    assert read_look(out) == read_look(xml)
    assert main(["presets", "-o", str(tmp_path / "all.json")]) == 2
    assert "holds one look" in capsys.readouterr().err


def test_command_makes_thumbnails_and_renders_with_a_file(tmp_path, capsys):
    volume = tmp_path / "head.npy"
    np.save(volume, head_phantom(24).values)
    small = ["--size", "16x12", "--samples", "1", "--threads", "1"]
    folder = tmp_path / "thumbs"
    assert main(["presets", "ct-bone", "-o", str(folder), "--input", str(volume), *small]) == 0
    assert [path.name for path in folder.iterdir()] == ["ct-bone.png"]
    assert "optical depth" in capsys.readouterr().out
    write_look(LOOKS["ct-bone"], tmp_path / "mine.json")
    out = tmp_path / "a.png"
    preset = ["--preset", str(tmp_path / "mine.json")]
    assert main(["render", str(volume), "-o", str(out), *preset, *small]) == 0
    assert "look ct-bone, as asked" in capsys.readouterr().out
