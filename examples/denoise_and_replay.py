"""A noisy picture, the same with less noise, and both made again from the file alone.

python examples/denoise_and_replay.py [PICTURE.png]
"""

import sys
from pathlib import Path

import vtkmcvr


def main(picture: str = "denoised.png") -> None:
    head = vtkmcvr.Volume.from_grid(*vtkmcvr.head_phantom(96))
    measured = vtkmcvr.render(head, preset="ct-bone", size=(240, 180), samples=4)
    smooth = measured.denoised("knn")  # or "oidn", with render(..., aovs=("albedo", "normal"))
    smooth.with_display(exposure=0.5).save(picture)  # neither of these traces a ray
    print(f"NRMS {measured.nrms:.0%} as measured; noise reduced: {smooth.facts()['denoised']}")

    # The file holds scene, seed and samples, and of the volume a hash
    again, identical, notes = vtkmcvr.replay(picture, head)
    print("the same bits" if identical else f"other bits: {notes}")
    again.with_display(exposure=0.0).save(Path(picture).with_suffix(".npz"))


if __name__ == "__main__":
    main(*sys.argv[1:])
