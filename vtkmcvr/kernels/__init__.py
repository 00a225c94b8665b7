"""Numba kernels: plain functions over the NamedTuples of `vtkmcvr.packed`."""
