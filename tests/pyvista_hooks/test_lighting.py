"""A renderer's environment texture lights volumes from where it lights meshes."""

import numpy as np
import pytest
import pyvista as pv
from plotters import add, look, pixels, plotter

from vtkmcvr.vtk_bridge.environment import FACES, Environment, panorama_of

DIRECTIONS = {
    # Place in the texture, from the lower left corner: where VTK has it in the world
    (0.5, 0.5): (1, 0, 0),
    (0.75, 0.5): (0, 0, 1),
    (0.25, 0.5): (0, 0, -1),
    (0.5, 0.99): (0, 1, 0),
}


def spot(place, shape=(64, 128)):
    """Black texture with a bright spot."""
    rows, columns = shape
    image = np.zeros((rows, columns, 3), np.uint8)
    row, column = int((1 - place[1]) * rows), int(place[0] * columns)
    image[max(row - 3, 0) : row + 3, column - 3 : column + 3] = 255
    return pv.Texture(image)


def brightest(environment):
    """World direction of the brightest light of an environment map, by its own convention."""
    light = environment.pixels.sum(axis=2)
    rows, columns = light.shape
    polar = np.pi * (np.arange(rows) + 0.5) / rows
    phi = 2 * np.pi * (np.arange(columns) + 0.5) / columns
    level = np.sin(polar)[:, None]
    local = np.stack([
        level * np.sin(phi), np.broadcast_to(np.cos(polar)[:, None], light.shape),
        -level * np.cos(phi),
    ], axis=-1)  # fmt: skip
    weight = light * level
    mean = (local * weight[..., None]).sum(axis=(0, 1)) @ environment.rotation.T
    return mean / np.linalg.norm(mean)


@pytest.mark.parametrize("place", DIRECTIONS)
def test_a_texture_stands_where_vtk_has_it(place):
    target = plotter()
    target.set_environment_texture(spot(place), show_background=False)
    environment = Environment()
    found = environment.of(target.renderer)
    np.testing.assert_allclose(brightest(found), DIRECTIONS[place], atol=0.1)
    assert environment.of(target.renderer) is found
    target.close()


def test_a_rotated_texture_turns_with_it():
    target = plotter()
    turn = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    target.set_environment_texture(spot((0.5, 0.5)), show_background=False, rotation=turn)
    theirs = highlight(target)
    ours = brightest(Environment().of(target.renderer))
    np.testing.assert_allclose(ours, theirs, atol=0.25)
    target.close()


def highlight(target):
    """Direction from which a shiny ball is lit, seen from along the axes."""
    ball = target.add_mesh(pv.Sphere(theta_resolution=60, phi_resolution=60), pbr=True,
                           metallic=1.0, roughness=0.3)  # fmt: skip
    target.set_background("black")
    target.enable_parallel_projection()
    seen = {}
    for axis in range(3):
        for sign in (1.0, -1.0):
            toward = tuple(sign * (axis == k) for k in range(3))
            target.camera_position = [
                np.multiply(5, toward), (0, 0, 0), (0, 0, 1) if axis < 2 else (0, 1, 0)
            ]  # fmt: skip
            image = pixels(target)
            seen[toward] = image[30:42, 40:56].mean()
    target.remove_actor(ball)
    best = max(seen, key=seen.get)
    return np.array(best)


def test_a_cube_map_has_its_faces_where_opengl_has_them():
    """Each direction looks at the face, and the place on it, that the OpenGL specification says."""
    n = 16
    faces = []
    for axis, across, along in FACES:
        t, s = np.meshgrid(*(2 * (np.arange(n) + 0.5) / n - 1,) * 2, indexing="ij")
        d = np.array(axis) + s[..., None] * np.array(across) + t[..., None] * np.array(along)
        faces.append(d / np.linalg.norm(d, axis=-1, keepdims=True))
    panorama = panorama_of(faces)
    rows, columns = panorama.shape[:2]
    polar, phi = np.pi * 5.5 / rows, 2 * np.pi * 9.5 / columns
    expected = (np.sin(polar) * np.sin(phi), np.cos(polar), -np.sin(polar) * np.cos(phi))
    np.testing.assert_allclose(panorama[5, 9], expected, atol=0.08)
    assert (np.linalg.norm(panorama, axis=-1) > 0.9).all()


def test_a_texture_lights_the_volume_from_its_side():
    target = plotter()
    target.renderer.remove_all_lights()
    add(target, opacity=[0.0, 0.9])
    target.set_environment_texture(spot((0.5, 0.5)), show_background=False)
    target.set_background("black")
    look(target, (0.0, 0.0, 7.0))
    target.mcvr.enable(samples=64, exposure=5.0)
    image = pixels(target).mean(axis=2)
    target.close()
    middle = image.shape[1] // 2
    assert image[:, middle + 4 :].mean() > 1.5 * image[:, : middle - 4].mean()
