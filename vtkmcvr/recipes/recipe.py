"""What a saved picture says of how it was made: enough to make the same bits again."""

from __future__ import annotations

import base64
import dataclasses
import hashlib
import zlib
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .. import __version__, packed
from .content_hash import content
from .serialise import NotSerialisable, to_plain

if TYPE_CHECKING:
    from ..pictures.picture import Picture

FORMAT = 1


def recipe_of(picture: Picture) -> dict[str, Any]:
    """Recipe of a picture, as plain JSON values.

    What the front door noted, with "measured" (what came out) and "replay" (what `vtkmcvr.replay`
    reads): the whole scene, seed, samples of each pixel, display, denoiser, and a hash of the film.
    Of volume and environment there are hashes and shapes only: no path, no voxel, no patient.
    """
    return {
        **picture.recipe,
        "exposure": picture.display.exposure,
        "background": picture.display.background,
        "measured": {
            "samples": picture.samples,
            "seconds": picture.seconds,
            "nrms": picture.nrms if np.isfinite(picture.nrms) else None,
            "stopped_by": picture.stopped_by,
            "device": picture.device,
            "rejected_samples": picture.rejected_samples,
            "majorant_violations": picture.majorant_violations,
        },
        "replay": _replay(picture),
    }


def _replay(picture: Picture) -> dict[str, Any]:
    try:
        scene = to_plain(picture.plan.scene)
    except NotSerialisable as error:
        return {"format": FORMAT, "version": __version__, "impossible": str(error)}
    return {
        "format": FORMAT,
        "version": __version__,
        "scene": scene,
        "seed": picture.seed,
        "backend": picture.backend,
        "samples": plain_counts(picture.film.count),
        "density": None if picture.density is None else plain_counts(picture.density),
        "display": dataclasses.asdict(picture.display),
        "denoised": picture.denoiser,
        "film": film_hash(picture.film),
    }


def film_hash(film: packed.Film) -> str:
    """SHA-256 of the counts and the means of radiance, in hexadecimal."""
    digest = hashlib.sha256(content(film.count))
    digest.update(content(film.mean))
    return digest.hexdigest()


def plain_counts(count: NDArray[np.int64]) -> Any:
    """Samples of each pixel: a number, or a compressed map where a run was cut off."""
    first = int(count.flat[0])
    if (count == first).all():
        return first
    return base64.b64encode(zlib.compress(content(count), 9)).decode("ascii")


def counts_of(plain: Any, size: tuple[int, int]) -> NDArray[np.int64]:
    """Map (H, W) of what `plain_counts` made; ValueError where it is none."""
    width, height = size
    if type(plain) is int and 0 <= plain < 2**62:
        return np.full((height, width), plain, np.int64)
    try:
        unpack = zlib.decompressobj()
        bound = 8 * width * height + 1
        unpacked = unpack.decompress(base64.b64decode(plain, validate=True), bound)
        counts = np.frombuffer(unpacked, "<i8").reshape(height, width)
    except (TypeError, ValueError, zlib.error):
        raise ValueError("the recipe does not say how many samples a pixel has") from None
    if counts.min() < 0:
        raise ValueError("the recipe has pixels of less than no samples")
    return counts.astype(np.int64)
