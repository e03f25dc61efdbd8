"""Dyes: light that comes back at other wavelengths, against sums over their matrices, nm by nm from 300 to 830.

A dye shines Q a(i) e(o) i / o at the wavelength o of what comes at i, in power: of a photon that is absorbed, with a, one
leaves with the chance Q, and e is its emission in photons. Beside it paper reflects 0.92 - a.
"""

from typing import NamedTuple

import numpy as np

import colors

from . import readers
from .color import XYZ
from .row import Row
from .scenes import sphere, view

NM = np.arange(300.0, 831.0)
# The eye sees none of what lies below 360 nm.
OBSERVER = np.stack([np.interp(NM, colors.WAVELENGTHS, axis, left=0) for axis in colors.OBSERVER.values.T])
# Between so many wavelengths spectra are splines: by how much that may move a color, of its largest number.
LANES, SMOOTH = {"bands": 32}, 3e-4
POWER = "a quantum yield of power, and not of photons"


class Dye(NamedTuple):
    """Bells of what is absorbed, 0.9 at most, and of the photons that shine: their middle and deviation in nm."""

    name: str
    absorbs: tuple[float, float]
    shines: tuple[float, float]
    quantum_yield: float

    @property
    def absorbed(self):
        return 0.9 * bell(*self.absorbs)

    @property
    def glow(self):
        """Power per nm of 1 in all."""
        power = bell(*self.shines) / NM
        return power / power.sum()

    @property
    def excited(self):
        """Power that shines of a power of 1 at each wavelength."""
        photons = bell(*self.shines)
        return self.quantum_yield * self.absorbed * NM * (photons / NM).sum() / photons.sum()

    @property
    def in_power(self):
        """The same by mistake."""
        return self.quantum_yield * self.absorbed

    def material(self):
        samples = {
            "reflectance": 0.92 - self.absorbed,
            "absorption": self.absorbed,
            "emission": 1000 * bell(*self.shines) / NM,
        }
        curves = {key: {"samples": np.column_stack([NM, values]).tolist()} for key, values in samples.items()}
        dye = {"absorption": curves["absorption"], "emission": curves["emission"], "quantum_yield": self.quantum_yield}
        return {"diffuse": {"reflectance": curves["reflectance"], "fluorescence": dye}}


def bell(middle, deviation):
    return np.exp(-0.5 * ((NM - middle) / deviation) ** 2)


DYES = (
    Dye("yellow dye", (450, 25), (520, 20), 0.9),
    Dye("red dye", (540, 25), (600, 20), 0.8),
    Dye("brightener", (365, 20), (440, 22), 0.85),
)


def illuminant(name):
    """Power per nm with Y = 1, with its ultraviolet light."""
    table = colors.colour.SDS_ILLUMINANTS[name]
    power = np.interp(NM, table.wavelengths, table.values, left=0, right=0)
    return power / (OBSERVER[1] @ power)


def room(dye, excited, opacity, light):
    """Radiance in a closed room that the dye covers by an opacity; light comes from outside."""
    left = 1 - opacity * (0.92 - dye.absorbed)
    outside = (1 - opacity) * light
    brightness = (excited * outside / left).sum() / (1 - opacity * (excited * dye.glow / left).sum())
    return OBSERVER @ ((outside + opacity * brightness * dye.glow) / left)


def rows(quick):
    # FL11 has no ultraviolet light.
    for dye, names in zip(DYES, (("D65", "A", "FL11"), ("D65", "A", "FL11"), ("D65", "A")), strict=True):
        yield from (patch(dye, name) for name in names)
        yield ball(dye, quick)


def row(name, formula, scene, expected, mistaken, words, seeds=1):
    """Of those of X, Y and Z that the mistake changes."""
    bound = SMOOTH * np.abs(expected).max()
    told = np.abs(mistaken - expected) > 8 * bound
    return Row(
        "dyes",
        name,
        formula,
        scene,
        lambda image: readers.colors(image)[:, told],
        expected[told],
        POWER,
        mistaken[told],
        words,
        seeds,
        rounding=np.full(told.sum(), bound),
    )


def patch(dye, name):
    light = illuminant(name)
    expected, mistaken = (
        OBSERVER @ ((0.92 - dye.absorbed) * light + (excited @ light) * dye.glow)
        for excited in (dye.excited, dye.in_power)
    )
    scene = colors.patches_scene([0], {"illuminant": name}, LANES, XYZ)
    scene["material"] = {"m0": dye.material()}
    scene["render"]["samples"] = 1
    words = (
        f"A diffuse patch that reflects 0.92 - a and has a dye of absorption a = 0.9 exp(-((nm - {dye.absorbs[0]}) / "
        f"{dye.absorbs[1]})^2 / 2), emission in photons exp(-((nm - {dye.shines[0]}) / {dye.shines[1]})^2 / 2) and "
        f"quantum yield {dye.quantum_yield}, under an even sky of {name}, Y = 1, in CIE XYZ."
    )
    formula = "sum of light x (reflectance + Q a e i / o) x observer"
    return row(f"{dye.name} under {name}", formula, scene, expected, mistaken, words)


def ball(dye, quick, opacity=0.8):
    light = illuminant("D65")
    expected, mistaken = (room(dye, excited, opacity, light) for excited in (dye.excited, dye.in_power))
    scene = view(
        {"dyed": dye.material(), "wall": {"mask": {"material": "dyed", "opacity": opacity}}},
        [("wall", sphere())],
        [{"environment": {"radiance": {"illuminant": "D65"}}}],
        eye=(0, 0, 0),
        target=(0, 0, 1),
        fov=20,
        size=16 if quick else 24,
        space=XYZ,
        samples=128 if quick else 256,
        model=LANES,
    )
    words = (
        f"The inside of a ball whose wall covers {opacity} of all directions with the {dye.name} of the row above, and "
        f"lets the rest of the light through; outside an even sky of D65, Y = 1, in CIE XYZ."
    )
    formula = "(1 - opacity (reflectance + Q a e i / o))^-1 (1 - opacity) E"
    return row(f"ball of {dye.name} with holes", formula, scene, expected, mistaken, words, 2)
