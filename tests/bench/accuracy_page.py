"""docs/accuracy.md from docs/accuracy.json: no number on the page comes from anywhere else."""

from __future__ import annotations

import math
from typing import Any

from vtkmcvr.costs import summary
from vtkmcvr.costs.summary import percent, seconds

Facts = dict[str, Any]
COMMAND = "python tests/bench/bench_accuracy.py"
NOISY = 0.9
# Seconds that all parts take together
FULL_BUDGET = 720.0


def page(facts: Facts) -> str:
    """Markdown; the answers come first."""
    parts = [
        ["# What accuracy costs", ""],
        _answers(facts),
        _conditions(facts),
        _volumes(facts),
        _convergence(facts),
        _predictions(facts),
        _adaptive(facts),
        _occlusion(facts),
        _peers(facts),
        _study(facts),
    ]
    return "\n".join(line for part in parts for line in part).rstrip() + "\n"


def share_of_cores(facts: Facts) -> float:
    """Processor seconds over seconds of the clock, of the longest renders."""
    full = [found["full"] for found in facts["volumes"].values()]
    return sum(f["cpu_seconds"] for f in full) / sum(f["seconds"] for f in full)


def seconds_to(found: Facts, target: float) -> float:
    """Seconds at 800 x 600 until the error is down to a target, by its inverse square."""
    full = found["full"]
    return full["cpu_seconds"] * (full["nrms"] / target) ** 2


def _range(values: list[float | None], write: Any) -> str:
    known = [x for x in values if x is not None]
    return f"{write(min(known))} to {write(max(known))}" if known else write(None)


def _answers(facts: Facts) -> list[str]:
    volumes = facts["volumes"]
    ten = [seconds_to(found, 0.1) for found in volumes.values()]
    one = [seconds_to(found, 0.01) for found in volumes.values()]
    second = [found["full"]["one_second"]["nrms"] for found in volumes.values()]
    lines = [
        f"{len(volumes)} volumes at 800 x 600 on {facts['threads']} threads, lit by an environment "
        "and two area lights. An error is the RMS over all pixels of the difference from the true "
        "radiance, over its RMS (NRMS).",
        "",
        f"- **10 %** costs {_range(ten, seconds)}.",
        f"- **1 %** costs {_range(one, seconds)}: a hundred times as much, since the error falls "
        "with the root of the samples.",
        f"- **One second** gives an error of {_range(second, percent)}.",
    ]
    if "study" in facts:
        lines.append(f"- **Effects**: {_effects(facts)}.")
    if "occlusion" in facts:
        lines.append(f"- **Occlusion** is enough {_enough(facts)}.")
    return [*lines, ""]


def _effects(facts: Facts) -> str:
    """What leaving each effect out changes of the time of a sample."""
    rows = summary.rows(facts["study"])
    base = rows[0].seconds_per_sample
    off = [row for row in rows if row.group == "without an effect"]
    parts = [f"{row.name} {row.seconds_per_sample / base - 1:+.0%}" for row in off]
    parts += [
        f"{row.name} scattering {row.seconds_per_sample / base - 1:+.0%}"
        for row in rows
        if row.group == "scattering"
    ]
    return f"of the time per sample of the {facts['studied']}, " + ", ".join(parts)


def _enough(facts: Facts) -> str:
    modes = [found["modes"]["default"] for found in facts["occlusion"].values()]
    fast = [found["modes"]["fast"] for found in facts["occlusion"].values()]
    return (
        "where a model of light from the viewer's side is wanted, and an error of "
        f"{_range([m['nrms'] for m in modes], percent)} of that model: it takes "
        f"{_range([m['seconds'] for m in modes], seconds)} at 400 x 300, without noise, and "
        f"Monte Carlo of the same model takes "
        f"{_range([m['same_noise_seconds'] for m in modes], seconds)} to get as near (mode fast: "
        f"{_range([m['nrms'] for m in fast], percent)} in "
        f"{_range([m['seconds'] for m in fast], seconds)}). It is not where shadows and light from "
        "the side count: from the picture with all lights it differs by "
        f"{_range([m['matched'] for m in modes], percent)} at the best brightness, whatever time "
        "it gets"
    )


