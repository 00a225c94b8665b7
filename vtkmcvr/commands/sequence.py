"""`vtkmcvr render --time all`: one picture per volume of 4-D data, or a movie."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .inputs import input_options, read_as_asked
from .render import picture_facts, picture_of
from .terminal import say_to, write_json

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ..scene import Scene

MOVIES = (".gif", ".webp", ".mp4")
SECONDS_PER_FRAME = (0.02, 2.0)
USUAL_SECONDS = 0.1


def make_sequence(args: argparse.Namespace) -> int:
    """Render every volume as the first one: look, range of values, camera and lights."""
    from ..pictures.picture import check_suffix
    from ..readers import time_steps

    output = Path(args.output)
    movie = output.suffix.lower() in MOVIES
    if movie:
        _check_writer(output)
    else:
        check_suffix(output)
    say = say_to(args)
    times = time_steps(args.input, series=input_options(args).get("series"))
    frames: list[NDArray[np.uint8]] = []
    facts: list[dict[str, Any]] = []
    first: Scene | None = None
    for index, time in enumerate(times):
        picture = picture_of(read_as_asked(args.input, args, time=index), args, first)
        if first is None:
            args.preset = args.preset or picture.recipe["preset"]
            # Solids of a label map are volumes of their own
            first = picture.plan.scene if args.preset != "labels" else None
            say(picture.recipe["notes"][0])
        if movie:
            frames.append(_opaque(picture.rgba))
            say(f"frame {index + 1} of {len(times)}: time {time:g}")
        else:
            path = frame_path(output, index, len(times))
            picture.save(path, bits=args.bits)
            say(f"picture {index + 1} of {len(times)}: time {time:g}, {path.resolve()}")
        facts.append({**picture_facts(picture), "time": time})
        if picture.stopped_by == "user":
            say(f"interrupted after {index + 1} of {len(times)}")
            break
    if movie:
        write_movie(output, frames, _frame_seconds(times))
        say(f"movie: {output.resolve()}")
    write_json(args.json, {"frames": facts})
    return 0


def frame_path(output: Path, index: int, count: int) -> Path:
    """Return the file of one frame: "a-07.png" of "a.png", or where the name has "%d", there."""
    if "%" in output.name:
        try:
            return output.with_name(output.name % index)
        except (TypeError, ValueError):
            raise ValueError(
                f"a name for frames has one number such as %03d, got {output.name!r}"
            ) from None
    digits = len(str(max(count - 1, 1)))
    return output.with_name(f"{output.stem}-{index:0{digits}}{output.suffix}")


def write_movie(path: Path, frames: list[NDArray[np.uint8]], seconds: float) -> None:
    """Write frames as .gif or .webp (Pillow) or .mp4 (imageio with FFmpeg).

    Parameters
    ----------
    path : Path
        The file, complete or not there.
    frames : list of ndarray, shape (rows, columns, 3)
        sRGB of 8 bits, row 0 on top.
    seconds : float
        How long each is shown.
    """
    from ..safe_files import replacing

    with replacing(path, path.suffix.lower()) as temporary:
        if path.suffix.lower() == ".mp4":
            _write_mp4(temporary, frames, seconds)
            return
        from PIL import Image

        first, *rest = (Image.fromarray(frame) for frame in frames)
        first.save(
            temporary, save_all=True, append_images=rest, duration=round(1000 * seconds), loop=0
        )


def _check_writer(path: Path) -> None:
    """Say before anything is rendered that a package is missing."""
    if path.suffix.lower() == ".mp4":
        try:
            import imageio_ffmpeg  # noqa: F401
        except ImportError as error:
            raise ImportError(
                'writing .mp4 needs imageio with FFmpeg: pip install "vtkmcvr[movie]"; .gif and '
                ".webp do not"
            ) from error
    if not path.parent.is_dir():
        raise FileNotFoundError(f"cannot write {path}: there is no folder {path.parent}")


def _write_mp4(path: Path, frames: list[NDArray[np.uint8]], seconds: float) -> None:
    import imageio_ffmpeg

    # The usual colour format needs even numbers of rows and columns.
    rows, columns = (size // 2 * 2 for size in frames[0].shape[:2])
    writer = imageio_ffmpeg.write_frames(
        str(path), (columns, rows), fps=1 / seconds, macro_block_size=2
    )
    writer.send(None)
    for frame in frames:
        writer.send(np.ascontiguousarray(frame[:rows, :columns]))
    writer.close()


def _opaque(rgba: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return a picture with straight alpha before black."""
    alpha = rgba[..., 3:].astype(np.uint16)
    return ((rgba[..., :3] * alpha + 127) // 255).astype(np.uint8)


def _frame_seconds(times: list[float]) -> float:
    """Return the mean step of times that may be seconds, or the usual one."""
    step = (times[-1] - times[0]) / (len(times) - 1) if len(times) > 1 else 0.0
    whole_numbers = times == [float(k) for k in range(len(times))]
    low, high = SECONDS_PER_FRAME
    return USUAL_SECONDS if whole_numbers or not low <= step <= high else step
