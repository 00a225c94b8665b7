"""Samplers of directions against the density they claim.

Chance fails a right sampler in less than 1e-3 of all choices of seeds: each p-value is compared
with 1e-3 / TESTS (Bonferroni over all p-values of the files that use this).
"""

import math

import numpy as np
from scipy import stats

f32 = np.float32
TESTS = 300
N = 100_000
COSINES, ANGLES, FINER = 20, 24, 24


def p_value(counts, expected):
    """Chi-square p-value of counts in bins; bins that expect fewer than 5 are pooled."""
    counts, expected = np.ravel(counts), np.ravel(expected)
    enough = expected >= 5
    counts = np.append(counts[enough], counts[~enough].sum())
    expected = np.append(expected[enough], expected[~enough].sum())
    if expected[-1] < 5:
        # Too little even together: nearly nothing may fall there
        assert counts[-1] < 25
        counts, expected = counts[:-1], expected[:-1]
    statistic = ((counts - expected) ** 2 / expected).sum()
    return stats.chi2.sf(statistic, len(counts) - 1)


def bin_probabilities(density, cosines=COSINES, angles=ANGLES, finer=FINER):
    """Integral of a density per steradian over bins of (cos theta, phi), by Gauss-Legendre."""
    nodes, weights = np.polynomial.legendre.leggauss(finer)
    z = (2 * (np.arange(cosines)[:, None] + (nodes + 1) / 2) / cosines - 1).reshape(-1, 1)
    phi = (2 * (np.arange(angles)[:, None] + (nodes + 1) / 2) / angles - 1).reshape(1, -1) * math.pi
    r = np.sqrt(1 - z * z)
    d = np.stack(np.broadcast_arrays(r * np.cos(phi), r * np.sin(phi), z), -1).reshape(-1, 3)
    fine = density(d.astype(f32)).reshape(cosines, finer, angles, finer).astype(np.float64)
    return np.einsum("aibj,i,j->ab", fine, weights, weights) * (math.pi / (cosines * angles))


def direction_counts(directions, cosines=COSINES, angles=ANGLES):
    z = np.clip(directions[:, 2], -1, 1)
    phi = np.arctan2(directions[:, 1], directions[:, 0])
    limits = [[-1, 1], [-math.pi, math.pi]]
    return np.histogram2d(z, phi, (cosines, angles), limits)[0]


def check(directions, density, **bins):
    """Directions follow the density; what is missing to an integral of 1 has been rejected."""
    assert np.abs(np.linalg.norm(directions, axis=1) - 1).max() < 1e-5
    valid = density(directions) > 0
    expected = N * bin_probabilities(density, **bins)
    counts = direction_counts(directions[valid], **{k: v for k, v in bins.items() if k != "finer"})
    if valid.mean() > 0.9999:
        # Nothing is rejected but by rounding; the rest is the error of the quadrature
        assert abs(expected.sum() / N - 1) < 5e-3
    else:
        counts = np.append(counts, np.count_nonzero(~valid))
        expected = np.append(expected, N - expected.sum())
    assert p_value(counts, expected * (counts.sum() / expected.sum())) > 1e-3 / TESTS
