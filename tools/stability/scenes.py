"""Scenes for the stability plots, as TOML text made from numbers, and what is read from their images.

from stability.scenes import photograph, view
image = photograph(view([...], eye=(0, 0, 3), rows=64, height=2))
"""

import resource

import numpy as np
import render

WHITE_SKY = {"environment": {"radiance": 1}}
MATERIALS = {
    "black glass": {"dielectric": {"index": 1.5, "absorption": 1e4}},
    "lamp": {"emissive": {"radiance": 1}},
    "white": {"diffuse": {"reflectance": 1}},
}


def toml(value) -> str:
    """An inline TOML value; floats with all their digits."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f'"{key}" = {toml(item)}' for key, item in value.items()) + " }"
    if isinstance(value, (list, tuple, np.ndarray)):
        return "[" + ", ".join(map(toml, value)) + "]"
    if isinstance(value, (bool, np.bool_)):
        return str(bool(value)).lower()
    if isinstance(value, str):
        return f'"{value}"'
    return repr(int(value) if isinstance(value, (int, np.integer)) else float(value))


def view(
    objects,
    lights=(),
    materials=None,
    *,
    eye,
    target=(0, 0, 0),
    up=(0, 1, 0),
    fov=None,
    height=None,
    columns=1,
    rows=1,
    space=None,
    **settings,
) -> str:
    """A scene's text. `objects` pairs materials with shapes; `fov` is in degrees; or the `height` of a parallel view.

    Without `samples`, rays go through the centers of pixels, and smooth surfaces leave nothing to chance."""
    lens = {"projection": "orthographic", "height": height} if height else {"vertical_fov": fov or 1e-4}
    film = {"width": columns, "height": rows, "filter": "box" if "samples" in settings else "center"}
    tables = {
        "camera": {"position": eye, "look_at": target, "up": up, **lens},
        "film": film | ({"color_space": space} if space else {}),
        "render": {"model": "rgb", **settings},
        "material": MATERIALS | (materials or {}),
        "object": [{"material": name, "shape": shape} for name, shape in objects],
        "light": list(lights),
    }
    return "".join(f"{key} = {toml(value)}\n" for key, value in tables.items())


def photograph(text: str, **flags) -> render.Image:
    """The image of a scene's text on one thread."""
    return render.render(text, threads=1, **flags)


def timed(text: str, **flags) -> tuple[render.Image, float]:
    """The image, and the processor time of the whole program."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    image = photograph(text, **flags)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return image, max(after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime, 1e-3)


def green(text: str, **flags) -> np.ndarray:
    """One channel of an image whose channels are alike."""
    return photograph(text, **flags).channels["G"].astype(np.float64)


def mean_and_error(text: str, seeds=8, **flags) -> tuple[float, float]:
    """Mean of all pixels, and its standard error from independent seeds."""
    means = [green(text, seed=seed, **flags).mean() for seed in range(1, seeds + 1)]
    return float(np.mean(means)), float(np.std(means, ddof=1) / np.sqrt(seeds))


def fresnel(index: float, cosine):
    """Reflectance of unpolarized light at a dielectric, by the cosine of the angle of incidence (Born & Wolf 1.5.2)."""
    cosine = np.clip(cosine, 0, 1)
    beyond = np.sqrt(index**2 - 1 + cosine**2)
    s = (cosine - beyond) / (cosine + beyond)
    p = (index**2 * cosine - beyond) / (index**2 * cosine + beyond)
    return (s**2 + p**2) / 2


def sphere(center=(0.0, 0.0, 0.0), radius=1.0) -> dict:
    return {"sphere": {"center": list(center), "radius": radius}}


def plane(point, normal) -> dict:
    return {"plane": {"point": list(point), "normal": list(normal)}}


def slab(top: float, bottom: float, side=40.0) -> dict:
    """A wide box between two heights."""
    return {"cube": {"center": [0, (top + bottom) / 2, 0], "size": [side, top - bottom, side]}}
