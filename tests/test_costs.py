"""Studies of what accuracy costs, predictions, and the page about a picture."""

import base64
import dataclasses
import html.parser
import json
import math
import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest
from scenes import blob, everything, frontal, medium, render, scene, slab

from vtkmcvr import ColourCurve, Curve, Labels, Layer, Lens, Plane, PlaneReceiver, Surface
from vtkmcvr.cli import main
from vtkmcvr.costs import stored, summary
from vtkmcvr.costs.effects import SWITCHES, _without, effect_costs
from vtkmcvr.costs.families import LIGHTS, NUMBERS, RADII, apertures, families
from vtkmcvr.costs.figures import pareto
from vtkmcvr.costs.ladder import Reference, climb, make_reference
from vtkmcvr.costs.study import fingerprint, study
from vtkmcvr.costs.variants import BIAS, MODEL, SAME, variants
from vtkmcvr.effects import TOGETHER
from vtkmcvr.lights import ConstantEnvironment, irradiance_at
from vtkmcvr.occlusion import Occlusion
from vtkmcvr.pictures.files import write_png
from vtkmcvr.plan import plan
from vtkmcvr.prediction import estimate
from vtkmcvr.rendering import empty_film, render_scene
from vtkmcvr.report import error_map, write_report
from vtkmcvr.scene import Camera
from vtkmcvr.schedule import fill_up

LIT = (ConstantEnvironment(1.0),)


def small(**changes):
    return dataclasses.replace(scene(lights=LIT, size=(20, 16)), **changes)


# Errors against a reference


def test_error_against_a_reference_leaves_its_noise_out():
    rng = np.random.default_rng(1)
    truth = 1 + rng.random((40, 50, 3))
    reference = Reference(
        truth + 0.1 * rng.normal(size=truth.shape), np.full(truth.shape, 0.01), 1, 1.0
    )
    noisy = truth + 0.05 * rng.normal(size=truth.shape)
    expected = 0.05 / math.sqrt((truth**2).mean())
    nrms, spread = reference.error(noisy)
    # Square differences of 0.0125, of which 0.01 are the reference's: known to sqrt(2 / 6000) of
    # 0.0125, 0.00023, that is 9 % of 0.0025; two of those
    assert nrms == pytest.approx(expected, rel=0.1)
    assert 0.02 * expected < spread < 0.25 * expected


@pytest.mark.parametrize("seconds", [1e-9, 0.1])
def test_noise_of_a_reference_is_known_from_the_first_sample_on(seconds):
    # Square error of a reference against a far longer one, over its claim: 1024 grey values of
    # differences of two pictures, whose squares spread by sqrt(2 / 1024) = 4.4 % and by more for
    # their heavy tails
    planned = plan(small(size=(32, 32)))
    reference = make_reference(planned, seconds, 1)
    truth = render_scene(planned, samples=max(64 * reference.samples, 2000), seed=5).film.mean
    wrong = ((reference.radiance - truth) ** 2).mean()
    assert reference.variance.mean() == pytest.approx(wrong, rel=0.4)
    assert reference.samples >= 2


def entry(kind, samples, seconds, estimated, measured, spread=0.0, group="scene", name="as it is"):
    point = {"samples": samples, "seconds": seconds, "cpu_seconds": seconds}
    point |= {"estimated": estimated, "measured": measured}
    return {"group": group, "name": name, "kind": kind, "points": [{**point, "spread": spread}]}


def test_summary_extrapolates_by_the_inverse_square_root():
    row = summary.row(entry(SAME, 64, 3.2, 0.05, 0.05))
    assert row.seconds_per_sample == pytest.approx(0.05)
    assert row.noise == pytest.approx(0.4)
    assert row.seconds_to(0.1) == pytest.approx(0.8)
    assert row.seconds_to(0.01) == pytest.approx(80)
    assert row.nrms_after(0.8) == pytest.approx(0.1)
    assert not row.biased


def test_summary_tells_noise_from_bias():
    row = summary.row(entry(MODEL, 64, 1.0, 0.03, 0.05, 0.001))
    assert row.floor == pytest.approx(0.04)
    assert row.biased
    within = summary.row(entry(SAME, 64, 1.0, 0.03, 0.0301, 0.002))
    assert not within.biased
    # Of a denoised picture only the error itself is known
    denoised = summary.row(entry(BIAS, 4, 1.0, None, 0.08, 0.001))
    assert (denoised.noise, denoised.seconds_to(0.1), denoised.floor) == (None, None, 0.08)


