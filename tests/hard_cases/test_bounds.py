"""Bounds checks are on where `make sanitize` asks for them."""

import os

import numpy as np
import pytest

from vtkmcvr.kernels.jit import device, kernel

pytestmark = pytest.mark.skipif(
    os.environ.get("NUMBA_BOUNDSCHECK") != "1", reason="for NUMBA_BOUNDSCHECK=1: make sanitize"
)


@device
def element(values, i):
    return values[i]


@kernel
def read(values, i):
    return element(values, i)


def test_an_index_beyond_the_array_is_noticed():
    values = np.arange(3.0)
    assert read(values, 2) == 2
    with pytest.raises(IndexError):
        read(values, 3)
