"""A PyVista script: read or make a volume, render it with physically based light, show the result.

python examples/pyvista_script.py [PICTURE.png [VOLUME]]
"""

import sys

import numpy as np
import pyvista as pv

import vtkmcvr


def synthetic_head() -> pv.ImageData:
    """The synthetic CT head as PyVista would hold it."""
    head = vtkmcvr.head_phantom(96)
    shape = head.values.shape
    image = pv.ImageData(dimensions=shape[::-1], spacing=head.spacing, origin=head.origin)
    image["HU"] = np.ravel(head.values)
    return image


def main(picture: str = "pyvista_script.png", volume: str | None = None) -> None:
    image = vtkmcvr.read(volume) if volume else synthetic_head()
    result = vtkmcvr.render(image, preset="ct-skin", size=(400, 300), samples=32, seed=1)
    print(result.plan.explain())
    print(f"{result.samples} samples in {result.seconds:.1f} s, error (NRMS) {result.nrms:.1%}")
    result.save(picture)


if __name__ == "__main__":
    main(*sys.argv[1:])
