"""`vtkmcvr.count_work`: how often a camera path looks up, shades, casts rays, draws numbers.

The kernels' own sources run as plain Python, each function that is counted behind a counter. A
function that is handed None where its effect would be has nothing to do, and does not count.
"""

from __future__ import annotations

import functools
import math
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from .. import checks
from ..plan import Plan, plan
from ..rendering import empty_film
from ..scene import Scene
from .sources import DECORATORS, load_kernels

# What is counted -> functions and how many each call is worth. Where a name ends in "?", calls
# whose first argument is None do not count: the effect is absent.
WORK: dict[str, dict[str, int]] = {
    "camera rays": {"camera.ray_through": 1},
    "lens samples": {"camera.through_lens?": 1},
    "random numbers": {"rng.word": 1, "sobol.net_pair": 2},
    "walks of camera and scattered rays": {"tracking.sample_collision": 1},
    "shadow rays": {"tracking.transmittance?": 1},
    "rays drawn by scattering": {"direct.light_met": 1},
    "lookups": {"grid.trilinear": 1},
    "gradients": {"grid.gradient": 1},
    "transfer evaluations": {
        "transfer.extinction": 1, "transfer.rgb": 1, "transfer.number_channel?": 1,
        "transfer.gradient_factor": 1, "transfer.extinction_2d": 1, "transfer.colour_2d": 1,
    },
    "emission": {"transfer.emitted?": 1},
    "labels": {"transfer.of_label?": 1},
    "cuts": {"cut.clip_interval?": 1, "cut.outside_holes?": 1, "cut.in_regions?": 1},
    "scatterings": {"path.roulette": 1},
    "surface tests": {"brdf.surface_event?": 1},
    "opacities of surfaces": {"brdf.opacity_over": 1},
    "BRDF evaluations": {
        "brdf.brdf_value_and_pdf": 1, "brdf.brdf_weight_and_pdf": 1, "brdf.sample_brdf": 1,
    },
    "microfacets": {"brdf.microfacets": 1, "brdf.sample_microfacet": 1},
    "phase evaluations": {"phase.phase_value": 1, "phase.sample_phase": 1},
    "anisotropic phase evaluations": {"phase.phase_value?": 1, "phase.sample_phase?": 1},
    "MIS weights": {"direct.power_heuristic": 1},
    "light choices": {"light_tree.choose_light": 1},
    "light bounds met": {"light_tree.meets": 1},
    "area lights met": {"lights.area_light_distance": 1},
    "light densities": {"lights.area_light_pdf?": 1},
    "light textures": {"light_texture.texture_factor?": 1},
    "constant environment": {"environment.ambient_radiance?": 1},
    "environment lookups": {"environment.environment_radiance?": 1},
    "environment draws": {"environment.sample_environment": 1},
    "environment densities": {"environment.environment_pdf?": 1},
    "receivers": {"receivers.nearest_receiver?": 1},
    "backdrop": {"backdrop.ray_end?": 1},
    "moments of batches": {"sample.close_batch?": 1},
    "albedo and normal": {"sample.accumulate_aov?": 1},
}  # fmt: skip


@dataclass(frozen=True)
class Work:
    """What some camera paths of a scene did.

    Attributes
    ----------
    paths : int
    collisions : int
        Of the paths, those that met something.
    counts : dict
        Name of the work, of `vtkmcvr.work.count.WORK` -> how often, for all paths together.
    """

    paths: int
    collisions: int
    counts: dict[str, int]

    def __getitem__(self, name: str) -> int:
        if name not in self.counts:
            raise KeyError(f"{name!r} is not counted; counted are {', '.join(self.counts)}")
        return self.counts[name]

    def per_path(self, name: str) -> float:
        """How often in one path, on average."""
        return self[name] / self.paths

    def __str__(self) -> str:
        width = max(map(len, self.counts))
        lines = [f"{'in one of ' + str(self.paths) + ' camera paths':<{width}}"]
        for name, count in self.counts.items():
            lines.append(f"{name:<{width}}  {count / self.paths:10.4g}")
        return "\n".join(lines)


def count_work(scene: Scene | Plan, paths: int = 1000, seed: int = 0) -> Work:
    """Count what the camera paths of a scene do, spread evenly over the picture.

    Counts are those of the paths that a render with this seed starts with, up to roundings of
    compiled arithmetic. A zero is exact: what is not counted is not done.

    Parameters
    ----------
    scene : Scene or Plan
    paths : int
        At least as many paths are followed, in plain Python: about a thousand a second.
    seed : int
        >= 0.

    Returns
    -------
    Work

    Examples
    --------
    >>> work = vtkmcvr.count_work(scene)
    >>> work["gradients"], work.per_path("lookups")
    """
    checks.whole("paths", paths, least=1)
    checks.whole("seed", seed, least=0)
    planned = scene if isinstance(scene, Plan) else plan(scene)
    counts: Counter[str] = Counter()
    counted = functools.partial(_counted, counts)
    render_tile = load_kernels("cpu", dict.fromkeys(DECORATORS, counted)).render_tile
    film = empty_film(planned)
    # Arithmetic of NumPy's scalars tells of overflows, which random numbers are made of
    with np.errstate(all="ignore"):
        for row, column, samples in _places(film.count.shape, paths):
            goal = np.broadcast_to(samples, film.count.shape)
            render_tile(film, planned.packed, row, row + 1, column, column + 1, goal, seed)
    done = {name: counts[name] for name in WORK}
    return Work(int(film.count.sum()), int(film.hits.sum()), done)


def _places(shape: tuple[int, int], paths: int) -> Iterator[tuple[int, int, int]]:
    """Rows and columns that cover the film evenly, and the samples that each of them gets."""
    pixels = math.prod(shape)
    samples = -(-paths // pixels)
    for place in np.unique(np.linspace(0, pixels - 1, min(paths, pixels)).astype(int)):
        yield int(place // shape[1]), int(place % shape[1]), samples


def _counted(counts: Counter[str], function: Callable) -> Callable:
    """`function` with a counter for each kind of work that it is."""
    name = f"{function.__module__.rpartition('.')[2]}.{function.__name__}"
    always = _kinds(name)
    present = _kinds(f"{name}?")
    if not always and not present:
        return function

    @functools.wraps(function)
    def counting(first, *rest):
        for kind, worth in always:
            counts[kind] += worth
        if first is not None:
            for kind, worth in present:
                counts[kind] += worth
        return function(first, *rest)

    return counting


def _kinds(name: str) -> list[tuple[str, int]]:
    return [(kind, functions[name]) for kind, functions in WORK.items() if name in functions]
