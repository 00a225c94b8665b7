"""The bias audit, and the faults that it must find."""

import os
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import audit
import numpy as np
import pytest

REPOSITORY = Path(__file__).resolve().parents[2]


def check(record, found):
    """Every finding holds; the page shows the averages."""
    for finding in found:
        assert not finding.biased, finding
        if finding.scene == -1:
            tolerance = audit.TOLERANCE + audit.SIGMAS * finding.error
            what = f"{finding.quantity} over truth, {finding.estimator}"
            record("audit", what, "monte-carlo single", 1, finding.ratio, tolerance)


def test_no_estimator_is_biased(record):
    check(record, audit.audit(range(2), 256))


@pytest.mark.slow
def test_no_estimator_is_biased_in_twenty_scenes(record):
    found = audit.audit(range(20), 1024)
    check(record, found)
    # The averages are known to less than the tolerance, where light is not left to chance
    averages = [f for f in found if f.scene == -1 and f.estimator != "scatter sampling"]
    assert max(f.error for f in averages) < 5e-4


def lower_majorants(planned):
    """Plan whose majorants are 30 % too low."""
    medium = planned.packed.medium
    majorant = np.where(medium.majorant > 0, 0.7 * medium.majorant, medium.majorant)
    medium = medium._replace(majorant=majorant.astype(np.float32))
    return replace(planned, packed=planned.packed._replace(medium=medium))


def brighter(planned):
    """Plan whose rectangle shines with 1 % more radiance."""
    lights = planned.packed.area_lights
    (lamp,) = lights.few
    radiance = tuple(np.float32(1.01) * c for c in lamp.radiance)
    lights = lights._replace(few=(lamp._replace(radiance=radiance),))
    return replace(planned, packed=planned.packed._replace(area_lights=lights))


def test_majorants_too_low_are_found_and_counted(caplog):
    found = audit.audit(range(1), 64, lower_majorants)
    assert all(f.biased for f in found if f.quantity == "alpha" or "scatter" not in f.estimator)
    assert "met an extinction above its bound" in caplog.text


def test_one_per_cent_of_light_is_found():
    # 0.1 % + 4.5 standard errors of 0.12 % each
    found = audit.audit(range(1, 2), 1024, brighter)
    assert next(f for f in found if f.quantity == "radiance").biased


# Paths one by one, where they would go in step
ONE_BY_ONE = (
    "tiles.py", "    return COMPILED and all(effect is None for effect in others)\n",
    "    return False\n",
)  # fmt: skip
# Faults in the code: (file, what is there, what takes its place) of each change
FAULTS = {
    "majorant too low": [
        ("kernels/majorant.py", "= m * (f32(1.0) + ROUNDING)", "= m * f32(0.7)"),
    ],
    "swapped densities": [(
        "kernels/direct.py", "power_heuristic(light.pdf, pdf)",
        "power_heuristic(pdf, light.pdf)",
    )],
    "missing cosine of the surface": [
        ("kernels/brdf.py", "return scale(f, cos_i), HALF", "return f, HALF"),
    ],
    "missing cosine of the light": [(
        "kernels/shapes.py", "return distance * distance / (cosine * area)",
        "return distance * distance / area",
    )],
    "phase function turned round": [(
        "kernels/phase.py", "apart = add(wo, scale(wi, math.copysign(ONE, phase.shape)))",
        "apart = add(wo, scale(wi, -math.copysign(ONE, phase.shape)))",
    )],
    "ratio tracking by half": [(
        "kernels/packets.py", "left * (ONE - sigma_t / majorant)",
        "left * (ONE - np.float32(0.5) * sigma_t / majorant)",
    )],
    "roulette without its weight": [(
        "kernels/packets.py", "    left = select(low, roulette, left)\n", "",
    )],
    "ratio tracking by half, one by one": [ONE_BY_ONE, (
        "kernels/tracking.py", "T *= ONE - sigma_t / sigma_maj",
        "T *= ONE - f32(0.5) * sigma_t / sigma_maj",
    )],
    "roulette without its weight, one by one": [ONE_BY_ONE, (
        "kernels/tracking.py", "                    T = ratio.roulette\n",
        "                    T = ONE * T\n",
    )],
}  # fmt: skip


def run_audit(package_parent, cache):
    """Exit status of the audit on a copy of the package."""
    tests = REPOSITORY / "tests"
    script = tests / "hard_cases" / "audit.py"
    path = os.pathsep.join(map(str, (package_parent, tests, script.parent)))
    environment = {**os.environ, "PYTHONPATH": path, "NUMBA_CACHE_DIR": str(cache)}
    code = (
        "import sys, runpy, vtkmcvr\n"
        "assert vtkmcvr.__file__.startswith(sys.argv[1]), vtkmcvr.__file__\n"
        "sys.argv[:] = [sys.argv[2], '2', '128']\n"
        "runpy.run_path(sys.argv[0], run_name='__main__')"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(package_parent), str(script)], env=environment,
        capture_output=True, text=True, timeout=600, cwd=package_parent,
    )  # fmt: skip
    assert "Error" not in done.stderr, done.stderr
    return done.returncode


@pytest.mark.slow
@pytest.mark.parametrize("fault", [None, *FAULTS])
def test_audit_finds_every_fault(tmp_path, fault):
    shutil.copytree(
        REPOSITORY / "vtkmcvr", tmp_path / "vtkmcvr", ignore=shutil.ignore_patterns("__pycache__")
    )
    for name, whole, broken in FAULTS.get(fault, ()):
        path = tmp_path / "vtkmcvr" / name
        text = path.read_text(encoding="utf-8")
        assert text.count(whole) == 1, f"{name} has changed: renew the fault"
        path.write_text(text.replace(whole, broken), encoding="utf-8")
    assert run_audit(tmp_path, tmp_path / "cache") == (1 if fault else 0)
