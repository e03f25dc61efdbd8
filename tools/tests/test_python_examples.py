"""The Python examples run, and produce what they promise.

pytest tools/tests/test_python_examples.py
"""

import importlib.util
import re
import subprocess
import sys

import numpy as np
import pytest
import render

abbe = pytest.importorskip("abbe", reason="the package is not installed: python3 tools/test.py --only wheel")

EXAMPLES = render.ROOT / "examples/python"


def example(name):
    spec = importlib.util.spec_from_file_location(f"example_{name}", EXAMPLES / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_readme_says_what_runs(tmp_path, monkeypatch):
    pages = [(render.ROOT / page).read_text("utf-8") for page in ("README.md", "src/python/README.md")]
    (first, *_), (code,) = (re.findall(rf"```{kind}\n(.*?)```", page, re.DOTALL) for kind, page in zip(("toml", "python"), pages, strict=True))
    small = first.replace("scenes/", f"{render.SCENES}/").replace("640", "64").replace("360", "36")
    (tmp_path / "first.toml").write_text(small)
    monkeypatch.chdir(tmp_path)
    names = {}
    exec(code, names)
    image = abbe.read_exr("first.exr")
    assert image.rgb.shape == (36, 64, 3) and "albedo" in image and (tmp_path / "look.png").is_file()
    assert abbe.diff(names["a"], names["b"]).agrees and names["image"].stats["error"]["is_reached"]


def test_every_example_is_run_here():
    names = sorted(path.stem for path in EXAMPLES.glob("*.py"))
    assert names == ["color_chart", "furnace", "prism", "turntable"]


def test_the_furnace_passes_by_itself():
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", EXAMPLES / "furnace.py"]
    run = subprocess.run(command, capture_output=True, text=True)
    assert run.returncode == 0 and "4 passed" in run.stdout, run.stdout


def test_the_prism_keeps_snells_law(tmp_path):
    # The bar is one pixel, 0.06 degrees. Noise, and Fresnel losses that vary across the view, are a third of it. From
    # 460 to 640 nm the edge moves by 20 pixels.
    assert example("prism").main(tmp_path / "prism.png") < 1
    assert (tmp_path / "prism.png").stat().st_size > 10_000


def test_the_color_chart_is_that_of_the_tables(tmp_path):
    pytest.importorskip("colour", reason="colour-science is not installed")
    worst = example("color_chart").main(tmp_path / "chart.png")
    # The noise of the darkest patch, whose paths end at random: all its channels are off by the same factor.
    assert worst.keys() == {"D65", "A", "FL11"} and max(worst.values()) < 0.05, worst


def test_the_turntable_turns(tmp_path):
    example("turntable").main(tmp_path, 3, samples=1)
    frames = [render.read(path).rgb for path in sorted(tmp_path.glob("*.exr"))]
    assert len(frames) == 3 and not np.allclose(frames[0], frames[1]) and not np.allclose(frames[1], frames[2])
