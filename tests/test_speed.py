"""The page of speeds says what was measured, and the scenes behind it are what they are called."""

import json
import sys
from pathlib import Path

import pytest

from vtkmcvr.phantom import head_phantom
from vtkmcvr.plan import plan
from vtkmcvr.scene import Volume

BENCH = Path(__file__).parent / "bench"
DOCS = Path(__file__).resolve().parents[1] / "docs"


@pytest.fixture
def bench(monkeypatch):
    monkeypatch.syspath_prepend(str(BENCH))
    import bench_effects

    yield bench_effects
    sys.modules.pop("bench_effects")


def effects_of(scene):
    return {effect.name for effect in plan(scene).effects if effect.on}


def test_page_is_made_of_the_measurements(bench):
    facts = json.loads((DOCS / "speed.json").read_text(encoding="utf-8"))
    assert (DOCS / "speed.md").read_text(encoding="utf-8") == bench.page(facts)


def test_every_volume_has_every_effect_measured(bench):
    from vtkmcvr.front import scene_of

    dressed = scene_of(Volume.from_grid(*head_phantom(16)), preset="ct-bone", size=(8, 6))
    names = [name for _, name, _ in bench.with_effects(dressed)]
    facts = json.loads((DOCS / "speed.json").read_text(encoding="utf-8"))
    assert set(facts["volumes"]) == set(bench.SUBJECTS)
    for rows in facts["volumes"].values():
        assert [row["name"] for row in rows] == names
        assert all(row["seconds"] > 0 and row["nrms"] > 0 for row in rows)


def test_rows_add_the_effect_that_they_name_to_the_baseline(bench):
    from vtkmcvr.front import scene_of

    dressed = scene_of(Volume.from_grid(*head_phantom(16)), preset="ct-bone", size=(8, 6))
    scenes = {name: scene for _, name, scene in bench.with_effects(dressed)}
    base = effects_of(scenes["baseline"])
    added = {
        "thin lens": "depth of field",
        "constant environment": "constant environment",
        "environment map": "environment map",
        "albedo and normal": "first-hit AOVs",
        "hybrid surfaces": "surface shading",
    }
    for name, effect in added.items():
        assert effect not in base
        assert effect in effects_of(scenes[name])
    assert "shadows" in base
    assert "shadows" not in effects_of(scenes["no shadows"])
    assert len(scenes["64 lights"].lights) == 64
    assert len(scenes["2 lights"].lights) == 2
