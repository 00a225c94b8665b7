"""Scenes as JSON and back, to the bit; nothing that a file names is trusted."""

import json
import math

import numpy as np
import pytest
from scenes import blob, everything, noise, scene

from vtkmcvr import lights
from vtkmcvr.camera import Camera, Lens, PixelFilter
from vtkmcvr.curves import ColourCurve, Curve
from vtkmcvr.material import Surface, TransferFunction, TransferTable
from vtkmcvr.phases import Cone, HenyeyGreenstein, Isotropic, Rayleigh, Schlick
from vtkmcvr.recipes.content_hash import content_hash
from vtkmcvr.recipes.deserialise import MissingArray, from_plain
from vtkmcvr.recipes.serialise import NotSerialisable, to_plain

SKY = lights.EnvironmentMap(np.random.default_rng(1).random((3, 5, 3)), 0.7)


def again(value, *arrays):
    text = json.dumps(to_plain(value), allow_nan=False)
    return from_plain(json.loads(text), {content_hash(a): a for a in arrays})


def assert_equal(a, b):
    """Equal fields, also of classes that compare by identity."""
    assert type(a) is type(b)
    if isinstance(a, np.ndarray):
        assert a.dtype == b.dtype
        np.testing.assert_array_equal(a, b)
    elif hasattr(a, "__dataclass_fields__"):
        for name in a.__dataclass_fields__:
            assert_equal(getattr(a, name), getattr(b, name))
    elif isinstance(a, dict):
        assert_equal(tuple(a.items()), tuple(b.items()))
    elif isinstance(a, tuple):
        assert len(a) == len(b)
        for one, other in zip(a, b, strict=True):
            assert_equal(one, other)
    else:
        assert a == b or (a != a and b != b)


SMALL = [
    lights.ConstantEnvironment((0.1, 0.2, 1 / 3)),
    lights.RectangleLight((1, 2, 3), (0, 0.1, 0), (2, 3), 5.0, (0.1, 0.2, 0.3), True, True),
    lights.PointLight((1, 2, 3), 4.0, (1, 0, 1), (0.1, 0.2, -1), 30.0, 2.0),
    Camera((1, 2, 3), (0, 0, 0), (0.1, 0.2, 1), 33.3, 4.5, (0.1, -0.2), Lens(0.5, 7.0)),
    Surface(0.3, specular=(0.1, 0.2, 0.3), exponent=12.0),
    TransferFunction(
        None, ColourCurve([(1, 0.1, 0.2, 0.3), (0, 1, 1, 1, 0.3, 0.7)], clamp=False), 2.0,
        Curve([(0, 0), (0, 5.0), (3, 1)]), 0.5,
    ),
    PixelFilter("tent", 1.5),
]  # fmt: skip


@pytest.mark.parametrize("value", SMALL, ids=lambda value: type(value).__name__)
def test_round_trip(value):
    assert_equal(again(value), value)


def test_whole_scenes_round_trip():
    for one in (
        everything(SKY, vol=noise()),
        scene(blob(dtype=np.float64), shadow_reach=math.inf, aovs=("normal",)),
    ):
        pixels = [light.pixels for light in one.lights if isinstance(light, lights.EnvironmentMap)]
        assert_equal(again(one, one.volume.values, *pixels), one)


def test_mappings_keep_their_keys():
    one = {3: SMALL[0], 7: None, "name": (1.5, math.inf)}
    assert_equal(again(one), one)


def test_a_transfer_function_is_written_whatever_its_size():
    table = TransferTable(np.random.default_rng(1).random((40, 50, 4)), (0.0, 1.0), (0.0, 2.0))
    assert_equal(again(table), table)


def test_every_phase_function_round_trips():
    for phase in (Isotropic(), HenyeyGreenstein(0.3), Schlick(-0.4), Rayleigh(), Cone(30.0)):
        assert_equal(again(scene(phase=phase), blob().values).phase, phase)


def test_unit_vectors_keep_their_bits():
    # Normalising what is normalised moves the last bit of about one in four
    rng = np.random.default_rng(1)
    for direction in rng.normal(size=(500, 3)):
        light = lights.DirectionalLight(direction)
        assert again(light).direction == light.direction


