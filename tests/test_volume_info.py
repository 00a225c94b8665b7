"""Facts about a volume and the page that shows them."""

from __future__ import annotations

import json

import numpy as np
import pytest
import pyvista
from vtkmodules.vtkCommonDataModel import vtkImageData

from vtkmcvr import volume_info as module
from vtkmcvr.commands.info_page import format_info
from vtkmcvr.recorded_facts import record_facts
from vtkmcvr.volume_info import volume_info


def image_of(values: np.ndarray, size: tuple[int, int, int] = (10, 20, 30)) -> pyvista.ImageData:
    image = pyvista.ImageData(dimensions=size, spacing=(1, 2, 3), origin=(-5, 0, 5))
    image.point_data["values"] = values
    return image


def noise(kind: type) -> np.ndarray:
    return np.random.default_rng(3).normal(100, 30, 6000).astype(kind)


@pytest.mark.parametrize("kind", [np.uint8, np.int16, np.uint16, np.int32, np.float32, np.float64])
def test_measured_facts_agree_with_numpy(kind: type) -> None:
    values = noise(kind)
    info = volume_info(image_of(values))
    counts, edges = np.histogram(values, 32)
    assert info["range"] == [values.min(), values.max()]
    assert info["histogram"]["counts"] == counts.tolist()
    np.testing.assert_allclose(info["histogram"]["edges"], edges)
    exact = np.percentile(values, [1, 50, 99], method="inverted_cdf")
    np.testing.assert_allclose(list(info["percentiles"].values()), exact, atol=1)
    assert (info["dtype"], info["components"]) == (np.dtype(kind).name, 1)
    assert info["memory_mb"] == values.nbytes / 1e6


def test_geometry_and_facts_are_ready_for_json() -> None:
    image = image_of(noise(np.int16))
    image.direction_matrix = [[0, 0, 1], [1, 0, 0], [0, 1, 0]]
    record_facts(image, ["read as NRRD"], "CT", "HU")
    info = json.loads(json.dumps(volume_info(image)))
    assert info["dimensions"] == [10, 20, 30]
    assert info["spacing"] == [1, 2, 3]
    assert info["origin"] == [-5, 0, 5]
    assert info["direction"] == [[0, 0, 1], [1, 0, 0], [0, 1, 0]]
    assert info["bounds"] == list(image.bounds)
    assert (info["array"], info["association"]) == ("values", "points")
    assert (info["notes"], info["modality"], info["units"]) == (["read as NRRD"], "CT", "HU")


def test_not_finite_values_are_counted_and_left_out() -> None:
    values = noise(np.float32)
    values[:3] = np.nan, np.inf, -np.inf
    info = volume_info(image_of(values))
    assert (info["nan"], info["inf"]) == (1, 2)
    assert info["range"] == [values[3:].min(), values[3:].max()]
    assert sum(info["histogram"]["counts"]) == 5997
    assert "1 NaN, 2 infinite" in format_info(info)


def test_only_nan() -> None:
    info = volume_info(image_of(np.full(6000, np.nan)))
    assert info["range"] is None
    assert info["percentiles"] == {"1": None, "50": None, "99": None}
    assert "no finite value" in format_info(info)
    json.dumps(info, allow_nan=False)


def test_constant_volume() -> None:
    info = volume_info(image_of(np.full(6000, 7, np.int16)))
    assert info["range"] == [7, 7]
    assert sum(info["histogram"]["counts"]) == 6000
    assert info["percentiles"]["50"] == 7


def test_components_have_their_own_range() -> None:
    colours = np.column_stack([np.arange(6000) % 9, np.full(6000, 50)]).astype(np.uint8)
    info = volume_info(image_of(colours))
    assert info["components"] == 2
    assert info["range"] == [0, 50]
    assert info["component_ranges"] == [[0, 8], [50, 50]]
    assert "2 components" in format_info(info)


def test_cell_values_are_said_to_be_on_cells() -> None:
    image = pyvista.ImageData(dimensions=(3, 3, 3))
    image.cell_data["label"] = np.arange(8)
    info = volume_info(image)
    assert info["association"] == "cells"
    assert "'label' on cells" in format_info(info)


def test_plain_vtk_image_without_values() -> None:
    image = vtkImageData()
    image.SetDimensions(2, 3, 4)
    info = volume_info(image)
    assert (info["array"], info["association"], info["range"]) == ("", "", None)
    assert "none: the image has no point or cell array" in format_info(info)


def test_large_volumes_are_sampled_for_percentiles(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "CHUNK", 512)
    values = noise(np.float64)
    info = volume_info(image_of(values))
    assert sum(info["histogram"]["counts"]) == 6000
    np.testing.assert_allclose(info["percentiles"]["50"], np.median(values), atol=5)


def test_page_shows_a_logarithmic_histogram() -> None:
    values = np.zeros(6000, np.int16)
    values[0] = 320
    record = image_of(values)
    record_facts(record, ["read as NRRD"], "CT", "HU")
    page = format_info(volume_info(record))
    assert "10 x 20 x 30" in page
    assert "0 320 HU" in page
    assert "note         read as NRRD" in page
    bars = [line.count("#") for line in page.splitlines() if " .. " in line and "from" not in line]
    assert len(bars) == 32
    assert bars[0] == 40
    assert bars[1] == 0
    assert 0 < bars[-1] < 8
