"""The package's types are correct, according to pyright and stubtest.

pytest tools/tests/test_python_types.py
"""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import render

abbe = pytest.importorskip("abbe", reason="the package is not installed: python3 tools/test.py --only wheel")

USE = """
import abbe
import numpy as np

image: abbe.Image = abbe.render({"film": {"width": 3}}, samples=4, set={"film.width": 5}, progress=print, error=0.1)
rows: int = image.rgb.shape[0]
exposed: np.ndarray = image["Z"] * 2
model: str = abbe.plan("scene.toml", time="10m").model
index: float = abbe.catalog.glass("N-BK7").index(587.56)
sizes = np.array([0, 0, 2, 2])
abbe.render("scene.toml", samples=np.int64(4), error=np.float32(0.1), crop=sizes, overscan=sizes, seed=np.uint8(3))
agrees: bool = abbe.diff(image, "other.exr", layer="albedo").agrees
try:
    abbe.Scene("scene.toml")
except abbe.SceneError as error:
    keys: list[str | None] = [mistake.key for mistake in error.mistakes]
"""
WRONG = """
import abbe
abbe.render("scene.toml", samples="many")  # one
abbe.render("scene.toml", smaples=4)  # two
abbe.plan("scene.toml").modle  # three
"""


def run(*command, folder=render.ROOT):
    run = subprocess.run([sys.executable, "-m", *map(str, command)], capture_output=True, text=True, cwd=folder)
    return run.returncode, run.stdout + run.stderr


def pyright(path):
    return run("pyright", "--pythonpath", sys.executable, path)


def test_pyright_finds_nothing_in_the_package(tmp_path):
    # pyright skips installed packages.
    package = Path(shutil.copytree(Path(abbe.__file__).parent, tmp_path / "abbe"))
    code, said = pyright(package)
    assert code == 0 and said.startswith("0 errors, 0 warnings"), said
    (package / "wrong.py").write_text("from . import nothing")
    assert pyright(package)[0] == 1


def test_pyright_knows_the_package_and_finds_what_is_wrong(tmp_path):
    (tmp_path / "use.py").write_text(USE)
    code, said = pyright(tmp_path / "use.py")
    assert code == 0, said
    (tmp_path / "wrong.py").write_text(WRONG)
    code, said = pyright(tmp_path / "wrong.py")
    assert code == 1 and said.count(" - error: ") == 3, said


def test_the_stub_is_what_the_module_is(tmp_path):
    code, said = run("mypy.stubtest", "abbe", folder=tmp_path)
    assert code == 0, said


def test_everything_public_says_what_it_is():
    public = [getattr(abbe, name) for name in abbe.__all__ if name not in ("LAYERS", "__version__")]
    catalog = [getattr(abbe.catalog, name) for name in vars(abbe.catalog) if name[0] != "_" and name != "Any"]
    own = [thing for thing in public + catalog if getattr(thing, "__module__", "abbe").startswith("abbe")]
    assert len(own) > 25
    for thing in own:
        assert thing.__doc__, thing
        members = vars(thing).items() if isinstance(thing, type) else ()
        for name, member in members:
            if not name.startswith("_") and (callable(member) or isinstance(member, property)):
                assert member.__doc__, (thing, name)
