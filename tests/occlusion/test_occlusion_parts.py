"""Cuts, masks, labels and several volumes in slices; opaque surfaces; the recipe in a picture."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from occlusion_scenes import block, frontal, half_space, half_space_scene, medium
from scenes import BOX, blob, scene, volume

import vtkmcvr
from vtkmcvr import Labels, Layer, Plane, PlaneReceiver, Sphere
from vtkmcvr.cli import main
from vtkmcvr.lights import ConstantEnvironment
from vtkmcvr.occlusion import Occlusion, render_occlusion
from vtkmcvr.occlusion.beams import _spiral
from vtkmcvr.phases import Cone
from vtkmcvr.rendering import render_scene
from vtkmcvr.scene import Camera

SKY = (ConstantEnvironment(1.0),)
VIEW = Camera((0.5, -4.0, 0.8), (0, 0, 0), view_angle=32)


def nrms(a, b):
    return float(np.sqrt(np.mean((a - b) ** 2) / np.mean(b**2)))


def middle(picture):
    rows, columns = picture.alpha.shape
    return float(picture.radiance[rows // 2, columns // 2, 1])


@pytest.mark.parametrize("mode", ["default", "fast"])
def test_a_cut_opens_light(mode):
    # HC-92: what lies 7.3 mean free paths deep would be black; cut free, it is a half-space's face,
    # with the opacity and the distance of what is left
    lit = half_space_scene(clip=(Plane((0, 7.3, 0), (0, 1, 0)),))
    picture = render_occlusion(lit, Occlusion(60, mode))
    assert middle(picture) == pytest.approx(half_space(60), rel=0.01)
    assert picture.alpha.min() > 0.9999
    # The camera stands 50 before the front face; collisions lie one mean free path behind the cut
    assert float(picture.depth[4, 4]) == pytest.approx(50 + 7.3 + 1, abs=0.3)


def test_a_cut_across_the_view_ends_where_it_says():
    vol, transfer = block(4.0, 12.0, 50.0)
    cut = scene(vol, transfer, frontal(4.0), size=(64, 8), pixel_filter=BOX,
                clip=(Plane((0.3, 0, 0), (1, 0, 0)),))  # fmt: skip
    whole = replace(cut, clip=())
    alpha, before = (render_occlusion(s, Occlusion(60)).alpha[4] for s in (cut, whole))
    # Pixels of one world unit, one of which is half cut
    kept = np.arange(64) - 31.5 > 0.3
    assert np.abs(alpha - np.where(kept, before, 0)).sum() < 1.01


def test_a_mask_is_a_cut_between_voxels():
    lit = half_space_scene()
    mask = np.ones(lit.volume.values.shape, bool)
    mask[:, :8] = False
    masked = render_occlusion(replace(lit, mask=mask), Occlusion(60))
    assert middle(masked) == pytest.approx(half_space(60), rel=0.01)
    # The nearest voxel decides: the face is half a voxel before the first one that is kept
    assert float(masked.depth[4, 4]) == pytest.approx(50 + 7.5 + 1, abs=0.3)


def test_every_label_has_its_own_transfer_function():
    vol = blob(21)
    rows = np.zeros(vol.values.shape, np.uint8)
    rows[:, :, 11:] = 3
    white, red = medium(9.0, (0.9, 0.9, 0.9)), medium(3.0, (0.8, 0.2, 0.1))
    view = replace(VIEW, position=(0, -4, 0))
    lit = scene(vol, white, view, (32, 32), lights=SKY)
    both = render_occlusion(replace(lit, labels=Labels(rows, {3: red})), Occlusion(60))
    left, right = (
        render_occlusion(replace(lit, transfer=each), Occlusion(60)) for each in (white, red)
    )
    # Away from the border, where either shades the other
    for part, alone in ((slice(4, 12), left), (slice(22, 28), right)):
        assert np.abs(both.alpha[:, part] - alone.alpha[:, part]).max() < 0.01
    hue = [p.radiance[16, c, 1] / p.radiance[16, c, 0] for p, c in ((both, 10), (both, 22))]
    assert hue[0] == pytest.approx(1.0, abs=1e-3)
    assert hue[1] == pytest.approx(0.25, abs=1e-3)


@pytest.mark.slow
def test_extinctions_of_several_volumes_add():
    lit = scene(blob(), medium(6.0, (0.8, 0.8, 0.8)), VIEW, (32, 32), lights=SKY, aovs="albedo")
    half = replace(lit, transfer=medium(3.0, (1.0, 0.8, 0.6)), layers=(
        Layer(blob(), medium(3.0, (0.6, 0.8, 1.0))),
    ))  # fmt: skip
    one, two = (render_occlusion(each, Occlusion(60)) for each in (lit, half))
    np.testing.assert_allclose(two.alpha, one.alpha, atol=1e-4)
    np.testing.assert_allclose(two.radiance, one.radiance, atol=2e-3)
    np.testing.assert_allclose(one.albedo, 0.8 * one.alpha[..., None] * np.ones(3), atol=1e-4)
    np.testing.assert_allclose(two.albedo, one.albedo, atol=2e-3)


def test_a_further_volume_stands_where_it_is_put():
    beside = blob(17, (1.2, 0.0, 0.0))
    near = scene(blob(), medium(6.0), VIEW, (32, 32), lights=SKY)
    both = replace(near, layers=(Layer(beside, medium(6.0)),))
    alone = render_occlusion(replace(near, volume=beside), Occlusion(60))
    first, pair = render_occlusion(near, Occlusion(60)), render_occlusion(both, Occlusion(60))
    expected = 1 - (1 - alone.alpha) * (1 - first.alpha)
    assert nrms(pair.alpha, expected) < 0.01


@pytest.mark.slow
def test_cuts_labels_and_volumes_look_as_by_monte_carlo():
    vol = blob(25)
    rows = np.zeros(vol.values.shape, np.uint8)
    rows[:12] = 1
    lit = scene(
        vol, medium(9.0, (0.9, 0.6, 0.3)), VIEW, (48, 48), lights=SKY,
        labels=Labels(rows, {1: medium(4.0, (0.2, 0.5, 0.9))}),
        clip=(Plane((0, -0.25, 0), (0.3, 1, 0.2)), Sphere((0.4, -0.2, 0.2), 0.3, "outside")),
        layers=(Layer(blob(17, (-0.5, -0.4, 0.3)), medium(2.0, (0.9, 0.9, 0.2))),),
    )  # fmt: skip
    reference = render_scene(replace(lit, phase=Cone(60)), samples=256)
    picture = render_occlusion(lit, Occlusion(60))
    raw = nrms(picture.radiance, reference.radiance)
    assert math.sqrt(max(raw**2 - reference.nrms**2, 0)) < 0.04
    assert nrms(picture.alpha, reference.alpha) < 0.04


@pytest.mark.parametrize("tilt", [0, 35, 60])
@pytest.mark.parametrize("theta", [30, 60, 80])
def test_opaque_oblique_faces_are_as_bright_as_they_are(tilt, theta):
    # A plane face, 8 optical depths to a voxel. With the cosines m of light and o of the eye to its
    # normal, L is the cone's mean of m / (m + o), whatever the extinction
    n, a = 41, math.radians(tilt)
    _, y, x = np.mgrid[:n, :n, :n] - n // 2
    values = np.clip(y * math.cos(a) + x * math.sin(a) + 0.5, 0, 1).astype(np.float32)
    lit = scene(volume(values), medium(8.0), frontal(4.0), size=(24, 24), pixel_filter=BOX)
    picture = render_occlusion(lit, Occlusion(theta))
    c = 1 - (np.arange(300) + 0.5) / 300 * (1 - math.cos(math.radians(theta)))
    turn = np.cos((np.arange(300) + 0.5) / 300 * 2 * math.pi)
    m = c[:, None] * math.cos(a) + np.sqrt(1 - c**2)[:, None] * turn * math.sin(a)
    exact = np.where(m > 0, m / (m + math.cos(a)), 0).mean()
    light = picture.radiance[..., 1]
    assert light.mean() == pytest.approx(exact, rel=0.05)
    # Lines along the slices are faint
    assert light[4:-4, 4:-4].std() < 0.1 * exact


def test_directions_are_even_in_solid_angle():
    # HC-82: a disk's even samples weigh the rim 191 times too much at 80 degrees
    for theta in (30, 80):
        c = math.cos(math.radians(theta))
        directions = _spiral(c, 40)
        assert directions[:, 2].mean() == pytest.approx((1 + c) / 2, rel=1e-6)
        assert (directions[:, 2] ** 2).mean() == pytest.approx((1 + c + c * c) / 3, rel=1e-3)
        assert np.abs(directions[:, :2].mean(axis=0)).max() < 0.02


def test_paths_off_the_axis_are_longer():
    # HC-86: a slab of optical depth 0.5 across the axis, seen at up to 45 degrees
    vol, transfer = block(1.0, 40.0, 0.5)
    camera = Camera((0, -10.0, 0), (0, 0, 0), view_angle=90)
    lit = scene(vol, transfer, camera, size=(33, 33), pixel_filter=BOX)
    alpha = render_occlusion(lit, Occlusion(30)).alpha
    x = (np.arange(33) + 0.5) / 33 * 2 - 1
    secant = np.sqrt(1 + x**2 + x[:, None] ** 2)
    np.testing.assert_allclose(alpha, -np.expm1(-0.5 * secant), rtol=2e-3)


def test_a_turned_film_shows_a_turned_picture():
    # HC-89: the published 2 x 2 samples lie along the film's axes, and show it
    lit = scene(blob(25), medium(12.0), VIEW, (40, 40), lights=SKY)
    right, up, _ = VIEW.frame
    turned = replace(lit, camera=replace(VIEW, view_up=tuple(up * 0.7071 + right * 0.7071)))
    square = replace(lit, camera=replace(VIEW, view_up=tuple(right)))
    upright, quarter = (render_occlusion(s, Occlusion(85)).radiance for s in (lit, square))
    assert nrms(np.rot90(quarter, 1), upright) < 0.03 or nrms(np.rot90(quarter, -1), upright) < 0.03
    oblique = render_occlusion(turned, Occlusion(85)).radiance
    assert oblique.mean() == pytest.approx(upright.mean(), rel=0.01)


def test_the_background_shows_through_what_is_left():
    # HC-90: not as printed, where it is added whole
    vol, transfer = block(4.0, 12.0, 0.25, albedo=0.0)
    lit = scene(vol, transfer, frontal(1.0), size=(5, 5))
    for mode in ("default", "fast", "paper"):
        picture = render_occlusion(lit, Occlusion(60, mode))
        picture = picture.with_display(background=(1.0, 1.0, 1.0))
        T = math.exp(-1)
        expected = 255 * (1.055 * T ** (1 / 2.4) - 0.055)
        # Alpha is blended in sRGB, as viewers do, or in linear light: between the two
        assert 255 * T - 1 <= picture.rgba[2, 2, 0] <= expected + 1


def test_narrow_light_from_the_side_is_widened_and_says_so():
    lit = scene(blob(), medium(12.0), VIEW, (24, 24), lights=SKY)
    picture = render_occlusion(lit, Occlusion(0.01, toward_light=(-0.5, -1, 0)))
    assert any("widened from 0.01" in note for note in picture.plan.notes)
    assert picture.radiance[12, 12, 1] > 0.1 * picture.alpha[12, 12]
    plain = render_occlusion(lit, Occlusion(0))
    narrow = render_occlusion(lit, Occlusion(0.2))
    assert nrms(narrow.radiance, plain.radiance) < 0.01


def test_what_slices_do_not_know_is_refused():
    lit = scene(blob(), medium(3.0), size=(16, 8))
    with pytest.raises(ValueError, match="does not know receivers"):
        render_occlusion(replace(lit, receivers=(PlaneReceiver((0, 0, -1), (0, 0, 1)),)))
    with pytest.raises(ValueError, match="one volume only"):
        more = (Layer(blob(), medium(1.0)),)
        render_occlusion(replace(lit, aovs=("normal",), layers=more))


@pytest.mark.parametrize("suffix", ["png", "npz"])
def test_a_saved_picture_is_made_again_bit_for_bit(tmp_path, suffix):
    data = blob(13)
    settings = Occlusion(40, bleeding=0.5, directions=24)
    picture = vtkmcvr.render(data, technique="occlusion", occlusion=settings, preset="solid",
                             size=(20, 16), aovs=("albedo",))  # fmt: skip
    path = picture.save(tmp_path / f"a.{suffix}")
    again = vtkmcvr.replay(path, data, threads=3)
    assert again.identical and not again.notes
    for name, plane in picture.planes.items():
        np.testing.assert_array_equal(again.picture.planes[name], plane)
    np.testing.assert_array_equal(again.picture.rgba, picture.rgba)
    assert again.picture.settings == settings
    other = replace(data, values=data.values * np.float32(0.5))
    with pytest.raises(ValueError, match="other data"):
        vtkmcvr.replay(path, other)


def test_the_command_line_replays_occlusion(tmp_path, capsys):
    first, second = tmp_path / "a.npz", tmp_path / "b.npz"
    assert main(["demo", "-o", str(first), "--technique", "occlusion", "--mode", "fast", "--size",
                 "24x18", "--slices", "60", "--threads", "2", "--quiet"]) == 0  # fmt: skip
    facts = tmp_path / "b.json"
    assert main(["replay", str(first), "-o", str(second), "--json", str(facts)]) == 0
    assert "the same bits" in capsys.readouterr().out
    assert json.loads(facts.read_text())["identical"] is True
    with np.load(first) as a, np.load(second) as b:
        np.testing.assert_array_equal(a["radiance"], b["radiance"])