def _conditions(facts: Facts) -> list[str]:
    machine = facts["machine"]
    share = share_of_cores(facts)
    lines = [
        f"{machine['processor']}, {facts['threads']} threads of {machine['cpus']} CPUs, Python "
        f"{machine['python']}, Numba {machine['numba']}"
        + (f", Mitsuba {machine['mitsuba']}" if machine["mitsuba"] else "")
        + ". Seconds are processor seconds over the number of threads: those of the clock where "
        f"nothing else runs; here the clock gave {share:.0%} of them. Compilation and reading are "
        "not counted.",
    ]
    if share < NOISY:
        lines.append(
            "**Other programs ran during these measurements: seconds are too long, and ratios of "
            "them uncertain.**"
        )
    return [
        *lines,
        "",
        f"Written by {_command(facts)} from the numbers in [accuracy.json](accuracy.json); a test "
        "checks that they agree.",
        "",
    ]


def _command(facts: Facts) -> str:
    """What was run, and how long its parts were allowed to take where that is not the default."""
    short = {part: x for part, x in facts["budgets"].items() if x != FULL_BUDGET}
    if not short:
        return f"`{COMMAND}`"
    budgets = ", ".join(f"{part} {seconds(x)}" for part, x in short.items())
    return (
        f"a reduced run of `{COMMAND}` (budgets of its parts instead of {seconds(FULL_BUDGET)}: "
        f"{budgets}; numbers are rougher than those of the command as it is)"
    )


def _volumes(facts: Facts) -> list[str]:
    lines = [
        "## Seconds to 10 %",
        "",
        "| volume | points | M paths/s | samples to 10 % | seconds to 10 % | to 1 % | error "
        "after 1 s (samples) |",
        "|---|---|---|---|---|---|---|",
    ]
    for name, found in facts["volumes"].items():
        full = found["full"]
        samples = full["samples"] * (full["nrms"] / 0.1) ** 2
        second = full["one_second"]
        lines.append(
            f"| {name} | {' x '.join(map(str, full['shape']))} {full['type']} "
            f"| {full['paths_per_second'] / 1e6:.2f} | {samples:.0f}{_mark(full)} "
            f"| {seconds(seconds_to(found, 0.1))} | {seconds(seconds_to(found, 0.01))} "
            f"| {percent(second['nrms'])} ({second['samples']}) |"
        )
    lines += [
        "",
        "Rendered with `nrms=0.1`, which stops when the upper end of the 95 % interval is below "
        "10 %; samples and seconds are scaled from the error reached to 10 % and to 1 % by the "
        "inverse square.",
    ]
    if any(_mark(found["full"]) for found in facts["volumes"].values()):
        reached = [f["full"]["nrms"] for f in facts["volumes"].values() if _mark(f["full"])]
        lines.append(
            f"(\\*) The time was over at an error of {_range(reached, percent)}; scaled from there."
        )
    return [*lines, ""]


def _mark(full: Facts) -> str:
    return "" if full["stopped_by"] == "nrms" else "\\*"


def _convergence(facts: Facts) -> list[str]:
    lines = [
        "## How the error falls",
        "",
        "![Convergence of the volumes](images/accuracy-volumes.png)",
        "",
        "Measured against a reference of the same scene at 400 x 300, whose own noise is taken "
        "off; bands are 95 % intervals. Squares are what the picture itself says without a "
        "reference: below 32 samples of Sobol points, which are fewer than two batches, an upper "
        "estimate.",
        "",
        "![The same against seconds](images/accuracy-seconds.png)",
        "",
    ]
    if "fall" not in facts:
        return lines
    fall = facts["fall"]
    width, height = fall["size"]
    most = fall["independent"]["points"][-1]["samples"]
    return [
        *lines,
        f"From 1 to {most} samples ({facts['studied']}, {width} x {height}, pairs of independent "
        "pictures), fitted exponents with 95 % half widths: independent samples "
        f"{_exponent(fall['independent'])}, Sobol points {_exponent(fall['sobol'])}. "
        f"At {most} samples the error is {percent(fall['independent']['points'][-1]['nrms'])} and "
        f"{percent(fall['sobol']['points'][-1]['nrms'])}.",
        "",
        "![From 1 sample on](images/accuracy-fall.png)",
        "",
    ]


def _exponent(found: Facts) -> str:
    return f"{found['exponent']:.3f} ± {found['spread']:.3f}"


def _predictions(facts: Facts) -> list[str]:
    lines = [
        "## Predictions",
        "",
        "`vtkmcvr.estimate` for 10 % at 800 x 600, from a pilot of two seconds, against what the "
        "render then took. The stop rule wants the upper end of the interval below the target, "
        "which costs some percent more.",
        "",
        "| volume | samples predicted | needed | off by | seconds predicted | needed | off by |",
        "|---|---|---|---|---|---|---|",
    ]
    for name, found in facts["volumes"].items():
        predicted, full = found["full"]["predicted"], found["full"]
        samples = full["samples"] * (full["nrms"] / predicted["nrms"]) ** 2
        spent = full["seconds"] * (full["nrms"] / predicted["nrms"]) ** 2
        lines.append(
            f"| {name} | {predicted['samples']} | {samples:.0f} "
            f"| {predicted['samples'] / samples - 1:+.0%} | {predicted['seconds']:.1f} "
            f"| {spent:.1f} | {predicted['seconds'] / spent - 1:+.0%} |"
        )
    return [*lines, "", "Seconds of the clock here, as the prediction's are.", ""]