def test_durations_and_errors_are_written_as_people_write_them():
    assert [summary.seconds(x) for x in (None, 0.0123, 4.56, 600, 7200)] == [
        "–", "12 ms", "4.6 s", "10 min", "2.0 h",
    ]  # fmt: skip
    assert [summary.percent(x) for x in (None, 0.5, 0.012, 0.0012)] == [
        "–", "50.0%", "1.2%", "0.12%",
    ]  # fmt: skip


# Studies


def test_variants_follow_the_scene():
    bare = {v.key for v in variants(small())}
    assert "without an effect: no shadows" in bare
    assert not any("surface" in key or "environment" in key for key in bare)
    dark = {v.key for v in variants(small(lights=()))}
    assert not any(key.startswith(("directions", "shadow rays")) for key in dark)
    assert len({v.key for v in variants(small())}) == len(variants(small()))


FEW = (
    "without an effect: no shadows",
    "denoiser: knn",
    "sampler: independent",
    "sampler: adaptive",
    "occlusion: fast, 60 degrees",
)


def pinhole(scene):
    (first, *_) = apertures(dataclasses.replace(scene, camera=Camera((0, -9, 0), (0, 0, 0))))
    return first


def by_samples(patch):
    """Let studies take samples instead of time, so that no other program decides what they see."""
    patch.setattr("vtkmcvr.costs.study.make_reference", reference_of_samples)
    patch.setattr("vtkmcvr.costs.study.climb", lambda *a, **k: climb(*a, **k, most=64))


def reference_of_samples(plan, seconds, threads, abort=None):
    a, b = (render_scene(plan, samples=256, seed=s, threads=1).film.mean for s in (77, 78))
    return Reference((a + b) / 2, (a - b) ** 2 / 4, 512, 1.0)


LONG = 1e4


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    folder = tmp_path_factory.mktemp("study")
    with pytest.MonkeyPatch.context() as patch:
        by_samples(patch)
        few = [v for v in variants(small()) if v.key in FEW]
        patch.setattr("vtkmcvr.costs.study.variants", lambda scene: few)
        patch.setattr("vtkmcvr.costs.study.families", lambda scene: [pinhole(scene)])
        found = study(small(), budget=LONG, folder=folder, threads=1)
    assert not found.left_out
    return folder, found


def test_study_measures_the_scene_and_its_variants(done):
    folder, found = done
    assert set(found.results["measured"]) == {"scene: as it is", *FEW, "aperture: pinhole"}
    rows = found.rows()
    assert rows[0].group == "scene" and not rows[0].biased
    last = rows[0].last
    # Both know the same error: 960 values, 5 % each way, and the reference's noise
    assert last["measured"] == pytest.approx(last["estimated"], rel=0.3)
    assert json.loads((folder / stored.RESULTS).read_text()) == found.results


def test_no_shadows_differ_as_another_model(done):
    rows = {row.name: row for row in done[1].rows()}
    assert rows["no shadows"].biased and rows["no shadows"].kind == MODEL


def test_occlusion_shows_its_bias_against_its_own_model(done):
    _, found = done
    (row,) = [row for row in found.rows() if row.group == "occlusion"]
    # Thin: light through the cone is hardly shaded, and a blur of it is near to the truth
    assert 0 < row.bias["nrms"] < 0.15 and row.bias["half_angle"] == 60
    assert found.results["cones"]["60"]["samples"] > 0
    assert summary.cone_seconds(row, found.results) > 0
    assert summary.percent(row.bias["nrms"]) in str(found)


def test_occlusion_of_a_scene_that_it_does_not_know_is_refused_with_the_reason(tmp_path):
    shaded = [v for v in variants(small()) if v.occlusion is not None][:1]
    panorama = small(camera=Camera((0, -5, 0), (0, 0, 0), panorama=True))
    with pytest.MonkeyPatch.context() as patch:
        by_samples(patch)
        patch.setattr("vtkmcvr.costs.study.variants", lambda scene: shaded)
        patch.setattr("vtkmcvr.costs.study.families", lambda scene: [])
        found = study(panorama, budget=LONG, threads=1)
    assert found.left_out == [] and "panorama" in found.results["refused"][shaded[0].key]
    assert "panorama" in str(found)


