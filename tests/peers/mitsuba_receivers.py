"""One scene with a medium and opaque shapes, for both renderers; as a program, Mitsuba's picture.

python mitsuba_receivers.py sigma_t.npy out.npz PASSES SAMPLES MAX_DEPTH
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np

SIZE = (48, 40)
SPACING = (1.0, 0.8, 1.25)
POSITION, FOCAL_POINT, VIEW_ANGLE = (30.0, -70.0, 35.0), (2.0, 0.0, -8.0), 40.0
FLOOR = {"z": -26.0, "half": 60.0, "colour": (0.6, 0.5, 0.3)}
BALL = {"centre": (26.0, -10.0, -17.0), "radius": 9.0, "colour": (0.2, 0.4, 0.7)}
CUBE = {"centre": (-24.0, -12.0, -18.0), "half": (5.0, 7.0, 8.0), "colour": (0.7, 0.2, 0.2)}
LAMP = {"centre": (40.0, -30.0, 60.0), "edge": 24.0, "radiance": (12.0, 10.0, 8.0)}
SKY = (0.3, 0.35, 0.4)
ALBEDO = 0.8


def mitsuba_scene(mi: Any, sigma_t: np.ndarray, samples: int, max_depth: int) -> Any:
    """The scene as Mitsuba describes it; the medium is centred at the origin."""
    T = mi.ScalarTransform4f

    def rgb(value: Any) -> dict[str, Any]:
        return {"type": "rgb", "value": list(value)}

    def diffuse(part: dict[str, Any]) -> dict[str, Any]:
        bsdf = {"type": "diffuse", "reflectance": rgb(part["colour"])}
        return {"type": "twosided", "bsdf": bsdf}

    points = np.array(sigma_t.shape[::-1], float)
    texels = points * SPACING
    half = (points - 1) * SPACING / 2
    film = {
        "type": "hdrfilm", "width": SIZE[0], "height": SIZE[1], "rfilter": {"type": "box"},
        "pixel_format": "rgb", "component_format": "float32",
    }  # fmt: skip
    grid = {
        "type": "gridvolume", "grid": mi.VolumeGrid(np.ascontiguousarray(sigma_t[..., None])),
        "filter_type": "trilinear", "wrap_mode": "clamp", "raw": True,
        "to_world": T().translate(list(-texels / 2)).scale(list(texels)),
    }  # fmt: skip
    lamp = T().look_at(origin=LAMP["centre"], target=(0, 0, 0), up=(0, 0.6, 0.8))
    return mi.load_dict({
        "type": "scene",
        "integrator": {"type": "volpath", "max_depth": max_depth, "rr_depth": 10_000},
        "sensor": {
            "type": "perspective", "fov": VIEW_ANGLE, "fov_axis": "y", "near_clip": 1e-3,
            "far_clip": 1e6, "film": film,
            "to_world": T().look_at(origin=POSITION, target=FOCAL_POINT, up=(0, 0, 1)),
            "sampler": {"type": "independent", "sample_count": samples},
        },
        "medium": {
            "type": "cube", "to_world": T().scale(list(half)), "bsdf": {"type": "null"},
            "interior": {
                "type": "heterogeneous", "sigma_t": grid,
                "albedo": {"type": "constvolume", "value": ALBEDO},
            },
        },
        "floor": {
            "type": "rectangle", "bsdf": diffuse(FLOOR),
            "to_world": T().translate([0, 0, FLOOR["z"]]).scale(FLOOR["half"]),
        },
        "ball": {
            "type": "sphere", "center": list(BALL["centre"]), "radius": BALL["radius"],
            "bsdf": diffuse(BALL),
        },
        "cube": {
            "type": "cube", "bsdf": diffuse(CUBE),
            "to_world": T().translate(list(CUBE["centre"])).scale(list(CUBE["half"])),
        },
        "lamp": {
            "type": "rectangle", "to_world": lamp.scale([LAMP["edge"] / 2, LAMP["edge"] / 2, 1]),
            "emitter": {"type": "area", "radiance": rgb(LAMP["radiance"])},
        },
        "sky": {"type": "constant", "radiance": rgb(SKY)},
    })  # fmt: skip


def main() -> None:
    """Write mean and standard error of independent passes."""
    import mitsuba as mi

    source, out, *numbers = sys.argv[1:]
    passes, samples, max_depth = map(int, numbers)
    mi.set_variant("scalar_rgb")
    scene = mitsuba_scene(mi, np.load(source), samples, max_depth)
    images = [np.array(mi.render(scene, spp=samples, seed=i), np.float64) for i in range(passes)]
    error = np.std(images, axis=0, ddof=1) / np.sqrt(passes)
    np.savez(out, image=np.mean(images, axis=0), standard_error=error)


if __name__ == "__main__":
    main()
