"""The body of a CT without its table."""

import numpy as np
import pytest

from vtkmcvr.front import scene_of
from vtkmcvr.phantom import head_phantom
from vtkmcvr.presets import dress
from vtkmcvr.presets.body import body_mask, worth_hiding
from vtkmcvr.scene import Volume
from vtkmcvr.studio import view_camera

SPACING = (1.5, 1.5, 3.0)


def lying(axes="kji"):
    """Cylinder of tissue with a lung and a bone in it, 6 mm above a table; HU."""
    k, j, i = np.indices((24, 100, 110))
    x, y = (i - 55) * 1.5, (j - 45) * 1.5
    values = np.full(k.shape, -1000, np.int16)
    body = (x / 60) ** 2 + (y / 45) ** 2 < 1
    values[body] = 40
    values[((x - 25) / 18) ** 2 + (y / 25) ** 2 < 1] = -850
    values[(x / 8) ** 2 + ((y - 25) / 8) ** 2 < 1] = 900
    table = (y > 51) & (y < 60) & (np.abs(x) < 75)
    values[table] = 300
    return Volume.from_grid(values, SPACING), body, table


def test_the_table_is_left_out_and_the_body_is_whole():
    volume, body, table = lying()
    mask = body_mask(volume, -300.0)
    assert not mask[table].any()
    # What the skin encloses belongs to the body, lung and all
    assert mask[body].all()
    assert mask.dtype == np.uint8


def test_depth_is_counted_from_the_skin():
    volume, body, _ = lying()
    mask = body_mask(volume, -300.0, 15.0)
    along = np.flatnonzero(mask[12, 45])
    # The body reaches from -60 to 60 mm there, the grid of the search has 1.5 mm
    assert abs((along[0] - 55) * 1.5 + 45) <= 3
    assert abs((along[-1] - 55) * 1.5 - 45) <= 3
    # It goes on beyond the ends of the scan
    np.testing.assert_array_equal(mask[0], mask[-1])
    assert not mask[~body].any()


def test_nothing_dense_is_no_body():
    assert body_mask(Volume.from_grid(np.full((8, 8, 8), -1000.0)), -300.0) is None


def test_a_mask_that_hides_nothing_is_not_used():
    volume, _, table = lying()
    camera = view_camera(volume)
    shown = dress(volume, camera, "ct-bone", units="HU", size=(8, 6))
    assert shown.scene.mask is not None
    assert any("the body, no table" in note for note in shown.notes)
    whole = dress(volume, camera, "ct-bone", units="HU", size=(8, 6), whole=True)
    assert whole.scene.mask is None
    bare = Volume.from_grid(np.where(table, -1000, volume.values), SPACING)
    assert dress(bare, camera, "ct-bone", units="HU", size=(8, 6)).scene.mask is None
    head = head_phantom(48)
    assert scene_of(Volume.from_grid(*head), preset="ct-bone", size=(8, 6)).scene.mask is None


def test_worth_hiding_counts_what_is_seen():
    seen = np.zeros((10, 10, 10), bool)
    seen[:5] = True
    mask = np.ones(seen.shape, np.uint8)
    assert not worth_hiding(mask, seen)
    mask[5:] = 0
    assert not worth_hiding(mask, seen)
    mask[0] = 0
    assert worth_hiding(mask, seen)
    assert not worth_hiding(mask, np.zeros_like(seen))


@pytest.mark.parametrize("axis", [0, 1])
def test_slices_may_run_along_any_axis(axis):
    volume, _, _ = lying()
    turned = np.swapaxes(volume.values, axis, 2)
    matrix = volume.index_to_world.copy()
    column = 2 - axis
    matrix[:, [0, column]] = matrix[:, [column, 0]]
    other = Volume(np.ascontiguousarray(turned), matrix)
    expected = np.swapaxes(body_mask(volume, -300.0), axis, 2)
    assert np.mean(body_mask(other, -300.0) == expected) > 0.995


def test_a_picture_with_a_mask_of_the_body_can_be_replayed(tmp_path):
    import vtkmcvr

    volume, _, _ = lying()
    path = tmp_path / "a.png"
    picture = vtkmcvr.render(volume, preset="ct-bone", size=(16, 12), samples=2, threads=1)
    assert picture.plan.scene.mask is not None
    picture.save(path)
    again = vtkmcvr.replay(path, volume, threads=1)
    assert again.identical
    other = Volume(np.where(volume.values > 500, 0, volume.values), volume.index_to_world)
    with pytest.raises(ValueError, match="made of other data"):
        vtkmcvr.replay(path, other)
