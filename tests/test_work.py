"""What is absent does nothing: exact zeros, counted in the kernels' own sources."""

import importlib
import math
from dataclasses import replace

import numpy as np
import pytest
from scenes import blob, frontal, medium, noise, render, scene, slab

from vtkmcvr import (
    Camera,
    ColourCurve,
    ConstantEnvironment,
    Curve,
    DirectionalLight,
    EnvironmentMap,
    HenyeyGreenstein,
    Labels,
    Lens,
    Plane,
    PlaneReceiver,
    PointLight,
    RectangleLight,
    Surface,
    Texture,
    TransferFunction,
    count_work,
)
from vtkmcvr.work.count import WORK

PATHS = 64
SKY = (ConstantEnvironment(1.0),)
SUN = (DirectionalLight((0.3, 1, -1), 2.0),)
LAMP = (RectangleLight((2, -2, 3), (0, 0, 0), (5, 5), 9.0),)
MAP = (EnvironmentMap(np.linspace(0.5, 2, 24).reshape(2, 4, 3)),)
STRIPES = Texture(np.linspace(0.5, 2, 24).reshape(2, 4, 3))
SHINY = Surface(0.7, specular=0.3, exponent=20)
DENSE = medium(9.0)
GLOWING = TransferFunction(
    None, ColourCurve([(0, 0.5, 0.5, 0.5)]), extinction=Curve([(0, 0), (1, 9)]),
    emission=ColourCurve([(0, 1, 1, 1)]),
)  # fmt: skip
LABELS = Labels(np.arange(9**3).reshape(9, 9, 9) % 2, {1: medium(5.0, 0.5)})
LENS = Camera((0, -5, 0), (0, 0, 0), view_angle=20, lens=Lens(0.1))
FLOOR = (PlaneReceiver((0, 0, -1), (0, 0, 1), (4, 4)),)
CUT = (Plane((0, 0, 0), (1, 0, 0)),)

LIGHT = {"shadow rays", "light choices", "light bounds met", "area lights met", "light densities",
         "light textures", "MIS weights", "rays drawn by scattering"}  # fmt: skip
ENVIRONMENT = {"constant environment", "environment lookups", "environment draws",
               "environment densities"}  # fmt: skip
SURFACE = {"gradients", "surface tests", "opacities of surfaces", "BRDF evaluations", "microfacets"}
PHASE = {"phase evaluations", "anisotropic phase evaluations"}
RARE = {"lens samples", "emission", "labels", "cuts", "receivers", "backdrop", "albedo and normal",
        "scatterings"}  # fmt: skip
ALL = LIGHT | ENVIRONMENT | SURFACE | PHASE | RARE
MET = {"area lights met", "light densities", "MIS weights",
       "rays drawn by scattering"}  # fmt: skip


def count(paths=PATHS, **options):
    given = {"vol": noise(), "transfer": DENSE, "camera": frontal(0.9), **options}
    return count_work(scene(**given), paths)


