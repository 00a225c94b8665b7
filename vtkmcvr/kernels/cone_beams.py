"""Beams of light: what they let through, which directions are in a cone, and how long paths are."""

import math

import numpy as np

from .jit import device

f32 = np.float32
ZERO, HALF, ONE, TWO = f32(0.0), f32(0.5), f32(1.0), f32(2.0)
SIXTH, TWENTY_FOURTH = f32(1.0 / 6.0), f32(1.0 / 24.0)
# (1 - e^-x) / x as a quotient of polynomials: 1 - x/2 + x^2/6 at 0, 1/x at infinity, relative error
# 6e-4 in between
P1, P2, P3 = f32(0.28106047), f32(0.06866372), f32(0.01305129)
Q1, Q2 = f32(0.78106047), f32(0.29252)


@device
def transmitted(depth):
    """e^-depth for depth >= 0, absolute error 4e-6: a Taylor polynomial, squared six times.

    Without branches and integers, so that compilers turn it into vector code.
    """
    y = max(-depth, f32(-64.0)) * f32(1.0 / 64.0)
    p = ONE + y * (ONE + y * (HALF + y * SIXTH))
    p *= p
    p *= p
    p *= p
    p *= p
    p *= p
    return p * p


@device
def opacity(depth):
    """1 - e^-depth for depth >= 0, relative error 1e-6: as `transmitted`, by what is missing.

    Squaring 1 - x makes it 1 - x (2 - x).
    """
    y = min(depth, f32(64.0)) * f32(1.0 / 64.0)
    x = y * (ONE - y * (HALF - y * (SIXTH - y * TWENTY_FOURTH)))
    x *= TWO - x
    x *= TWO - x
    x *= TWO - x
    x *= TWO - x
    x *= TWO - x
    return x * (TWO - x)


@device
def mean_transmitted(x):
    """(1 - e^-x) / x: mean transmittance over a layer of optical depth x."""
    over = ONE + x * (P1 + x * (P2 + x * P3))
    return over / (ONE + x * (Q1 + x * (Q2 + x * (P2 + x * P3))))


@device
def eye_secant(perspective, row, column):
    """Length of the view ray per depth."""
    if perspective is None:
        return ONE
    x = (f32(column) + HALF - perspective.eye_column) * perspective.slope
    y = (f32(row) + HALF - perspective.eye_row) * perspective.slope
    return math.sqrt(ONE + x * x + y * y)


@device
def cone_weight(cone, lx, ly, x, y, upright):
    """Whether a direction lies in the cone, with a soft edge, per solid angle; and its secant.

    `upright` is the cosine of the view ray, which goes by (x, y) per depth.
    """
    square = ONE + lx * lx + ly * ly
    inverse = ONE / math.sqrt(square)
    if cone.around_view:
        cosine = (ONE - lx * x - ly * y) * inverse * upright
    else:
        cosine = (lx * cone.axis[0] + ly * cone.axis[1] + cone.axis[2]) * inverse
    share = min(max((cosine - cone.cosine) * cone.per_cosine + HALF, ZERO), ONE)
    return share * inverse * inverse * inverse, square * inverse


@device
def direction_by(perspective, cone, beam, zoom, row, column, upright):
    """Length of a beam's path per depth, as seen at a pixel, and its weight there.

    `upright` is the cosine of the pixel's view ray.
    """
    if perspective is None:
        square = beam.sideways_x * beam.sideways_x + beam.sideways_y * beam.sideways_y
        return math.sqrt(ONE + square), beam.weight
    x = (f32(column) + HALF - perspective.eye_column) * perspective.slope
    y = (f32(row) + HALF - perspective.eye_row) * perspective.slope
    lx, ly = beam.sideways_x * zoom - x, beam.sideways_y * zoom - y
    share, secant = cone_weight(cone, lx, ly, x, y, upright)
    return secant, share * beam.weight


@device
def direction_at(perspective, cone, beam, zoom, row, column):
    """The same where nothing is known of the view ray."""
    upright = ONE / eye_secant(perspective, row, column)
    return direction_by(perspective, cone, beam, zoom, row, column, upright)


@device
def relieved(relief, layer, row, column, depth):
    """Optical depth less what the raster's steps added to it, which may be in the layer itself."""
    if relief is None:
        return depth
    return depth - relief[layer, row, column]


@device
def span_of(perspective):
    """Columns over which directions go evenly."""
    if perspective is None:
        return 4096
    return perspective.span
