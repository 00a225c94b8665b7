"""A volume in bricks, where a device has no room for it: the same picture, bit by bit."""

import logging
from dataclasses import replace

import numpy as np
import pytest
from fake_device import FakeDevice, poisoned
from needs import compiler, numba_cuda
from scenes import blob, everything, frontal, medium, volume
from simulated import SEED, check_same, films_of

from vtkmcvr import backends, packed
from vtkmcvr.curves import ColourCurve, Curve
from vtkmcvr.gpu import bricks, device, fitting
from vtkmcvr.gpu.errors import OutOfDeviceMemory
from vtkmcvr.kernels.grid import trilinear
from vtkmcvr.layers import Layer
from vtkmcvr.lights import ConstantEnvironment
from vtkmcvr.plan import plan
from vtkmcvr.rendering import render_scene
from vtkmcvr.scene import TransferFunction

SIZE = (16, 12)
SKY = ConstantEnvironment(0.5)
# Clear up to a half
STEEP = TransferFunction(
    None, ColourCurve([(0, 0.9, 0.9, 0.9)]), extinction=Curve([(0.5, 0), (0.9, 60)])
)


def speck(points=(100, 40, 66)):
    """Fractions, clear but for a ball that lies in four bricks of many."""
    random = np.random.default_rng(5)
    values = 0.4 * random.random(points)
    place = np.indices(points) - np.array((20, 33, 31)).reshape(3, 1, 1, 1)
    values += np.exp(-((place / 5.0) ** 2).sum(0))
    return volume(values, tuple(2.0 / max(points) for _ in range(3)))


def scene_of(vol, **options):
    return replace(everything(SKY, vol=vol, size=SIZE), transfer=STEEP, **options)


# Where the ball is
NEAR = frontal(0.15, centre=(-0.03, 0.27, -0.59))
SPECK = scene_of(speck(), camera=NEAR)


class Tight(FakeDevice):
    """A device with so many bytes; it renders from the voxels that it got."""

    def __init__(self, most):
        super().__init__()
        self.most, self.kinds = most, []

    def room_for(self, *parts):
        needed = sum(array.nbytes for array in device._arrays(parts[0].medium))
        if needed > self.most:
            raise OutOfDeviceMemory(f"scene and film take {needed} bytes: no room")

    def upload(self, part):
        if isinstance(part, packed.Scene):
            self.kinds.append(type(part.medium.values))
            if isinstance(part.medium.values, packed.Bricks):
                part = part._replace(medium=poisoned(part.medium))
        return super().upload(part)


@pytest.fixture
def use(monkeypatch):
    def with_device(fake):
        monkeypatch.setattr(backends, "missing", lambda: None)
        monkeypatch.setattr(device, "CudaDevice", lambda: fake)
        return fake

    return with_device


@pytest.mark.parametrize(
    "change", ["shadows and hybrid", pytest.param("gradient opacity", marks=pytest.mark.slow)]
)
def test_no_path_reads_what_is_left_out(use, change, caplog):
    described = SPECK
    if change == "gradient opacity":
        transfer = replace(STEEP, gradient_opacity=Curve([(0, 0.2), (3, 1)]))
        described = replace(SPECK, transfer=transfer)
    whole = plan(described).packed.medium.values.nbytes
    fake = use(Tight(0.7 * whole))
    with caplog.at_level(logging.INFO, "vtkmcvr"):
        picture = render_scene(described, samples=4, seed=SEED, backend="cuda")
    assert fake.kinds == [packed.Bricks] and "in bricks" in caplog.text
    expected = render_scene(described, samples=4, seed=SEED, backend="cpu")
    assert expected.film.hits.sum() > 100 and expected.film.mean.max() > 0.05
    for field in ("mean", "m2", "hits", "depth"):
        assert np.array_equal(getattr(picture.film, field), getattr(expected.film, field))


def test_voxels_left_out_that_are_read_would_be_noticed(use, monkeypatch):
    monkeypatch.setattr(bricks, "APRON", -6)
    use(Tight(0.7 * plan(SPECK).packed.medium.values.nbytes))
    picture = render_scene(SPECK, samples=4, seed=SEED, backend="cuda")
    expected = render_scene(SPECK, samples=4, seed=SEED, backend="cpu")
    assert not np.array_equal(picture.film.mean, expected.film.mean)


