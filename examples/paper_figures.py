"""Figures like 3, 6, 7, 8, 9 and 11 of Exposure Render (PLoS ONE 2012), on public volumes.

python examples/paper_figures.py [PICTURE.png]                   convergence on the synthetic head
python examples/paper_figures.py --all FOLDER --data DIR         all of them, about 900 pixels wide
                                 [--only NAME] [--width 900] [--samples 256] [--threads 1]

Where a volume is not in DIR, the synthetic head stands in for it. `figures.json` says what was
drawn, in how many seconds, with which error. Noise is not reduced.
"""

from __future__ import annotations

import argparse
import json
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import paper_scenes as scenes
from paper_convergence import SAMPLES, curves, plot
from paper_scenes import Shot, Stage, Subject, stage_of

from vtkmcvr.pictures.files import write_png

GAP = 4
CONVERGENCE = "figure_11_convergence"


@dataclass(frozen=True)
class Figure:
    """What to draw of which volume.

    Attributes
    ----------
    subject : Subject
    draw : callable
    columns : int
        Pictures side by side.
    aspect : float
        Their height over their width.
    effort : float
        Samples of this figure over those of the others.
    """

    subject: Subject
    draw: Callable[[Stage, Shot], list]
    columns: int = 3
    aspect: float = 1.1
    effort: float = 1.0


FIGURES = {
    "figure_3_depth_of_field": Figure(scenes.ENGINE_NEAR, scenes.depth_of_field, aspect=0.88),
    "figure_6_hybrid": Figure(scenes.BRAIN, scenes.hybrid_scattering, aspect=0.88),
    "figure_7_soft_shadow": Figure(scenes.ENGINE, scenes.soft_shadow, aspect=0.9, effort=0.75),
    "figure_8_thin_media": Figure(scenes.MAN, scenes.thin_media),
    "figure_9_gold": Figure(scenes.SKULL, scenes.gold),
    CONVERGENCE: Figure(scenes.BRAIN, scenes.convergence, columns=5, aspect=0.9),
}


def make(name: str, path: Path, data: Path | None, width: int, samples: int, threads) -> dict:
    """Draw one figure and return what it took, one entry per picture."""
    figure = FIGURES[name]
    column = (width - GAP * (figure.columns - 1)) // figure.columns
    size = (column, round(column * figure.aspect))
    stage = stage_of(figure.subject, data, size)
    pictures = figure.draw(stage, Shot(size, max(1, round(samples * figure.effort)), threads))
    pixels = montage([picture.rgba[..., :3] for picture in pictures])
    facts = {
        "preset": stage.dressed.preset,
        "size": size,
        "samples": [p.samples for p in pictures],
        "seconds": [round(p.seconds, 2) for p in pictures],
        "nrms": [round(p.nrms, 4) if p.samples > 1 else None for p in pictures],
    }
    if name == CONVERGENCE and data is not None:
        facts["curves"] = {"samples": SAMPLES, **curves(data, threads)}
        panels = {key: value for key, value in facts["curves"].items() if key != "samples"}
        pixels = np.vstack([pixels, plot(panels, pixels.shape[1], pixels.shape[1] * 3 // 10)])
    write_png(path, pixels)
    return facts


def montage(pictures: list[np.ndarray]) -> np.ndarray:
    """Pictures side by side with a white gap between them."""
    gap = np.full((len(pictures[0]), GAP, 3), 255, np.uint8)
    parts = [part for picture in pictures for part in (picture, gap)]
    return np.hstack(parts[:-1])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("picture", nargs="?", default="paper_figures.png")
    parser.add_argument("--all", metavar="FOLDER", type=Path)
    parser.add_argument("--data", type=Path, default=os.environ.get("VTKMCVR_DATA"))
    parser.add_argument("--only", choices=FIGURES, action="append")
    parser.add_argument("--width", type=int, default=900)
    parser.add_argument("--samples", type=int, default=256)
    parser.add_argument("--threads", type=int)
    args = parser.parse_args()
    if args.all is None:
        made = make(CONVERGENCE, Path(args.picture), None, 900, 256, args.threads)
        print(json.dumps(made))
        return
    args.all.mkdir(parents=True, exist_ok=True)
    record = args.all / "figures.json"
    made = json.loads(record.read_text()) if record.exists() else {}
    for name in args.only or FIGURES:
        data = Path(args.data) if args.data else None
        path = args.all / f"{name}.png"
        made[name] = make(name, path, data, args.width, args.samples, args.threads)
        print(name, json.dumps(made[name]), flush=True)
        record.write_text(json.dumps(made, indent=1) + "\n")


if __name__ == "__main__":
    main()
