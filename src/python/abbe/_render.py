"""Scenes, plans and renders."""

from __future__ import annotations

import errno
import json
import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple, Union

import numpy as np
import numpy.typing as npt

from . import _abbe, _arguments
from ._arguments import Path
from ._image import Image

Whole = Union[int, "np.integer[Any]"]
Real = Union[float, "np.floating[Any]", Whole]
Pixels = Union[Sequence[Whole], "npt.NDArray[np.integer[Any]]"]
Time = Union[Real, str]


class Progress(NamedTuple):
    """The progress of a render."""

    done: int
    """Work done so far, in camera samples. A photon counts as the number of samples that take as long."""
    total: int
    """All work, in camera samples. If an error or a time ends the render, this is an estimate. With an error alone, it
    is the maximum until the error is first estimated, after 64 samples per pixel."""
    seconds: float
    """Seconds since the render began, or was resumed."""

    @property
    def share(self) -> float:
        """The fraction of the work that is done, 0 to 1."""
        return min(self.done / max(self.total, 1), 1.0)

    def __str__(self) -> str:
        return f"{100 * self.share:.0f} %, {self.seconds:.1f} s passed"


class Plan(NamedTuple):
    """How a scene will be rendered, and why. `print(plan)` shows the reasons."""

    model: str
    """How spectra are represented."""
    transport: str
    """The light transport algorithm."""
    samples: int
    """Camera samples per pixel, or the maximum if an error or a time ends the render."""
    photons: int | None
    """Photons in all passes. None if an error or a time ends the render."""
    processor_seconds: float | None
    """Estimated time of all processors together, in seconds. None if an error or a time ends the render."""
    seconds: float | None
    """Estimated time on this machine, in seconds, if its processors are otherwise idle. None if unknown."""
    model_error: float
    """How far colors may be off because few values represent a spectrum, relative to the strongest channel."""
    left_out: list[str]
    """Descriptions of the light that is left out."""
    words: list[str]
    """The plan in words, one decision per entry."""

    def __repr__(self) -> str:
        return f"<abbe.Plan: model {self.model}, transport {self.transport}, {self.samples} samples per pixel>"

    def __str__(self) -> str:
        return "\n".join(self.words)


class Scene:
    """A scene that was read and checked. It can be rendered several times.

    - `source`: the path of a scene file, or a dict with the keys of one. A dict may contain numbers, strings, booleans,
      dicts, lists, tuples, paths, numbers and arrays of numpy, and entries of the catalog, which stand for their names.
      Images are given by the path of a file, not as arrays.
    - `set`: values that replace those of the scene, by the paths of their keys, such as
      `{"film.width": 320, "object.ball.material": "gold"}`. Entries of lists are found by name, or by number from 1. A
      single word sets a variable of the scene: `{"frame": 7}` corresponds to `--frame 7` of the command.
    - `folder`: where to look for the files named in a dict.

    Raises `SceneError` if the scene contains mistakes, and `FileNotFoundError` if there is no such file.
    """

    def __init__(
        self, source: Path | Mapping[str, Any], *, set: Mapping[str, Any] | None = None, folder: Path = ""
    ) -> None:
        settings = None if set is None else _arguments.settings(set)
        source = os.fsdecode(source) if isinstance(source, bytes) else source
        if isinstance(source, Scene):
            raise TypeError("this is a scene already: Scene(..) takes what it is made of, a dict or the path of a file")
        if isinstance(source, str) and (loads := _loads(source)):
            message = f"a scene is the path of a file or a dict: {loads} makes a dict of its text"
            raise FileNotFoundError(errno.ENOENT, message)
        self._core = _abbe.Scene.compile(source, _arguments.path("folder", folder), settings)

    def __repr__(self) -> str:
        width, height = self._core.size
        objects = "1 object" if self._core.objects == 1 else f"{self._core.objects} objects"
        return f"<abbe.Scene of {objects}, {width} x {height} pixels>"

    @property
    def warnings(self) -> list[str]:
        """Warnings about the scene, in sentences. They do not prevent a render."""
        return self._core.warnings


def _loads(source: str) -> str | None:
    """Returns the function that parses `source`, if it is the text of a scene rather than its path."""
    is_json = source.lstrip().startswith("{")
    if (is_json or "\n" in source) and not os.path.lexists(source):
        return "json.loads" if is_json else "tomllib.loads"
    return None


def _scene(scene: Path | Mapping[str, Any] | Scene, set: Mapping[str, Any] | None, folder: Path) -> _abbe.Scene:
    if isinstance(scene, Scene):
        if set is not None:
            raise TypeError("values are set in a scene when it is made: Scene(.., set=..)")
        if folder != "":
            raise TypeError("the folder of a scene is given when it is made: Scene(.., folder=..)")
        return scene._core
    return Scene(scene, set=set, folder=folder)._core


