"""Abbe: a spectral, HDR, offline renderer.

    import abbe
    image = abbe.render("scene.toml", samples=16)
    image.rgb                      # linear red, green and blue: float32, height x width x 3
    image.write_exr("scene.exr")

A scene is a TOML file, or a dict with the same keys. Lengths are in scene units, wavelengths in nm.
"""

from . import catalog
from ._abbe import LAYERS, __version__
from ._errors import Mistake, OptionsError, RenderError, SceneError
from ._exr import Difference, ExrImage, diff, read_exr
from ._image import Image, Spectrum
from ._render import Plan, Progress, Scene, plan, render

__all__ = [
    "LAYERS",
    "Difference",
    "ExrImage",
    "Image",
    "Mistake",
    "OptionsError",
    "Plan",
    "Progress",
    "RenderError",
    "Scene",
    "SceneError",
    "Spectrum",
    "__version__",
    "catalog",
    "diff",
    "plan",
    "read_exr",
    "render",
]

# Tracebacks and help name the module in which users find these names.
for _name in __all__:
    if hasattr(globals()[_name], "__module__"):
        globals()[_name].__module__ = __name__
