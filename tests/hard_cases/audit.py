"""Bias audit: radiance along single rays by every estimator, against quadrature in float64.

    PYTHONPATH=tests python tests/hard_cases/audit.py [SCENES] [SAMPLES]

Random noises with a ramp of extinction, as media or as surfaces, lit by a rectangle. Ends with
status 1 where an estimator is off by more than 1e-3 (and 4.5 standard errors), in one scene or on
average over all. Of the renderer, the reference uses the description of a scene only.
"""

import math
import sys
from dataclasses import dataclass, replace

import brute
import numpy as np
from brdf_reference import gloss, reference
from scenes import everything, medium, volume

from vtkmcvr.lights import RectangleLight
from vtkmcvr.plan import plan
from vtkmcvr.rendering import render_scene
from vtkmcvr.scene import Camera, HenyeyGreenstein, Surface

TOLERANCE, SIGMAS = 1e-3, 4.5
PIXELS, STEPS, SHADOW_STEPS, LIGHT_POINTS = 32, 400, 100, 6
ESTIMATORS = {
    "local majorants, MIS": {},
    "global majorant": {"estimator": "woodcock"},
    "shadows by delta tracking": {"ratio_tracking": False},
    "light sampling": {"light_sampling": "light"},
    "scatter sampling": {"light_sampling": "scatter"},
}


@dataclass(frozen=True)
class Finding:
    """An estimator's value over the true one, with its standard error."""

    scene: int
    estimator: str
    quantity: str
    ratio: float
    error: float

    @property
    def biased(self):
        return abs(self.ratio - 1) > TOLERANCE + SIGMAS * self.error


def random_scene(number):
    """Scene in which all pixels see along one ray."""
    rng = np.random.default_rng(number)
    values = rng.random((6, 5, 7)).astype(np.float32) * 0.8 + 0.2
    vol = volume(values, (0.3, 0.5, 0.4))
    d = rng.normal(size=3)
    d /= np.linalg.norm(d)
    aim = vol.centre + rng.uniform(-0.2, 0.2, 3)
    camera = Camera(aim - 5 * d, aim, (0.3, 0.5, 0.7), parallel_scale=1e-9)
    # On the viewer's side, so that surfaces are lit
    side = -d + 0.6 * rng.normal(size=3)
    place = vol.centre + side / np.linalg.norm(side) * rng.uniform(3, 4)
    light = RectangleLight(place, vol.centre, tuple(rng.uniform(1, 2, 2)), 20.0)
    mode = ("brdf", "threshold")[number % 2]
    return everything(
        light, vol=vol, transfer=medium(rng.uniform(1, 6), 0.8), camera=camera,
        surface=Surface(mode=mode, threshold=1.0, specular=0.3, exponent=5.0),
        phase=HenyeyGreenstein(rng.uniform(-0.7, 0.7)), size=(PIXELS, PIXELS),
    )  # fmt: skip


def light_points(light):
    """Points on a rectangle with their areas, by Gauss-Legendre, and its normal."""
    u, v, normal = light.frame
    x, w = np.polynomial.legendre.leggauss(LIGHT_POINTS)
    a, b = np.multiply(light.size, 0.5)
    points = light.centre + a * x[:, None, None] * u + b * x[None, :, None] * v
    return points.reshape(-1, 3), (a * b * np.outer(w, w)).ravel(), normal


def gradients(volume, x):
    """World gradients at points (n, 3): differences over one voxel to either side."""
    p, last = brute.to_index(volume, x), np.array(volume.shape) - 1
    found = np.empty_like(p)
    m = volume.index_to_world
    for axis in range(3):
        low, high = p.copy(), p.copy()
        low[:, axis] = np.maximum(p[:, axis] - 1, 0)
        high[:, axis] = np.minimum(p[:, axis] + 1, last[axis])
        a, b = (brute.scalars(volume, q @ m[:3, :3].T + m[:3, 3])[0] for q in (low, high))
        found[:, axis] = (b - a) / (high[:, axis] - low[:, axis])
    return found @ np.linalg.inv(m[:3, :3])


