"""Finds the renderer, renders a scene and reads its EXR: what the checkers share.

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
    """$RENDER if it is set, else the release build."""
    path = Path(os.environ.get("RENDER") or ROOT / "target/release/render").resolve()
    if not path.is_file():
        raise SystemExit(f"{path} does not exist: run `cargo build --release`, or set RENDER to a built binary")
    return path


def said(*words):
    """What a command of the renderer prints."""
    return subprocess.run([binary(), *map(str, words)], capture_output=True, text=True, check=True).stdout


class Spent(NamedTuple):
    """What a process took."""

    processor: float  # seconds, of all threads
    wall: float  # seconds
    peak: int  # bytes of memory


def measured(command):
    """What any command takes, its exit code, and what it says of errors."""
    start = time.monotonic()
    with subprocess.Popen(list(map(str, command)), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) as process:
        complaint = process.stderr.read().decode()
        _, status, used = os.wait4(process.pid, 0)
        wall = time.monotonic() - start
        process.returncode = os.waitstatus_to_exitcode(status)
    peak = used.ru_maxrss * (1 if sys.platform == "darwin" else 1024)
    return Spent(used.ru_utime + used.ru_stime, wall, peak), process.returncode, complaint


def spent(*words):
    """What a command of the renderer takes; one that fails ends this script with its words."""
    command = [binary(), *words]
    took, code, complaint = measured(command)
    if code:
        raise SystemExit(f"{' '.join(map(str, command))}: exit code {code}\n{complaint}")
    return took


def read(path):
    """The only part of an EXR file, every channel by its name."""
    with OpenEXR.File(str(path), separate_channels=True) as file:
        (part,) = file.parts
        return Image(dict(part.header), {name: channel.pixels.copy() for name, channel in part.channels.items()})


def write(scene, exr, timeout=3600, **flags):
    """Renders `scene` (a path, or a scene's text) into the file `exr`; flags as on the command line: samples=16; those
    that are given several times: set=["film.width=64", "film.height=48"].

    A render that takes longer than `timeout` seconds is an error."""
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
    """The image of `scene`, by way of a temporary file."""
    with tempfile.TemporaryDirectory() as folder:
        exr = Path(folder) / "scene.exr"
        write(scene, exr, **flags)
        return read(exr)
