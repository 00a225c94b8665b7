"""Occlusion against the cone phase function by Monte Carlo, and against itself."""

from dataclasses import replace

import numpy as np
import pytest
from occlusion_scenes import block, frontal, half_space_scene, medium
from scenes import BOX, blob, noise, scene, volume

from vtkmcvr.lights import ConstantEnvironment
from vtkmcvr.occlusion import Occlusion, render_occlusion, traced
from vtkmcvr.occlusion.beams import beams_of
from vtkmcvr.occlusion.rendering import layout
from vtkmcvr.phases import Cone
from vtkmcvr.rendering import render_scene
from vtkmcvr.scene import Camera, Stereo, Surface

SKY = (ConstantEnvironment(1.0),)
PERSPECTIVE = Camera((0.5, -4.0, 0.8), (0, 0, 0), view_angle=32)
PARALLEL = Camera((0.5, -4.0, 0.8), (0, 0, 0), parallel_scale=1.15)


def nrms(a, b):
    return float(np.sqrt(np.mean((a - b) ** 2) / np.mean(b**2)))


def error_against_monte_carlo(scene_, theta, samples=256, **settings):
    """NRMS and mean ratio, the noise of the reference taken off."""
    reference = render_scene(replace(scene_, phase=Cone(theta)), samples=samples)
    picture = render_occlusion(scene_, Occlusion(theta, **settings))
    raw = nrms(picture.radiance, reference.radiance)
    error = np.sqrt(max(raw**2 - reference.nrms**2, 0.0))
    return error, picture.radiance.mean() / reference.radiance.mean(), picture, reference


def lumps(n=33):
    """Three balls that shade each other, as soft as data are."""
    z, y, x = np.mgrid[-1 : 1 : n * 1j, -1 : 1 : n * 1j, -1 : 1 : n * 1j]
    values = np.zeros((n, n, n))
    for cx, cy, cz, r in ((-0.3, 0.2, 0.1, 0.5), (0.35, -0.35, 0.3, 0.3), (0.4, 0.3, -0.4, 0.35)):
        ball = (r - np.sqrt((x - cx) ** 2 + (y - cy) ** 2 + (z - cz) ** 2)) * n / 4 + 0.5
        values = np.maximum(values, np.clip(ball, 0, 1))
    return volume(values.astype(np.float32), (2 / (n - 1),) * 3)


@pytest.mark.parametrize("camera", [PERSPECTIVE, PARALLEL], ids=["perspective", "parallel"])
@pytest.mark.parametrize("theta", [30, 70])
def test_default_mode_is_close_to_the_cone_integral(camera, theta):
    lit = scene(lumps(), medium(12.0), camera, (64, 64), lights=SKY)
    error, ratio, picture, reference = error_against_monte_carlo(lit, theta)
    assert error < 0.05
    assert abs(ratio - 1) < 0.03
    assert nrms(picture.alpha, reference.alpha) < 0.05
    # One buffer is further away, and paper mode too
    for mode in ("fast", "paper"):
        worse = error_against_monte_carlo(lit, theta, mode=mode)[0]
        assert worse > error


def test_default_mode_converges_as_its_knobs_are_turned_up():
    lit = scene(lumps(), medium(12.0), PERSPECTIVE, (48, 48), lights=SKY)
    coarse, *_ = error_against_monte_carlo(lit, 60, 512, directions=6, detail=0.4)
    fine, *_ = error_against_monte_carlo(lit, 60, 512, directions=64, detail=1.6)
    assert fine < 0.03
    assert fine < coarse / 2


def test_soft_media_need_no_detail():
    lit = scene(blob(), medium(1.0), PERSPECTIVE, (48, 48), lights=SKY)
    error, ratio, *_ = error_against_monte_carlo(lit, 70)
    assert error < 0.02
    assert abs(ratio - 1) < 0.01


def test_oblique_anisotropic_volumes():
    vol = lumps()
    shear = vol.index_to_world.copy()
    shear[:3, :3] = shear[:3, :3] @ np.array([[1.2, 0.3, 0], [0, 0.7, 0.2], [-0.2, 0, 1.5]])
    oblique = replace(vol, index_to_world=shear)
    view = Camera(oblique.centre + np.array((0.5, -6, 1)), oblique.centre, view_angle=30)
    lit = scene(oblique, medium(12.0), view, (64, 64), lights=SKY)
    error, ratio, picture, reference = error_against_monte_carlo(lit, 60)
    assert error < 0.06
    assert abs(ratio - 1) < 0.04
    assert nrms(picture.alpha, reference.alpha) < 0.05
    seen = picture.alpha > 0.9
    assert np.abs(picture.depth[seen] - reference.depth[seen]).mean() < 0.03


