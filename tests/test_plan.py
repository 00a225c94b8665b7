import dataclasses

import numpy as np
import pytest
from scenes import blob, everything, medium, noise, scene, slab

from vtkmcvr.lights import (
    ConstantEnvironment,
    DirectionalLight,
    EnvironmentMap,
    PointLight,
    RectangleLight,
)
from vtkmcvr.plan import plan
from vtkmcvr.scene import Camera, Cone, HenyeyGreenstein, Lens, Stereo, Surface

EFFECTS = {
    "clipping", "cropping", "mask", "labels", "more volumes", "receivers",
    "medium", "colour by point", "gradient classification", "emission", "multiple scattering",
    "surface shading", "specular coat", "anisotropic phase", "constant environment",
    "gradient environment", "environment map", "area lights", "light textures",
    "point and directional lights",
    "multiple importance sampling", "shadows", "depth of field", "visible environment",
    "backdrop", "first-hit AOVs",
    "even samples",
}  # fmt: skip
PARTS = {
    "lens": "depth of field", "surface": "surface shading", "gloss": "specular coat",
    "phase": "anisotropic phase", "scattering": "multiple scattering",
    "shadows": "shadows", "ambient": "constant environment",
    "environment": "environment map", "area_lights": "area lights",
    "delta_lights": "point and directional lights",
}  # fmt: skip


def effects(planned):
    return {effect.name: effect for effect in planned.effects}


def lensed(radius=0.1, **options):
    return Camera((0, -5, 0), (0, 0, 0), lens=Lens(radius), **options)


def test_every_effect_is_explained():
    for planned in (plan(scene()), plan(everything())):
        found = effects(planned)
        assert set(found) == EFFECTS
        lines = planned.explain().splitlines()
        assert len(lines) == len(EFFECTS)
        for line, effect in zip(lines, planned.effects, strict=True):
            assert line.startswith(effect.name)
            assert line.endswith(effect.reason)
            assert len(effect.reason) >= 4
            assert f"  {'on' if effect.on else 'off'}" in line


def test_absent_effects_are_none_in_the_packed_scene():
    planned = plan(scene())
    for part, name in PARTS.items():
        assert getattr(planned.packed, part) is None
        assert not effects(planned)[name].on
    assert planned.packed.ratio is None
    assert planned.packed.choice is None
    assert effects(planned)["medium"].on
    assert planned.notes == ()


def test_present_effects_are_there():
    planned = plan(dataclasses.replace(everything(), camera=lensed(), scattering="multiple"))
    for part, name in PARTS.items():
        assert getattr(planned.packed, part) is not None
        assert effects(planned)[name].on
    assert planned.packed.ratio is not None
    assert planned.packed.choice is not None


SKY = (ConstantEnvironment(),)
MAP, DELTA = "environment map", "point and directional lights"
LAMP = (RectangleLight((0, 0, 5), (0, 0, 0), (1, 1)),)


@pytest.mark.parametrize(
    ("changes", "part", "name", "reason"),
    [
        ({"camera": lensed(0)}, "lens", "depth of field", "aperture radius is 0"),
        ({"camera": lensed(panorama=True)}, "lens", "depth of field", "panorama"),
        ({"surface": Surface(0)}, "surface", "surface shading", "gradient factor is 0"),
        ({"surface": Surface(0)}, "gloss", "specular coat", "no surfaces"),
        ({"surface": Surface(specular=0)}, "gloss", "specular coat", "Lambert"),
        ({"phase": HenyeyGreenstein(1e-4)}, "phase", "anisotropic phase", "isotropic"),
        ({"shadow_reach": 1.0}, "shadows", "shadows", "no lights"),
        ({"lights": SKY, "shadow_reach": 0}, "shadows", "shadows", "reach is 0"),
        ({"lights": SKY, "shadow_reach": 0, "ratio_tracking": True}, "ratio", "shadows", "is 0"),
        ({"lights": (ConstantEnvironment(0),)}, "ambient", "constant environment", "black"),
        ({"lights": (EnvironmentMap(np.zeros((1, 1, 3))),)}, "environment", MAP, "black"),
        ({"lights": (EnvironmentMap(np.ones((1, 1, 3)), 0),)}, "environment", MAP, "black"),
        ({"lights": (DirectionalLight((0, 0, 1), 0),)}, "delta_lights", DELTA, "black"),
        ({"lights": (PointLight((0, 0, 1), 0),)}, "delta_lights", DELTA, "black"),
        ({"lights": SKY}, "choice", "multiple importance sampling", "two strategies"),
    ],
)  # fmt: skip
def test_effects_of_no_consequence_are_off(changes, part, name, reason):
    planned = plan(scene(**changes))
    assert getattr(planned.packed, part) is None
    effect = effects(planned)[name]
    assert not effect.on
    assert reason in effect.reason


