"""Volumes of the accuracy page: an environment and two area lights around each."""

from __future__ import annotations

import os
from pathlib import Path
from typing import NamedTuple

import numpy as np

from vtkmcvr.front import View, scene_of
from vtkmcvr.readers import read_vtk
from vtkmcvr.scene import Scene, Volume
from vtkmcvr.vtk_bridge.scene import volume_of

DATA = Path(os.environ.get("VTKMCVR_DATA", Path(__file__).parents[3] / "shared" / "data"))


class Subject(NamedTuple):
    """File, index axes that are stored backwards, look and view."""

    file: str
    flip: str
    preset: str
    view: View = View()


SUBJECTS = {
    "CT head": Subject("scivis/cthead/CThead.nhdr", "k", "ct-bone", View(azimuth=-28)),
    "engine": Subject("scivis/engine.nhdr", "", "solid", View(azimuth=-35, elevation=24)),
    "CT thorax": Subject("dicom/ct_thorax_lidc0314", "", "ct-bone"),
    "MR head": Subject("nifti/MR_Gd.nii.gz", "", "mr-head", View(azimuth=-60, elevation=15)),
    "CT abdomen": Subject("nifti/example_ct.nii.gz", "", "ct-bone"),
}


def volume_named(name: str) -> Volume:
    """Volume of a subject."""
    subject = SUBJECTS[name]
    volume = volume_of(read_vtk(str(DATA / subject.file)))
    return volume.flipped(subject.flip) if subject.flip else volume


def scene_named(name: str, volume: Volume, size: tuple[int, int]) -> Scene:
    """Scene of a subject in its look."""
    subject = SUBJECTS[name]
    return scene_of(volume, preset=subject.preset, size=size, view=subject.view).scene


def on_axes(volume: Volume) -> Volume:
    """The same values on a grid along the axes of the world, which every renderer knows."""
    return Volume.from_grid(np.asarray(volume.values), tuple(volume.spacing.tolist()))
