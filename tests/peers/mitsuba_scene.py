"""scene.json of the peer script `mitsuba_reference.py` -> our Scene.

Everything that both renderers can express is translated; anything else raises a ValueError that
names the key. Two things have no key and are left to whoever writes the scene: the camera must be
outside the volume (Mitsuba takes a camera inside for one in vacuum), and must not see area lights
on which other lights shine (they are diffuse grey in Mitsuba and black here).
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vtkmcvr.curves import ColourCurve, Curve
from vtkmcvr.lights import (
    ConstantEnvironment,
    CylinderLight,
    DirectionalLight,
    DiskLight,
    EnvironmentMap,
    Light,
    PointLight,
    RectangleLight,
    SphereLight,
)
from vtkmcvr.scene import (
    Camera,
    HenyeyGreenstein,
    Lens,
    PixelFilter,
    Scene,
    TransferFunction,
    Volume,
)

Spec = dict[str, Any]

# Rows of a Mitsuba map reach from pole to pole, ours are centred in bands. A map is resampled to
# this many times its rows, while it stays small, so that the bends of its interpolant stay sharp.
FINER_ROWS, MOST_ROWS = 8, 4096


def load_scene(path: str | os.PathLike[str], *, ratio_tracking: bool = True) -> Scene:
    """Read a scene.json.

    Parameters
    ----------
    path : path-like
        File names inside are looked for in the working directory, as the peer does, then beside it.
    ratio_tracking : bool
        Estimate transmittance by ratio tracking, as Mitsuba does; no expected value depends on it.
    """
    path = Path(path)
    spec = json.loads(path.read_text())
    sigma_t = _extinction(_find(spec["sigma_t"], path))
    albedo, colours = _albedo(spec["albedo"], path)
    # Mitsuba counts the last segment, to the light
    depth = spec.get("max_depth", 2)
    return Scene(
        Volume(sigma_t, _index_to_world(spec), colours),
        _transfer(sigma_t, albedo),
        _camera(spec["camera"]),
        lights=tuple(_light(item, path) for item in spec["lights"]),
        phase=HenyeyGreenstein(spec["phase"]["g"]),
        scattering="single" if depth == 2 else "multiple",
        max_scatterings=None if depth == -1 else depth - 1,
        environment_visible=True,
        ratio_tracking=ratio_tracking,
        size=tuple(spec["size"]),
        pixel_filter=PixelFilter("box", 0.5),
    )


def _find(name: str, scene: Path) -> Path:
    return Path(name) if Path(name).exists() else scene.parent / name


def _extinction(path: Path) -> NDArray[np.float32]:
    grid = np.load(path).astype(np.float32)
    if grid.ndim == 4 and grid.shape[3] == 1:
        grid = grid[..., 0]
    if grid.ndim != 3:
        raise ValueError(f"sigma_t: only a grid [z, y, x] can be expressed, got shape {grid.shape}")
    return grid


def _index_to_world(spec: Spec) -> NDArray[np.float64]:
    matrix = np.diag([*map(float, spec["spacing"]), 1.0])
    matrix[:3, 3] = spec["origin"]
    return matrix


def _albedo(albedo: object, scene: Path) -> tuple[float, NDArray[np.float32] | None]:
    """A number; or a grid of colours at the points, and any number."""
    if isinstance(albedo, int | float):
        return albedo, None
    grid = np.load(_find(str(albedo), scene)).astype(np.float32)
    if grid.ndim == 3:
        grid = grid[..., None]
    return 1.0, np.ascontiguousarray(np.broadcast_to(grid, (*grid.shape[:3], 3)))


def _transfer(sigma_t: NDArray[np.float32], albedo: float) -> TransferFunction:
    """Extinction is the scalar itself."""
    low, high = float(sigma_t.min()), float(sigma_t.max())
    nodes = ((low, low), (high, high)) if high > low else ((low, low),)
    return TransferFunction(
        opacity=None, colour=ColourCurve(((low, albedo, albedo, albedo),)), extinction=Curve(nodes)
    )


def _camera(spec: Spec) -> Camera:
    radius = spec.get("aperture_radius", 0)
    lens = Lens(radius, spec["focus_distance"]) if radius > 0 else None
    return Camera(
        spec["position"], spec["focal_point"], spec["view_up"], spec["view_angle"], lens=lens
    )


def _light(spec: Spec, scene: Path) -> Light:
    kind = spec["type"]
    if kind == "envmap":
        return _map(spec, scene)
    if kind not in LIGHTS:
        known = ", ".join(sorted([*LIGHTS, "envmap"]))
        raise ValueError(f"lights: {kind!r} cannot be expressed yet; these can: {known}")
    return LIGHTS[kind](spec)


def _rectangle(spec: Spec) -> RectangleLight:
    # Mitsuba's look_at puts local x along cross(up, normal), which is our width
    return RectangleLight(
        spec["center"], spec["target"], tuple(spec["size"]), spec["radiance"],
        up=spec.get("up", (0, 0.6, 0.8)), visible=True,
    )  # fmt: skip


def _spot(spec: Spec) -> PointLight:
    # Mitsuba dims linearly in the angle between the two; ours has a sharp edge
    if spec["beam"] < 0.999 * spec["cutoff"]:
        raise ValueError(
            f"lights: a spot can be expressed with beam = cutoff = {spec['cutoff']} only, "
            f"got beam {spec['beam']}"
        )
    axis = np.subtract(spec["target"], spec["position"])
    return PointLight(
        spec["position"], spec["intensity"], direction=tuple(axis), cone_angle=spec["cutoff"]
    )


LIGHTS: dict[str, Callable[[Spec], Light]] = {
    "constant": lambda spec: ConstantEnvironment(spec["radiance"]),
    "point": lambda spec: PointLight(spec["position"], spec["intensity"]),
    "directional": lambda spec: DirectionalLight(spec["direction"], spec["irradiance"]),
    "rectangle": _rectangle,
    "disk": lambda spec: DiskLight(
        spec["center"], spec["target"], spec["radius"], spec["radiance"], visible=True
    ),
    "sphere": lambda spec: SphereLight(
        spec["center"], spec["radius"], spec["radiance"], visible=True
    ),
    "cylinder": lambda spec: CylinderLight(
        spec["start"], spec["end"], spec["radius"], spec["radiance"], visible=True
    ),
    "spot": _spot,
}


def _map(spec: Spec, scene: Path) -> EnvironmentMap:
    """Mitsuba's local frame is ours: +y up, column angle atan2(x, -z)."""
    to_world = np.array(spec.get("to_world", np.eye(4)), float)
    return EnvironmentMap(
        _rows_between_poles(_pixels(_find(spec["file"], scene))),
        float(spec.get("scale", 1)),
        to_world[:3, :3],
    )


