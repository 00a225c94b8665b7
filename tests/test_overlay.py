"""A second volume over the first, and images of several components."""

import numpy as np
import pytest
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData

from vtkmcvr.cli import main
from vtkmcvr.front import scene_of
from vtkmcvr.phantom import head_phantom
from vtkmcvr.recorded_facts import record_facts
from vtkmcvr.scene import Volume
from vtkmcvr.vtk_bridge.single import single_volume


def image_of(values):
    """Image of an array (k, j, i) or (k, j, i, component)."""
    image = vtkImageData()
    image.SetDimensions(*values.shape[2::-1])
    flat = np.ascontiguousarray(values).reshape(np.prod(values.shape[:3]), -1)
    image.GetPointData().SetScalars(numpy_to_vtk(flat, deep=True))
    return image


def uptake():
    values = np.full((12, 12, 12), 1.0, np.float32)
    values[5:8, 5:8, 5:8] = 9.0
    image = image_of(values)
    image.SetSpacing(8.0, 8.0, 8.0)
    record_facts(image, [], "PT", "SUV")
    return image


def test_pet_over_ct_shows_what_glows_and_no_more():
    head = Volume.from_grid(*head_phantom(32))
    dressed = scene_of(head, preset="ct-bone", overlay=uptake(), size=(16, 12))
    (layer,) = dressed.scene.layers
    # Normal uptake hides nothing, high uptake shines
    assert layer.transfer.opacity(1.0) == 0.0
    assert layer.transfer.opacity(9.0) > 0.1
    assert layer.transfer.emission(9.0)[0] > 0.5
    assert "overlay in look pet-fusion: seen from 2 to 12" in dressed.notes
    np.testing.assert_array_equal(layer.volume.spacing, (8, 8, 8))


def test_pet_alone_shows_the_body_too():
    scene = scene_of(uptake(), size=(16, 12))
    assert scene.preset == "pet-fusion"
    assert scene.scene.transfer.opacity(1.0) > 0.0


def test_an_overlay_may_have_another_look_and_comes_from_the_command_line(tmp_path, capsys):
    head = Volume.from_grid(*head_phantom(32))
    layer = scene_of(head, overlay=uptake(), overlay_preset="solid", size=(8, 6)).scene.layers[0]
    assert layer.transfer.emission is None
    for name, values in (("a", head.values), ("b", head.values[::2, ::2, ::2])):
        np.save(tmp_path / f"{name}.npy", values)
    command = ["render", str(tmp_path / "a.npy"), "--overlay", str(tmp_path / "b.npy")]
    small = ["--dry-run", "--size", "8x6", "--threads", "1", "--overlay-preset", "no-such"]
    assert main([*command, *small]) == 2
    assert "preset is one of ct-bone" in capsys.readouterr().err


def test_components_become_one_volume():
    rng = np.random.default_rng(3)
    values = rng.integers(0, 256, (4, 5, 6, 4)).astype(np.uint8)
    volume, notes = single_volume(image_of(values))
    np.testing.assert_array_equal(volume.values, values[..., 3])
    np.testing.assert_array_equal(volume.colours, values[..., :3])
    assert notes == ("components are red, green, blue and opacity",)
    volume, _ = single_volume(image_of(values[..., :3]))
    expected = values[..., :3] @ (0.2126, 0.7152, 0.0722)
    np.testing.assert_allclose(volume.values, expected, rtol=1e-6)
    vectors = rng.normal(size=(4, 5, 6, 3))
    volume, notes = single_volume(image_of(vectors))
    np.testing.assert_allclose(volume.values, np.linalg.norm(vectors, axis=-1), rtol=1e-6)
    assert "length" in notes[0]
    assert scene_of(image_of(vectors), size=(8, 6)).notes[-1] == notes[0]
    with pytest.raises(ValueError, match="5 components of float64"):
        single_volume(image_of(rng.normal(size=(4, 5, 6, 5))))
