"""The renderers that tools/chart.py compares: which are installed, and a picture and its processor seconds from each.

    renderer = open_renderer(series, Path("scene.toml"), folder)
    picture, seconds = renderer.run(samples=64, seed=1)
"""

import contextlib
import glob
import importlib.metadata
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import render
from peers import povray
from smallpt import reference

TOOLS = render.ROOT / "tools"
PACKAGES = {"mitsuba": "mitsuba", "luxcore": "pyluxcore", "cycles": "bpy"}
INSTALL = {"mitsuba": "mitsuba==3.9.1", "luxcore": "pyluxcore==2.11.2", "cycles": "bpy==5.2.3 (for Python 3.13)"}
NAMES = {"abbe": "Abbe", "smallpt": "smallpt", "mitsuba": "Mitsuba 3", "luxcore": "LuxCore"}
NAMES |= {"cycles": "Blender Cycles", "povray": "POV-Ray"}
LLVM = (
    "/usr/lib/*/libLLVM*.so*",
    "/usr/lib/libLLVM*.so*",
    "/usr/lib/llvm-*/lib/libLLVM*.so*",
    "/opt/homebrew/opt/llvm/lib/libLLVM.dylib",
)


class Missing(Exception):
    """Says in one line that a renderer is not installed, and how to install it."""


def first_line(*command: str | Path) -> str:
    run = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    return (run.stdout or run.stderr).strip().splitlines()[0]


def llvm_library() -> str:
    """Returns the file that Mitsuba's llvm variants load: $DRJIT_LIBLLVM_PATH, or the newest one found."""
    if given := os.environ.get("DRJIT_LIBLLVM_PATH"):
        return given
    number = lambda path: [int(digits) for digits in re.findall(r"\d+", Path(path).name)]  # noqa: E731
    found = [path for pattern in LLVM for path in glob.glob(pattern) if number(path)]
    if not found:
        raise Missing("Mitsuba's llvm variants need the library LLVM: apt install libllvm19, or set DRJIT_LIBLLVM_PATH")
    return max(found, key=number)


def version(renderer: str, variant: str = "") -> str:
    """Returns a renderer's entry in the chart's list of versions; raises Missing."""
    if renderer == "abbe":
        return first_line(render.binary(), "--version")
    if renderer == "smallpt":
        if not shutil.which("g++"):
            raise Missing("smallpt needs a C++ compiler: apt install g++")
        flags = " ".join(reference.EXACT_FLAGS)
        return f"tools/smallpt/smallpt.cpp, {first_line('g++', '--version')} -O3 -march=native, run with {flags}"
    if renderer == "povray":
        if not shutil.which("povray"):
            raise Missing("POV-Ray is not installed: apt install povray")
        return povray.version()
    package = PACKAGES[renderer]
    if importlib.util.find_spec(package) is None:
        raise Missing(f"{NAMES[renderer]} is not installed: pip install {INSTALL[renderer]}")
    number = f"{package} {importlib.metadata.version(package)}"
    return f"{number} with {Path(llvm_library()).name}" if variant.startswith("llvm") else number


class Program:
    """A renderer that runs as one process per picture. User and system time of the whole process count."""

    def run(self, samples: int, seed: int) -> tuple[np.ndarray, float]:
        took, code, said = render.measured(self.command(samples, seed))
        if code:
            raise RuntimeError(f"{self.label} failed: {said.strip()[-2000:]}")
        return self.picture(), took.processor

    def close(self) -> None:
        pass


class Abbe(Program):
    """Abbe, on one thread."""

    def __init__(self, label: str, scene: Path, folder: Path):
        self.label, self.scene, self.out = label, scene, folder / "abbe.exr"

    def command(self, samples: int, seed: int) -> list:
        return [render.binary(), self.scene, "--exr", self.out, "--samples", samples, "--seed", seed, "--threads", 1]

    def picture(self) -> np.ndarray:
        return render.read(self.out).rgb


class Smallpt(Program):
    """The 99-line program smallpt."""

    def __init__(self, label: str, scene: Path, folder: Path):
        self.label = label
        self.binary, self.out = reference.compile_program(folder), folder / "smallpt.pfm"
        film = tomllib.loads(scene.read_text("utf-8"))["film"]
        self.size = film["width"], film["height"]

    def command(self, samples: int, seed: int) -> list:
        return [self.binary, samples, *self.size, seed, self.out, *reference.EXACT_FLAGS]

    def picture(self) -> np.ndarray:
        return reference.read_pfm(self.out).astype(np.float64)


class PovRay(Program):
    """POV-Ray. Its `samples` are the quality that tools/peers/povray.py explains."""

    def __init__(self, label: str, scene: Path, folder: Path):
        self.label, self.scene, self.folder = label, scene, folder

    def command(self, samples: int, seed: int) -> list:
        return povray.command(self.scene, samples, seed, self.folder)

    def picture(self) -> np.ndarray:
        return povray.read_picture(self.folder)


class Worker:
    """A renderer that is a Python module, run in a process of its own by tools/chart/worker.py."""

    def __init__(self, series, scene: Path, folder: Path):
        self.label, self.out, self.log = series.label, folder / "picture.npy", folder / "log.txt"
        environment = {**os.environ, "PYTHONPATH": str(TOOLS)}
        if series.variant.startswith("llvm"):
            environment["DRJIT_LIBLLVM_PATH"] = llvm_library()
        words = [series.renderer, series.variant, scene, *(["flat-lamp"] if series.flat_lamp else [])]
        with self.log.open("w") as log:
            self.process = subprocess.Popen(
                [sys.executable, "-m", "chart.worker", *map(str, words)],
                stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=log, text=True, env=environment,
            )  # fmt: skip
        self.answer()

    def answer(self) -> str:
        line = self.process.stdout.readline().strip()
        if not line:
            code = self.process.wait()
            ended = f"\nits process was ended by signal {-code}" if code < 0 else ""
            raise RuntimeError(f"{self.label} failed: {self.log.read_text(errors='replace').strip()[-2000:]}{ended}")
        return line

    def run(self, samples: int, seed: int) -> tuple[np.ndarray, float]:
        with contextlib.suppress(BrokenPipeError):  # it has ended, and its log says why
            self.process.stdin.write(f"{samples} {seed} {self.out}\n")
            self.process.stdin.flush()
        seconds = float(self.answer())
        return np.load(self.out), seconds

    def close(self) -> None:
        """Ends the process, and kills it if it has not ended by itself after 5 seconds."""
        with contextlib.suppress(BrokenPipeError):
            self.process.stdin.close()
        try:
            self.process.wait(5)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.process.stdout.close()


PROGRAMS = {"abbe": Abbe, "smallpt": Smallpt, "povray": PovRay}


def open_renderer(series, scene: Path, folder: Path):
    """Opens the renderer of a series; `folder` is for its files alone."""
    folder.mkdir()
    if series.renderer in PROGRAMS:
        return PROGRAMS[series.renderer](series.label, scene, folder)
    return Worker(series, scene, folder)