def needed_by(described):
    return bricks.needed_bricks(plan(described).packed.medium)


def test_needed_bricks_are_those_around_the_cells_with_extinction():
    planned = plan(SPECK).packed.medium
    edge, size = int(packed.BRICK), int(planned.cell_size)
    wanted = np.zeros(needed_by(SPECK).shape, bool)
    for cell in np.argwhere(planned.majorant > 0):
        voxels = [range(c * size - 2, (c + 1) * size + 3) for c in cell]
        inside = [
            sorted({n // edge for n in line if 0 <= n < points})
            for line, points in zip(voxels, planned.values.shape, strict=True)
        ]
        wanted[np.ix_(*inside)] = True
    assert np.array_equal(needed_by(SPECK), wanted)
    assert 0 < wanted.sum() < wanted.size


def test_bricks_hold_the_voxels_of_the_volume():
    planned = plan(SPECK).packed.medium
    found = bricks.in_bricks(planned).values
    assert found.voxels.dtype == planned.values.dtype
    assert found.shape == planned.values.shape
    needed = np.argwhere(needed_by(SPECK).repeat(32, 0).repeat(32, 1).repeat(32, 2))
    for place in needed[::997]:
        if (place < planned.values.shape).all():
            k, j, i = map(np.uintp, place)
            assert found[k, j, i] == planned.values[k, j, i]


def test_where_all_is_full_or_looked_up_volumes_stay_whole():
    full = plan(replace(SPECK, transfer=medium(2.0))).packed
    assert bricks.bricked(full) is full
    marched = plan(replace(SPECK, estimator="ray-march")).packed
    assert bricks.bricked(marched) is marched
    assert bricks.bricked(marched.medium) is marched.medium
    other = Layer(speck((40, 40, 40)), STEEP)
    two = bricks.bricked(plan(replace(SPECK, layers=(other,))).packed)
    assert isinstance(two.medium.values, packed.Bricks)
    small = bricks.bricked(plan(scene_of(blob(9))).packed)
    assert isinstance(small.medium.values, np.ndarray)


def test_smaller_types_come_first_and_then_it_is_an_error(use, caplog):
    rounded = replace(
        SPECK, volume=replace(SPECK.volume, values=np.round(20 * SPECK.volume.values)),
        transfer=replace(STEEP, extinction=Curve([(10, 0), (18, 60)])),
    )  # fmt: skip
    whole = plan(rounded).packed.medium.values.size
    fake = use(Tight(1.5 * whole))
    render_scene(rounded, samples=1, backend="cuda")
    assert fake.kinds == [np.ndarray]
    use(Tight(100))
    with (
        caplog.at_level(logging.INFO, "vtkmcvr"),
        pytest.raises(OutOfDeviceMemory, match="no room"),
    ):
        render_scene(rounded, samples=1, backend="cuda")
    assert caplog.text.index("smaller type") < caplog.text.rindex("in bricks")
    assert len(fitting.STEPS) == 2


@numba_cuda
def test_simulated_picture_from_bricks_is_that_of_the_whole_volume(tmp_path):
    counts = np.ones((5, 6), np.int64)
    described = replace(SPECK, size=(6, 5))
    [(cpu, whole)] = films_of({"one": described}, counts, tmp_path).values()
    [(_, found)] = films_of({"one": described}, counts, tmp_path, there=bricks.bricked).values()
    assert cpu.hits.sum() > 3
    for field in ("mean", "m2", "hits", "depth"):
        assert np.array_equal(getattr(found, field), getattr(whole, field))
    check_same(cpu, found)


@compiler
@pytest.mark.parametrize("capability", [(7, 5), (9, 0)])
def test_interpolation_in_bricks_compiles_without_doubles(capability, monkeypatch):
    from numba.cuda.typing.typeof import typeof
    from ptx import doubles, pretend, ptx_of

    from vtkmcvr.kernels import cuda  # noqa: F401  (has bricks read)

    pretend(monkeypatch, capability)

    def look_up(out, values):
        out[0] = trilinear(values, (out[0], out[1], out[2]))

    small = plan(SPECK).packed
    types = tuple(map(typeof, (np.zeros(3, np.float32), bricks.bricked(small).medium.values)))
    ptx = ptx_of(look_up, types, capability)
    assert ptx.count("ld.global") > 16 and not doubles(ptx)
