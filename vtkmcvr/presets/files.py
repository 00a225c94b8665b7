"""Looks in files: our own JSON, and what 3D Slicer writes."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

from ..recipes.deserialise import from_plain
from ..recipes.serialise import to_plain
from ..safe_files import replacing
from .look import Look

FORMAT = "vtkmcvr look 1"
SUFFIXES = (".json", ".xml", ".mrml", ".vp")
LARGEST = 1 << 24


def names_file(preset: str) -> bool:
    """Whether a preset is the path of a look, perhaps with #NAME behind it."""
    return Path(preset.partition("#")[0]).suffix.lower() in SUFFIXES


def write_look(look: Look, path: str | os.PathLike[str]) -> None:
    """Write a look as JSON.

    Parameters
    ----------
    look : Look
    path : path-like
        Ends in .json; complete or not there.
    """
    if Path(path).suffix.lower() != ".json":
        raise ValueError(f"a look is written as .json, got {os.fspath(path)}")
    plain = {"format": FORMAT, "look": to_plain(look, "look")}
    with replacing(path, ".json") as temporary:
        temporary.write_text(json.dumps(plain, indent=2, allow_nan=False) + "\n", encoding="utf-8")


def read_look(path: str | os.PathLike[str], name: str | None = None) -> Look:
    """Read a look from a file.

    Parameters
    ----------
    path : path-like
        .json of `write_look`; presets.xml, .mrml, .vp or .vp.json of 3D Slicer. "FILE#NAME" stands
        for `name`.
    name : str, optional
        Which one, where the file holds several.

    Raises
    ------
    ValueError
        Where the file holds no look, or several and no name is given; the message lists them.
    """
    place, _, after = os.fspath(path).partition("#")
    wanted = name or after or None
    looks = {look.name: look for look in read_looks(place)}
    if wanted is None and len(looks) == 1:
        return next(iter(looks.values()))
    if wanted in looks:
        return looks[wanted]
    asked = "name one of them" if wanted is None else f"there is no {wanted!r}"
    raise ValueError(f"{place} holds {len(looks)} looks, {asked}: {place}#{next(iter(looks))} "
                     f"or another of {', '.join(looks)}")  # fmt: skip


def read_looks(path: str | os.PathLike[str]) -> list[Look]:
    """Read all looks of a file; see `read_look`."""
    from . import slicer

    place = Path(path)
    suffix = place.suffix.lower()
    if suffix not in SUFFIXES:
        raise ValueError(f"{place}: a file of looks ends in {', '.join(SUFFIXES)}")
    if place.stat().st_size > LARGEST:
        raise ValueError(f"{place} is far too long for a file of looks")
    text = place.read_text(encoding="utf-8", errors="replace")
    try:
        if suffix in (".xml", ".mrml"):
            return slicer.looks_from_xml(text)
        if suffix == ".vp":
            return [slicer.look_from_lines(text, place.stem)]
        return _from_json(json.loads(text), place)
    except (ValueError, RecursionError) as error:
        reason = "nested too deep" if isinstance(error, RecursionError) else error
        raise ValueError(f"{place} holds no look: {reason}") from None


def _from_json(content: Any, place: Path) -> list[Look]:
    from . import slicer

    if isinstance(content, dict) and "volumeProperties" in content:
        return slicer.looks_from_json(content, place.name.removesuffix(".json").removesuffix(".vp"))
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        raise ValueError(f'it has no "format": "{FORMAT}" and no "volumeProperties"')
    look = from_plain(content.get("look"), {}, "look")
    if not isinstance(look, Look):
        raise ValueError("its look is of another type")
    return [look]
