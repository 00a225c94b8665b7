"""Volumes of the collection in VTKMCVR_DATA; tests that need one skip where it is absent."""

import os
from pathlib import Path

import pytest

from vtkmcvr.readers import read_vtk
from vtkmcvr.vtk_bridge.scene import volume_of

DATA = Path(os.environ.get("VTKMCVR_DATA", Path(__file__).parents[2] / "shared" / "data"))


def real_path(name):
    """Path of a file or folder of the collection."""
    path = DATA / name
    if not path.exists():
        pytest.skip(f"{name} is not here: set VTKMCVR_DATA to the volume collection")
    return path


def real_volume(name):
    """Volume of a file or folder of the collection."""
    return volume_of(read_vtk(str(real_path(name))))
