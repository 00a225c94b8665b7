"""Cuts, labels, receivers and layers as the user describes them."""

import json

import numpy as np
import pytest
from scenes import blob, medium, scene

from vtkmcvr.curves import Curve
from vtkmcvr.cutting import ALL_REGIONS, Box, Cropping, Plane, Sphere
from vtkmcvr.labels import Labels
from vtkmcvr.layers import Layer
from vtkmcvr.lights import EnvironmentMap, PointLight
from vtkmcvr.phases import HenyeyGreenstein
from vtkmcvr.plan import plan
from vtkmcvr.receivers import BoxReceiver, MeshReceiver, PlaneReceiver, SphereReceiver
from vtkmcvr.recipes.content_hash import content_hash
from vtkmcvr.recipes.deserialise import from_plain
from vtkmcvr.recipes.serialise import to_plain
from vtkmcvr.scene import Surface, TransferFunction

SHAPE = (17, 17, 17)
RISING = Curve([(0, 0.0), (1, 0.5)])
TRIANGLE = np.eye(3), np.array([[0, 1, 2]])


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Plane((0, 0, 0), (0, 0, 0)), r"plane\.normal must not be \(0, 0, 0\)"),
        (lambda: Sphere((0, 0, 0), 0), r"sphere\.radius must be above 0, got 0"),
        (lambda: Sphere((0, 0, 0), 1, keep="both"), "keep is inside or outside, got 'both'"),
        (lambda: Box((0, 0, 0), (1, -1, 1)), r"box\.size must be above 0, got -1"),
        (lambda: Box((0, 0, 0), (1, 1, 1), np.ones((3, 3))), r"box\.axes .* orthonormal"),
        (lambda: Box.from_bounds((0, 1, 2)), r"bounds are \(x0, x1, y0, y1, z0, z1\)"),
        (lambda: Cropping((3, 0, 0), (2, 9, 9)), r"cropping\.lower must not be above upper"),
        (lambda: Cropping((0, 0, 0), (2, 9, 9), ALL_REGIONS + 1), "27 bits, got 0x8000000"),
        (lambda: Labels(np.zeros((2, 2)), {}), r"labels has one value per voxel.*\(2, 2\)"),
        (lambda: Labels(np.full(SHAPE, 0.5), {}), "whole numbers, got float64 with fractions"),
        (lambda: Labels(np.zeros(SHAPE), {1.5: None}), r"a label is a whole number, got 1\.5"),
        (lambda: PlaneReceiver((0, 0, 0), (0, 0, 1), colour=1.5), "colour goes from 0 to 1"),
        (lambda: PlaneReceiver((0, 0, 0), (0, 0, 1), (1, 0)), "plane height must be above 0"),
        (lambda: SphereReceiver((0, 0, 0), -1), "radius must be above 0"),
        (lambda: BoxReceiver((0, 0, 0), (0, 1, 1)), "size must be above 0"),
        (lambda: MeshReceiver(TRIANGLE[0], np.array([[0, 1, 3]])), "index 3 points, got 0 to 3"),
        (lambda: MeshReceiver(TRIANGLE[0], np.eye(3)), "indices, got type float64"),
        (lambda: MeshReceiver(np.full((3, 3), np.nan), TRIANGLE[1]), "points must be finite"),
        (lambda: MeshReceiver(*TRIANGLE, np.ones((2, 3))), "3 points and 2 normals"),
    ],
)
def test_bad_parts_say_what_is_allowed(make, message):
    with pytest.raises(ValueError, match=message):
        make()


@pytest.mark.parametrize(
    ("parts", "error", "message"),
    [
        ({"clip": (3,)}, TypeError, "clip takes Plane, Sphere and Box, got int"),
        ({"crop": "half"}, TypeError, "crop takes a Cropping, got str"),
        ({"labels": np.zeros(SHAPE)}, TypeError, "labels takes Labels, got ndarray"),
        ({"mask": np.zeros((2, 3, 4))}, ValueError, "17 x 17 x 17 points, got 4 x 3 x 2"),
        ({"labels": Labels(np.zeros((2, 3, 4)), {})}, ValueError, "labels must have the volume's"),
        ({"receivers": ("floor",)}, TypeError, r"receivers are PlaneReceiver.*got str"),
        ({"layers": (blob(),)}, TypeError, "layers takes Layer objects, got Volume"),
    ],
)
def test_parts_that_do_not_fit_the_scene_are_named(parts, error, message):
    with pytest.raises(error, match=message):
        scene(blob(17), **parts)


