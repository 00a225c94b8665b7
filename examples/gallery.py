"""Pictures of all looks on real volumes: docs/gallery.md and what it shows.

    python examples/gallery.py --data FOLDER [--only ct-bone,labels] [--samples 64] [-o docs]

FOLDER holds the volumes under the paths below; those that are missing are left out. Nothing is
denoised.
"""

import argparse
import sys
from dataclasses import dataclass, field
from pathlib import Path

import vtkmcvr
from vtkmcvr.presets import LOOKS
from vtkmcvr.segmentation import Segmentation
from vtkmcvr.studio import View

SIZE, SAMPLES, QUALITY = 320, 128, 88
LARGEST_FILE = 60_000


@dataclass(frozen=True)
class Shot:
    """One picture of the gallery.

    Attributes
    ----------
    look, path : str
        Preset, and the volume below the folder of data.
    words : str
        Options of the command line that make the same picture.
    caption : str
    name : str
        Of the file; default: the look's.
    options : dict
        Of `vtkmcvr.render`.
    flip : str
        Axes that the file stores backwards without saying so.
    labels : str
        Segmentation beside the volume.
    chosen : dict
        Of `Segmentation`.
    samples : int
        Per pixel.
    """

    look: str
    path: str
    caption: str
    words: str = ""
    name: str = ""
    options: dict = field(default_factory=dict)
    flip: str = ""
    labels: str = ""
    chosen: dict = field(default_factory=dict)
    samples: int = SAMPLES


THORAX, ABDOMEN = "dicom/ct_thorax_lidc0314", "nifti/example_ct.nii.gz"
LABELS = "nifti/example_ct_labels.nii.gz"
HEAD = "scivis/cthead/CThead.nhdr"
SHOTS = (
    Shot(
        "ct-bone", HEAD, "CT of a head; its values are HU + 1024, which is found out", flip="k",
        samples=256,
    ),
    Shot("ct-skin", HEAD, "The same head; the headrest is left out", flip="k", samples=256),
    Shot("ct-soft", ABDOMEN, "CT of an abdomen at 3 mm, 7 mm below the skin", samples=256),
    Shot(
        "ct-lung", THORAX, "90 mm of a CT of the chest, from below",
        "--elevation -60", options={"view": View(elevation=-60)}, samples=256,
    ),
    Shot(
        "ct-airways", THORAX, "The same chest: air in windpipe, bronchi and emphysema",
        "--azimuth 20 --elevation -30", options={"view": View(azimuth=20, elevation=-30)},
        samples=256,
    ),
    Shot(
        "ct-heart", THORAX, "The same chest, 38 mm below the skin; without contrast agent",
        "--elevation -40", options={"view": View(elevation=-40)},
    ),
    Shot(
        "ct-vessels", THORAX, "The same chest; without contrast agent bone and chalk show",
        "--azimuth 20 --elevation -35", options={"view": View(azimuth=20, elevation=-35)},
    ),
    Shot("mr-head", "nifti/ch2.nii.gz", "MR template in bytes, without units, cut at the nose"),
    Shot("mr-brain", "nifti/CIT168toMNI152-2009c_T1w_brain.nii.gz", "T1 template without skull"),
    Shot("mr-angio", "nrrd/avf_float_32.nrrd", "Fistula between an artery and a vein"),
    Shot("pet-fusion", "dicom/pt_headneck", "PET: brain, heart, bladder and a tumour of the neck"),
    Shot(
        "labels", LABELS, "61 of 117 classes that TotalSegmentator found in the CT of the abdomen",
    ),
    Shot(
        "ct-bone", ABDOMEN, "Organs of that segmentation in their CT, in the colours of the file",
        name="organs", labels=LABELS,
        words=f"--labels {LABELS} --show 'liver,kidney*,spleen,aorta,urinary_bladder'",
        chosen={"show": ("liver", "kidney*", "spleen", "aorta", "urinary_bladder")},
    ),
    Shot(
        "labels", LABELS, "One organ highlighted among faint ones", name="highlight",
        words="--show 'colon,hip*,sacrum,vertebrae*,urinary_bladder' --highlight colon",
        chosen={
            "show": ("colon", "hip*", "sacrum", "vertebrae*", "urinary_bladder"),
            "highlight": ("colon",),
        },
    ),
    Shot("microct", "scivis/engine.nhdr", "Industrial CT of two cylinders of an engine"),
    Shot("solid", "vtk/vase_4comp.vti", "Scan of a vase: red, green, blue and opacity by voxel"),
    Shot("signed", "nifti/zstat1.nii.gz", "Statistic of a functional MR, above and below 0"),
    Shot("cloud", "scivis/ironProt.vtk", "Density of a protein, as mist"),
)  # fmt: skip