# What a scene does beyond camera rays, walks and look-ups; all else that is counted is exactly 0
DOES = {
    "nothing but alpha": ({}, set()),
    "surfaces in the dark": (
        {"surface": SHINY, "phase": HenyeyGreenstein(0.5), "scattering": "multiple"}, set()
    ),
    "black lights": ({"lights": (PointLight((0, 0, 3), 0.0),), "surface": SHINY}, set()),
    "emission alone": ({"transfer": GLOWING, "surface": SHINY}, {"emission"}),
    "emission in many events": (
        {"transfer": GLOWING, "scattering": "multiple"},
        {"emission", "scatterings", "phase evaluations", "rays drawn by scattering"},
    ),
    "delta light": ({"lights": SUN}, {"shadow rays", "light choices", "phase evaluations"}),
    "delta light without shadows": (
        {"lights": SUN, "shadow_reach": 0.0}, {"light choices", "phase evaluations"}
    ),
    "constant environment": (
        {"lights": SKY},
        {"shadow rays", "constant environment", "phase evaluations", "rays drawn by scattering"},
    ),
    "environment map": (
        {"lights": MAP},
        {"shadow rays", "environment lookups", "environment draws", "environment densities",
         "light choices", "MIS weights", "phase evaluations", "rays drawn by scattering"},
    ),
    "area light": (
        {"lights": LAMP}, MET | {"shadow rays", "light choices", "phase evaluations"}
    ),
    "many area lights": (
        {"lights": tuple(replace(LAMP[0], centre=(x, 0, 3)) for x in range(5))},
        MET | {"shadow rays", "light choices", "light bounds met", "phase evaluations"},
    ),
    "area light, by light only": (
        {"lights": LAMP, "light_sampling": "light"},
        {"shadow rays", "light choices", "phase evaluations", "area lights met"},
    ),
    "area light, by scattering only": (
        {"lights": LAMP, "light_sampling": "scatter"},
        {"shadow rays", "phase evaluations", "area lights met",
         "light densities", "rays drawn by scattering"},
    ),
    "anisotropic phase": (
        {"lights": SUN, "phase": HenyeyGreenstein(0.5)},
        PHASE | {"shadow rays", "light choices"},
    ),
    "g = 0": (
        {"lights": SUN, "surface": Surface(0.0), "phase": HenyeyGreenstein(0.0)},
        {"shadow rays", "light choices", "phase evaluations"},
    ),
    "Lambert surfaces": (
        {"lights": SUN, "surface": Surface(mode="brdf", specular=0)},
        {"shadow rays", "light choices", "gradients", "surface tests", "BRDF evaluations"},
    ),
    "coated surfaces": (
        {"lights": SUN, "surface": Surface(mode="brdf", specular=0.3)},
        {"shadow rays", "light choices", "gradients", "surface tests", "BRDF evaluations",
         "microfacets"},
    ),
    "hybrid": (
        {"lights": SUN, "surface": Surface(0.7, specular=0)},
        {"shadow rays", "light choices", "gradients", "surface tests", "BRDF evaluations",
         "opacities of surfaces", "phase evaluations"},
    ),
    "hybrid, whatever the opacity": (
        {"lights": SUN, "surface": Surface(0.7, specular=0, opacity_modulated=False)},
        {"shadow rays", "light choices", "gradients", "surface tests", "BRDF evaluations",
         "phase evaluations"},
    ),
    "depth of field": ({"camera": LENS}, {"lens samples"}),
    "textured area light": (
        {"lights": (replace(LAMP[0], texture=STRIPES),)},
        MET | {"shadow rays", "light choices", "light textures", "phase evaluations"},
    ),
    "labels": ({"labels": LABELS}, {"labels"}),
    "clip plane": ({"clip": CUT}, {"cuts"}),
    "floor in the dark": ({"receivers": FLOOR}, {"receivers"}),
    "albedo": ({"aovs": ("albedo",)}, {"albedo and normal"}),
    "normal": ({"aovs": ("normal",)}, {"albedo and normal", "gradients"}),
}  # fmt: skip


@pytest.mark.parametrize("name", DOES)
def test_only_what_the_scene_calls_for_is_done(name):
    options, does = DOES[name]
    work = count(**options)
    assert {kind for kind in ALL if work[kind]} == does


def test_lens_is_two_random_numbers():
    # Nothing but the camera draws any where the volume is transparent
    for camera, numbers in ((replace(LENS, lens=None), 2), (LENS, 4)):
        for sampler in ("sobol", "independent"):
            work = count(transfer=medium(0.0), camera=camera, sampler=sampler)
            assert work["random numbers"] == numbers * PATHS
            assert work["lookups"] == work["transfer evaluations"] == 0


def test_shadow_rays_are_one_a_strategy():
    for lights, rays in ((SUN, 1), (SKY, 1), (SUN + SKY, 2), ((), 0)):
        work = count(lights=lights)
        assert work.collisions > 0
        assert work["shadow rays"] == rays * work.collisions
        # One volume: every ray is walked once
        assert work["walks of camera and scattered rays"] == work["camera rays"] == PATHS


def test_one_event_ends_the_path_of_single_scattering():
    single, multiple = (count(lights=SUN, scattering=how) for how in ("single", "multiple"))
    assert single["scatterings"] == 0
    assert multiple["scatterings"] >= multiple.collisions
    assert multiple["walks of camera and scattered rays"] > PATHS


def test_channels_without_a_use_are_not_looked_up():
    shiny = replace(
        GLOWING, specular=ColourCurve([(0, 0, 0, 0), (1, 1, 1, 1)]), emission=None,
        exponent=Curve([(0, 1), (1, 90)]),
    )  # fmt: skip
    plain = count(lights=SUN, transfer=shiny)
    # Extinction at each look-up of a scalar, colour at each collision
    assert plain["transfer evaluations"] == plain["lookups"] + plain.collisions
    # And both channels of the coat
    coated = count(lights=SUN, transfer=shiny, surface=SHINY)
    fetched = coated["lookups"] - 6 * coated["gradients"]
    assert coated["transfer evaluations"] == fetched + 3 * coated.collisions