def _rows_between_poles(pixels: NDArray[np.float32]) -> NDArray[np.float32]:
    """Rows at angles pi j / (rows - 1), as Mitsuba reads them -> rows at pi (j + 1/2) / rows."""
    last = len(pixels) - 1
    rows = len(pixels) * max(1, min(FINER_ROWS, MOST_ROWS // len(pixels)))
    at = (np.arange(rows) + 0.5) / rows * last
    above = np.minimum(at.astype(int), max(last - 1, 0))
    share = (at - above)[:, None, None].astype(np.float32)
    return pixels[above] * (1 - share) + pixels[np.minimum(above + 1, last)] * share


def _pixels(path: Path) -> NDArray[np.float32]:
    if path.suffix == ".exr":
        return _exr_pixels(path)
    if path.suffix == ".hdr":
        return _hdr_pixels(path)
    raise ValueError(f"file: environment maps are read from .exr and .hdr, got {path.name!r}")


def _exr_pixels(path: Path) -> NDArray[np.float32]:
    import OpenEXR

    with OpenEXR.File(str(path), separate_channels=True) as file:
        channels = {name: channel.pixels for name, channel in file.channels().items()}
        missing = sorted({"R", "G", "B"} - set(channels))
        if missing:
            raise ValueError(f"file: {path.name} has no channel {', '.join(missing)}")
        return np.stack([channels[name] for name in "RGB"], axis=-1).astype(np.float32)


def _hdr_pixels(path: Path) -> NDArray[np.float32]:
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOImage import vtkHDRReader

    reader = vtkHDRReader()
    reader.SetFileName(str(path))
    reader.Update()
    image = reader.GetOutput()
    width, height, _ = image.GetDimensions()
    # VTK's row 0 is at the bottom
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width, 3)[::-1]
