"""Launching without a device: what is handed over is what the compiled kernel takes."""

import ctypes
import re
from types import SimpleNamespace

import numpy as np
import pytest
import sweeps
from needs import compiler
from scenes import blob, everything, scene, volume

from vtkmcvr.gpu.bricks import bricked
from vtkmcvr.gpu.device import _rebuilt
from vtkmcvr.lights import ConstantEnvironment
from vtkmcvr.plan import plan
from vtkmcvr.rendering import empty_film
from vtkmcvr.screen import Display, packed_screen

pytestmark = compiler
SIZES = {"u64": 8, "f64": 8, "u32": 4, "f32": 4, "u16": 2, "u8": 1, "b8": 1}
PARAMETER = re.compile(r"\.param \.(\w+) ")
SCENES = {
    "everything": everything(vol=blob(5), size=(8, 6)),
    "albedo and normal": scene(
        blob(5), lights=(ConstantEnvironment(0.5),), aovs=("albedo", "normal"), size=(8, 6)
    ),
    "in bricks": everything(vol=volume(np.pad(blob(5).values, 30), (0.03,) * 3), size=(8, 6)),
}


def on_device(part):
    """Stands for a packed tuple on the device: arrays with an address and no memory."""
    from numba.cuda.args import ArgHint

    class OnDevice(ArgHint):
        def to_device(self, retr, stream=0):
            array = self.value
            layout = SimpleNamespace(
                strides_in_bytes=array.strides, is_contiguous_c=True, is_contiguous_f=False
            )
            return SimpleNamespace(
                size=array.size, dtype=array.dtype, ptr=4096, shape=array.shape, _layout=layout
            )

    if isinstance(part, np.ndarray):
        return OnDevice(part)
    return _rebuilt(part, on_device) if isinstance(part, tuple) else part


def size_of(argument):
    """Bytes that the driver takes from an argument."""
    if isinstance(argument, (bool, np.bool_)):
        return 1
    return 8 if isinstance(argument, int) else ctypes.sizeof(argument)


def handed_over(types, arguments, extensions):
    """Arguments as numba-cuda flattens them for a launch."""
    from numba.cuda.dispatcher import _Kernel

    kernel = _Kernel.__new__(_Kernel)
    kernel.extensions = extensions
    flat = []
    for ty, argument in zip(types, arguments, strict=True):
        kernel._prepare_args(ty, argument, 0, [], flat)
    return flat


@pytest.mark.parametrize("name", SCENES)
def test_every_parameter_gets_an_argument_of_its_size(name, monkeypatch):
    from numba.cuda.typing.typeof import typeof
    from ptx import pretend, ptx_of

    from vtkmcvr.kernels.cuda import render_rows

    pretend(monkeypatch, (9, 0))
    planned = plan(SCENES[name])
    film, number = empty_film(planned), np.int64(1)
    there = bricked(planned.packed) if "bricks" in name else planned.packed
    on_host = film, there, number, number, film.count, number, number, number
    arguments = on_device(on_host)
    types = tuple(map(typeof, arguments))
    assert types == tuple(map(typeof, on_host))

    def same_parameters(film, scene, row_0, row_1, goal, cap, seed, every):
        film.count[row_0, row_1] = goal[row_0, row_1] + cap + seed + every

    wanted = [SIZES[kind] for kind in PARAMETER.findall(ptx_of(same_parameters, types, (9, 0)))]
    flat = handed_over(types, arguments, render_rows.extensions)
    assert list(map(size_of, flat)) == wanted
    # What CUDA takes since 12.1, from compute capability 7.0 on; 4096 before
    assert sum(wanted) < 4096


@pytest.mark.parametrize(
    "display", [Display(), Display(background=(1, 1, 1), film_filter="gaussian-5x5")]
)
def test_every_parameter_of_what_is_shown_gets_an_argument_of_its_size(display, monkeypatch):
    from numba.cuda.typing.typeof import typeof
    from ptx import pretend, ptx_of

    from vtkmcvr.kernels.film_cuda import show_pixels

    pretend(monkeypatch, (9, 0))
    film = empty_film(plan(SCENES["everything"]))
    arguments = on_device((film, packed_screen(display), np.zeros((6, 8, 4), np.uint8)))
    types = tuple(map(typeof, arguments))

    def same_parameters(film, screen, pixels):
        pixels[0, 0, 0] = film.count[0, 0]

    ptx = ptx_of(same_parameters, types, (9, 0))
    wanted = [SIZES[kind] for kind in PARAMETER.findall(ptx)]
    assert list(map(size_of, handed_over(types, arguments, show_pixels.extensions))) == wanted


def test_numba_cuda_still_needs_help_with_absent_effects():
    from numba.cuda import types

    with pytest.raises(NotImplementedError):
        handed_over([types.none], [None], [])


def test_arguments_are_what_a_launch_packs():
    handler = pytest.importorskip("cuda.core._kernel_arg_handler")
    from numba.cuda.typing.typeof import typeof

    from vtkmcvr.kernels.cuda import render_rows

    arguments = on_device((plan(SCENES["everything"]).packed,))
    flat = handed_over(tuple(map(typeof, arguments)), arguments, render_rows.extensions)
    assert handler.ParamHolder(flat).ptr


@pytest.mark.parametrize("name", ["default", "fast", "paper", "two volumes"])
def test_every_parameter_of_a_sweep_gets_an_argument_of_its_size(name, monkeypatch):
    from numba.cuda.typing.typeof import typeof
    from ptx import pretend, ptx_of

    from vtkmcvr.kernels.cone_cuda import sweep_layers

    pretend(monkeypatch, (9, 0))
    arguments = on_device(sweeps.dense_tables(*{**sweeps.MODES, **sweeps.MORE}[name]))
    arguments = (*arguments, np.int64(0), np.int64(1))
    types = tuple(map(typeof, arguments))

    def same_parameters(volumes, sweep, sheets, eye, shade, film, light, work, first, last):
        work[0] = first + last

    ptx = ptx_of(same_parameters, types, (9, 0))
    wanted = [SIZES[kind] for kind in PARAMETER.findall(ptx)]
    assert list(map(size_of, handed_over(types, arguments, sweep_layers.extensions))) == wanted
    # What CUDA takes since 12.1, from compute capability 7.0 on
    assert sum(wanted) < 32764


def test_arrays_of_one_value_are_made_by_a_kernel_for_each_type(monkeypatch):
    from numba.cuda.typing.typeof import typeof
    from ptx import pretend, ptx_of

    from vtkmcvr.kernels.cone_cuda import set_all

    pretend(monkeypatch, (9, 0))
    for kind in (np.float32, np.uint8, np.int32):
        types = tuple(map(typeof, (np.zeros(3, kind), kind(1))))
        assert ".entry" in ptx_of(set_all.py_func, types, (9, 0))