def test_half_as_thick_slices_hardly_change_the_picture():
    lit = scene(lumps(), medium(12.0), PERSPECTIVE, (64, 64), lights=SKY)
    usual = render_occlusion(lit, Occlusion(60))
    count = int(dict((e.name, e.reason) for e in usual.plan.effects)["slices"].split()[0])
    finer = render_occlusion(lit, Occlusion(60, slices=2 * count))
    assert nrms(finer.radiance, usual.radiance) < 0.02


@pytest.mark.parametrize("mode", ["default", "fast", "paper"])
def test_same_bits_for_any_number_of_threads(mode):
    lit = scene(lumps(), medium(12.0), PERSPECTIVE, (40, 31), lights=SKY)
    pictures = [render_occlusion(lit, Occlusion(70, mode, grid=3), threads=n) for n in (1, 2, 5)]
    for other in pictures[1:]:
        for name, array in pictures[0].planes.items():
            np.testing.assert_array_equal(other.planes[name], array)


@pytest.mark.parametrize("mode", ["default", "fast", "paper"])
def test_skipping_empty_and_saturated_space_changes_nothing(mode):
    # HC-91
    lit = scene(lumps(), medium(40.0), PERSPECTIVE, (40, 40), lights=SKY)
    quick = render_occlusion(lit, Occlusion(70, mode, grid=3))
    whole = render_occlusion(lit, Occlusion(70, mode, grid=3, skip=False))
    # What the eye does not see behind a transmittance of 1e-5, a few times where pixels add up
    assert np.abs(quick.radiance - whole.radiance).max() < 5e-5
    assert np.abs(quick.alpha - whole.alpha).max() < 2e-5
    assert quick.work.looked_up < 0.7 * whole.work.looked_up
    assert quick.work.seen < whole.work.seen


@pytest.mark.parametrize("mode", ["default", "fast", "paper"])
def test_nothing_is_done_behind_the_last_view_ray(mode):
    # A wall across the whole film, opaque long before its back
    vol, transfer = block(24.0, 24.0, 5.0)
    lit = scene(vol, transfer, frontal(6.0), size=(16, 16), pixel_filter=BOX, lights=SKY)
    quick = render_occlusion(lit, Occlusion(50, mode, grid=3))
    whole = render_occlusion(lit, Occlusion(50, mode, grid=3, skip=False))
    assert np.abs(quick.radiance - whole.radiance).max() < 5e-5
    assert quick.work.looked_up < 0.5 * whole.work.looked_up
    # Where a single ray gets past the wall, the sweep goes on
    beside = replace(lit, camera=frontal(6.0, centre=(9.0, 0.0, 0.0)))
    quick = render_occlusion(beside, Occlusion(50, mode, grid=3))
    whole = render_occlusion(beside, Occlusion(50, mode, grid=3, skip=False))
    assert (quick.alpha == 0).any()
    assert np.abs(quick.radiance - whole.radiance).max() < 5e-5


def test_bands_of_rows_change_only_the_order_of_sums(monkeypatch):
    # Room for one beam to be moved, and too little: then it goes in one band
    lit = scene(lumps(), medium(12.0), PERSPECTIVE, (40, 130), lights=SKY)
    for room in (traced.ROOM, 8):
        monkeypatch.setattr(traced, "ROOM", room)
        pictures = []
        for band in (64, 10**9):
            monkeypatch.setattr(traced, "BAND", band)
            pictures.append(render_occlusion(lit, Occlusion(70)))
        many, one = (picture.radiance for picture in pictures)
        assert np.abs(many - one).max() < 1e-5 * one.max()


def test_an_off_centre_window_is_a_part_of_the_whole():
    # HC-87: the right half of a film of twice the width, as a window off the axis
    lit = scene(lumps(), medium(12.0), PERSPECTIVE, (64, 32), lights=SKY, pixel_filter=BOX)
    half = replace(lit, size=(32, 32), camera=replace(PERSPECTIVE, window_centre=(1.0, 0.0)))
    whole = render_occlusion(lit, Occlusion(60))
    part = render_occlusion(half, Occlusion(60))
    np.testing.assert_allclose(part.alpha, whole.alpha[:, 32:], atol=2e-3)
    # Other occluders' rasters and directions, so only nearly the same light
    assert nrms(part.radiance, whole.radiance[:, 32:]) < 0.03


def test_an_object_that_leaves_the_film_has_no_halo():
    # HC-88: a slab seen head-on, larger than the film: even to the border
    picture = render_occlusion(half_space_scene(size=(24, 24)), Occlusion(60))
    light = picture.radiance[..., 1]
    assert light.max() / light.min() < 1.01


