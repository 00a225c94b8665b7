"""One page about one picture: how wrong it is, what was simulated and why, what it cost."""

from __future__ import annotations

import base64
import html
import json
import math
import os
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from . import __version__
from .accuracy import image_error
from .pictures import files as picture_files
from .safe_files import replacing

if TYPE_CHECKING:
    from .effects import EffectCost
    from .pictures.picture import Picture

# Errors relative to the picture's RMS radiance that the error map shows as black and as white
LEAST, MOST = 1e-3, 1.0
# Stops of the error map: dark blue, violet, orange, pale yellow; evenly rising in lightness
STOPS = np.array([(8, 8, 40), (92, 26, 110), (221, 97, 62), (252, 246, 180)], np.float64)

STYLE = """
:root { color-scheme: light dark; font: 16px/1.5 system-ui, sans-serif; }
body { max-width: 62rem; margin: 2rem auto; padding: 0 1rem; }
img { max-width: 100%; border-radius: 6px; background: #15171a; }
figure { margin: 0; } figcaption { opacity: .75; font-size: .85rem; }
.pair { display: grid; grid-template-columns: 1fr 1fr; gap: 1rem; }
table { border-collapse: collapse; width: 100%; } td, th { text-align: left; padding: .2rem .8rem
.2rem 0; border-bottom: 1px solid #8884; vertical-align: top; } .off { opacity: .55; }
.key { font-size: 1.15rem; } pre { overflow-x: auto; font-size: .8rem; }
@media (max-width: 40rem) { .pair { grid-template-columns: 1fr; } }
"""


def write_report(
    picture: Picture, path: str | os.PathLike, costs: Sequence[EffectCost] = ()
) -> Path:
    """Write a self-contained HTML page about a picture.

    Parameters
    ----------
    picture : Picture
    path : path
        Ends in .html.
    costs : sequence of EffectCost, optional
        What each effect costs, from `vtkmcvr.costs.effects.effect_costs`.

    Returns
    -------
    Path
    """
    target = Path(path)
    check_report(target)
    parts = [
        _head(picture), _pictures(picture), _effects(picture), _costs(costs), _recipe(picture),
    ]  # fmt: skip
    page = (
        "<!doctype html>\n<html lang=en><meta charset=utf-8>"
        '<meta name=viewport content="width=device-width">'
        f"<title>vtkmcvr report</title><style>{STYLE}</style>\n" + "\n".join(parts) + "\n</html>\n"
    )
    with replacing(target, ".html") as temporary:
        temporary.write_text(page, encoding="utf-8")
    return target


def check_report(path: str | os.PathLike | None) -> None:
    """Refuse a path, where one is given, that is no .html file."""
    if path is not None and Path(path).suffix.lower() not in (".html", ".htm"):
        raise ValueError(f"a report is saved as .html; got {Path(path).name!r}")


def error_map(picture: Picture) -> NDArray[np.uint8]:
    """Standard error of each pixel over the RMS radiance of the picture, (H, W, 3), logarithmic."""
    error = np.sqrt(np.mean(picture.standard_error.astype(np.float64) ** 2, axis=-1))
    scale = math.sqrt(float(np.mean(picture.radiance.astype(np.float64) ** 2))) or 1.0
    share = np.clip(error / scale, LEAST, MOST)
    x = np.log(share / LEAST) / math.log(MOST / LEAST) * (len(STOPS) - 1)
    low = np.minimum(x.astype(int), len(STOPS) - 2)
    f = (x - low)[..., None]
    return (STOPS[low] * (1 - f) + STOPS[low + 1] * f + 0.5).astype(np.uint8)


def _head(picture: Picture) -> str:
    error = image_error(picture.film)
    width, height = picture.size
    spread = "samples each" if picture.density is None else "adaptive samples on average"
    if not error.bright:
        known = "black: no path has found light"
    elif math.isfinite(error.high):
        known = (
            f"error (NRMS) {error.nrms:.2%}, 95 % sure between {error.low:.2%} and {error.high:.2%}"
        )
    else:
        known = "error not known: too few samples"
    return (
        f"<h1>vtkmcvr {html.escape(__version__)}</h1><p class=key>{known}</p>"
        f"<p>{width} x {height} pixels, {picture.samples} {spread}, {picture.seconds:.2f} s on "
        f"{html.escape(picture.rendered_on)} ({picture.paths_per_second / 1e6:.2f} M paths/s); "
        f"ended by {html.escape(picture.stopped_by)}; "
        f"samples rejected: {picture.rejected_samples}.</p>"
    )


def _pictures(picture: Picture) -> str:
    legend = f"from {LEAST:.1%} (dark) to {MOST:.0%} (pale) of the picture's RMS radiance"
    return (
        '<div class=pair><figure><img alt="the picture" src="'
        + _data_uri(picture.rgba)
        + '"><figcaption>The picture</figcaption></figure><figure><img alt="its error" src="'
        + _data_uri(error_map(picture))
        + f'"><figcaption>Standard error of each pixel, {legend}</figcaption></figure></div>'
    )


def _data_uri(pixels: NDArray[np.uint8]) -> str:
    if pixels.shape[-1] == 3:
        opaque = np.full((*pixels.shape[:2], 1), 255, np.uint8)
        pixels = np.concatenate([pixels, opaque], axis=-1)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "picture.png"
        picture_files.write_png(file, pixels)
        return "data:image/png;base64," + base64.b64encode(file.read_bytes()).decode("ascii")


def _effects(picture: Picture) -> str:
    rows = "".join(
        f"<tr{'' if effect.on else ' class=off'}><td>{html.escape(effect.name)}<td>"
        f"{'on' if effect.on else 'off'}<td>{html.escape(effect.reason)}"
        for effect in picture.plan.effects
    )
    notes = "".join(f"<li>{html.escape(note)}" for note in picture.plan.notes)
    return (
        "<h2>What was simulated, and why</h2><table><tr><th>effect<th><th>reason"
        f"{rows}</table>{f'<ul>{notes}</ul>' if notes else ''}"
    )


def _costs(costs: Sequence[EffectCost]) -> str:
    if not costs:
        return ""
    rows = "".join(
        f"<tr><td>{html.escape(cost.name)}<td>{cost.saved:+.0%}<td>{cost.change:.1%}"
        for cost in costs
    )
    return (
        "<h2>What each effect costs</h2><table><tr><th>rendered<th>change of time per sample"
        f"<th>change of the picture (NRMS){rows}</table>"
    )


def _recipe(picture: Picture) -> str:
    text = json.dumps(picture.recipe, indent=1, default=str)
    return f"<h2>Recipe</h2><pre>{html.escape(text)}</pre>"
