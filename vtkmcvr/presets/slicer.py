"""Looks of 3D Slicer: presets.xml and MRML scenes, .vp, .vp.json.

Slicer shows its colours as they are, that is as sRGB; here they are albedo in linear light. Its
opacities are per mm. Where shading is on, half of the scattering is surfaces, with VTK's highlight
turned into a coat as in `vtkmcvr.vtk_bridge.property.surface_of`. Ambient and diffuse coefficients
have no meaning for light that is simulated.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any
from xml.etree import ElementTree

from ..material import Surface
from ..pictures.display import srgb_decode
from .look import Look, Nodes

# Lines of a .vp file, in this order
LINES = ("interpolation", "shade", "diffuse", "ambient", "specular", "specularPower",
         "scalarOpacity", "gradientOpacity", "colorTransfer")  # fmt: skip
MOST_NUMBERS = 1 << 16


def looks_from_xml(text: str) -> list[Look]:
    """Return the looks of a presets.xml or MRML scene.

    Raises
    ------
    ValueError
        Where it is no XML, declares entities, or has no VolumeProperty that can be read.
    """
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise ValueError("it declares a document type, which presets of 3D Slicer do not")
    try:
        root = ElementTree.fromstring(text.encode("utf-8"))
    except ElementTree.ParseError as error:
        raise ValueError(f"it is no XML ({error})") from None
    found = [
        _look(element.attrib, element.get("name") or f"preset-{number}")
        for number, element in enumerate(root.iter("VolumeProperty"), 1)
    ]
    if not found:
        raise ValueError("it has no VolumeProperty element")
    return found


def look_from_lines(text: str, name: str) -> Look:
    """Return the look of a .vp file: one property on each line."""
    lines = [line.partition("=>")[0].strip() for line in text.splitlines()]
    lines = [line for line in lines if line]
    if len(lines) < len(LINES):
        raise ValueError(f"a .vp file has {len(LINES)} lines, this one {len(lines)}")
    return _look(dict(zip(LINES, lines, strict=False)), name)


def looks_from_json(content: Mapping[str, Any], name: str) -> list[Look]:
    """Return the looks of a .vp.json file (volume-property-schema 1.0)."""
    properties = content.get("volumeProperties")
    if not isinstance(properties, list) or not properties:
        raise ValueError("its volumeProperties are no list with an entry")
    several = len(properties) > 1
    return [
        _look(_attributes(item), f"{name}-{number}" if several else name)
        for number, item in enumerate(properties, 1)
    ]


def _attributes(item: Any) -> dict[str, Any]:
    """Return the attributes of a property in .vp.json under the names that XML has."""
    try:
        component = item["components"][0]
        light = component.get("lighting", {})
        names = ("scalarOpacity", "rgbTransferFunction")
        points = {name: component[name]["points"] for name in names}
        gradient = component.get("gradientOpacity", {}).get("points", [])
        return {
            "shade": str(int(bool(component.get("shade", False)))),
            "specular": str(light.get("specular", 0.2)),
            "specularPower": str(light.get("specularPower", 10.0)),
            "unit": str(component.get("scalarOpacityUnitDistance", 1.0)),
            "scalarOpacity": _flat([[p["x"], p["y"]] for p in points["scalarOpacity"]]),
            "gradientOpacity": _flat([[p["x"], p["y"]] for p in gradient]),
            "colorTransfer": _flat([[p["x"], *p["color"]] for p in points["rgbTransferFunction"]]),
        }
    except (KeyError, TypeError, IndexError, AttributeError) as error:
        raise ValueError(f"a property lacks what the schema asks for ({error!r})") from None


def _flat(rows: list[list[Any]]) -> str:
    numbers = [str(x) for row in rows for x in row]
    return " ".join([str(len(numbers)), *numbers]) if numbers else ""


def _look(attributes: Mapping[str, str], name: str) -> Look:
    colour = tuple(
        (x, *(float(c) for c in srgb_decode(rgb)))
        for x, *rgb in _nodes(attributes, "colorTransfer", 4)
    )
    gradient = _nodes(attributes, "gradientOpacity", 2) if attributes.get("gradientOpacity") else ()
    return Look(
        name,
        "imported from 3D Slicer",
        "HU" if name.upper().startswith("CT") else "data",
        _nodes(attributes, "scalarOpacity", 2),
        colour,
        unit_distance=_number(attributes, "unit", 1.0),
        surface=_surface(attributes),
        gradient_opacity=gradient if any(y != 1.0 for _, y in gradient) else None,
    )


def _surface(attributes: Mapping[str, str]) -> Surface | None:
    if not _number(attributes, "shade", 0.0):
        return None
    exponent = 4.0 * min(max(_number(attributes, "specularPower", 10.0), 0.0), 1e5)
    highlight = 8.0 * _number(attributes, "specular", 0.2) / (exponent + 2.0)
    return Surface(0.5, specular=min(max(highlight, 0.0), 1.0), exponent=exponent)


def _number(attributes: Mapping[str, str], key: str, usual: float) -> float:
    text = attributes.get(key, str(usual))
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ValueError(f"{key} is no number: {str(text)[:40]!r}")
    return value


def _nodes(attributes: Mapping[str, str], key: str, width: int) -> Nodes:
    """Return the nodes of "COUNT NUMBER NUMBER ...", `width` numbers each."""
    words = str(attributes.get(key, "")).split()
    try:
        count, *numbers = (float(word) for word in words[: MOST_NUMBERS + 1])
    except ValueError:
        raise ValueError(f"{key} is no list of numbers: {' '.join(words)[:40]!r}") from None
    if count != len(words) - 1 or not numbers or len(numbers) % width:
        raise ValueError(
            f"{key} promises {count:g} numbers in groups of {width} and has {len(words) - 1}"
        )
    if not all(map(math.isfinite, numbers)):
        raise ValueError(f"{key} has a number that is not finite")
    return tuple(tuple(numbers[i : i + width]) for i in range(0, len(numbers), width))
