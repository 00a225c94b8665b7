"""Kernels in lanes, on arrays that lie against pages which nobody may touch.

    python tests/kernels/guard_pages.py pictures walks:int16 positions:uint8 ...

A kernel that reads or writes beside an array ends this program by a signal. Memory that a kernel
has to write before it reads is full of NaN, or -1.
"""

import ctypes
import itertools
import mmap
import sys
import threading
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from scenes import everything
from test_packets import RATIO, N, at_once, planned, rays_through, voxels

from vtkmcvr import tiles
from vtkmcvr.kernels.grid import trilinear
from vtkmcvr.kernels.jit import entry_point
from vtkmcvr.kernels.lanes import WIDTH
from vtkmcvr.kernels.lanes_memory import load, store
from vtkmcvr.kernels.packets import trilinear as trilinear_of_lanes
from vtkmcvr.kernels.pool import new_pool, new_queue
from vtkmcvr.kernels.room import new_room
from vtkmcvr.lights import ConstantEnvironment
from vtkmcvr.plan import plan
from vtkmcvr.rendering import empty_film
from vtkmcvr.scene import Surface

# More than a stride of a small grid
GUARD = 2**20
# Less than any thread gets by default
STACK = 2**18

libc = ctypes.CDLL(None, use_errno=True)
libc.mmap.restype = ctypes.c_void_p
libc.mmap.argtypes = [ctypes.c_void_p, ctypes.c_size_t, *3 * [ctypes.c_int], ctypes.c_long]
libc.mprotect.argtypes = [ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int]


def guarded(array, at_end, garbage=False):
    """Copy of an array, of which the end or else the start lies against an inaccessible page."""
    size = -(-max(array.nbytes, 1) // mmap.PAGESIZE) * mmap.PAGESIZE
    base = libc.mmap(None, size + 2 * GUARD, 0, mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS, -1, 0)
    if libc.mprotect(base + GUARD, size, mmap.PROT_READ | mmap.PROT_WRITE):
        raise OSError(ctypes.get_errno(), "mprotect")
    ctypes.memset(base + GUARD, 0xFF, size)
    start = base + GUARD + (size - array.nbytes if at_end else 0)
    bytes_there = (ctypes.c_char * array.nbytes).from_address(start)
    copy = np.frombuffer(bytes_there, array.dtype).reshape(array.shape)
    if not garbage:
        copy[...] = array
    return copy


def all_guarded(part, at_end, garbage=False):
    """Packed tuple with copies of all its arrays."""
    if isinstance(part, np.ndarray):
        return guarded(part, at_end, garbage)
    if hasattr(part, "_asdict"):
        return type(part)(*(all_guarded(x, at_end, garbage) for x in part))
    return part


@entry_point
def at_positions(values, points, out):
    """Scalars at positions (3, n), n a multiple of WIDTH, in lanes and one by one."""
    n = points.shape[1]
    for i in range(0, n, WIDTH):
        p = (load(points, i), load(points, n + i), load(points, 2 * n + i))
        store(out, i, trilinear_of_lanes(values, p))
    for i in range(n):
        out[1, i] = trilinear(values, (points[0, i], points[1, i], points[2, i]))


def positions(kind):
    """Look up scalars everywhere, beyond the ends and at no number."""
    values = voxels(kind)
    edges = [
        (np.nan, -np.inf, np.inf, -1e30, 1e30, -1.0, -0.0, 0.4, n - 1.5, n - 1, n, 2.0**31)
        for n in values.shape[::-1]
    ]
    points = np.array(list(itertools.product(*edges)), np.float32).T
    points = np.pad(points, ((0, 0), (0, -points.shape[1] % WIDTH)))
    for at_end in (True, False):
        found = guarded(np.zeros((2, points.shape[1]), np.float32), at_end)
        at_positions(guarded(values, at_end), guarded(points, at_end), found)
        assert np.isfinite(found).mean() > 0.9
        np.testing.assert_allclose(found[0], found[1], rtol=1e-5)


def walks(kind):
    """Walk rays, as many as fill all lanes and a few; again with what the first walk has left."""
    packed = planned(kind).packed
    rays = rays_through(packed.medium.values)
    for at_end, n in itertools.product((True, False), (N, 5)):
        expected, found = np.zeros((2, n, 4), np.float32)
        columns = -(-n // WIDTH) * WIDTH
        some = [packed.medium, packed.transfer, RATIO, rays[:n].copy()]
        at_once(*some, new_queue(columns), new_pool(), expected)
        room = [all_guarded(x, at_end, garbage=True) for x in (new_queue(columns), new_pool())]
        some = [all_guarded(x, at_end) for x in some]
        for _ in range(2):
            out = guarded(found, at_end)
            at_once(*some, *room, out)
            np.testing.assert_array_equal(out, expected)


def pictures():
    """Render by single and by multiple scattering."""
    some = everything(ConstantEnvironment(1.0), surface=Surface(gradient_factor=1.0))
    for scattering in ("single", "multiple"):
        picture(plan(replace(some, scattering=scattering)))


def picture(made):
    """Render in a thread of little stack; again in the room that the first picture has left."""
    assert tiles.goes_in_step(made.packed)
    expected = empty_film(made)
    height, width = expected.count.shape
    goal = np.full_like(expected.count, 3)
    rest = (0, height, 0, width, goal, np.int64(7))
    tiles.render_tile(expected, made.packed, *rest)
    failures = []

    def render(at_end):
        try:
            room = all_guarded(new_room(), at_end, garbage=True)
            tiles._free[:] = [room]
            scene = all_guarded(made.packed, at_end)
            for _ in range(2):
                film = all_guarded(empty_film(made), at_end)
                tiles.render_tile(film, scene, *rest)
                np.testing.assert_array_equal(film.mean, expected.mean)
        except BaseException as failure:
            failures.append(failure)

    threading.stack_size(STACK)
    for at_end in (True, False):
        thread = threading.Thread(target=render, args=(at_end,))
        thread.start()
        thread.join()
    if failures:
        raise failures[0]


if __name__ == "__main__":
    for word in sys.argv[1:]:
        what, *kind = word.split(":")
        {"pictures": pictures, "walks": walks, "positions": positions}[what](*kind)
        print(f"{word}: nothing beside the arrays", flush=True)
