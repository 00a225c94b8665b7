"""Every part of a scene by hand: transfer function, lights, lens, surface; then refine and save.

python examples/own_scene.py [PICTURE.png]
"""

import sys

import vtkmcvr


def main(picture: str = "own_scene.png") -> None:
    volume = vtkmcvr.Volume.from_grid(*vtkmcvr.head_phantom(96))
    scene = vtkmcvr.Scene(
        volume,
        vtkmcvr.TransferFunction(
            vtkmcvr.Curve([(150, 0.0), (400, 0.6), (1500, 0.9)]),
            vtkmcvr.ColourCurve([(150, 0.6, 0.3, 0.2), (800, 0.9, 0.85, 0.75)]),
            unit_distance=1.0,  # mm
        ),
        vtkmcvr.Camera(
            position=(-180, -420, 60),
            focal_point=(0, 0, 0),
            lens=vtkmcvr.Lens(radius=6, focus_distance=380),
        ),
        lights=[
            vtkmcvr.ConstantEnvironment((0.3, 0.35, 0.4)),
            vtkmcvr.RectangleLight((-300, -300, 300), (0, 0, 0), (150, 150), (30, 27, 24)),
        ],
        surface=vtkmcvr.Surface(gradient_factor=0.9),
        size=(400, 300),
    )
    quick = vtkmcvr.render(scene, samples=8)
    better = quick.refine(samples=32)
    print(f"NRMS {quick.nrms:.1%} after {quick.samples}, {better.nrms:.1%} after {better.samples}")
    better.save(picture)


if __name__ == "__main__":
    main(*sys.argv[1:])