def test_occlusion_is_compared_by_mode_angle_and_slices():
    asked = [v.occlusion for v in variants(small()) if v.occlusion is not None]
    assert {o.mode for o in asked} == {"default", "fast", "paper"}
    assert len({o.half_angle for o in asked}) == 3
    assert len({o.slices for o in asked}) == 3
    assert all(isinstance(o, Occlusion) for o in asked)


def test_families_differ_in_one_quantity():
    members = families(scene(camera=Camera((0, -9, 0), (0, 0, 0)), lights=LIT))
    assert [v.name for v in members[:3]] == list(RADII)
    radii = [v.scene.camera.lens.radius if v.scene.camera.lens else 0 for v in members[:3]]
    assert radii == pytest.approx([0, 0.09, 0.36])
    lit = [v.scene.lights for v in members if v.group == LIGHTS]
    assert [len(lights) - 1 for lights in lit] == list(NUMBERS)
    for lights in lit:
        total = sum(irradiance_at(light, (0, 0, 0))[0] for light in lights[1:])
        assert total == pytest.approx(math.pi, rel=1e-3)
        places = {light.centre for light in lights[1:]}
        assert len(places) == len(lights) - 1 and all(y < 0 for _, y, _ in places)
    # A parallel view has no aperture
    assert not any(v.group == "aperture" for v in families(scene(camera=frontal(), lights=LIT)))


def test_pareto_front_has_what_nothing_beats():
    times, errors = [1, 2, 3, 4, 5, 6], [0.5, 0.6, 0.3, 0.3, 0.1, 0.2]
    points = [{"cpu_seconds": t, "measured": e} for t, e in zip(times, errors, strict=True)]
    assert [p["cpu_seconds"] for p in pareto(points[::-1])] == [1, 3, 5]


def test_maps_of_errors_hold_the_error(done):
    folder, found = done
    plane = stored.load_error(folder, "scene: as it is").astype(float)
    assert plane.shape == (16, 20)
    last = found.results["measured"]["scene: as it is"]["points"][-1]
    reference = found.results["reference"]["nrms"]
    # The map has the reference's noise in it
    rms = math.sqrt((plane**2).mean())
    assert rms == pytest.approx(math.hypot(last["measured"], reference), rel=0.02)
    wide = Reference(np.ones((100, 700, 3)), np.zeros((100, 700, 3)), 1, 1.0)
    reduced = stored.error_plane(wide.radiance + 0.25, wide)
    assert reduced.shape == (33, 233) and np.allclose(reduced, 0.25)


def test_study_says_what_it_left_out():
    found = study(small(), budget=1e-3, threads=1)
    assert list(found.results["measured"]) == ["scene: as it is"]
    assert found.left_out == [v.key for v in (*variants(small()), *families(small()))]
    assert all(key in str(found) for key in found.left_out)


def test_study_goes_on_where_it_stopped(done):
    folder, found = done
    again = study(small(), budget=1e-3, folder=folder, threads=1)
    for key, entry in found.results["measured"].items():
        assert again.results["measured"][key] == entry
    assert again.results["reference"] == found.results["reference"]


def test_study_of_another_scene_starts_anew(done, tmp_path):
    folder, found = done
    other = tmp_path / "other"
    shutil.copytree(folder, other)
    changed = small(transfer=medium(1.0))
    assert fingerprint(changed) != found.results["scene"] == fingerprint(small())
    fresh = study(changed, budget=0.5, folder=other, threads=1)
    assert fresh.results["scene"] == fingerprint(changed)
    assert fresh.results["reference"] != found.results["reference"]


def test_tables_and_figures_are_written(done, tmp_path):
    pytest.importorskip("matplotlib")
    _, found = done
    tables = found.write(tmp_path).read_text()
    for number in (found.rows()[0].seconds_to(0.1), found.rows()[0].seconds_to(0.01)):
        assert summary.seconds(number) in tables
    assert all(name in tables for name in ("as it is", "no shadows", "knn", "independent"))
    figures = found.draw(tmp_path)
    expected = {"convergence.png", "error-time.png", "aperture.png", "errors.png"}
    assert {figure.name for figure in figures} == expected
    for figure in figures:
        assert figure.read_bytes().startswith(b"\x89PNG") and figure.stat().st_size > 10_000


def test_a_broken_result_file_is_refused(tmp_path):
    (tmp_path / stored.RESULTS).write_text("{")
    with pytest.raises(ValueError, match=r"cost\.json is no result of a study"):
        study(small(), budget=0.5, folder=tmp_path)


