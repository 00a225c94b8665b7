"""One sample of a pixel, and what it adds to the film: the body that all launchers share."""

import math

import numpy as np

from ..packed import BATCH
from .backdrop import accumulate_behind, accumulate_cover, before, ray_end
from .camera import film_position, ray_through
from .jit import device, glue
from .path import radiance
from .rng import start_path
from .vec import scale


@device
def close_batch(batches, row, column, n, mean):
    """Update the moments of the batch means where sample n ends a batch.

    The mean of all samples is that of all batch means, so that its step at the end of batch k,
    times k, is the deviation of batch k from the mean before it (Welford 1962).
    """
    if batches is None:
        return
    k = n // BATCH
    if k * BATCH != n:
        return
    for c in range(3):
        step = mean[row, column, c] - batches.mean[row, column, c]
        batches.mean[row, column, c] = mean[row, column, c]
        batches.m2[row, column, c] += k * (k - 1.0) * step * step


@device
def accumulate(film, row, column, L, hit, depth):
    """Update the running moments of a pixel by one sample (Welford 1962)."""
    n = film.count[row, column] + 1
    film.count[row, column] = n
    if not (math.isfinite(L[0]) and math.isfinite(L[1]) and math.isfinite(L[2])):
        film.rejected[row, column] += 1
        if L[0] == -math.inf or L[1] == -math.inf or L[2] == -math.inf:
            film.violations[row, column] += 1
        L = (np.float32(0.0), np.float32(0.0), np.float32(0.0))
    weight = 1.0 / n
    for c in range(3):
        delta = L[c] - film.mean[row, column, c]
        film.mean[row, column, c] += delta * weight
        film.m2[row, column, c] += delta * (L[c] - film.mean[row, column, c])
    close_batch(film.batches, row, column, n, film.mean)
    if hit:
        hits = film.hits[row, column] + 1
        film.hits[row, column] = hits
        film.depth[row, column] += (depth - film.depth[row, column]) / hits


@device
def accumulate_aov(plane, n, row, column, value):
    """Update the mean of what the first collision met by sample number n, from 1."""
    if plane is None:
        return
    weight = 1.0 / n
    for c in range(3):
        plane[row, column, c] += (value[c] - plane[row, column, c]) * weight


@glue
def camera_ray(columns, scene, row, column, sample, seed):
    """Ray of a sample of a pixel. Returns (origin float64, unit direction, stop, rng).

    `stop` is where it meets the backdrop, and which point of it.
    """
    pixel = row * columns + column
    rng = start_path(scene.sobol, seed, pixel, sample)
    x, y, rng = film_position(scene.camera, column, row, rng)
    origin, d, rng = ray_through(scene.camera, scene.lens, column, x, y, rng)
    return origin, d, ray_end(scene.backdrop, x, y, d), rng


@glue
def add_sample(film, scene, row, column, sample, d, stop, L, hit, depth, albedo, normal):
    """Add sample number `sample`, from 0, to the film: what `path.radiance` returns."""
    _, layer, i, j = stop
    left, shown = before(scene.backdrop, (layer, i, j), d, hit, depth)
    accumulate(film, row, column, scale(L, np.float32(left)), hit, depth)
    accumulate_aov(film.albedo, sample + 1, row, column, albedo)
    accumulate_aov(film.normal, sample + 1, row, column, normal)
    accumulate_cover(film.cover, sample + 1, row, column, hit, left)
    accumulate_behind(
        film.behind, scene.backdrop, sample + 1, row, column, (layer, i, j), hit, left, shown
    )


@glue
def take_sample(film, scene, row, column, sample, seed):
    """Add sample number `sample`, from 0, of a pixel to its film, which has those before it."""
    origin, d, stop, rng = camera_ray(film.count.shape[1], scene, row, column, sample, seed)
    L, hit, depth, albedo, normal = radiance(scene, origin, d, stop[0], rng)
    add_sample(film, scene, row, column, sample, d, stop, L, hit, depth, albedo, normal)
