"""Calls of kernels that take a film and a scene: hundreds of numbers, as a block of words.

A word has 64 bits, and holds a number or an address. In which order they follow is that of Numba's
calling convention: fields of tuples one after the other; of an array what its structure has.
"""

import ctypes
from collections.abc import Iterator
from typing import Any

import numpy as np
from numba import typeof, types
from numba.core.registry import CPUDispatcher
from numpy.typing import NDArray

# What an array begins with: its memory's owner and parent, which kernels know nothing of
UNOWNED = (0, 0)
# Type and words of values by their identity; with the values, so that none takes another's identity
Known = dict[int, tuple[types.Type, NDArray[np.int64], Any]]
way_in = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p)


def words_of(value: Any) -> NDArray[np.int64]:
    """Words of an argument, (n,): of arrays, tuples of such, numbers and None.

    Arrays go by address: the caller keeps them as long as the words. Raises TypeError for others.
    """
    return np.array(list(_words(value, typeof(value))), np.int64)


def _words(value: Any, kind: types.Type) -> Iterator[int]:
    if isinstance(kind, types.Array):
        yield from UNOWNED
        yield from (value.size, value.itemsize, value.ctypes.data, *value.shape, *value.strides)
    elif isinstance(kind, types.BaseTuple):
        for part, part_kind in zip(value, kind, strict=True):
            yield from _words(part, part_kind)
    elif isinstance(kind, types.NoneType):
        yield 0
    elif isinstance(kind, (types.Number, types.Boolean)):
        bits = np.array(value, str(kind)).tobytes()
        yield int.from_bytes(bits.ljust(8, b"\0"), "little", signed=True)
    else:
        raise TypeError(f"kernels take arrays, tuples, numbers and None, not {kind}")


def taken_apart(value: Any, known: Known) -> tuple[types.Type, NDArray[np.int64]]:
    """Type and words of an argument, from those parts that are `known` and others, which will be.

    Numba takes its time to tell the type of a tuple of hundreds of values.
    """
    if id(value) not in known:
        if hasattr(value, "_fields"):
            parts = [taken_apart(part, known) for part in value]
            kind = types.BaseTuple.from_types([kind for kind, _ in parts], type(value))
            words = np.concatenate([words for _, words in parts])
        else:
            kind, words = typeof(value), words_of(value)
        known[id(value)] = kind, words, value
    return known[id(value)][:2]


class Launched(CPUDispatcher):
    """A kernel that takes its arguments as words, compiled by `compilers.LaunchedCompiler`."""

    # By the identities of types, which are kept along
    _addresses: dict[tuple[int, ...], tuple[int, tuple[types.Type, ...]]]

    @classmethod
    def of(cls, dispatcher: CPUDispatcher) -> CPUDispatcher:
        """Make one of Numba's dispatcher; where nothing is compiled, a function stays one."""
        if hasattr(dispatcher, "py_func"):
            dispatcher.__class__ = cls
            dispatcher._addresses = {}
        return dispatcher

    def __call__(self, *arguments: Any) -> None:
        """Run for these arguments, compiled for their types."""
        self.launch(self.address(*arguments), *map(words_of, arguments))

    def address(self, *arguments: Any) -> int:
        """Machine code for arguments of these types, compiled where there is none yet."""
        return self.address_for(tuple(map(typeof, arguments)))

    def address_for(self, kinds: tuple[types.Type, ...]) -> int:
        """Machine code for arguments of some types, compiled where there is none yet."""
        # Types are one object each as long as anybody has them; to compare them takes its time
        key = tuple(map(id, kinds))
        if key not in self._addresses:
            self.compile(kinds)
            compiled = self.overloads[kinds]
            name = compiled.fndesc.llvm_cpython_wrapper_name
            self._addresses[key] = compiled.library.get_pointer_to_function(name), kinds
        return self._addresses[key][0]

    @staticmethod
    def launch(address: int, *words: NDArray[np.int64]) -> None:
        """Run machine code for the words of its arguments, without the GIL.

        The caller keeps the arguments until it returns.
        """
        block = np.concatenate(words)
        status = way_in(address)(block.ctypes.data)
        if status != 0:
            raise RuntimeError(f"a kernel ended with status {status}; this is a fault of vtkmcvr")