@pytest.mark.parametrize(("sigma_t", "least", "most"), [(0.1, 0.0, 0.12), (20.0, 0.5, 20.0)])
def test_effects_change_the_picture_as_much_as_they_do(sigma_t, least, most):
    # Shadows in a slab of edge 1: optical depths of 0.05, or 10, on the way to the light
    slabs = scene(slab(), medium(sigma_t), lights=LIT, size=(16, 16))
    (cost,) = [c for c in effect_costs(slabs, 0.5, 1) if c.name == "no shadows"]
    assert least <= cost.change <= most


# Predictions


def test_prediction_is_close_to_what_happens():
    lit = scene(lights=LIT, size=(64, 48))
    predicted = estimate(lit, 0.02, pilot_seconds=0.5)
    picture = render(lit, samples=None, nrms=0.02)
    # The stop rule wants the upper end of the interval below the target: some 5 % more samples
    assert picture.samples == pytest.approx(predicted.samples, rel=0.15)
    assert predicted.low <= predicted.samples <= predicted.high
    assert predicted.memory >= lit.volume.values.nbytes + 64 * 48 * 3 * 8 * 2
    assert "2.00%" in str(predicted) and str(predicted.samples) in str(predicted)
    json.dumps(predicted.facts(), allow_nan=False)


def test_prediction_by_fewer_pixels_is_close_too():
    lit = scene(lights=LIT, size=(400, 300))
    few = estimate(lit, 0.02, pilot_seconds=0.05)
    assert few.pilot["pixels"] < 400 * 300 / 2 and few.pilot["samples"] >= 64
    assert few.samples == pytest.approx(estimate(lit, 0.02, pilot_seconds=3.0).samples, rel=0.15)


def test_prediction_does_not_mind_a_pilot_that_was_cut_off(monkeypatch):
    # Two thirds of the rows have three times the samples of the others
    lit = scene(lights=LIT, size=(64, 48))

    def cut_off(planned, seconds, threads):
        film = empty_film(planned)
        goal = np.full(film.count.shape, 64, np.int64)
        goal[16:] = 192
        fill_up(planned.packed, film, goal, 7)
        return film, 1.0

    even = estimate(lit, 0.02, pilot_seconds=1.0).samples
    monkeypatch.setattr("vtkmcvr.prediction._pilot", cut_off)
    assert estimate(lit, 0.02).samples == pytest.approx(even, rel=0.15)


def test_nothing_is_predicted_for_darkness():
    predicted = estimate(scene(lights=(), size=(8, 8)), 0.02, pilot_seconds=0.1)
    assert predicted.samples is None and predicted.seconds is None
    assert "no light" in str(predicted)
    with pytest.raises(ValueError, match="nrms"):
        estimate(small(), 0)


# Reports


class Page(html.parser.HTMLParser):
    def __init__(self):
        super().__init__()
        self.images, self.tags, self.text = [], set(), []

    def handle_starttag(self, tag, attributes):
        self.tags.add(tag)
        if tag == "img":
            self.images.append(dict(attributes)["src"])

    def handle_data(self, data):
        self.text.append(data)


def test_report_is_one_file_with_picture_error_effects_and_recipe(tmp_path):
    picture = render(scene(blob(), lights=LIT, size=(24, 18)), samples=16)
    path = write_report(picture, tmp_path / "r.html", effect_costs(small(), 0.1, 1))
    source = path.read_text(encoding="utf-8")
    assert "http://" not in source and "https://" not in source
    page = Page()
    page.feed(source)
    write_png(tmp_path / "p.png", picture.rgba)
    pictures = [base64.b64decode(src.partition(",")[2]) for src in page.images]
    assert pictures[0] == (tmp_path / "p.png").read_bytes() and len(pictures) == 2
    text = " ".join(page.text)
    assert f"{picture.nrms:.2%}" in text and "16 samples each" in text
    for effect in picture.plan.effects:
        assert effect.name in text
    assert "no shadows" in text


def test_report_says_that_samples_are_adaptive(tmp_path):
    picture = render(scene(blob(), lights=LIT, size=(24, 18)), samples=16, adaptive=True)
    path = write_report(picture, tmp_path / "r.html")
    assert "16 adaptive samples on average" in path.read_text(encoding="utf-8")


