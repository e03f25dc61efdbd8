"""Scenes for the stability plots, built from those of the validation book, and values read from their images.

from stability.scenes import photograph, view
image = photograph(view([...], eye=(0, 0, 3), rows=64, height=2))
"""

import resource

import numpy as np
import render
from validation import scenes

WHITE_SKY = scenes.SKY
MATERIALS = {
    "black_glass": scenes.glass(1.5, absorption=1e4),
    "lamp": scenes.glow(),
    "white": scenes.diffuse(1),
}


def view(objects, lights=(), materials=None, *, columns=1, rows=1, **more) -> str:
    """Returns a scene's text. `objects` pairs materials with shapes; `more` is passed to the book's `view`."""
    return scenes.toml_file(scenes.view(MATERIALS | (materials or {}), objects, lights, size=(columns, rows), **more))


def photograph(text: str, **flags) -> render.Image:
    """Renders a scene's text on one thread."""
    return render.render(text, threads=1, **flags)


def timed(text: str, **flags) -> tuple[render.Image, float]:
    """Returns the image, and the processor time of the whole program."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    image = photograph(text, **flags)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return image, max(after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime, 1e-3)


def green(text: str, **flags) -> np.ndarray:
    """Returns the green channel of an image whose channels are equal."""
    return photograph(text, **flags).channels["G"].astype(np.float64)


def mean_and_error(text: str, seeds=8, **flags) -> tuple[float, float]:
    """Returns the mean of all pixels, and its standard error from independent seeds."""
    means = [green(text, seed=seed, **flags).mean() for seed in range(1, seeds + 1)]
    return float(np.mean(means)), float(np.std(means, ddof=1) / np.sqrt(seeds))


def fresnel(index: float, cosine):
    """Returns the reflectance of a dielectric for unpolarized light, by the cosine of incidence (Born & Wolf 1.5.2)."""
    cosine = np.clip(cosine, 0, 1)
    beyond = np.sqrt(index**2 - 1 + cosine**2)
    s = (cosine - beyond) / (cosine + beyond)
    p = (index**2 * cosine - beyond) / (index**2 * cosine + beyond)
    return (s**2 + p**2) / 2


def slab(top: float, bottom: float, side=40.0) -> dict:
    """Returns a wide box between two heights."""
    return scenes.cube((0, (top + bottom) / 2, 0), [side, top - bottom, side])
