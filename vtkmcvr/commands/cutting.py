"""Options that cut a volume open, and put a floor under it."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ..cutting import Cropping, Shape
    from ..receivers import PlaneReceiver
    from ..scene import Volume

AXES = "xyz"


def add_cutting_options(parser: argparse.ArgumentParser) -> None:
    """What is cut off, and where shadows fall."""
    add = parser.add_argument
    add(
        "--clip",
        action="append",
        default=[],
        metavar="AXIS=FROM:TO",
        help="keep a range of x, y or z in world coordinates, such as y=12.5: or z=:60%%; percent "
        "are of the volume's extent; may be given again",
    )
    add(
        "--crop",
        metavar="I:I,J:J,K:K",
        help="keep a range of voxels along each axis, such as 20:90,:,0:40",
    )
    add("--mask", metavar="FILE", help="volume on the same grid; its zeros hide voxels")
    add(
        "--labels",
        metavar="FILE",
        help="segmentation, put onto the volume's grid; each label gets its colour, in the look's "
        "opacity",
    )
    names = "names (* and ? stand for any letters) or numbers of labels, with commas between"
    add("--show", metavar="NAMES", help=f"labels that become solids: {names}; or all")
    add("--hide", metavar="NAMES", help="labels that are left out")
    add("--highlight", metavar="NAMES", help="labels that are solid among faint ones")
    add("--floor", action="store_true", help="a floor under the volume, for its shadow")


def cutting_options(data: Any, options: dict[str, Any], args: argparse.Namespace) -> dict[str, Any]:
    """`options` of `scene_of` with those of the command line added."""
    chosen = {part: getattr(args, part) for part in ("show", "hide", "highlight")}
    asked = (args.clip, args.crop, args.mask, args.labels, args.floor, *chosen.values())
    if not any(asked):
        return options
    from ..front import scene_of
    from ..scene import Volume
    from ..vtk_bridge.scene import volume_of
    from .labelling import labelled

    volume = data if isinstance(data, Volume) else volume_of(data)
    options = {**options}
    if args.clip:
        options["clip"] = tuple(shape for text in args.clip for shape in _clip(text, volume))
    if args.crop:
        options["crop"] = _crop(args.crop, volume)
    flip = getattr(args, "flip", None)
    # What lies beside the volume's file was stored the same way round
    stored = volume.flipped(flip) if flip else volume
    if args.mask:
        options["mask"] = _grid(args.mask, stored)
    if args.labels or any(chosen.values()):
        options |= labelled(data, volume, stored, args.labels, chosen, options)
    if args.floor:
        options["receivers"] = (floor_under(scene_of(data, **options).scene),)
    return options


def _clip(text: str, volume: Volume) -> list[Shape]:
    import numpy as np

    from ..cutting import Plane

    axis, _, span = text.partition("=")
    start, colon, end = span.partition(":")
    if axis not in AXES or len(axis) != 1 or not colon or not (start or end):
        raise ValueError(f"--clip is an axis and a range such as y=12.5: or z=:60%, got {text!r}")
    corners = volume.corners[:, AXES.index(axis)]
    planes: list[Shape] = []
    for end_text, sign in ((start, 1.0), (end, -1.0)):
        if end_text:
            unit = np.eye(3)[AXES.index(axis)]
            origin = unit * _place(end_text, corners, text)
            planes.append(Plane(tuple(origin.tolist()), tuple((sign * unit).tolist())))
    return planes


def _place(number: str, corners: NDArray, text: str) -> float:
    """World coordinate, given as such or in percent of the volume's extent."""
    try:
        value = float(number.removesuffix("%"))
    except ValueError:
        raise ValueError(f"--clip takes numbers and percentages, got {text!r}") from None
    if not number.endswith("%"):
        return value
    low, high = float(corners.min()), float(corners.max())
    return low + (high - low) * value / 100


def _crop(text: str, volume: Volume) -> Cropping:
    from ..cutting import Cropping

    parts = [part.split(":") for part in text.split(",")]
    try:
        lower, upper = zip(
            *(
                (float(a) if a else 0.0, float(b) if b else float(n - 1))
                for (a, b), n in zip(parts, volume.shape, strict=True)
            ),
            strict=True,
        )
    except ValueError:
        raise ValueError(
            f"--crop is a range of voxels for each axis such as 20:90,:,0:40, got {text!r}"
        ) from None
    return Cropping(lower, upper)


def _grid(path: str, volume: Volume) -> NDArray:
    """Values of a file that has the volume's grid, place included."""
    import numpy as np

    from ..vtk_bridge.scene import volume_of
    from .inputs import read_input

    other = volume_of(read_input(path, None))
    same = other.shape == volume.shape and np.allclose(
        other.corners, volume.corners, atol=0.01 * float(volume.spacing.min())
    )
    if not same:
        raise ValueError(
            f"{path} has another grid than the volume: {other.shape} points from "
            f"{np.round(other.corners[0], 3).tolist()}, not {volume.shape} from "
            f"{np.round(volume.corners[0], 3).tolist()}; resample it first"
        )
    return other.values


def floor_under(scene: Any) -> PlaneReceiver:
    """Floor on which the visible part of a scene's volumes stands, as the camera sees it."""
    import numpy as np

    from ..plan import plan
    from ..receivers import PlaneReceiver

    up = np.array(scene.camera.frame[1])
    largest = int(np.argmax(np.abs(up)))
    axis = np.sign(up[largest]) * np.eye(3)[largest]
    corners = plan(scene).corners
    if not len(corners):
        corners = scene.volume.corners
    lowest = float((corners @ axis).min()) - 0.01 * scene.volume.radius
    middle = (corners.min(0) + corners.max(0)) / 2
    place = middle + (lowest - middle @ axis) * axis
    return PlaneReceiver(tuple(place.tolist()), tuple((axis + 0.0).tolist()), colour=0.45)
