"""All checks that take a GPU, in one command: `python tests/gpu -o gpu.json`.

Ends within ten minutes: a check that would start too late is left out and says so. Exit status: 0
where all that ran passed, 1 where one did not, 0 with a plain message where there is no device.
"""

import argparse
import datetime
import json
import platform
import sys
import time
import traceback
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parents[1])]

# The folders above come first
import agreement  # noqa: E402
import film_shown  # noqa: E402
import first_picture  # noqa: E402
import kept  # noqa: E402
import occluded  # noqa: E402
import several  # noqa: E402
import speed  # noqa: E402

from vtkmcvr import __version__  # noqa: E402
from vtkmcvr.gpu.available import missing  # noqa: E402

LIMIT = 540.0


def lookups():
    """Array against textures."""
    # Its kernels take numba-cuda
    import lookups as probe

    return probe.lookups()


# Name, seconds that it may need (a guess, on the safe side), what to call; first things first
CHECKS = (
    ("same_bits", 60, agreement.same_bits),
    ("agreement_single", 60, agreement.single),
    ("throughput", 90, speed.throughput),
    ("time_to_error", 60, speed.time_to_error),
    ("first_picture", 120, first_picture.first_picture),
    ("occlusion_same_bits", 40, occluded.same_bits),
    ("occlusion_agreement", 40, occluded.agreement),
    ("occlusion_throughput", 120, occluded.throughput),
    ("denoising", 20, occluded.denoising),
    ("film_on_device", 20, film_shown.film_on_device),
    ("live", 40, kept.live),
    ("bricks", 40, kept.bricks),
    ("lookups", 40, lookups),
    ("several_devices", 30, several.several_devices),
    ("occlusion_hard_cases", 40, occluded.hard_cases),
    ("agreement_multiple", 60, agreement.multiple),
    ("agreement_lights", 60, agreement.area_lights),
    ("agreement_cuts", 60, agreement.cuts),
    ("agreement_march", 60, agreement.march),
    ("hard_cases", 90, agreement.hard_cases),
)


def main():
    parser = argparse.ArgumentParser(prog="tests/gpu", description=__doc__)
    parser.add_argument("-o", "--output", default="gpu.json", help="default: gpu.json")
    parser.add_argument("--only", nargs="*", choices=[name for name, _, _ in CHECKS])
    args = parser.parse_args()
    absent = missing()
    if absent is not None:
        print(f"no GPU checks: {absent}")
        return 0
    report = {"machine": machine(), "checks": {}}
    start = time.perf_counter()
    for name, needed, check in CHECKS:
        if args.only and name not in args.only:
            continue
        if time.perf_counter() - start + needed > LIMIT:
            report["checks"][name] = {"left_out": "no time left"}
            continue
        report["checks"][name] = outcome = carried_out(check)
        print(f"{name}: {json.dumps(outcome)}", flush=True)
        report["seconds"] = time.perf_counter() - start
        Path(args.output).write_text(json.dumps(report, indent=1) + "\n")
    failed = [name for name, done in report["checks"].items() if done.get("passed") is False]
    verdict = f"FAILED: {', '.join(failed)}" if failed else "all passed"
    print(f"written: {args.output}; {verdict}")
    return 1 if failed else 0


def carried_out(check):
    """What a check says; an error is a check that failed."""
    start = time.perf_counter()
    try:
        outcome = check()
    except Exception:
        outcome = {"passed": False, "error": traceback.format_exc()}
    return {**outcome, "seconds_in_all": time.perf_counter() - start}


def machine():
    """What the figures belong to."""
    import numba
    import numba_cuda
    from numba import cuda

    from vtkmcvr.gpu.device import CudaDevice

    memory = cuda.current_context().get_memory_info()
    return {
        "device": CudaDevice().name,
        "device_memory": memory.total,
        "runtime": list(cuda.runtime.get_version()),
        "numba": numba.__version__,
        "numba_cuda": numba_cuda.__version__,
        "vtkmcvr": __version__,
        "python": platform.python_version(),
        "processor": platform.processor() or platform.machine(),
        "date": datetime.date.today().isoformat(),
    }


if __name__ == "__main__":
    sys.exit(main())