def test_voxels_and_pixels_are_never_written():
    text = json.dumps(to_plain(everything(SKY, vol=noise(2))))
    assert text.count('"outside array"') == 2
    with pytest.raises(MissingArray, match=r"scene\.volume\.values: array of 2 x 2 x 2 <f4, hash"):
        from_plain(json.loads(text), {})


def test_hash_is_of_values_shape_and_type_alone():
    values = np.arange(24, dtype=np.int16).reshape(2, 3, 4)
    same = [values.copy(), values.astype(">i2"), np.asfortranarray(values)]
    assert {content_hash(array) for array in same} == {content_hash(values)}
    assert content_hash(np.broadcast_to(values[:, :, :1], (2, 3, 4))) != content_hash(values)
    other = [values.astype(np.int32), values.reshape(4, 3, 2), values + 1, -values]
    assert len({content_hash(array) for array in (values, *other)}) == 5


def test_a_hash_is_forgotten_with_its_array():
    hashes = set()
    for i in range(50):
        hashes.add(content_hash(np.full((4, 4, 4), i)))
    assert len(hashes) == 50


def test_functions_have_no_plain_form():
    with pytest.raises(NotSerialisable, match=r"^scene\[1\] is a function, which a recipe"):
        to_plain([1, test_round_trip])


GOOD = to_plain(Camera((1, 2, 3), (0, 0, 0)))
HOSTILE = {
    "unknown type": ({"type": "lights.LaserLight"}, "unknown type 'lights.LaserLight'"),
    "other module": ({"type": "os.Popen"}, "unknown type"),
    "the command": ({"type": "__main__.X"}, "unknown type"),
    "private": ({"type": "phantom.shapes._Hidden"}, "unknown type"),
    "a function": ({"type": "checks.number"}, "unknown type"),
    "no dataclass": ({"type": "rendering.Any"}, "unknown type"),
    "imported, not defined there": ({**GOOD, "type": "scene.Camera"}, "unknown type"),
    "no type": ({"a": 1}, "unknown type None"),
    "type is a list": ({"type": ["Camera"]}, "unknown type"),
    "unknown field": ({**GOOD, "shutter": 1}, "the field 'shutter', which camera.Camera"),
    "missing field": ({"type": "camera.Camera"}, "is no camera.Camera: "),
    "bad value": ({**GOOD, "view_angle": -3}, "view_angle must be above 0"),
    "wrong kind": ({**GOOD, "position": "here"}, "camera.position must be three numbers"),
    "float": ({"type": "float", "value": "1e999"}, "is no number"),
    "array type": ({"type": "array", "shape": [1], "dtype": "O", "zlib": ""}, "is no array"),
    "array shape": ({"type": "array", "shape": [-1], "dtype": "<f8", "zlib": ""}, "is no array"),
    "array length": (
        {"type": "array", "shape": [9], "dtype": "<f8", "zlib": "eJwDAAAAAAE="}, "array of shape"
    ),
    "no zlib": (
        {"type": "array", "shape": [1], "dtype": "|u1", "zlib": "AAAA"}, "is no array of shape"
    ),
    "mapping": ({"type": "mapping", "items": [1, 2]}, "is no mapping"),
    "mapping without items": ({"type": "mapping"}, "is no mapping"),
    "base64": ({"type": "array", "shape": [1], "dtype": "|u1", "zlib": "$"}, "is no array"),
    "hash": ({"type": "outside array", "shape": [1], "dtype": "|u1"}, "no content hash"),
    "deep": (json.loads("[" * 100 + "]" * 100), "nested too deep"),
}  # fmt: skip


@pytest.mark.parametrize("case", HOSTILE)
def test_hostile_forms_are_one_sentence(case):
    form, message = HOSTILE[case]
    with pytest.raises(ValueError) as caught:
        from_plain(form, {})
    assert message in str(caught.value)


def test_a_field_that_came_later_takes_its_default():
    form = {name: value for name, value in GOOD.items() if name != "window_centre"}
    assert from_plain(form, {}) == Camera((1, 2, 3), (0, 0, 0))
