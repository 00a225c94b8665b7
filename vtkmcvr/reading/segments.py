"""Names and colours of the labels of a label map, from the file or from a table beside it."""

from __future__ import annotations

import json
import re
from typing import TYPE_CHECKING, Any

from ..recorded_facts import Segment
from .colours import spread_colour
from .errors import fail

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

SIDECARS = (".ctbl", ".txt", ".tsv", ".json", ".label")
SIZE_LIMIT = 1 << 24
CARET_LABEL = re.compile(r"<Label\s([^>]*)>\s*(?:<!\[CDATA\[(.*?)\]\]>|([^<]*))</Label>", re.DOTALL)
ATTRIBUTE = re.compile(r'(\w+)="([^"]*)"')
ITK_SNAP = re.compile(r'^(\d+)\s+(\d+)\s+(\d+)\s+(\d+)\s+[\d.]+\s+\d+\s+\d+\s+"(.*)"$')
Colour = tuple[float, float, float]


def segments_from_slicer(pairs: dict[str, str]) -> list[Segment]:
    """Return the segments that 3D Slicer writes into a .seg.nrrd file.

    Where several layers use the same label value, the segments are numbered from 1 instead.
    """
    found = []
    layers = {text for key, text in pairs.items() if re.fullmatch(r"Segment\d+_Layer", key)}
    number = 0
    while f"Segment{number}_LabelValue" in pairs:
        text = {
            name: pairs.get(f"Segment{number}_{name}", "")
            for name in ("LabelValue", "Name", "ID", "Color")
        }
        value = number + 1 if len(layers) > 1 else _whole(text["LabelValue"]) or 0
        colour = _colour(text["Color"].split(), 1.0) or spread_colour(value)
        found.append(Segment(value, text["Name"] or text["ID"] or str(value), colour))
        number += 1
    return found


def segments_from_caret(text: str) -> list[Segment]:
    """Return the segments of the label table that Caret and TotalSegmentator write as XML."""
    found = []
    for attributes, quoted, plain in CARET_LABEL.findall(text):
        known = dict(ATTRIBUTE.findall(attributes))
        value = _whole(known.get("Key", ""))
        if value:
            parts = [known.get(name, "") for name in ("Red", "Green", "Blue")]
            colour = _colour(parts, 1.0) or spread_colour(value)
            found.append(Segment(value, (quoted or plain).strip() or str(value), colour))
    return found


def sidecar_of(source: Path) -> Path | None:
    """Return the table of labels beside a label map, such as aal.nii.txt of aal.nii.gz."""
    stems = {source.name}
    for suffix in (".gz", ".nii", ".nrrd", ".seg", ".nhdr", ".mha", ".mhd"):
        stems |= {stem.removesuffix(suffix) for stem in stems}
    places = (source.with_name(stem + suffix) for suffix in SIDECARS for stem in sorted(stems))
    return next((place for place in places if place != source and place.is_file()), None)


def read_sidecar(path: Path) -> list[Segment]:
    """Read a table of labels.

    Parameters
    ----------
    path : Path
        A colour table of 3D Slicer (.ctbl, .txt), a label description of ITK-SNAP, a list of
        numbers and names, a BIDS .tsv, or JSON: {"name": 1}, {"1": "name"}, the same under
        "labels", or a list of objects with value, name and color.

    Raises
    ------
    VolumeReadError
        If nothing in it names a label.
    """
    if path.stat().st_size > SIZE_LIMIT:
        fail(path, "far too long for a table of labels; check the file")
    text = path.read_text(encoding="utf-8", errors="replace")
    if path.suffix == ".json":
        try:
            found = _from_json(json.loads(text))
        except (ValueError, RecursionError):
            fail(path, "not a table of labels in JSON; check the file")
    elif path.suffix == ".tsv":
        found = _from_tsv(text.splitlines())
    else:
        found = [_from_line(line.strip()) for line in text.splitlines()]
    segments = [segment for segment in found if segment is not None and segment.value > 0]
    if not segments:
        fail(path, "names no label; give lines such as '1 liver 220 120 90 255'")
    return segments


def _from_line(line: str) -> Segment | None:
    snap = ITK_SNAP.match(line)
    if snap:
        label = int(snap[1])
        return Segment(label, snap[5], _colour(snap.groups()[1:4], 255.0) or spread_colour(label))
    words = line.split()
    value = _whole(words[0]) if len(words) > 1 else None
    if value is None:
        return None
    colour = _colour(words[-4:-1], 255.0) if len(words) >= 6 else None
    name = " ".join(words[1:-4]) if colour else words[1]
    return Segment(value, name.strip('"'), colour or spread_colour(value))


def _from_tsv(lines: list[str]) -> list[Segment | None]:
    columns = [name.strip().lower() for name in (lines or [""])[0].split("\t")]
    if not {"index", "name"} <= set(columns):
        return []
    found = []
    for line in lines[1:]:
        row = dict(zip(columns, line.split("\t"), strict=False))
        found.append(_from_object({**row, "value": row.get("index")}))
    return found


def _from_json(content: Any) -> list[Segment | None]:
    if isinstance(content, dict):
        content = content.get("labels", content.get("segments", content))
    if isinstance(content, dict):
        pairs = ((_whole(k), v) if _whole(k) is not None else (_whole(v), k)
                 for k, v in content.items())  # fmt: skip
        content = [{"value": value, "name": str(name)} for value, name in pairs]
    items = content if isinstance(content, list) else []
    return [_from_object(item) for item in items if isinstance(item, dict)]


def _from_object(item: dict[str, Any]) -> Segment | None:
    keys = {str(key).lower(): value for key, value in item.items()}
    numbers = (keys.get(key) for key in ("value", "labelvalue", "label", "id", "index"))
    value = next((n for n in map(_whole, numbers) if n is not None), None)
    if value is None:
        return None
    name = str(keys.get("name") or keys.get("label") or value)
    return Segment(value, name, _any_colour(keys) or spread_colour(value))


def _any_colour(keys: dict[str, Any]) -> Colour | None:
    given = next((keys[key] for key in ("color", "colour", "rgb") if key in keys), None)
    if isinstance(given, str) and re.fullmatch(r"#?[0-9a-fA-F]{6}", given.strip()):
        given = [int(given.strip().lstrip("#")[k : k + 2], 16) for k in (0, 2, 4)]
        return _colour(given, 255.0)
    if not isinstance(given, list):
        return None
    whole = all(isinstance(part, int) for part in given) and max(given, default=0) > 1
    return _colour(given[:3], 255.0 if whole else 1.0)


def _whole(text: Any) -> int | None:
    try:
        return int(text)
    except (TypeError, ValueError):
        return None


def _colour(parts: Iterable[Any], scale: float) -> Colour | None:
    try:
        red, green, blue = (float(part) / scale for part in parts)
    except (TypeError, ValueError):
        return None
    return (red, green, blue) if all(0.0 <= x <= 1.0 for x in (red, green, blue)) else None
