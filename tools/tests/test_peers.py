"""Compares the scenes that tools/peers/scene.py makes for other renderers with the scenes themselves."""

from collections import Counter

import numpy as np
import render
from peers import scene as peers_scene


def edges(faces):
    return Counter((int(a), int(b)) for face in faces for a, b in zip(face, np.roll(face, -1), strict=True))


def test_the_walls_of_smallpt_enclose_its_room():
    scene = peers_scene.read(render.SCENES / "smallpt.toml")
    quads = [values for kind, values, _ in peers_scene.shapes(scene) if kind == "quad"]
    corners = np.concatenate([peers_scene.quad_triangles(**quad)[0] for quad in quads])
    assert len(quads) == 6
    np.testing.assert_allclose(corners.min(axis=0), [1, 0, 0], atol=1e-9)
    np.testing.assert_allclose(corners.max(axis=0), [99, 81.6, 170], atol=1e-9)


def test_the_flat_lamp_of_smallpt_has_the_rim_of_the_sphere_that_pokes_through_the_ceiling():
    scene = peers_scene.read(render.SCENES / "smallpt.toml")
    ((disc),) = [values for kind, values, _ in peers_scene.shapes(scene, flat_lamp=True) if kind == "disc"]
    np.testing.assert_allclose(disc["radius"], np.sqrt(600**2 - 599.73**2), rtol=1e-9)
    np.testing.assert_allclose(disc["center"], [50, 81.33, 81.6], rtol=1e-12)


def test_a_ball_of_triangles_is_closed_and_faces_outward():
    points, faces, normals = peers_scene.ball([1, 2, 3], 0.5)
    corners = points[faces]
    outward = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (np.einsum("ij,ij->i", outward, corners.mean(axis=1) - [1, 2, 3]) > 0).all()
    np.testing.assert_allclose(points, [1, 2, 3] + 0.5 * normals)


def test_the_bumpy_ball_is_closed_and_has_1_3_million_triangles():
    points, faces = peers_scene.bumpy_ball(60, 60)
    count = edges(faces)
    assert all(number == 1 and count[b, a] == 1 for (a, b), number in count.items())
    corners = points[faces]
    volume = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6
    assert 3.5 < volume < 5
    rings, sectors = peers_scene.BUMPY
    assert 1.29e6 < 2 * sectors * (rings - 1) < 1.32e6
