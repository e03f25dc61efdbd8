"""The small scene of the tests of layers, and the forms in which its file can be written."""

import functools
import tempfile
from pathlib import Path
from typing import NamedTuple

import check_exr
import render

WIDTH, HEIGHT = 64, 48
CROP = (20, 11, 31, 26)  # first column, first row, width and height
OVERSCAN = (7, 3, 2, 9)  # columns and rows to the left, above, to the right and below
COMPRESSIONS = tuple(check_exr.LOSSLESS.values())

# A ball, dispersive glass and two cubes of one mesh on a floor, under a lamp, a spot and a sky, so that no layer is
# empty.
SCENE = """
camera = {{ position = [0, 1.6, 6], look_at = [0, 0.7, 0], vertical_fov = 38 }}
film = {{ width = {width}, height = {height}{film} }}
render = {{ samples = 4, seed = 5, model = "rgb" }}
[material]
floor.diffuse.reflectance = {{ rgb = [0.7, 0.5, 0.3] }}
red.plastic = {{ reflectance = {{ rgb = [0.8, 0.1, 0.1] }}, roughness = 0.2 }}
glass.dielectric.index = "N-SF11"
lamp.emissive.radiance = 40
[[object]]
name = "floor"
shape.quad = {{ center = [0, 0, 0], u = [4, 0, 0], v = [0, 0, -4] }}
material = "floor"
[[object]]
name = "ball"
shape.sphere = {{ center = [-0.9, 0.6, 0.3], radius = 0.6 }}
material = "red"
[[object]]
name = "стекло"
shape.sphere = {{ center = [0.7, 0.7, 0.6], radius = 0.7 }}
material = "glass"
[[object]]
name = "cubes"
shape.cube = {{ center = [0, 0.15, 0], size = 0.3 }}
material = "red"
instances = [[{{ translate = [-0.4, 0, 1.8] }}], [{{ translate = [0.1, 0, 2.2] }}]]
[[object]]
name = "board"
shadow_catcher = true
shape.quad = {{ center = [1.9, 0.01, 1.6], u = [0.5, 0, 0], v = [0, 0, -0.6] }}
material = "floor"
[[object]]
name = "key lamp"
shape.sphere = {{ center = [-1, 2.3, -1], radius = 0.15 }}
material = "lamp"
[[light]]
environment.radiance = 0.2
[[light]]
group = "rim"
spot = {{ position = [3, 3, -2], look_at = [0.7, 0.7, 0.6], cone_angle = 40, intensity = 8 }}
"""

# The layers of the file with all layers, with their channels and their minimum number of bits.
LAYERS = {
    **dict.fromkeys(("emission", "background", "direct", "indirect", "caustics", "dispersed", "shadow"), ("RGB", 16)),
    **dict.fromkeys((f"{lobe}_{kind}" for lobe in check_exr.LOBES for kind in ("direct", "indirect")), ("RGB", 16)),
    **dict.fromkeys(("light_key_lamp", "light_environment", "light_rim"), ("RGB", 16)),
    "albedo": ("RGB", 16),
    "N": ("XYZ", 16),
    "Nd": ("XYZ", 16),
    "P": ("XYZ", 32),
    "UV": ("UV", 32),
    "variance": ("RGB", 32),
    "samples": ("V", 32),
    "residual": ("RGB", 32),
    "half_a": ("RGB", 16),
    "half_b": ("RGB", 16),
    **{f"Crypto{of}0{i}": ("rgba", 32) for of in ("Object", "Material", "Asset") for i in range(3)},
}


class Form(NamedTuple):
    """The settings with which a file is rendered."""

    layers: bool = True
    precision: str = "float"
    compression: str = "zip"
    multipart: bool = False
    crop: bool = False
    overscan: bool = False
    sharp: bool = False

    def __str__(self):
        words = ("layers" if self.layers else "plain", self.precision, self.compression)
        return "-".join([*words, *(name for name in ("multipart", "crop", "overscan", "sharp") if getattr(self, name))])

    def scene(self):
        """Returns the text of the scene."""
        film = f', precision = "{self.precision}", compression = "{self.compression}"'
        film += ", multipart = true" if self.multipart else ""
        film += ', layers = "all"' if self.layers else ""
        film += f", crop = {list(CROP)}" if self.crop else ""
        film += ', filter = "mitchell"' if self.sharp else ""
        film += f", overscan = {list(OVERSCAN)}" if self.overscan else ""
        return SCENE.format(width=WIDTH, height=HEIGHT, film=film + ', metadata = { owner = "Émilie", comments = "shot 12" }')

    def bits(self):
        """Returns the channels of the file, with the bits of each."""
        least = 16 if self.precision == "half" else 32
        image = {**dict.fromkeys("RGBA", least), "Z": 32}
        layers = LAYERS.items() if self.layers else ()
        return image | {f"{layer}.{each}": max(least, bits) for layer, (channels, bits) in layers for each in channels}


@functools.cache
def folder():
    return tempfile.TemporaryDirectory()


@functools.cache
def rendered(form):
    """Returns the file of a form. Each is rendered once."""
    path = Path(folder().name) / f"{form}.exr"
    render.write(form.scene(), path)
    return path


@functools.cache
def read(form):
    """Returns the contents of the file of a form."""
    return check_exr.read(rendered(form))
