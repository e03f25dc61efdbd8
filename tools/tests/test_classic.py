"""The renderer's image of the classic scene is the independent tracer's, pixel by pixel and band by band.

    pytest tools/tests/test_classic.py
"""

import numpy as np
import pytest
import render
from classic import command as classic
from classic.scene import Disc, Plane, Sphere, Triangle, read_scene

ORIGIN = np.array([[0.3, 0.2, 5.0]])
DOWN_Z = np.array([[0.0, 0.0, -1.0]])
FREE = np.array([False])


@pytest.fixture(scope="module")
def scene():
    return read_scene(render.SCENES / "classic.toml")


@pytest.fixture(scope="module")
def expected(scene):
    return classic.trace(scene)


@pytest.mark.parametrize(
    ("shape", "distance"),
    [
        (Plane([9, 9, 1], [0, 0, 2]), 4),
        (Triangle([[0, 0, 2], [1, 0, 2], [0, 1, 2]]), 3),
        (Triangle([[0.4, 0, 2], [1, 0, 2], [0.4, 1, 2]]), np.inf),
        (Disc([0, 0, 2], [0, 0, 1], 0.37), 3),
        (Disc([0, 0, 2], [0, 0, 1], 0.36), np.inf),
        (Sphere([0.3, 0.2, 0], 1), 4),
        (Sphere([0.3, 1.1, 0], 1), 5 - 0.19**0.5),
        (Sphere([0.3, 1.3, 0], 1), np.inf),
    ],
)
def test_each_shape_is_hit_at_its_distance(shape, distance):
    with np.errstate(divide="ignore", invalid="ignore"):
        assert shape.distance(ORIGIN, DOWN_Z, FREE) == pytest.approx(distance)


def test_a_ray_that_leaves_a_sphere_inward_meets_its_far_side_only():
    sphere = Sphere([0, 0, 0], 2)
    start = np.array([[0.0, 0.0, 2.0]])
    assert sphere.distance(start, DOWN_Z, ~FREE) == pytest.approx(4)
    assert sphere.distance(start, -DOWN_Z, ~FREE) == np.inf


def test_fresnel_gives_the_known_reflectances_of_glass():
    cosine = np.cos(np.radians([0, 30, 45, 60, 75, 85]))
    share, _ = classic.fresnel(cosine, 1.0, 1.5)
    assert share[:, 0] == pytest.approx([0.04, 0.041523, 0.050240, 0.089187, 0.253061, 0.612800], abs=5e-7)


def test_total_reflection_begins_at_the_critical_angle():
    share, _ = classic.fresnel(np.cos(np.radians([41.8, 41.82])), 1.5, 1.0)
    assert share[0, 0] < 1
    assert share[1, 0] == 1


def test_the_scene_shows_parted_bands_and_every_kind_of_material(scene, expected):
    assert {material.kind for material in scene.materials} == {"diffuse", "emissive", "mirror", "dielectric"}
    assert {type(shape) for shape in scene.shapes} == {Plane, Triangle, Disc, Sphere}
    assert np.isfinite(expected).all()
    assert expected.min() >= 0
    assert 0.05 < expected.mean() < 0.5


def test_no_pixel_is_ill_conditioned(scene, expected):
    """Moving the camera by 1e-12, thousands of roundings, changes no value by a hundredth of the tolerance."""
    position = [coordinate + 1e-12 for coordinate in scene.camera["position"]]
    moved = classic.trace(scene._replace(camera={**scene.camera, "position": position}))
    assert classic.error(moved, expected).max() < 0.01


def test_every_pixel_and_band_agrees_with_the_independent_tracer(expected):
    image = render.render(render.SCENES / "classic.toml").rgb
    errors = classic.error(image, expected)
    y, x, band = np.unravel_index(np.argmax(errors), errors.shape)
    worst = f"pixel ({x}, {y}) band {band}: {image[y, x, band]:.9g}, expected {expected[y, x, band]:.9g}"
    assert np.count_nonzero(errors > 1) == 0, worst