@pytest.mark.parametrize(
    ("changes", "part", "name"),
    [
        ({"surface": Surface()}, "surface", "surface shading"),
        ({"surface": Surface()}, "gloss", "specular coat"),
        ({"phase": HenyeyGreenstein(0.5)}, "phase", "anisotropic phase"),
        ({"scattering": "multiple"}, "scattering", "multiple scattering"),
    ],
)
def test_what_reflects_is_left_out_where_nothing_shines(changes, part, name):
    dark, lit = plan(scene(**changes)), plan(scene(lights=SKY, **changes))
    assert getattr(dark.packed, part) is None
    assert "no light to reflect" in effects(dark)[name].reason
    assert getattr(lit.packed, part) is not None
    # The volumes of the one plan serve the other
    again = plan(lit.scene, like=dark)
    assert getattr(again.packed, part) is not None


def test_normals_of_the_dark_are_kept():
    planned = plan(scene(surface=Surface(), aovs=("normal",)))
    assert planned.packed.surface is not None
    assert planned.packed.gloss is None


def test_constant_volume_has_no_surfaces():
    planned = plan(scene(slab(), surface=Surface(mode="brdf"), lights=SKY))
    assert planned.packed.surface is None
    assert "constant" in effects(planned)["surface shading"].reason


def test_reasons_name_quantities():
    planned = plan(
        scene(
            noise(), camera=lensed(0.25), surface=Surface(0.7, exponent=12),
            phase=HenyeyGreenstein(0.4),
            lights=(*SKY, *LAMP, DirectionalLight((0, 0, 1)), PointLight((0, 9, 0))),
            shadow_reach=3.5, ratio_tracking=True, environment_visible=True,
        )
    )  # fmt: skip
    text = planned.explain()
    assert "within 60 degrees" in plan(scene(phase=Cone(60), lights=SKY)).explain()
    for words in ("0.25", "0.7", "exponent 12", "g = 0.4", "1 rectangle", "2, one shadow ray",
                  "ratio tracking, up to 3.5", "power heuristic", "miss the volume"):  # fmt: skip
        assert words in text


def test_visible_environment_needs_an_environment():
    found = effects(plan(scene(environment_visible=True, lights=LAMP)))["visible environment"]
    assert (found.on, found.reason) == (False, "no environment")


@pytest.mark.parametrize("kind", ["light", "scatter"])
def test_test_modes_of_light_sampling_are_named(kind):
    effect = effects(plan(scene(lights=LAMP, light_sampling=kind)))["multiple importance sampling"]
    assert not effect.on
    assert f"by {kind} only" in effect.reason


def test_transparent_volume_says_so():
    planned = plan(scene(transfer=medium(0.0)))
    assert planned.empty
    assert "transparent" in effects(planned)["medium"].reason
    assert not plan(scene()).empty


def test_black_rectangle_still_blocks():
    black = RectangleLight((0, 0, 5), (0, 0, 0), (1, 1), 0.0)
    planned = plan(scene(lights=(black, DirectionalLight((0, 0, -1)))))
    assert planned.packed.area_lights is not None
    assert planned.packed.all_lights is not None


def test_everything_is_float32_but_the_camera_and_the_sampler():
    def leaves(part):
        if isinstance(part, tuple):
            for x in part:
                yield from leaves(x)
        elif part is not None:
            yield part

    others = {
        "camera": ("float64", "int64"), "medium": ("float64",), "sobol": ("uint64", "int64"),
    }  # fmt: skip
    eyes = dataclasses.replace(
        everything(), camera=lensed(stereo=Stereo()), ratio_tracking=True, scattering="multiple"
    )
    packed = plan(eyes).packed
    for name, part in packed._asdict().items():
        for leaf in leaves(part):
            # No Python number, which would compile anew, and no array that is not C-contiguous
            assert isinstance(leaf, (np.ndarray, np.generic)), (name, leaf)
            kinds = ("float32", "bool", "int32", *others.get(name, ()))
            assert leaf.dtype.name in kinds, (name, leaf.dtype)
            if isinstance(leaf, np.ndarray):
                assert leaf.flags.c_contiguous


def test_two_plans_of_a_scene_are_alike():
    one = everything(vol=blob())
    first, second = plan(one), plan(one)
    assert first.explain() == second.explain()
    np.testing.assert_array_equal(first.packed.medium.majorant, second.packed.medium.majorant)
    assert first.packed.medium.values is second.packed.medium.values
