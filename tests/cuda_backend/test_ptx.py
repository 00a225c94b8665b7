"""Kernels compile for CUDA, with arithmetic in float64 only where it is meant."""

import numpy as np
import pytest
from needs import compiler
from scenes import blob, everything, medium, noise, scene, volume

from vtkmcvr.cutting import Plane, Sphere
from vtkmcvr.gpu.bricks import bricked
from vtkmcvr.kernels.brdf import brdf_value_and_pdf, sample_brdf
from vtkmcvr.kernels.phase import phase_value, sample_phase
from vtkmcvr.kernels.rng import logarithm, start
from vtkmcvr.kernels.warp import concentric_disk, cosine_hemisphere
from vtkmcvr.layers import Layer
from vtkmcvr.lights import (
    ConstantEnvironment,
    CylinderLight,
    DiskLight,
    RectangleLight,
    SphereLight,
)
from vtkmcvr.plan import plan
from vtkmcvr.receivers import PlaneReceiver, SphereReceiver
from vtkmcvr.rendering import empty_film
from vtkmcvr.scene import Camera, Lens, Schlick, Surface, Volume

pytestmark = compiler
TURING, HOPPER = (7, 5), (9, 0)
# Glue is counted where it is merged into: `through` in direct.py, the loop over samples in cuda.py
MEANT = {
    "sample.py": "moments of the film",
    "camera.py": "rays until they enter the volume",
    "cuda.py": "the same, and the film",
    "vec.py": "the same",
    "grid.py": "where rays enter the volume",
    "cut.py": "where rays enter what clipping leaves",
    "event.py": "where rays enter, layers",
    "direct.py": "where shadow rays enter",
    "visibility.py": "the same",
    "merged": "no line of their own",
    "path.py": "where the next ray of a path enters",
    "scatter.py": "index position of a point on a receiver",
    "receivers.py": "rays relative to receivers",
    "bvh.py": "products of float32 that must be exact",
    "spherical_rectangle.py": "solid angle as a difference of angles",
}
# With a lens, where the ray enters is computed in both branches of the map to the disk, under its
# lines; the map alone has no doubles, see below
LENS = {"warp.py": "where rays enter"}
SKY = (ConstantEnvironment(0.5),)
SCENES = {
    "single, hybrid, all kinds of light": everything(vol=blob(5)),
    "multiple": everything(vol=blob(5), scattering="multiple"),
    "area lights near by, emission": scene(
        blob(5), medium(9.0), phase=Schlick(-0.5), surface=Surface(0.9, coat="ggx"),
        lights=(
            RectangleLight((0, -1.2, 0), (0, 0, 0), (1, 1), 9.0), SphereLight((0, -1, 2), 0.3, 9.0),
            DiskLight((2, -2, 2), (0, 0, 0), 1.0, 2.0),
            CylinderLight((2, 2, 2), (2, 2, 3), 0.2, 2.0),
        ),
    ),
    "lens, cuts, receivers, layers": scene(
        Volume((255 * blob(5).values).astype(np.uint8), blob(5).index_to_world), medium(0.01),
        lights=SKY, aovs=("albedo", "normal"), surface=Surface(0.9),
        camera=Camera((0, -5, 0), (0, 0, 0), view_angle=20, lens=Lens(0.1)),
        clip=(Plane((0, 0, 0), (1, 0, 0)), Sphere((0, 0, 0), 0.8)),
        receivers=(PlaneReceiver((0, 0, -1), (0, 0, 1)), SphereReceiver((0, 0, 2), 0.5)),
        layers=(Layer(noise(5), medium(1.0)),),
    ),
    "ray march": scene(blob(5), lights=SKY, estimator="ray-march"),
    "voxels in bricks": everything(vol=volume(np.pad(blob(5).values, 30), (0.03,) * 3)),
}  # fmt: skip


def parameter_types(name):
    from numba.cuda.typing.typeof import typeof

    planned = plan(SCENES[name])
    film, number = empty_film(planned), np.int64(1)
    there = bricked(planned.packed) if "bricks" in name else planned.packed
    parameters = film, there, number, number, film.count, number, number, number
    return tuple(map(typeof, parameters))


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_every_kernel_compiles_without_stray_doubles(name, monkeypatch, tmp_path):
    from ptx import assembled, doubles, pretend, ptx_of

    from vtkmcvr.kernels.cuda import render_rows

    types = parameter_types(name)
    for capability in (TURING, HOPPER):
        pretend(monkeypatch, capability)
        ptx = ptx_of(render_rows.py_func, types, capability)
        arch = "sm_{}{}".format(*capability)
        assert f".target {arch}" in ptx
        found = doubles(ptx)
        assert found["sample.py"] > 10
        assert set(found) <= set(MEANT) | set(LENS if "lens" in name else ()), found
        assert ("Bricks" in ptx) == ("bricks" in name)
        used = assembled(ptx, arch, tmp_path)
        print(f"{name}, {arch}: {found.total()} float64; {used} registers, bytes spilt")


