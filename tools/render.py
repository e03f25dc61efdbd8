"""Finds the renderer, renders a scene and reads its EXR: code that the other tools share.

    from render import read, render
    image = render(scene_text, samples=16, seed=3)
    image.rgb                                   # float64, height x width x 3
"""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np
import OpenEXR

ROOT = Path(__file__).resolve().parent.parent
SCENES = ROOT / "scenes"


class Image(NamedTuple):
    header: dict
    channels: dict  # name -> float array, height x width, as stored

    @property
    def rgb(self):
        return np.stack([self.channels[name] for name in "RGB"], axis=-1).astype(np.float64)


def binary():
    """Returns the path of the renderer: $RENDER if it is set, else the release build."""
    path = Path(os.environ.get("RENDER") or ROOT / "target/release/render").resolve()
    if not path.is_file():
        raise SystemExit(f"{path} does not exist: run `cargo build --release`, or set RENDER to a built binary")
    return path


def said(*words):
    """Returns what a command of the renderer prints."""
    return subprocess.run([binary(), *map(str, words)], capture_output=True, text=True, check=True).stdout


class Spent(NamedTuple):
    """Time and memory that a process took."""

    processor: float  # seconds, summed over all threads
    wall: float  # seconds
    peak: int  # bytes of memory


def measured(command):
    """Runs any command, and returns what it took, its exit code, and its standard error."""
    start = time.monotonic()
    with subprocess.Popen(list(map(str, command)), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) as process:
        complaint = process.stderr.read().decode()
        _, status, used = os.wait4(process.pid, 0)
        wall = time.monotonic() - start
        process.returncode = os.waitstatus_to_exitcode(status)
    peak = used.ru_maxrss * (1 if sys.platform == "darwin" else 1024)
    return Spent(used.ru_utime + used.ru_stime, wall, peak), process.returncode, complaint


def spent(*words):
    """Runs a command of the renderer and returns what it took. If it fails, ends this script with its error."""
    command = [binary(), *words]
    took, code, complaint = measured(command)
    if code:
        raise SystemExit(f"{' '.join(map(str, command))}: exit code {code}\n{complaint}")
    return took


def read(path):
    """Reads an EXR file of one part, with every channel by its name."""
    with OpenEXR.File(str(path), separate_channels=True) as file:
        (part,) = file.parts
        return Image(dict(part.header), {name: channel.pixels.copy() for name, channel in part.channels.items()})


def write(scene, exr, timeout=3600, **flags):
    """Renders `scene` (a path, or a scene's text) into the file `exr`.

    Flags are those of the command line: samples=16. A list gives a flag several times: set=["film.width=64",
    "film.height=48"]. A render that takes longer than `timeout` seconds is an error."""
    if isinstance(scene, str):
        text, scene = scene, Path(exr).with_suffix(".toml")
        scene.write_text(text, "utf-8")
    values = ((name, value) for name, given in flags.items() for value in (given if isinstance(given, list) else [given]))
    arguments = [word for name, value in values for word in (f"--{name}", str(value))]
    command = [str(binary()), str(scene), "--exr", str(exr), *arguments]
    run = subprocess.run(command, capture_output=True, text=True, check=False, timeout=timeout)
    if run.returncode:
        raise RuntimeError(f"{' '.join(command)}: exit code {run.returncode}\n{run.stderr}")


def render(scene, **flags):
    """Renders `scene` and returns its image, through a temporary file."""
    with tempfile.TemporaryDirectory() as folder:
        exr = Path(folder) / "scene.exr"
        write(scene, exr, **flags)
        return read(exr)
