"""What the user may ask of directional occlusion shading."""

from __future__ import annotations

from dataclasses import dataclass

from .. import checks

Vector = tuple[float, float, float]

MODES = ("default", "fast", "paper")
WIDEST, MOST_SLICES, MOST_DIRECTIONS = 89.9, 20_000, 4096


@dataclass(frozen=True)
class Occlusion:
    """Directional occlusion shading (Schott et al., CGF 28(3), 2009), and beyond.

    Parameters
    ----------
    half_angle : float
        Half angle theta of the cone of light, degrees, 0 to 89.9. 0: each view ray shades itself.
    mode : {"default", "fast", "paper"}
        "default": beams of light, converges to the cone integral (Eq. 7-10) with more `directions`
        and `detail`. "fast": one buffer, blurred, exact for a half-space. "paper": as published.
    slices : int, optional
        Planes across the view axis in which the scalar is looked up. Default: about two for each
        voxel.
    directions : int
        Beams that fill the cone in mode "default", 1 to 4096.
    detail : float
        1: a raster of light of 3/4 voxel and slices of about half a voxel; 2: twice as fine, about
        eight times the work. 0.1 to 16.
    toward_light : 3 floats, optional
        World direction of the cone's axis (Solteszova et al. 2010), toward the viewer's side.
        Default: every pixel's own view ray. Only in mode "default".
    radiance : colour, optional
        Radiance L_a of the light. Default: about as much as the scene's lights give.
    bleeding : float
        Share of the scattered light that goes on, in its colour, 0 to 1; 0: light has no colour.
        Not in mode "paper".
    shaded : bool
        Surfaces of the scene are shaded by their gradients, the light along the cone's axis.
    grid : int
        n of the n x n samples of mode "paper", 1 to 64.
    exact_distance : bool
        Mode "paper" by Algorithm 2 instead of 3.
    blur_reach : float, optional
        Distance from an occluder at which the blur of mode "fast" equals the cone's, world units.
        Default: two voxels.
    skip : bool
        Empty and saturated space is passed over: changes no pixel by more than 1e-5.
    """

    half_angle: float = 60.0
    mode: str = "default"
    slices: int | None = None
    directions: int = 40
    detail: float = 1.0
    toward_light: Vector | None = None
    radiance: Vector | float | None = None
    bleeding: float = 0.0
    shaded: bool = False
    grid: int = 7
    exact_distance: bool = False
    blur_reach: float | None = None
    skip: bool = True

    def __post_init__(self) -> None:
        checks.number("half_angle", self.half_angle, least=0.0, most=WIDEST)
        checks.choice("mode", self.mode, MODES)
        if self.slices is not None:
            checks.whole("slices", self.slices, least=1)
            if self.slices > MOST_SLICES:
                raise ValueError(f"slices are at most {MOST_SLICES}, got {self.slices}")
        if checks.whole("directions", self.directions, least=1) > MOST_DIRECTIONS:
            raise ValueError(f"directions are at most {MOST_DIRECTIONS}, got {self.directions}")
        checks.number("detail", self.detail, least=0.1, most=16.0)
        checks.number("bleeding", self.bleeding, least=0.0, most=1.0)
        if checks.whole("grid", self.grid, least=1) > 64:
            raise ValueError(f"grid is at most 64, got {self.grid}")
        if self.blur_reach is not None:
            checks.number("blur_reach", self.blur_reach, above=0.0)
        if self.radiance is not None:
            object.__setattr__(self, "radiance", checks.colour("radiance", self.radiance))
        self._check_mode()

    def _check_mode(self) -> None:
        if self.toward_light is not None:
            axis = checks.direction("toward_light", self.toward_light)
            object.__setattr__(self, "toward_light", axis)
            if self.mode != "default":
                raise ValueError(f'toward_light needs mode "default", got {self.mode!r}')
        if self.bleeding > 0 and self.mode == "paper":
            raise ValueError('mode "paper" has light without colour: bleeding must be 0')
