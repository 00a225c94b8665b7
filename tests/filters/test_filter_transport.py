"""All that a scene says about transport can be asked of the filter."""

import numpy as np
import pytest

from vtkmcvr.lights import EnvironmentMap
from vtkmcvr.scene import Isotropic, Rayleigh, Surface

ASKED = {
    "surface": Surface(0.8, mode="threshold", coat="ggx"),
    "phase": Rayleigh(),
    "shadow_reach": 2.5,
    "estimator": "woodcock",
    "ratio_tracking": False,
    "sampler": "independent",
}


def scene_of(pipeline):
    pipeline.source.Update()
    return pipeline.render.scene(pipeline.source.GetOutput())


def test_what_is_asked_reaches_the_scene(pipeline):
    before = scene_of(pipeline)
    assert before.surface is None
    assert isinstance(before.phase, Isotropic)
    for name, value in ASKED.items():
        assert getattr(before, name) != value
        setattr(pipeline.render, name, value)
    after = scene_of(pipeline)
    assert {name: getattr(after, name) for name in ASKED} == ASKED
    assert after.volume is before.volume


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("estimator", "delta", "estimator is one of majorant-grid, woodcock, ray-march"),
        ("sampler", "halton", "sampler is one of sobol, independent"),
        ("shadow_reach", -1.0, "shadow_reach"),
        ("surface", 0.5, "surface"),
        ("phase", 0.5, "phase"),
        ("nrms", 0.0, "nrms"),
    ],
)
def test_what_cannot_be_is_refused(pipeline, name, value, message):
    with pytest.raises((TypeError, ValueError), match=message):
        setattr(pipeline.render, name, value)


def test_error_that_is_asked_for_ends_the_render(pipeline, traced):
    pipeline.render.samples = None
    pipeline.render.nrms = 0.5
    pipeline.tone.Update()
    assert pipeline.render.picture.stopped_by == "nrms"
    pipeline.render.nrms = 0.4
    pipeline.tone.Update()
    assert len(traced) == 2


def test_another_environment_of_equal_scale_is_another_one(pipeline):
    dark, bright = (EnvironmentMap(np.full((2, 4, 3), x)) for x in (0.1, 1.0))
    for sky in (dark, bright):
        pipeline.render.environment = sky
        assert pipeline.render.environment is sky
        assert scene_of(pipeline).lights[-1] is sky
