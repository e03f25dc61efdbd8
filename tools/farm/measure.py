"""Measures the costs that make up a render in parts."""

from pathlib import Path
from statistics import median
from typing import NamedTuple

import numpy as np
import render

from .model import Work

# The numbers of parts that are merged to find the cost of one, and the number of repeats.
FEW, MANY, REPEATS = 2, 256, 5
# The cost of a part to a merge does not depend on its content: an image of one tile has it too, and renders at once.
BLACK = """
camera = { position = [0, 0, 4], look_at = [0, 0, 0], vertical_fov = 40 }
film = { width = 16, height = 16 }
render.samples = 1
"""
# The number of parts whose times show how much tiles vary.
COMPARED = 8


class Renderer(NamedTuple):
    """Renders a scene into a folder, and returns seconds of processor time."""

    scene: Path
    folder: Path
    threads: int
    samples: int | None  # per pixel; None for those of the scene
    flags: tuple  # further arguments of the command

    def of_scene(self, *words, samples=None):
        samples = samples or self.samples
        samples = ["--samples", samples] if samples else []
        return render.spent(self.scene, "--threads", self.threads, *samples, *self.flags, *words).processor

    def whole(self):
        return self.of_scene("--exr", self.folder / "whole.exr")

    def part(self, number, count, samples=None):
        words = ["--exr", self.folder / "image.exr", "--shard", f"{number}/{count}"]
        return self.of_scene(*words, samples=samples)

    def merge(self, count):
        parts = [self.folder / f"image.{number}-of-{count}.part" for number in range(1, count + 1)]
        return render.spent("merge", self.folder / "image.exr", *parts).processor


def tiles_of(exr):
    """Returns the number of tiles of 16 x 16 pixels in the image."""
    (left, top), (right, bottom) = render.read(exr).header["dataWindow"]
    return int(-(-(right - left + 1) // 16) * -(-(bottom - top + 1) // 16))


def measured(seconds, repeats=3):
    return median(seconds() for _ in range(repeats))


def merged(renderer, count):
    for number in range(1, count + 1):
        renderer.part(number, count, samples=1)
    return measured(lambda: renderer.merge(count), REPEATS)


def merging(renderer):
    """Returns the fixed cost of a merge, and its cost for each part."""
    scene, folder = renderer.folder / "black.toml", renderer.folder / "black"
    scene.write_text(BLACK, "utf-8")
    black = Renderer(scene, folder, threads=1, samples=None, flags=())
    each = max(0.0, merged(black, MANY) - merged(black, FEW)) / (MANY - FEW)
    return max(0.0, merged(renderer, FEW) - FEW * each), each


def measure(renderer):
    start = measured(lambda: render.spent("--version").processor)
    checked = measured(lambda: renderer.of_scene("--check"))
    planned = measured(lambda: renderer.of_scene("--plan"))
    whole = renderer.whole()
    count = tiles_of(renderer.folder / "whole.exr")
    # A part numbered beyond the number of tiles has no tiles: what is left is the work that every part repeats.
    repeated = measured(lambda: renderer.part(count + 1, count + 1))
    tiles = max(0.0, whole - repeated)
    merge, merge_part = merging(renderer)
    compared = min(COMPARED, count)
    costs = np.array([renderer.part(number, compared) for number in range(1, compared + 1)]) - repeated
    # Each part has count / compared tiles, whose random deviations average out by the square root of that number.
    variation = float(costs.std(ddof=1) / costs.mean() * np.sqrt(count / compared)) if compared > 1 else 0.0
    load, plan = max(0.0, checked - start), max(0.0, planned - checked)
    photons = max(0.0, repeated - start - load - plan)
    return Work(start, load, plan, photons, tiles, merge, merge_part, count, variation)
