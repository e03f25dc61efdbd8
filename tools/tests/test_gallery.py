"""The gallery shows every scene, and its scripts make the files that the repository holds.

    pytest tools/tests/test_gallery.py
"""

import json
import tomllib
from collections import Counter

import numpy as np
import pytest
from gallery import command as gallery
from gallery import shapes


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Returns a copy of scenes/ in which everything has been made anew."""
    kept, copy = gallery.SCENES, tmp_path_factory.mktemp("gallery")
    (copy / "large").mkdir()
    (copy / "large/instances.toml").write_bytes((kept / "large/instances.toml").read_bytes())
    gallery.SCENES = copy
    try:
        gallery.make()
    finally:
        gallery.SCENES = kept
    return copy


def test_the_page_lists_every_scene_with_its_first_line_and_picture():
    page = (gallery.SCENES / "README.md").read_text("utf-8")
    assert page == gallery.readme(), "run python tools/gallery.py write"
    for name in gallery.scenes():
        assert f"]({name}.toml)" in page and f"render --exr scenes/{name}.toml" in page
        assert page.count(gallery.first_line(name)) == 2, name


def test_every_scene_has_a_small_picture():
    for name in gallery.scenes():
        assert 0 < (gallery.SCENES / f"pictures/{name.split('/')[-1]}.png").stat().st_size <= 150_000, name


def test_every_scene_reaches_an_error_of_a_hundredth_within_three_minutes_at_640_x_360():
    measured = json.loads(gallery.MEASURED.read_text("utf-8"))
    for name in gallery.scenes():
        assert measured[name]["error"] <= 0.01, f"{name}: more samples, or run python tools/gallery.py errors {name}"
        assert gallery.seconds_to_bar(name, measured[name]) <= 180, name


def test_the_noise_of_two_renders_is_their_variance_over_the_square_of_what_they_show():
    random = np.random.default_rng(1)
    first, second = (3 + random.normal(0, 0.2, (200, 200, 3)) for _ in range(2))
    # The mean of 120 000 squares is uncertain by sqrt(2 / 120 000) = 0.4 %; the noise of the mean (0.02 / 9) adds 3 x
    # 0.02 / 9 = 0.7 %.
    assert gallery.noise(first, second) == pytest.approx(0.04 / 9.01, rel=0.03)


def test_a_reduced_scene_keeps_its_shape_and_finds_its_files():
    for name in gallery.scenes():
        film = [tomllib.loads(text)["film"] for text in ((gallery.SCENES / f"{name}.toml").read_text("utf-8"), gallery.reduced(name))]
        assert film[0]["width"] // 5 == film[1]["width"] and film[0]["height"] // 5 == film[1]["height"], name
    assert str(gallery.SCENES / "meshes/waves.ply") in gallery.reduced("pool")


def test_what_is_made_is_what_is_kept(made):
    kept = [path for folder in ("meshes", "textures", "large") for path in (made / folder).glob("*")]
    assert len(kept) >= 15
    for path in kept:
        if path.suffix in (".ply", ".toml"):
            there = gallery.SCENES / path.relative_to(made)
            assert there.read_bytes() == path.read_bytes(), f"{there}: run python tools/gallery.py make"


def test_the_landscape_has_two_million_triangles(made):
    head = (made / "generated/landscape.ply").open("rb").read(400).decode("ascii", "replace")
    assert "element face 2097152" in head


def edges(faces):
    return Counter((face[i], face[(i + 1) % 3]) for face in faces for i in range(3))


def lathed():
    profiles = dict(gallery.make_lenses()) | {"tumbler": shapes.tumbler(), "water": shapes.water()}
    return [(name, *shapes.lathe(profile, 24)[:2]) for name, profile in profiles.items()]


WAVES = shapes.block(shapes.waves(9), 5.2, 5.2, -1.5)
BODIES = [("waves", *WAVES[:2]), ("brilliant", *shapes.brilliant()), ("straw", *shapes.tube()[:2]), *lathed()]


@pytest.mark.parametrize(("points", "faces"), [body[1:] for body in BODIES], ids=[body[0] for body in BODIES])
def test_bodies_are_closed_and_face_outward(points, faces):
    places = np.unique(np.round(points, 9), axis=0, return_inverse=True)[1].reshape(-1)
    count = edges([[places[corner] for corner in face] for face in faces])
    assert all(count[b, a] == number for (a, b), number in count.items())
    a, b, c = (points[[face[i] for face in faces]] for i in range(3))
    assert np.einsum("ij,ij->", a, np.cross(b, c)) > 0


def test_the_brilliant_has_57_facets_and_a_round_girdle():
    points, faces = shapes.brilliant()
    a, b, c = (points[[face[i] for face in faces]] for i in range(3))
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    different = []
    for normal in normals:
        if not any(np.allclose(normal, other, atol=1e-3) for other in different):
            different.append(normal)
    facets = [normal for normal in different if abs(normal[1]) > 0.01]
    crown = [normal for normal in facets if normal[1] > 0]
    assert (len(facets), len(crown)) == (57, 33)
    steep = np.degrees(np.arccos([abs(normal[1]) for normal in facets]))
    for angle, number in ((0, 1), (34.5, 8), (40.75, 8)):
        assert np.sum(np.abs(steep - angle) < 0.01) == number
    flat = np.abs(points[:, 1] - points[:, 1].max()) < 1e-6
    assert np.hypot(*points[flat][:, [0, 2]].T).max() == pytest.approx(0.53, abs=1e-6)