def _adaptive(facts: Facts) -> list[str]:
    lines = [
        "## Adaptive samples",
        "",
        "`render(adaptive=True)`: time of evenly spread samples over that of adaptive ones at "
        "equal error, the pilot counted; above 1, adaptive samples are quicker.",
        "",
        "| volume | quicker by | 95 % interval |",
        "|---|---|---|",
    ]
    for name, found in facts["volumes"].items():
        if "half" in found:
            gain = found["half"]["gain"]
            lines.append(
                f"| {name} | {gain['ratio']:.2f} x | {gain['low']:.2f} to {gain['high']:.2f} |"
            )
    return [
        *lines,
        "",
        "Rays that miss the volume cost little, so that saving them saves little; that is why it "
        "is off by default.",
        "",
    ]


def _occlusion(facts: Facts) -> list[str]:
    if "occlusion" not in facts:
        return []
    lines = [
        "## When occlusion is enough",
        "",
        "Directional occlusion, half angle 60 degrees, 400 x 300. Its bias is the difference from "
        "Monte Carlo of the light that it stands for; the last but one column says when Monte "
        "Carlo of that light has as much noise. The last one is the difference from the picture "
        "with all its lights, at the best brightness: of models, no error of the method.",
        "",
        "| volume | mode | seconds | bias | Monte Carlo with as much noise | other model |",
        "|---|---|---|---|---|---|",
    ]
    for name, found in facts["occlusion"].items():
        for mode, m in found["modes"].items():
            lines.append(
                f"| {name} | {mode} | {seconds(m['seconds'])} | {percent(m['nrms'])} "
                f"| {seconds(m['same_noise_seconds'])} | {percent(m['matched'])} |"
            )
    return [*lines, "", "More of it, with angles and slices: [occlusion.md](occlusion.md).", ""]


def _peers(facts: Facts) -> list[str]:
    if not facts.get("peers"):
        return []
    first = next(iter(facts["peers"].values()))
    width, height = first["size"]
    lines = [
        "## Beside Mitsuba",
        "",
        "Mitsuba's variants for the CPU on the same grids of extinction and albedo, baked from the "
        f"look, without surfaces, single scattering, the same three lights, {width} x {height}, "
        f"in turns in the same run, the least time of {first['turns']}. z: difference of the mean "
        "radiance in its standard errors, to the first variant. Quicker by: than its best variant.",
        "",
        "| volume | | M paths/s | error (samples) | seconds to 10 % | quicker by | z |",
        "|---|---|---|---|---|---|---|",
    ]
    for name, found in facts["peers"].items():
        best = min(row["seconds_to_10_percent"] for row in found["rows"][:-1])
        for row in found["rows"]:
            ratio = best / row["seconds_to_10_percent"]
            lines.append(
                f"| {name} | {row['name']} | {row['paths_per_second'] / 1e6:.3f} "
                f"| {percent(row['nrms'])} ({row['samples']}) "
                f"| {seconds(row['seconds_to_10_percent'])} | {ratio:.1f} x "
                f"| {found['mean_z']:+.1f} |"
            )
    return [*lines, ""]


def _study(facts: Facts) -> list[str]:
    if "study" not in facts:
        return []
    return [
        f"## Every choice, on the {facts['studied']}",
        "",
        "As `vtkmcvr cost` measures it on any volume. Errors and biases are against a reference by "
        "Monte Carlo of the same scene; families of scenes have references of their own.",
        "",
        summary.markdown(facts["study"]).rstrip(),
        "",
        "![Error against time](images/accuracy-error-time.png)",
        "",
        "![Three apertures](images/accuracy-aperture.png)",
        "",
        "![1 to 16 lights](images/accuracy-lights.png)",
        "",
        "![Where the errors are](images/accuracy-errors.png)",
        "",
    ]


def finite(facts: Facts) -> bool:
    """Whether the numbers that the page divides by are there."""
    return all(
        math.isfinite(f["full"]["nrms"] or math.nan) and f["full"]["predicted"]["samples"]
        for f in facts["volumes"].values()
    )