def scattered(scene, x, wo, wi):
    """Scattering function times cosine of points (n, 3), directions (n, m, 3): (n, m)."""
    albedo = 0.8
    if scene.surface.mode == "threshold":
        g = scene.phase.g
        cosine = -(wi @ wo)
        return albedo * (1 - g * g) / (4 * math.pi * (1 + g * g - 2 * g * cosine) ** 1.5)
    coat = gloss(scene.surface.specular, scene.surface.exponent)
    out = np.zeros(wi.shape[:2])
    normals = gradients(scene.volume, x)
    for i, n in enumerate(normals / np.linalg.norm(normals, axis=1, keepdims=True)):
        n = n if n @ wo > 0 else -n
        s = np.cross(n, (1, 0, 0) if abs(n[0]) < 0.5 else (0, 1, 0))
        s /= np.linalg.norm(s)
        frame = np.array([s, np.cross(n, s), n])
        local = wi[i] @ frame.T
        seen = local[:, 2] > 0
        if seen.any():
            out[i, seen] = reference(coat, (albedo,) * 3, frame @ wo, local[seen])[:, 0]
    return out


def true_values(scene):
    """Alpha and radiance along the scene's ray."""
    curve = brute.curve_of(scene)
    d = np.subtract(scene.camera.focal_point, scene.camera.position)
    d /= np.linalg.norm(d)
    o = np.array(scene.camera.position)
    near, far = (t[0] for t in brute.span(scene.volume, o[None], d[None]))
    dt = (far - near) / STEPS
    x = o + d * (near + dt * (np.arange(STEPS) + 0.5))[:, None]
    sigma = brute.extinction(scene.volume, curve, x)
    before = np.concatenate([[0.0], np.cumsum(sigma * dt)])
    weight = np.exp(-before[:-1]) * -np.expm1(-sigma * dt)
    light = next(light for light in scene.lights if isinstance(light, RectangleLight))
    points, areas, normal = light_points(light)
    away = points - x[:, None, :]
    r = np.linalg.norm(away, axis=-1)
    wi = away / r[..., None]
    incident = 20.0 * np.maximum(-(wi @ normal), 0) / r**2 * areas
    shadow = np.exp(-brute.optical_depth(
        scene.volume, curve, np.repeat(x, len(points), axis=0), wi.reshape(-1, 3),
        steps=SHADOW_STEPS,
    )).reshape(r.shape)  # fmt: skip
    L = (scattered(scene, x, -d, wi) * incident * shadow).sum(axis=1)
    return -math.expm1(-before[-1]), float((weight * L).sum())


def findings(numbers, samples, fault=None):
    """Compare every estimator in every scene; `fault` may spoil their plans."""
    for number in numbers:
        scene = random_scene(number)
        alpha, radiance = true_values(scene)
        for seed, (name, options) in enumerate(ESTIMATORS.items()):
            planned = plan(replace(scene, sampler="independent", **options))
            planned = fault(planned) if fault else planned
            film = render_scene(planned, samples=samples, seed=seed).film
            n = int(film.count.sum())
            error = math.sqrt(alpha * (1 - alpha) / n) / alpha
            yield Finding(number, name, "alpha", film.hits.sum() / n / alpha, error)
            # One ray: all pixels are samples of one mean
            mean = film.mean[..., 0].mean()
            apart = ((film.mean[..., 0] - mean) ** 2).sum()
            spread = film.m2[..., 0].sum() + film.count[0, 0] * apart
            error = math.sqrt(spread / n) / math.sqrt(n) / radiance
            yield Finding(number, name, "radiance", mean / radiance, error)


def on_average(found):
    """Findings of each estimator over all scenes, weighted by their errors."""
    for quantity in ("alpha", "radiance"):
        for name in ESTIMATORS:
            some = [f for f in found if (f.estimator, f.quantity) == (name, quantity)]
            w = np.array([1 / max(f.error, 1e-6) ** 2 for f in some])
            ratio = float((w * [f.ratio for f in some]).sum() / w.sum())
            yield Finding(-1, name, quantity, ratio, 1 / math.sqrt(w.sum()))


def audit(numbers, samples, fault=None):
    """All findings, single ones and averages."""
    found = list(findings(numbers, samples, fault))
    return [*found, *on_average(found)]


if __name__ == "__main__":
    given = [int(x) for x in sys.argv[1:]]
    scenes, count = (given + [4, 512][len(given) :])[:2]
    result = audit(range(scenes), count)
    for finding in result:
        if finding.biased or finding.scene == -1:
            print(finding, "BIASED" if finding.biased else "")
    sys.exit(any(finding.biased for finding in result))