def test_no_light_is_lost_beside_a_silhouette():
    # A thin square in front of nothing: its own light only, up to its edge
    vol, transfer = block(1.0, 8.0, 1e-3, spacing=0.5)
    picture = render_occlusion(
        scene(vol, transfer, frontal(6.0), size=(48, 48), pixel_filter=BOX), Occlusion(80)
    )
    inside = picture.alpha > 0.9e-3
    np.testing.assert_allclose(picture.radiance[inside][:, 0], picture.alpha[inside], rtol=0.01)
    assert (picture.radiance[picture.alpha == 0] == 0).all()


def test_view_from_inside_the_volume():
    lit = scene(noise(17), medium(6.0), Camera((0, -0.2, 0), (0, 1, 0.1), view_angle=70),
                (32, 32), lights=SKY)  # fmt: skip
    # Monte Carlo sees light shaded behind the eye too; slices begin at the eye
    _, _, picture, reference = error_against_monte_carlo(lit, 40)
    assert nrms(picture.alpha, reference.alpha) < 0.06
    assert np.isfinite(picture.radiance).all()
    assert picture.radiance.mean() > 0.5 * reference.radiance.mean()


def test_reversed_axes_give_the_same_picture():
    # HC-93: the order of the slices follows the view, not the storage
    vol = lumps()
    values = np.ascontiguousarray(vol.values[::-1, ::-1, ::-1])
    turned = vol.index_to_world.copy()
    turned[:3, 3] += turned[:3, :3] @ (np.array(vol.shape) - 1)
    turned[:3, :3] *= -1
    mirrored = replace(vol, values=values, index_to_world=turned)
    pictures = [
        render_occlusion(scene(v, medium(12.0), PERSPECTIVE, (32, 32), lights=SKY), Occlusion(60))
        for v in (vol, mirrored)
    ]
    # The box around all medium, and with it the raster, may differ by a macrocell
    assert nrms(pictures[0].radiance, pictures[1].radiance) < 0.01


def test_empty_views_are_empty_pictures():
    dark = scene(lumps(), medium(0.0), PERSPECTIVE, (8, 8))
    away = replace(dark, transfer=medium(5.0), camera=Camera((0, -4, 0), (0, -8, 0)))
    for empty in (dark, away):
        for mode in ("default", "fast", "paper"):
            picture = render_occlusion(empty, Occlusion(60, mode))
            assert picture.alpha.max() == 0
            assert np.isinf(picture.depth).all()


def test_light_from_the_side_shades_the_other_side():
    lit = scene(lumps(), medium(12.0), PARALLEL, (48, 48), lights=SKY)
    left = render_occlusion(lit, Occlusion(30, toward_light=(-0.7, -1, 0)))
    right = render_occlusion(lit, Occlusion(30, toward_light=(0.7, -1, 0)))
    shift = (left.radiance - right.radiance)[..., 1]
    assert shift[:, :24].sum() > 0 > shift[:, 24:].sum()
    same = render_occlusion(lit, Occlusion(30, toward_light=-PARALLEL.frame[2]))
    usual = render_occlusion(lit, Occlusion(30))
    assert nrms(same.radiance, usual.radiance) < 0.02


def test_light_behind_the_picture_is_refused():
    lit = scene(lumps(), medium(12.0), PARALLEL, (8, 8))
    with pytest.raises(ValueError, match="viewer's side"):
        render_occlusion(lit, Occlusion(30, toward_light=(0, 1, 0)))


def test_coloured_light_keeps_the_colour_of_what_it_passes():
    red = medium(12.0, (0.9, 0.3, 0.1))
    lit = scene(lumps(), red, PERSPECTIVE, (32, 32), lights=SKY)
    plain = render_occlusion(lit, Occlusion(60)).radiance.sum((0, 1))
    bled = render_occlusion(lit, Occlusion(60, bleeding=1.0)).radiance.sum((0, 1))
    assert (bled > plain).all()
    assert bled[0] / plain[0] > bled[1] / plain[1] > bled[2] / plain[2] > 1
    white = scene(lumps(), medium(12.0, 0.0), PERSPECTIVE, (32, 32), lights=SKY)
    assert render_occlusion(white, Occlusion(60, bleeding=1.0)).radiance.max() == 0


def test_shading_darkens_what_is_turned_away():
    lit = scene(blob(33), medium(60.0), PARALLEL, (48, 48), lights=SKY,
                surface=Surface(1.0, specular=0.0))  # fmt: skip
    flat = render_occlusion(lit, Occlusion(20)).radiance[..., 1]
    round_ = render_occlusion(replace(lit, aovs=("normal",)), Occlusion(20, shaded=True))
    ratio = round_.radiance[..., 1] / np.maximum(flat, 1e-6)
    facing = -(round_.normal @ PARALLEL.frame[2])
    solid = (round_.alpha > 0.999) & (flat > 0.1)
    assert np.corrcoef(ratio[solid], facing[solid])[0, 1] > 0.9
    assert (np.linalg.norm(round_.normal[solid], axis=1) > 0.8).all()
    assert facing[solid].min() > -0.05


