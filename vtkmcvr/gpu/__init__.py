"""Rendering on CUDA devices: what is there, memory, launches.

The kernels are those of the CPU, compiled by numba-cuda. Nothing here imports it before it is asked
for.
"""