def volume_of_shot(shot: Shot, data: Path):
    """Read what a shot shows, in its place."""
    from vtkmcvr.vtk_bridge.scene import volume_of

    image = vtkmcvr.read(data / shot.path)
    return volume_of(image).flipped(shot.flip) if shot.flip else image


def segmentation_of_shot(shot: Shot, data: Path, image) -> Segmentation | None:
    """Labels beside the volume, or chosen ones of the volume itself."""
    if shot.labels:
        return Segmentation.of(vtkmcvr.read_labels(data / shot.labels, like=image), **shot.chosen)
    return Segmentation.of(image, **shot.chosen) if shot.chosen else None


def take(shot: Shot, data: Path, samples: int | None, threads: int | None):
    """Render a shot."""
    image = volume_of_shot(shot, data)
    segmentation = segmentation_of_shot(shot, data, image)
    return vtkmcvr.render(
        image, preset=shot.look, segmentation=segmentation, size=(SIZE, SIZE),
        samples=samples or shot.samples,
        threads=threads, **shot.options,
    )  # fmt: skip


def save_small(picture, path: Path) -> int:
    """Write a JPEG below the largest size; returns its bytes."""
    from PIL import Image

    image = Image.fromarray(picture.rgba[..., :3])
    for quality in range(QUALITY, 30, -6):
        image.save(path, quality=quality, optimize=True)
        if path.stat().st_size < LARGEST_FILE:
            break
    return path.stat().st_size


def page() -> str:
    """Return the text of the gallery."""
    lines = [
        "# Gallery",
        "",
        "Every look on a real volume, as it comes out of the command below it: no setting but "
        f"those that it names, {SIZE} x {SIZE} pixels, nothing denoised. "
        "`python examples/gallery.py --data FOLDER` makes them all.",
        "",
    ]
    for shot in SHOTS:
        name = shot.name or shot.look
        words = " ".join(
            part
            for part in (
                f"vtkmcvr render {shot.path} --preset {shot.look}",
                f"--flip {shot.flip}" if shot.flip else "",
                shot.words,
                f"--samples {shot.samples} --size {SIZE}x{SIZE}",
            )
            if part
        )
        lines += [
            f"## {name}",
            "",
            f"![{LOOKS[shot.look].about}](images/gallery/{name}.jpg)",
            "",
            f"{shot.caption}. Look `{shot.look}`: {LOOKS[shot.look].about}.",
            "",
            f"    {words} -o {name}.png",
            "",
        ]
    return "\n".join(lines)


def main(arguments: list[str]) -> None:
    """Make the pictures, then the page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("-o", "--output", type=Path, default=Path("docs"))
    parser.add_argument("--only", help="names, with commas between")
    parser.add_argument("--samples", type=int, help="instead of those of each picture")
    parser.add_argument("--threads", type=int)
    args = parser.parse_args(arguments)
    folder = args.output / "images" / "gallery"
    folder.mkdir(parents=True, exist_ok=True)
    wanted = args.only.split(",") if args.only else [shot.name or shot.look for shot in SHOTS]
    for shot in SHOTS:
        name = shot.name or shot.look
        if name not in wanted:
            continue
        if not (args.data / shot.path).exists():
            print(f"{name}: there is no {args.data / shot.path}")
            continue
        picture = take(shot, args.data, args.samples, args.threads)
        size = save_small(picture, folder / f"{name}.jpg")
        print(f"{name}: {picture.seconds:.0f} s, NRMS {picture.nrms:.1%}, {size} bytes")
    (args.output / "gallery.md").write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
