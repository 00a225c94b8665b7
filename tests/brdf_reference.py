"""The Fresnel blend in float64, straight from its formula, and the kernels' for many directions."""

import math

import numpy as np

from vtkmcvr import packed
from vtkmcvr.kernels.brdf import brdf_value_and_pdf
from vtkmcvr.kernels.jit import entry_point

f32 = np.float32
UP = (f32(0), f32(0), f32(1))


@entry_point
def values_and_densities(gloss, diffuse, n, wo, wi):
    out = np.empty((len(wi), 4), np.float32)
    for i in range(len(wi)):
        d = (wi[i, 0], wi[i, 1], wi[i, 2])
        out[i, :3], out[i, 3] = brdf_value_and_pdf(gloss, diffuse, n, wo, d)
    return out


def direction(theta, phi=0.0):
    """Unit vector at an angle (degrees) to +z."""
    theta, phi = math.radians(theta), math.radians(phi)
    v = (math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta))
    return tuple(f32(x) for x in v)


def gloss(specular, exponent, ggx=False):
    return packed.Gloss(
        tuple(f32(x) for x in np.broadcast_to(specular, 3)), f32(exponent), np.bool_(ggx)
    )


def colour(value):
    return tuple(f32(x) for x in np.broadcast_to(value, 3))


def grid(m=512, n=40):
    """Midpoints of the unit square, (m * n, 2)."""
    u, v = (np.arange(m) + 0.5) / m, (np.arange(n) + 0.5) / n
    return np.stack(np.meshgrid(u, v, indexing="ij"), -1).reshape(-1, 2)


def on_hemisphere(cosine, phi):
    sine = np.sqrt(np.maximum(0, 1 - cosine**2))
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), cosine], -1)


def half_vector_cosine(coat, u):
    """Cosine of the half vector as each coat draws it."""
    e = float(coat.exponent)
    if not coat.ggx:
        return u ** (1 / (e + 1))
    return np.sqrt((1 - u) / (1 - u + 2 / (e + 2) * u))


def directional_albedo(coat, diffuse, wo):
    """Integral of the BRDF times cosine, by quadrature warped to each lobe (balance heuristic)."""
    u = grid()
    phi = 2 * np.pi * u[:, 1]
    body = on_hemisphere(np.sqrt(u[:, 0]), phi)
    h = on_hemisphere(half_vector_cosine(coat, u[:, 0]), phi)
    o = np.array(wo, np.float64)
    lobe = 2 * (h @ o)[:, None] * h - o
    total = np.zeros(3)
    for wi in (body, lobe):
        out = values_and_densities(coat, diffuse, UP, wo, wi.astype(f32)).astype(np.float64)
        # density is the mean of both lobes', so value / (2 density) is the balance heuristic's
        # share
        fine = out[:, 3] > 0
        total += (out[fine, :3] / (2 * out[fine, 3:])).sum(axis=0) / len(wi)
    return total


def reference(coat, diffuse, wo, wi):
    """Fresnel blend times cosine in float64, straight from the formula; n is +z."""
    o, i = np.array(wo, np.float64), np.asarray(wi, np.float64)
    rs, e = np.array(coat.specular, np.float64), float(coat.exponent)
    cos_o, cos_i = o[2], i[..., 2]
    h = i + o
    length = np.linalg.norm(h, axis=-1, keepdims=True)
    # wi.h of unit vectors; the product of float32 ones is wrong by 1e-7 / length
    h, cos_h = h / length, length[..., 0] / 2
    # log of h_z next to 1, from its sine
    log_nh = 0.5 * np.log1p(-np.minimum(h[..., 0] ** 2 + h[..., 1] ** 2, 1 - 1e-300))
    if coat.ggx:
        a, sine_2 = 2 / (e + 2), h[..., 0] ** 2 + h[..., 1] ** 2
        d = a / math.pi / (a * (1 - sine_2) + sine_2) ** 2
    else:
        d = (e + 2) / (2 * math.pi) * np.exp(e * log_nh)
    fresnel = rs + (1 - rs) * ((1 - cos_h) ** 5)[..., None]
    body = 28 / (23 * math.pi) * (1 - (1 - cos_i / 2) ** 5) * (1 - (1 - cos_o / 2) ** 5)
    coat_part = fresnel * (d / (4 * cos_h * np.maximum(cos_i, cos_o)))[..., None]
    return (np.array(diffuse) * (1 - rs) * body[..., None] + coat_part) * cos_i[..., None]