def test_labels_refuse_transfer_functions_of_the_gradient():
    by_gradient = TransferFunction(RISING, medium(1.0).colour, gradient_opacity=RISING)
    labels = Labels(np.ones(SHAPE, int), {1: by_gradient})
    with pytest.raises(ValueError, match="transfer functions of the scalar alone"):
        plan(scene(blob(17), labels=labels))


def test_one_part_stands_for_a_sequence_of_one():
    made = scene(
        blob(17), clip=Plane((0, 0, 0), (0, 0, 1)), receivers=SphereReceiver((0, 0, 9), 1),
        layers=Layer(blob(9), medium(1.0)),
    )  # fmt: skip
    assert (len(made.clip), len(made.receivers), len(made.layers)) == (1, 1, 1)


def test_phase_function_of_each_volume_is_its_own():
    forward = TransferFunction(
        None, medium(1.0).colour, extinction=medium(1.0).extinction, g=RISING
    )
    lit, other = (PointLight((0, 0, 9), 1.0),), Layer(blob(9), forward)
    planned = plan(
        scene(blob(9), medium(1.0), phase=HenyeyGreenstein(0.2), layers=other, lights=lit)
    )
    first, other = planned.packed.transfer, planned.packed.more[0].transfer
    assert (first.phase == np.float32(0.2)).all()
    assert other.phase.max() == pytest.approx(0.5)
    assert planned.packed.phase is not None


def test_a_coat_anywhere_leaves_the_others_without_one():
    glossy = PlaneReceiver((0, 0, -2), (0, 0, 1), specular=0.2)
    lit = (PointLight((0, 0, 9), 1.0),)
    dull = Surface(specular=0.0)
    planned = plan(scene(blob(9), surface=dull, receivers=glossy, lights=lit)).packed
    assert planned.gloss.specular == (0, 0, 0)
    assert plan(scene(blob(9), surface=Surface(specular=0.0))).packed.gloss is None


def test_recipe_holds_all_parts():
    vol = blob(9)
    mesh = MeshReceiver(*TRIANGLE, np.ones((3, 3)), colour=0.3)
    made = scene(
        vol, clip=(Plane((0, 0, 0), (0, 1, 2)), Sphere((0, 0, 0), 1, "outside"),
                   Box((0, 0, 0), (1, 2, 3))),
        crop=Cropping((1, 1, 1), (5, 5, 5), 0x123), mask=vol.values > 0.2,
        labels=Labels((vol.values * 3).astype(int), {1: None, 2: medium(3.0)}),
        receivers=(PlaneReceiver((0, 0, -1), (0, 0, 1)), BoxReceiver((0, 0, 0), (1, 1, 1)), mesh),
        layers=Layer(vol, medium(2.0)),
    )  # fmt: skip
    plain = json.loads(json.dumps(to_plain(made)))
    arrays = {content_hash(a): a for a in (vol.values, made.mask, made.labels.values)}
    again = from_plain(plain, arrays)
    assert again.clip[:2] == made.clip[:2]
    np.testing.assert_array_equal(again.clip[2].axes, np.eye(3))
    assert again.crop == made.crop
    assert sorted(again.labels.transfers) == [1, 2]
    np.testing.assert_array_equal(again.receivers[2].normals, mesh.normals)
    assert again.layers[0].transfer == made.layers[0].transfer


def test_parts_that_hold_arrays_are_equal_to_themselves_alone():
    # Else caches and filters would take one for another of the same look
    triangle = [[0, 1, 2]]
    corners = np.eye(3)
    for make in (
        lambda: EnvironmentMap(np.ones((2, 4, 3))),
        lambda: MeshReceiver(corners, triangle),
        lambda: BoxReceiver((0, 0, 0), (1, 1, 1)),
    ):
        one, other = make(), make()
        assert one == one
        assert one != other
        assert len({one, other}) == 2
    assert PlaneReceiver((0, 0, 0), (0, 0, 1)) == PlaneReceiver((0, 0, 0), (0, 0, 1))
    assert PointLight((0, 0, 0)) == PointLight((0, 0, 0))
    assert PointLight((0, 0, 0)) != PointLight((0, 0, 1))


def test_each_mesh_is_planned_with_its_own_triangles():
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    for n in (1, 2):
        mesh = MeshReceiver(corners, [[0, 1, 2], [0, 1, 3]][:n])
        assert len(plan(scene(receivers=mesh)).packed.mesh.triangles) == n
