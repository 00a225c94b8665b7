"""The lights of a scene to choose from, many as a binary tree; see `kernels.light_tree`."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from .. import packed
from ..pack import f32, vector

# How flux becomes irradiance, as in `kernels.light_tree`
DECAYING, STEADY, DISTANT, AROUND = range(4)
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
# Of a light that faces away: it may still be in sight of some places
LEAST_COSINE = 0.02
NEAR = 0.05
# Lengths of the lists of lights of which each is asked
FEW = 1, 2, 4
Light = TypeVar("Light")
_NOWHERE = (f32(0), f32(0), f32(0))
NOTHING = packed.LightNode(
    _NOWHERE, f32(-1), _NOWHERE, f32(-1), f32(-1), f32(0), f32(0), np.int32(AROUND)
)


@dataclass(frozen=True, eq=False)
class Leaf:
    """What is known of one light, or of a cluster.

    Parameters
    ----------
    law : int
        DECAYING, STEADY, DISTANT or AROUND.
    flux : float
        Irradiance that it sends; at unit distance where it decays. 0: never chosen.
    centre, radius
        Sphere around it, relative to the volume's centre. radius < 0: there is none.
    axis : array (3,)
        Direction in which it emits.
    spread : float
        Largest angle between the axis and a light's own axis; pi: it emits all around.
    reach : float
        Largest angle to its own axis under which a light emits.
    within : float
        Irradiance that it sends to places of the volume, on average.
    """

    law: int
    flux: float
    centre: NDArray = field(default_factory=lambda: np.zeros(3))
    radius: float = -1.0
    axis: NDArray = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))
    spread: float = math.pi
    reach: float = math.pi / 2
    within: float = 0.0

    def seen_from(self, places: NDArray) -> Leaf:
        """Return the same light with what it sends to places (n, 3)."""
        if self.law != DECAYING:
            return replace(self, within=self.flux)
        way = places - self.centre
        # A place stands for the space around it
        nearest = NEAR * np.mean(np.sum(places * places, axis=1)) + self.radius**2
        square = np.maximum(np.sum(way * way, axis=1), nearest)
        cosine = way @ self.axis / np.sqrt(square)
        facing = np.maximum(cosine, LEAST_COSINE) if self.spread < math.pi else 1.0
        return replace(self, within=self.flux * float(np.mean(facing / square)))


@dataclass(frozen=True, eq=False)
class _Node:
    bounds: Leaf
    light: int = -1
    parts: tuple[_Node, ...] = ()


def pack_set(leaves: list[Leaf], places: NDArray) -> packed.LightSet:
    """All lights, to choose from.

    Parameters
    ----------
    leaves : list of Leaf
    places : array (n, 3)
        Where light is wanted, relative to the volume's centre: what a cluster that surrounds a
        point sends there is estimated by what it sends to these on average.
    """
    leaves = [leaf.seen_from(places) for leaf in leaves]
    few = few_of([_values(leaf) for leaf in leaves], NOTHING)
    return packed.LightSet(np.int32(len(leaves)), few, None if few else build_tree(leaves))


def few_of(lights: list[Light], dark: Light) -> tuple[Light, ...] | None:
    """The lights and dark ones, as many as kernels ask one by one; None where there are more.

    Kernels are compiled for each of these lengths, not for each number of lights.
    """
    for length in FEW:
        if len(lights) <= length:
            return (*lights, *[dark] * (length - len(lights)))
    return None


def build_tree(leaves: list[Leaf]) -> packed.LightTree:
    """Tree of all lights; those of one law are clustered by place or direction."""
    nodes = [_Node(leaf, i) for i, leaf in enumerate(leaves)]
    groups = [[n for n in nodes if n.bounds.law == law] for law in (DECAYING, STEADY, DISTANT)]
    around = [n for n in nodes if n.bounds.law == AROUND]
    clusters = [_cluster(group) for group in groups if group] + around
    root = clusters.pop()
    while clusters:
        root = _join(clusters.pop(), root)
    return _flatten(root, len(leaves))


def _cluster(nodes: list[_Node]) -> _Node:
    """Binary tree of lights of one law."""
    if len(nodes) == 1:
        return nodes[0]
    order, cut = _best_split(nodes)
    return _join(
        _cluster([nodes[i] for i in order[:cut]]), _cluster([nodes[i] for i in order[cut:]])
    )


def _best_split(nodes: list[_Node]) -> tuple[NDArray, int]:
    """Order along an axis and where to cut it.

    The cost of a half is its flux times the squared size of the box around it, as in a surface area
    heuristic. No more than 7/8 of many lights stay together, so that the tree is not deep.
    """
    distant = nodes[0].bounds.law == DISTANT
    places = np.array([n.bounds.axis if distant else n.bounds.centre for n in nodes])
    radii = np.array([max(n.bounds.radius, 0.0) for n in nodes])[:, None]
    flux = np.array([n.bounds.flux for n in nodes])
    flux += 1e-6 * flux.sum() + 1e-30
    count = len(nodes)
    allowed = np.arange(1, count)[max(count // 8 - 1, 0) : count - max(count // 8, 1)]
    found: list[tuple[float, int, NDArray]] = []
    for axis in range(3):
        order = np.argsort(places[:, axis], kind="stable")
        left = _costs(places[order], radii[order], flux[order])
        right = _costs(places[order[::-1]], radii[order[::-1]], flux[order[::-1]])[::-1]
        costs = left[allowed - 1] + right[allowed]
        # Where all lie in one place, halves are as good as anything
        k = int(np.lexsort((abs(allowed - count / 2), costs))[0])
        found.append((float(costs[k]), int(allowed[k]), order))
    _, cut, order = min(found, key=lambda split: split[0])
    return order, cut


def _costs(places: NDArray, radii: NDArray, flux: NDArray) -> NDArray:
    """Cost of the first 1, 2, ... lights as a cluster."""
    low = np.minimum.accumulate(places - radii)
    high = np.maximum.accumulate(places + radii)
    return np.cumsum(flux) * np.sum((high - low) ** 2, axis=1)


def _join(a: _Node, b: _Node) -> _Node:
    x, y = a.bounds, b.bounds
    centre, radius = _sphere_around(x, y)
    axis, spread = _cone_around(x, y)
    same = x.law == y.law
    bounds = Leaf(
        x.law if same else AROUND,
        x.flux + y.flux,
        centre,
        radius,
        axis,
        spread if same else math.pi,
        max(x.reach, y.reach),
        x.within + y.within,
    )
    return _Node(bounds, parts=(a, b))


def _sphere_around(a: Leaf, b: Leaf) -> tuple[NDArray, float]:
    """Smallest sphere around two, of which either may be nowhere."""
    if a.radius < b.radius:
        a, b = b, a
    apart = b.centre - a.centre
    distance = float(np.linalg.norm(apart))
    if b.radius < 0 or distance + b.radius <= a.radius:
        return a.centre, a.radius
    radius = (distance + a.radius + b.radius) / 2
    return a.centre + apart * ((radius - a.radius) / distance), radius


def _cone_around(a: Leaf, b: Leaf) -> tuple[NDArray, float]:
    """Narrow cone around two cones, black ones aside."""
    if a.flux == 0 or b.flux == 0:
        kept = b if a.flux == 0 else a
        return kept.axis, kept.spread
    if a.spread < b.spread:
        a, b = b, a
    between = math.acos(min(max(float(a.axis @ b.axis), -1.0), 1.0))
    if between + b.spread <= a.spread:
        return a.axis, a.spread
    spread = (between + a.spread + b.spread) / 2
    turn = np.cross(a.axis, b.axis)
    length = float(np.linalg.norm(turn))
    if spread >= math.pi or length < 1e-12:
        return a.axis, math.pi
    # Toward b, until the cone of a touches the new one
    angle = spread - a.spread
    side = np.cross(turn / length, a.axis)
    return a.axis * math.cos(angle) + side * math.sin(angle), spread


def _flatten(root: _Node, lights: int) -> packed.LightTree:
    """Nodes in depth-first order, with links instead of a stack."""
    rows: list[Leaf] = []
    links: list[list[int]] = []
    leaf = np.zeros(lights, np.int32)

    def visit(node: _Node, parent: int) -> None:
        k = len(rows)
        rows.append(node.bounds)
        links.append([0, parent, node.light])
        if node.light >= 0:
            leaf[node.light] = k
        for part in node.parts:
            visit(part, k)
        links[k][0] = len(rows)

    visit(root, -1)
    nodes = [_values(row) for row in rows]
    return packed.LightTree(
        np.array([(*node.centre, node.radius) for node in nodes]),
        np.array([(*node.axis, node.spread, node.reach) for node in nodes]),
        np.array([node.flux for node in nodes]),
        np.array([node.within for node in nodes]),
        np.array([node.law for node in nodes]),
        np.array(links, np.int32),
        leaf,
    )


def _values(leaf: Leaf) -> packed.LightNode:
    return packed.LightNode(
        vector(leaf.centre),
        # Rounding must not let a ray slip past
        f32(leaf.radius * (1 + 1e-4)),
        vector(leaf.axis), f32(_cosine(leaf.spread)), f32(math.cos(min(leaf.reach, math.pi))),
        f32(leaf.flux), f32(leaf.within), np.int32(leaf.law),
    )  # fmt: skip


def _cosine(angle: float) -> float:
    return -1.0 if angle >= math.pi else math.cos(angle)
