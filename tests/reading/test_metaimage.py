"""MetaImage: what is wrong with bad ones."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from made_volumes import VOXELS, error_of, save, voxels

from vtkmcvr.readers import read, time_steps


@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize("name", ["a.mha", "a.mhd"])
def test_truncated_metaimage(tmp_path: Path, name: str, compressed: bool) -> None:
    path = save(tmp_path / name, gz=compressed)
    data = next(iter([*tmp_path.glob("*.raw"), *tmp_path.glob("*.zraw"), path]))
    data.write_bytes(data.read_bytes()[:-20])
    assert "damaged" in error_of(path)


def test_bad_metaimage(tmp_path: Path) -> None:
    path = save(tmp_path / "a.mhd", gz=True)
    text = path.read_text()
    size = (tmp_path / "a.zraw").stat().st_size
    path.write_text(text.replace(f"CompressedDataSize = {size}", "CompressedDataSize = 30"))
    assert f"says 30 bytes of compressed data but there are {size}" in error_of(path)
    path.write_text(text.replace("NDims = 3", "NDims = 73"))
    assert "the header is damaged" in error_of(path)
    path.write_text(text.replace("DimSize = 7 6 5", "DimSize = 7 30 1"))
    assert "a 2-D image (7 x 30 x 1)" in error_of(path)
    path.write_text(text)
    (tmp_path / "a.zraw").unlink()
    assert "data file 'a.zraw' is missing" in error_of(path)
    path.write_text("hello")
    assert "not a MetaImage file" in error_of(path)


def test_bytes_behind_compressed_metaimage_are_ignored(tmp_path: Path) -> None:
    path = save(tmp_path / "a.mha", gz=True)
    path.write_bytes(path.read_bytes() + b"trailing")
    np.testing.assert_array_equal(voxels(read(path)), VOXELS)


def test_one_of_several_volumes_is_chosen(tmp_path: Path) -> None:
    path = save(tmp_path / "a.mha", np.stack([VOXELS + 1000 * k for k in range(4)]))
    np.testing.assert_array_equal(voxels(read(path)), VOXELS)
    np.testing.assert_array_equal(voxels(read(path, time=3)), VOXELS + 3000)
    assert "there is no volume with time=4; allowed is 0 to 3" in error_of(path, time=4)
    assert time_steps(path) == [0, 1, 2, 3]
