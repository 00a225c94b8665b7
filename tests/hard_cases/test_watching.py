"""What goes wrong at run time is counted and told: in Python, JSON, recipe, report and filter."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scenes import noise, scene
from techniques import SKY
from test_audit import lower_majorants

from vtkmcvr import cli
from vtkmcvr.filters import MonteCarloFilter
from vtkmcvr.occlusion import render_occlusion
from vtkmcvr.packed import Ambient
from vtkmcvr.plan import plan
from vtkmcvr.recipes.recipe import recipe_of
from vtkmcvr.rendering import render_scene
from vtkmcvr.report import write_report

LIT = scene(noise(), lights=SKY, size=(8, 8))


def spoilt_light(planned):
    """Plan whose sky is not a number."""
    nan = np.float32(np.nan)
    return replace(planned, packed=planned.packed._replace(ambient=Ambient((nan, nan, nan), None)))


def test_nothing_is_rejected_where_nothing_is_wrong(caplog):
    picture = render_scene(LIT, samples=16)
    assert picture.rejected_samples == 0
    assert picture.majorant_violations == 0
    assert "count as black" not in caplog.text
    assert render_occlusion(LIT).rejected_samples == 0


def test_samples_that_are_not_finite_are_counted(record, caplog, tmp_path):
    picture = render_scene(spoilt_light(plan(LIT)), samples=16)
    hits = int(picture.film.hits.sum())
    record("HC-54", "rejected under a sky that is NaN", "monte-carlo single", hits,
           picture.rejected_samples, 0)  # fmt: skip
    assert picture.majorant_violations == 0
    assert f"{hits} of 1024 samples were not finite" in caplog.text
    assert np.isfinite(picture.radiance).all()
    assert not picture.radiance.any()
    # Wherever a picture says what was measured
    assert picture.facts()["rejected_samples"] == hits
    assert recipe_of(picture)["measured"]["rejected_samples"] == hits
    page = write_report(picture, tmp_path / "a.html").read_text(encoding="utf-8")
    assert f"samples rejected: {hits}." in page


@pytest.mark.parametrize("ratio_tracking", [True, False])
@pytest.mark.parametrize("scattering", ["single", "multiple"])
def test_violated_majorants_are_counted(caplog, scattering, ratio_tracking):
    lit = replace(LIT, scattering=scattering, ratio_tracking=ratio_tracking)
    picture = render_scene(lower_majorants(plan(lit)), samples=16)
    violations = picture.majorant_violations
    assert 0 < violations == picture.rejected_samples
    assert f"({violations} of them met an extinction above its bound)" in caplog.text
    assert picture.facts()["majorant_violations"] == violations
    assert recipe_of(picture)["measured"]["majorant_violations"] == violations
    # A second run adds its own, and says so
    caplog.clear()
    more = picture.refine(samples=32)
    assert f"{more.rejected_samples - violations} of" in caplog.text


def test_command_line_writes_them_down(tmp_path):
    np.save(tmp_path / "a.npy", noise().values)
    measured = tmp_path / "a.json"
    cli.main(["render", str(tmp_path / "a.npy"), "-o", str(tmp_path / "a.png"), "--size", "8x8",
              "--samples", "2", "--json", str(measured)])  # fmt: skip
    facts = json.loads(measured.read_text(encoding="utf-8"))
    assert facts["rejected_samples"] == facts["majorant_violations"] == 0


def test_filter_hands_them_on():
    import pyvista

    image = pyvista.ImageData(dimensions=(9, 9, 9))
    image["scalars"] = noise().values.ravel()
    producer = MonteCarloFilter(film_size=(8, 8), samples=4)
    producer.SetInputDataObject(image)
    producer.Update()
    fields = pyvista.wrap(producer.GetOutputDataObject(0)).field_data
    assert list(fields["samples"]) == [4]
    assert list(fields["rejected_samples"]) == [0]