def test_ambient_radiance_scales_the_picture():
    lit = scene(blob(), medium(3.0), PARALLEL, (16, 16))
    one = render_occlusion(lit, Occlusion(60))
    sky = render_occlusion(replace(lit, lights=(ConstantEnvironment((2, 3, 4)),)), Occlusion(60))
    given = render_occlusion(lit, Occlusion(60, radiance=(2, 3, 4)))
    np.testing.assert_allclose(sky.radiance, one.radiance * (2, 3, 4), rtol=1e-5)
    np.testing.assert_array_equal(sky.radiance, given.radiance)


def test_the_picture_says_that_it_is_biased(tmp_path):
    lit = scene(blob(), medium(3.0), PARALLEL, (16, 16))
    picture = render_occlusion(lit, Occlusion(60))
    assert picture.standard_error is None
    assert picture.biased and picture.facts()["biased"] and picture.facts()["nrms"] is None
    assert "biased" in picture.plan.explain() and "biased" in str(picture)
    for suffix in (".png", ".npz", ".vti"):
        assert picture.save(tmp_path / f"a{suffix}").stat().st_size > 100


def test_abort_leaves_a_valid_picture():
    lit = scene(blob(), medium(3.0), PARALLEL, (16, 16))
    seen = []
    picture = render_occlusion(
        lit, Occlusion(60, slices=64), progress=lambda p: seen.append(p.fraction),
        abort=lambda: len(seen) > 2,
    )  # fmt: skip
    assert picture.stopped_by == "user"
    assert np.isfinite(picture.radiance).all()
    assert 0 < seen[0] < seen[1] < 1
    assert render_occlusion(lit).stopped_by == "end"


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"half_angle": 90}, "half_angle.*90"),
        ({"mode": "slow"}, "default, fast, paper.*slow"),
        ({"slices": 0}, "slices.*at least 1"),
        ({"directions": 10**6}, "at most 4096"),
        ({"mode": "paper", "bleeding": 0.5}, "bleeding must be 0"),
        ({"mode": "fast", "toward_light": (0, -1, 0)}, 'mode "default".*fast'),
        ({"detail": 0}, "detail.*0"),
        ({"grid": 65}, "at most 64"),
    ],
)
def test_bad_settings_are_explained(changes, message):
    with pytest.raises(ValueError, match=message):
        Occlusion(**changes)


def test_cameras_without_a_view_axis_are_refused():
    lit = scene(blob(), medium(3.0), size=(16, 8))
    with pytest.raises(ValueError, match="panorama"):
        render_occlusion(replace(lit, camera=Camera((0, -3, 0), (0, 0, 0), panorama=True)))
    eyes = Camera((0, -3, 0), (0, 0, 0), stereo=Stereo())
    with pytest.raises(ValueError, match="one eye"):
        render_occlusion(replace(lit, camera=eyes))
    one = replace(eyes, stereo=Stereo("left"))
    assert render_occlusion(replace(lit, camera=one)).alpha.max() > 0.5


@pytest.mark.parametrize("mode", ["default", "fast", "paper"])
def test_corners_of_a_wide_view_send_no_more_light_than_they_hide(mode):
    # White medium under a white sky, view rays up to 60 degrees off the axis
    eye = Camera((0, -1.3, 0), (0, 0, 0), view_angle=100)
    lit = scene(volume(np.ones((5, 5, 5)), (0.5,) * 3), medium(1.5), eye, (15, 15), lights=SKY)
    picture = render_occlusion(lit, Occlusion(60, mode))
    assert picture.alpha.max() > 0.5
    assert (picture.radiance <= 1.001 * picture.alpha[..., None]).all()


def test_a_view_through_a_keyhole_takes_no_more_steps_than_any_other():
    # A pixel 20 000 times smaller than a layer: beams in strides of pixels would not fit in memory
    def places(angle):
        camera = replace(PERSPECTIVE, view_angle=angle)
        lit = scene(blob(), medium(6.0), camera, (24, 24), lights=SKY)
        _, raster, _ = layout(lit, Occlusion(60))
        return sum(
            len(route.places) for route in beams_of(raster, np.radians(60), 64, None).routes(raster)
        )

    assert places(1e-3) <= 4 * places(32)
    lit = scene(blob(), medium(6.0), replace(PERSPECTIVE, view_angle=1e-3), (24, 24), lights=SKY)
    picture = render_occlusion(lit, Occlusion(60))
    assert np.isfinite(picture.radiance).all()
    assert np.ptp(picture.alpha) < 1e-3