def plan(
    scene: Path | Mapping[str, Any] | Scene,
    *,
    set: Mapping[str, Any] | None = None,
    folder: Path = "",
    samples: Whole | None = None,
    error: Real | None = None,
    time: Time | None = None,
    seed: Whole | None = None,
    overscan: Whole | Pixels | None = None,
    crop: Pixels | None = None,
    layers: Sequence[str] | str | None = None,
    spectral: bool = False,
    threads: Whole | None = None,
) -> Plan:
    """Plans a render without rendering: how it would be done, why, and how long it would take.

    Takes the arguments of `render` that describe the image, and raises the same errors.
    """
    account, on = _abbe.plan(_scene(scene, set, folder), locals())
    found = json.loads(account)
    seconds = found["processor_seconds"] and found["processor_seconds"] / on
    return Plan(words=found.pop("because"), seconds=seconds, **found)


def render(
    scene: Path | Mapping[str, Any] | Scene,
    *,
    set: Mapping[str, Any] | None = None,
    folder: Path = "",
    samples: Whole | None = None,
    error: Real | None = None,
    time: Time | None = None,
    seed: Whole | None = None,
    overscan: Whole | Pixels | None = None,
    crop: Pixels | None = None,
    layers: Sequence[str] | str | None = None,
    spectral: bool = False,
    threads: Whole | None = None,
    stamp: bool = False,
    progress: Callable[[Progress], object] | None = None,
    checkpoint: Path | None = None,
    every: Time = 60.0,
    resume: bool = False,
) -> Image:
    """Renders a scene, and returns its image. The arguments from `samples` to `layers` replace settings of the scene.

    - `scene`: the path of a scene file, a dict with the keys of one, or a `Scene`.
    - `set`, `folder`: as for `Scene`. They cannot be given with a `Scene`, which has its own.
    - `samples`: camera samples per pixel, 1 or more. With `error` or `time`, this is the maximum, and the scene's own
      number is ignored.
    - `error`: take samples until the relative error of the image is at most this in 95 of 100 renders, 0.000001 to 1.
      0.01 is one percent.
    - `time`: how long the render may take, in seconds, or a string with a unit (`ms`, `s`, `m` or `h`): `"10m"`.
    - `seed`: selects another set of random numbers, 0 to 2**64 - 1.
    - `overscan`: extra pixels around the format: one number for all sides, or left, top, right and bottom.
    - `crop`: the part of the image to render: first column, first row, width and height in pixels. In the overscan,
      the first column and row may be negative.
    - `layers`: a list of names of layers to render in addition to the image, or `"all"`. `LAYERS` has all names. S1, S2
      and S3 stay if the scene sets `film.stokes`. `"all"` does not include the layers of polarization.
    - `spectral`: whether to render spectra, even if the scene does not request them.
    - `threads`: the number of threads, 1 to 1024. By default, one for each processor.
    - `stamp`: whether files written by `Image.write_exr` record when the image was rendered, how long that took, and on
      how many threads.
    - `progress`: a function that is called with a `Progress`, twice a second and at the end. If it raises an exception,
      the render stops.
    - `checkpoint`: a file in which to save the work done so far. It is written at intervals, when the render is
      stopped, and at the end. An existing checkpoint is refused without `resume`.
    - `every`: the time between two writes of the checkpoint, in seconds, or a string such as `"10m"`.
    - `resume`: whether to continue from the checkpoint, if it exists, to the same image or to more samples.

    The image has the same bits as that of the command, for any number of threads. Other Python threads keep running
    during a render, and may render as well. So may other processes, including those that are forked while nothing is
    being rendered. They should return arrays or write files, because an image cannot be pickled.

    Ctrl-C raises `KeyboardInterrupt` within a second, or once the checkpoint is written.

    `Image.stats["warnings"]` lists warnings about the scene and the image, in sentences.

    Raises `SceneError` if the scene contains mistakes, `OptionsError` if an argument has a value that is not allowed,
    and `OSError` or `RenderError` if a file cannot be read or written.
    """
    asked = locals()
    tell = None
    if progress is not None:
        told = _arguments.function("progress", progress)
        tell = lambda *state: told(Progress(*state))  # noqa: E731
    kept = None if checkpoint is None else _arguments.path("checkpoint", checkpoint)
    resumes = _arguments.truth("resume", resume)
    return Image(_abbe.render(_scene(scene, set, folder), asked, tell, kept, every, resumes))