@pytest.mark.slow
def test_kernel_of_a_launch_links_to_machine_code(monkeypatch):
    from numba.cuda import codegen
    from numba.cuda.dispatcher import _Kernel
    from ptx import pretend

    from vtkmcvr.kernels.cuda import compiling, render_rows

    pretend(monkeypatch, HOPPER)
    monkeypatch.setattr(codegen.CUDACodeLibrary, "_ensure_cc", lambda self, cc: cc or HOPPER)
    types = parameter_types("single, hybrid, all kinds of light")
    with compiling():
        kernel = _Kernel(render_rows.py_func, types, **render_rows.targetoptions)
    # An ELF file
    assert kernel._codelibrary.get_cubin(cc=HOPPER).code[:4] == b"\x7fELF"


def disk(x, y, phase, gloss):
    return concentric_disk(x, y)


def hemisphere(x, y, phase, gloss):
    return cosine_hemisphere(x, y)


def phase_sample(x, y, phase, gloss):
    return sample_phase(phase, (x, y, x), start(1, 2, 3))[0]


def phase_density(x, y, phase, gloss):
    return phase_value(phase, (x, y, x), (y, x, x)), x


def surface(x, y, phase, gloss):
    return brdf_value_and_pdf(gloss, (x, x, x), (x, y, x), (y, x, x), (y, x, y))[0]


def surface_sample(x, y, phase, gloss):
    return sample_brdf(gloss, (x, y, x), (y, x, x), start(1, 2, 3))[0]


def free_path(x, y, phase, gloss):
    return logarithm(x), y


LEAVES = (disk, hemisphere, phase_sample, phase_density, surface, surface_sample, free_path)


@pytest.mark.parametrize("leaf", LEAVES)
def test_leaves_alone_have_no_doubles(leaf, monkeypatch):
    from numba import njit
    from numba.cuda.typing.typeof import typeof
    from ptx import doubles, pretend, ptx_of

    pretend(monkeypatch, HOPPER)
    called = njit(leaf)

    def kernel(out, phase, gloss):
        result = called(out[0], out[1], phase, gloss)
        out[0], out[1] = result[0], result[1]

    packed = plan(SCENES["single, hybrid, all kinds of light"]).packed
    types = tuple(map(typeof, (np.zeros(2, np.float32), packed.phase, packed.gloss)))
    ptx = ptx_of(kernel, types, HOPPER)
    assert ".f32" in ptx
    assert not doubles(ptx)


def test_a_stray_double_would_be_noticed(monkeypatch):
    from numba import float32, njit
    from ptx import doubles, pretend, ptx_of

    pretend(monkeypatch, HOPPER)

    @njit
    def stray(x):
        return x * 0.1

    @njit
    def clean(x):
        return x * np.float32(0.1)

    def kernel_of(leaf):
        def kernel(out):
            out[0] = leaf(out[0])

        return kernel

    assert sum(doubles(ptx_of(kernel_of(stray), (float32[:],), HOPPER)).values()) > 0
    assert not doubles(ptx_of(kernel_of(clean), (float32[:],), HOPPER))


def test_variables_are_values_while_vtkmcvr_compiles(monkeypatch):
    from numba import float32
    from numba.cuda.lowering import CUDALower, Lower
    from ptx import pretend, ptx_of

    from vtkmcvr.kernels.cuda import compiling

    pretend(monkeypatch, HOPPER)
    allocated, alloca = [], Lower.alloca

    def noted(self, name, kind):
        allocated.append(name)
        return alloca(self, name, kind)

    monkeypatch.setattr(Lower, "alloca", noted)

    def kernel(out):
        pair = (out[0], out[1])
        if pair[0] < pair[1]:
            out[0] = pair[1]
        else:
            out[1] = pair[0]

    assert ptx_of(kernel, (float32[::1],), HOPPER)
    assert "pair" in allocated
    allocated.clear()
    with compiling():
        assert ptx_of(kernel, (float32[::1],), HOPPER)
    assert "pair" not in allocated
    # Other people's kernels are compiled as ever
    assert "_find_singly_assigned_variable" not in vars(CUDALower)
