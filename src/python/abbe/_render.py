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
    """How far a render has got."""

    done: int
    """Camera samples that were taken, and photons, each of which counts as the samples that take as long."""
    total: int
    """All that are to be taken. Where an error or a time ends the render, this is a guess; before the first look at the
    error, after 64 samples of each pixel, it is the most that may be taken."""
    seconds: float
    """Since it began."""

    @property
    def share(self) -> float:
        """The share that is done, 0 to 1."""
        return min(self.done / max(self.total, 1), 1.0)

    def __str__(self) -> str:
        return f"{100 * self.share:.0f} %, {self.seconds:.1f} s passed"


class Plan(NamedTuple):
    """How a scene will be rendered, and why."""

    model: str
    """How spectra are carried."""
    transport: str
    """How light is followed."""
    samples: int
    """Camera samples per pixel, or the most."""
    photons: int | None
    """Photons of all passes, where it is known how many there will be."""
    processor_seconds: float | None
    """Time of all processors together, where it is known how many samples there will be."""
    seconds: float | None
    """Time on this machine, if nothing else keeps its processors busy."""
    model_error: float
    """How far colors may be off, relative to the strongest channel, because spectra are carried in so few lanes."""
    left_out: list[str]
    """What light is left out."""
    words: list[str]
    """The plan in words, a decision each."""

    def __repr__(self) -> str:
        return f"<abbe.Plan: model {self.model}, transport {self.transport}, {self.samples} samples per pixel>"

    def __str__(self) -> str:
        return "\n".join(self.words)


class Scene:
    """A scene that was read and checked, to be rendered several times, or only checked.

    `source` is the path of a scene file, or a dict with the keys of one. A dict may hold numbers, texts, dicts, lists,
    tuples, paths, numbers and arrays of numpy, and entries of the catalog, which stand for their names. Files that it
    names are looked up in `folder`. An image has to be a file, not an array. `set` replaces values of the scene by the
    paths of their keys, such as `{"film.width": 320, "object.ball.material": "gold"}`. Entries of lists are found by
    their name or by their number, counted from 1. A single word sets a variable of the scene: `{"frame": 7}` does what
    `--frame 7` does.

    Raises `SceneError` with all its mistakes, and `FileNotFoundError` if there is no such file.
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
        """What the scene's author should know but need not change."""
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

    The arguments are those of `render` that describe the image. The errors are the same too.
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
    """Renders a scene: a file, a dict with the keys of one, or a `Scene`.

    The image is identical to the last bit to that of the command, for any number of threads. Other Python threads keep
    running meanwhile, and may render as well.

    - `set`, `folder`: as for `Scene`. They cannot be given with a `Scene`, which has its own.
    - `samples`: camera samples per pixel, 1 or more, instead of the scene's; with `error` or `time`, the maximum.
    - `error`: relative error of the image at which to stop, 0.000001 to 1. 0.01 is one percent.
    - `time`: how long it may take, in seconds, or with a unit: `"10m"`.
    - `seed`: chooses another set of random numbers.
    - `overscan`: pixels around the format: one number, or those to the left, above, to the right and below.
    - `crop`: the part of the image to render: first column, first row, width and height in pixels.
    - `layers`: names of layers to make beside the image, or `"all"`; `LAYERS` lists them. The layers of `film.stokes`
      are kept beside them, and `"all"` does not include polarization.
    - `spectral`: whether to make spectra, for `Image.spectrum`.
    - `threads`: processor threads; all of them by default.
    - `stamp`: whether the file says when it was made and how long that took.
    - `progress`: is called twice a second, and at the end, with a `Progress`. An exception that it raises stops the
      render.
    - `checkpoint`: a file that keeps the work done so far, written `every` so many seconds, when the render is stopped,
      and at the end.
    - `resume`: continues from the checkpoint, if there is one, to the same image or to more samples.

    Ctrl-C stops a render within a second, or once its checkpoint is written, by `KeyboardInterrupt`. Other processes
    may render as well, including those that are forked while nothing is rendered. Let them return arrays or write
    files, because an image cannot be pickled.

    `Image.stats["warnings"]` lists, in sentences, what the author should know about the scene and the image.

    Raises `SceneError` if the scene is wrong, `OptionsError` if something impossible is asked for, and `OSError` or
    `RenderError` if reading or writing a file fails.
    """
    asked = locals()
    tell = None
    if progress is not None:
        told = _arguments.function("progress", progress)
        tell = lambda *state: told(Progress(*state))  # noqa: E731
    kept = None if checkpoint is None else _arguments.path("checkpoint", checkpoint)
    resumes = _arguments.truth("resume", resume)
    return Image(_abbe.render(_scene(scene, set, folder), asked, tell, kept, every, resumes))
