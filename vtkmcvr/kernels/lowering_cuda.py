"""`lowering` for CUDA: variables that are assigned once are values, which compiles faster.

This leans on parts of numba-cuda that it does not document: `Lower._find_singly_assigned_variable`.
"""

from contextlib import contextmanager

from numba.cuda.core import analysis, ir
from numba.cuda.lowering import CUDALower

from .lowering import assigned_before_use


def _find(self):
    self._singly_assigned_vars = assigned_before_use(self.blocks, ir.assign_types, analysis)
    self._blk_local_varmap = {}


@contextmanager
def variables_as_values():
    """Compile like this inside. Numba-cuda's pipeline takes no pass of others."""
    CUDALower._find_singly_assigned_variable = _find
    try:
        yield
    finally:
        if "_find_singly_assigned_variable" in vars(CUDALower):
            del CUDALower._find_singly_assigned_variable
