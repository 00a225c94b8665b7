"""The register of hard cases: which has its test where, which does not apply, and why."""

# In this folder a case has tests of its own name, test_hcNN_...; these are proven elsewhere, at the
# level of the kernel or with scenes of another kind
ELSEWHERE = {
    "HC-18": "tests/physics/test_materials.py::"
    "test_noise_in_the_data_is_less_noise_in_the_picture_by_a_lower_gradient_factor",
    "HC-20": "tests/kernels/test_brdf.py::test_surfaces_happen_with_their_probability",
    "HC-30": "tests/physics/test_furnace.py::test_white_furnace_is_white",
    "HC-37": "tests/physics/test_light_irradiance.py::test_lambert_surface_reflects_the_irradiance",
    "HC-38": "tests/kernels/test_light_shapes.py::test_integrals_over_what_is_seen",
    "HC-39": "tests/physics/test_lights.py::test_rectangle_casts_a_shadow_with_either_side",
    "HC-45": "tests/physics/test_lights.py::test_camera_sees_a_visible_rectangle_before_the_volume",
    "HC-50": "tests/kernels/test_camera.py::test_plate_in_the_focal_plane_is_sharp_to_the_corners",
    "HC-52": "tests/kernels/test_camera.py::test_polygonal_aperture_is_evenly_filled",
    "HC-62": "tests/filters/test_filter_updates.py::test_traces_nothing_without_a_change_of_value",
    "HC-71": "tests/test_vtk_scene.py::test_random_functions_are_exact",
    "HC-82": "tests/hard_cases/test_occlusion.py::test_hc83_half_space",
    "HC-92": "tests/occlusion/test_occlusion_parts.py::test_a_cut_opens_light",
}
# Slips or wishes without a counterpart here
NOT_HERE = {
    "HC-21": "no percentile in place of the largest gradient is offered: P_brdf follows the paper",
}
NUMBERS = [
    *range(1, 23), *range(30, 47), *range(50, 63), *range(70, 72), *range(80, 94),
]  # fmt: skip
ALL = [f"HC-{i:02}" for i in NUMBERS]