def test_error_map_is_dark_where_the_error_is_small():
    picture = render(scene(blob(), lights=LIT, size=(32, 24)), samples=64)
    shown = error_map(picture).astype(int).sum(-1)
    assert shown.shape == (24, 32)
    error = picture.standard_error.mean(-1)
    dark = error <= np.quantile(error, 0.1)
    assert shown[error > np.quantile(error, 0.9)].mean() > shown[dark].mean() + 100


def test_report_with_another_suffix_is_refused(tmp_path):
    picture = render(small(), samples=2)
    with pytest.raises(ValueError, match=r"\.html"):
        write_report(picture, tmp_path / "r.pdf")
    assert not list(tmp_path.iterdir())


def test_report_shows_both_pictures_in_a_browser(tmp_path):
    browser = shutil.which("chromium") or shutil.which("google-chrome")
    if browser is None:
        pytest.skip("no Chromium on this machine")
    imageio = pytest.importorskip("PIL.Image")
    picture = render(scene(blob(), lights=LIT, size=(200, 150)), samples=16)
    path = write_report(picture, tmp_path / "r.html")
    shot = tmp_path / "shot.png"
    command = [browser, "--headless", "--no-sandbox", "--disable-gpu", "--window-size=1000,900"]
    subprocess.run(
        [*command, f"--screenshot={shot}", path.as_uri()], check=True, capture_output=True,
        timeout=120,
    )  # fmt: skip
    seen = np.asarray(imageio.open(shot).convert("RGB")).astype(int)
    # The error map's warm colours and the ball's grey on a light or dark page
    warm = (seen[..., 0] - seen[..., 2] > 60).sum()
    assert warm > 1000


def test_plan_explains_what_each_effect_costs():
    dressed = small()
    costs = effect_costs(dressed, 0.1, 1)
    assert [cost.saved for cost in costs] == sorted(cost.saved for cost in costs)
    shadows = next(cost for cost in costs if cost.name == "no shadows")
    text = plan(dressed).explain(costs)
    line = next(x for x in text.splitlines() if x.startswith("shadows"))
    assert f"{shadows.saved:+.0%}" in line and f"{shadows.change:.1%}" in line
    assert "time" in text.splitlines()[0] and "picture" in text.splitlines()[0]
    # Nothing is said of what was not measured
    medium_line = next(x for x in text.splitlines() if x.startswith("medium"))
    assert "%" not in medium_line.partition("tracking")[0]


def test_each_switch_turns_off_what_it_says():
    glow = replace(medium(3.0, 0.5), emission=ColourCurve([(0, 1, 1, 1)]))
    steep = replace(medium(3.0), gradient_opacity=Curve([(0, 0.5), (1, 1)]))
    rich = everything(
        surface=Surface(specular=0.3), transfer=glow, clip=(Plane((0, 0, 0), (1, 0, 0)),),
        camera=Camera((0, -5, 0), (0, 0, 0), lens=Lens(0.1)),
        receivers=(PlaneReceiver((0, 0, -1), (0, 0, 1), (4, 4)),),
        layers=(Layer(blob(9), medium(1.0)),),
        labels=Labels(np.arange(17**3).reshape(17, 17, 17) % 2, {1: medium(5.0)}),
    )  # fmt: skip
    seen = set()
    for whole in (rich, small(scattering="multiple", aovs=("albedo",), transfer=steep)):
        before = {effect.name for effect in plan(whole).effects if effect.on}
        for name, without in _without(whole):
            after = {effect.name for effect in plan(without).effects if effect.on}
            switched = set(TOGETHER.get(SWITCHES[name], (SWITCHES[name],)))
            assert switched & before, name
            assert not switched & after, name
            seen.add(name)
    assert seen == set(SWITCHES)


def demo(tmp_path, *options):
    size = ["--size", "16x12", "--samples", "1", "-o", str(tmp_path / "p.png")]
    return main(["demo", *size, *options])


@pytest.mark.slow
def test_command_explains_and_measures(tmp_path, capsys):
    assert demo(tmp_path, "--explain", "measured") == 0
    line = next(x for x in capsys.readouterr().out.splitlines() if x.startswith("shadows"))
    assert line.count("%") == 2


def test_command_measures_no_occlusion(tmp_path, capsys):
    assert demo(tmp_path, "--explain", "measured", "--technique", "occlusion") == 2
    assert "not for --technique occlusion" in capsys.readouterr().err