def test_gradient_opacity_of_one_is_not_looked_up():
    transfer = replace(DENSE, gradient_opacity=Curve([(0, 1), (9, 1)]))
    assert count(transfer=transfer)["gradients"] == 0
    transfer = replace(DENSE, gradient_opacity=Curve([(0, 0.5), (9, 1)]))
    assert count(transfer=transfer)["gradients"] > 0


def test_bound_of_hybrid_shading_spares_gradients():
    # P <= 1 - exp(-25 g^3) = 2.5 % where g = 0.1, whatever the opacity: gradients are fetched in as
    # many of n collisions as a binomial distribution says; 5 standard deviations
    share = -math.expm1(-25 * 0.1**3)
    work = count(2000, lights=SUN, surface=Surface(0.1, opacity_modulated=False))
    n = work["surface tests"]
    assert n == work.collisions > 1000
    assert abs(work["gradients"] - share * n) < 5 * math.sqrt(share * n)


def test_surfaces_alone_draw_no_number_to_choose():
    # Dark, so that nothing but the choice could draw numbers after the collision
    without, alone, hybrid = (
        count(aovs=("normal",), surface=surface)
        for surface in (None, Surface(mode="brdf"), Surface(0.7))
    )
    assert alone["random numbers"] == without["random numbers"]
    assert hybrid["random numbers"] > without["random numbers"]


def test_opaque_voxels_take_one_look_up():
    opaque = TransferFunction(Curve([(0, 1), (1, 1)]), ColourCurve([(0, 1, 1, 1)]))
    work = count(transfer=opaque)
    # Rounding of a majorant rejects one collision in a million
    assert work["lookups"] == work.collisions > 0
    empty = count(transfer=replace(opaque, opacity=Curve([(0, 0), (1, 0)])))
    assert empty["lookups"] == empty["walks of camera and scattered rays"] == 0


def test_empty_cells_spare_look_ups():
    sparse = TransferFunction(
        None, ColourCurve([(0, 1, 1, 1)]), extinction=Curve([(0.8, 0), (0.9, 50)])
    )
    options = {"vol": blob(33), "transfer": sparse, "paths": 400}
    grid = count(**options)
    woodcock = count(estimator="woodcock", **options)
    assert 2 * grid["lookups"] < woodcock["lookups"]


def test_lights_that_the_camera_does_not_see_are_not_looked_for():
    # Behind the camera: seen by none of the paths, which are the same
    lamp = replace(LAMP[0], centre=(0, -9, 0))
    seen, unseen = (count(lights=(replace(lamp, visible=visible),)) for visible in (True, False))
    assert seen["area lights met"] - unseen["area lights met"] == PATHS
    assert seen["lookups"] == unseen["lookups"]


def test_environment_is_looked_up_behind_only_where_it_is_seen():
    for visible in (False, True):
        work = count(lights=SKY, environment_visible=visible, camera=frontal(1.5))
        missed = PATHS - work.collisions
        assert missed > 0
        assert work["constant environment"] == work.collisions + visible * missed


def test_moments_of_batches_are_those_of_dependent_samples():
    assert count(sampler="independent")["moments of batches"] == 0
    assert count()["moments of batches"] == PATHS


def test_paths_are_those_of_the_compiled_kernels():
    lit = scene(noise(), DENSE, frontal(0.9), size=(20, 20), lights=SUN)
    picture = render(lit, samples=1, seed=5)
    work = count_work(lit, 400, seed=5)
    # Roundings differ: a path in a hundred may collide in one and escape in the other
    assert abs(int(picture.film.hits.sum()) - work.collisions) <= 4


def test_few_paths_are_spread_over_the_film_and_many_are_samples():
    assert count(7).paths == 7
    assert count_work(scene(slab(), size=(4, 3)), 30).paths == 36


def test_all_that_is_counted_is_there():
    for functions in WORK.values():
        for name in functions:
            module, function = name.rstrip("?").split(".")
            assert callable(getattr(importlib.import_module(f"vtkmcvr.kernels.{module}"), function))


def test_words():
    work = count(10)
    assert "lookups" in str(work)
    assert work.per_path("camera rays") == 1
    with pytest.raises(KeyError, match="counted are camera rays"):
        work["miracles"]
    with pytest.raises(ValueError, match="paths"):
        count(0)
