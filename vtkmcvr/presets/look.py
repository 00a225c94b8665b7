"""A look: all that turns a kind of volume into a picture, with nothing of one volume in it."""

from __future__ import annotations

from dataclasses import dataclass, field

from .. import checks
from ..curves import ColourCurve, Curve
from ..material import Surface, TransferFunction
from ..phases import Isotropic, Phase
from ..studio import Studio, View

Nodes = tuple[tuple[float, ...], ...]

# What node positions mean
SCALES = {
    "HU": "Hounsfield units",
    "SUV": "standardised uptake values",
    "data": "the values of the data themselves",
    "relative": "0 to 1 from the lowest value to the 99.9th percentile",
    "threshold": "0 at the threshold that best splits the values, 1 at the 99.9th percentile",
    "signed": "-1 to 1, symmetric around the value 0, by the 99.9th percentile of the magnitude",
    "labels": "0 to 1 from outside to inside of the labels",
}
IN_MM = ("HU", "SUV", "data")
PARTS = {
    "name": str, "about": str, "surface": Surface | None, "studio": Studio, "view": View,
    "phase": Phase,
}  # fmt: skip


@dataclass(frozen=True)
class Look:
    """One way to show a kind of volume.

    Attributes
    ----------
    name : str
    about : str
        What it shows, of what.
    units : str
        What node positions mean, a key of `SCALES`.
    opacity : nodes (x, a)
        Opacity per `unit_distance`.
    colour : nodes (x, r, g, b)
        Linear RGB: albedo of the volume and of its surfaces.
    unit_distance : float
        mm where the units are HU, SUV or the data's own; else in voxel edges, because such data may
        come in any unit of length.
    surface : Surface, optional
        How much of it reflects as a surface. None: it scatters as a volume.
    studio : Studio
        Lights, placed around camera and volume.
    exposure : float
        Stops.
    view : View
        Where to look from, unless the user says.
    phase : Phase
    scattering : {"single", "multiple"}
    max_scatterings : int, optional
        Most events of "multiple".
    emission : nodes (x, r, g, b), optional
        Own light, in radiances of `emission_scale`.
    emission_scale : float
    gradient_opacity : nodes (g, factor), optional
        By gradient magnitude, in the units of the nodes per mean voxel edge.
    body : float, optional
        Only what lies at least so many mm below the skin is seen: no table, no air around. None:
        the whole volume. For HU only.
    """

    name: str
    about: str
    units: str
    opacity: Nodes
    colour: Nodes
    unit_distance: float = 1.0
    surface: Surface | None = field(default_factory=Surface)
    studio: Studio = field(default_factory=Studio)
    exposure: float = 0.0
    view: View = field(default_factory=View)
    phase: Phase = field(default_factory=Isotropic)
    scattering: str = "single"
    max_scatterings: int | None = None
    emission: Nodes | None = None
    emission_scale: float = 1.0
    gradient_opacity: Nodes | None = None
    body: float | None = None

    def __post_init__(self) -> None:
        checks.choice("units", self.units, tuple(SCALES))
        for name, kinds in PARTS.items():
            if not isinstance(getattr(self, name), kinds):
                raise TypeError(f"{name} of a look cannot be {getattr(self, name)!r}")
        checks.number("exposure", self.exposure)
        self.transfer()
        if self.body is not None:
            checks.number("body", self.body, least=0.0)
        checks.choice("scattering", self.scattering, ("single", "multiple"))

    def transfer(
        self, shift: float = 0.0, factor: float = 1.0, edge: float = 1.0
    ) -> TransferFunction:
        """Transfer function with the nodes x at shift + factor x, checked.

        Parameters
        ----------
        shift, factor : float
            What places nodes in the values of a volume; factor > 0.
        edge : float
            Smallest voxel edge, the unit of `unit_distance` where that is not mm.
        """

        def moved(nodes: Nodes) -> Nodes:
            return tuple((shift + factor * x, *rest) for x, *rest in nodes)

        steps = self.gradient_opacity
        return TransferFunction(
            Curve(moved(self.opacity)),
            ColourCurve(moved(self.colour)),
            self.unit_distance * (1.0 if self.units in IN_MM else edge),
            emission=None if self.emission is None else ColourCurve(moved(self.emission)),
            emission_scale=self.emission_scale,
            gradient_opacity=None
            if steps is None
            else Curve(tuple((factor * g, *rest) for g, *rest in steps)),
        )
