"""Every shipped scene renders to a file that obeys the EXR rules and states the position of its camera.

    pytest tools/tests/test_scenes.py
"""

import subprocess
import sys
import tomllib
from pathlib import Path

import check_exr
import numpy as np
import pytest
import render
from gallery import command as gallery

SCENES = sorted(render.SCENES.rglob("*.toml"))


@pytest.fixture(scope="module", params=SCENES, ids=[str(path.relative_to(render.SCENES)) for path in SCENES])
def rendered(request, tmp_path_factory):
    """Returns a scene file as a dictionary, and its EXR with one sample per pixel, half as wide and high."""
    if gallery.needs_making(request.param.relative_to(render.SCENES).with_suffix("")):
        gallery.make_landscape()
    exr = tmp_path_factory.mktemp("scenes") / "scene.exr"
    scene = tomllib.loads(request.param.read_text("utf-8"))
    small = [f"film.{side}={scene['film'][side] // 2}" for side in ("width", "height")]
    render.write(request.param, exr, samples=1, set=small, timeout=300)
    return scene, exr


def test_the_file_keeps_every_rule(rendered):
    assert check_exr.violations(rendered[1]) == []


def test_every_sample_is_finite(rendered):
    assert render.read(rendered[1]).header["render/nonFinite"] == 0


def test_openimageio_reads_every_pixel_as_finite(rendered):
    oiiotool = Path(sys.executable).with_name("oiiotool")
    report = subprocess.run([oiiotool, "--stats", rendered[1]], capture_output=True, text=True, check=True).stdout
    assert "NanCount: 0 0 0 0 0" in report
    assert "InfCount: 0 0 0 0 0" in report


def test_the_first_line_says_what_to_look_for():
    for path in SCENES:
        assert path.read_text("utf-8").startswith("# "), path


def test_world_to_camera_takes_the_position_to_the_origin_and_the_target_straight_ahead(rendered):
    camera, header = rendered[0]["camera"], render.read(rendered[1]).header
    ends = np.array([[*camera["position"], 1], [*camera["look_at"], 1]], float)
    origin, target = ends @ np.asarray(header["worldToCamera"], np.float64)
    distance = np.linalg.norm(ends[1] - ends[0])
    rounding = 1e-6 * np.abs(ends).max()
    assert origin == pytest.approx([0, 0, 0, 1], abs=rounding)
    assert target == pytest.approx([0, 0, distance, 1], abs=rounding)


def test_the_screen_window_is_as_wide_as_the_field_of_view(rendered):
    camera, film, header = rendered[0]["camera"], rendered[0]["film"], render.read(rendered[1]).header
    height = 2 * np.tan(np.radians(camera["vertical_fov"]) / 2)
    assert header["screenWindowWidth"] == pytest.approx(height * film["width"] / film["height"], rel=1e-6)
