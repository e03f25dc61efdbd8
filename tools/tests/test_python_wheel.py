"""The wheel on its own, without Rust and without this folder.

pytest tools/tests/test_python_wheel.py
"""

import re
import subprocess
import sys
import tomllib
import zipfile

import pytest
import render

pytest.importorskip("abbe", reason="the package is not installed: python3 tools/test.py --only wheel")

WHEELS = list((render.ROOT / "target/wheels").glob("abbe_render-*.whl"))
FIRST = """
import sys
sys.path.insert(0, sys.argv[1])
import abbe, tomllib
small = {"film.width": 64, "film.height": 36}
image = abbe.render(tomllib.loads(sys.argv[2]), folder=sys.argv[3], samples=1, set=small)
assert abbe.__file__.startswith(sys.argv[1]), abbe.__file__
image.write_exr("first.exr")
"""


@pytest.fixture(scope="module")
def wheel():
    if len(WHEELS) != 1:
        pytest.skip("there is no wheel: python3 tools/test.py --only wheel")
    return WHEELS[0]


def test_one_wheel_is_for_all_pythons_and_small(wheel):
    assert "-cp39-abi3-" in wheel.name
    assert wheel.stat().st_size < 15e6
    names = zipfile.ZipFile(wheel).namelist()
    assert {"abbe/__init__.py", "abbe/_abbe.pyi", "abbe/py.typed", "abbe/catalog.py"} <= set(names)
    assert not [name for name in names if not name.startswith(("abbe/", "abbe_render-"))]


def test_without_rust_it_renders_the_first_scene(wheel, tmp_path):
    site = tmp_path / "site"
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-index", "--no-deps", "--target", site, wheel]
    subprocess.run(list(map(str, pip)), check=True)
    (first, *_) = re.findall(r"```toml\n(.*?)```", (render.ROOT / "README.md").read_text("utf-8"), re.DOTALL)
    assert tomllib.loads(first)["film"]["width"] == 640
    command = [sys.executable, "-c", FIRST, str(site), first, str(render.ROOT)]
    subprocess.run(command, check=True, cwd=tmp_path, env={"PATH": ""})
    rgb = render.read(tmp_path / "first.exr").rgb
    assert rgb.shape == (36, 64, 3) and rgb.max() > 0.5
