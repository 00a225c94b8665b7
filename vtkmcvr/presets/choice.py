"""Which look a volume gets where none is asked for."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .statistics import finite_sample, hu_offset, is_label_map

# Share of the voxels that bone has to fill, and where bone, tissue and lung begin, HU
BONE_SHARE, BONE_HU, TISSUE_HU = 5e-4, 300.0, -300.0
# Share of the positive magnitude that negative values need for a look of both signs
SIGNED_SHARE = 0.2
BY_MODALITY = {"MR": "mr-head", "PT": "pet-fusion", "NM": "pet-fusion", "SEG": "labels",
               "colours": "solid"}  # fmt: skip


def choose_look(
    values: NDArray, units: str = "", modality: str = "", *, labels: bool = False
) -> str:
    """Name of the look for values of known or unknown kind.

    Parameters
    ----------
    values : array (k, j, i)
    units, modality : str
        "HU", "SUV"; "CT", "MR", "PT", "SEG", where the reader knows them; "colours" where each
        point has its own.
    """
    if modality in BY_MODALITY:
        return BY_MODALITY[modality]
    if units == "SUV":
        return "pet-fusion"
    offset = 0.0 if units == "HU" else hu_offset(values)
    if offset is not None:
        return _ct_look(finite_sample(values) + offset)
    if is_label_map(values):
        return "labels"
    sample = finite_sample(values)
    low, high = (float(np.percentile(sample, p)) for p in (0.1, 99.9))
    return "signed" if low < -SIGNED_SHARE * abs(high) < 0 else "solid"


def _ct_look(hu: NDArray[np.float64]) -> str:
    """By what there is: bone, else tissue, else nothing that HU would explain."""
    if float(np.mean(hu > BONE_HU)) > BONE_SHARE:
        return "ct-bone"
    return "ct-soft" if float(np.mean(hu > TISSUE_HU)) > BONE_SHARE else "solid"
