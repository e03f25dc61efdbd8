"""Dyes: light re-emitted at other wavelengths, against sums over their matrices, nm by nm from 300 to 830.

A dye turns power at the wavelength i into power Q a(i) e(o) i / o at the wavelength o. It absorbs a photon with the
share a, and emits one with the probability Q; e is its emission spectrum in photons. The paper beneath it reflects
0.92 - a.

Dye and paper are exact except for rounding: 32 lanes read the paper's reflectance so that its color is right under each
light.
"""

from typing import NamedTuple

import numpy as np

import colors

from . import readers
from .color import XYZ, observer
from .row import LIMIT, Row
from .scenes import sphere, view

NM = np.arange(300.0, 831.0)
# The eye sees no light below 360 nm.
OBSERVER = np.stack([np.interp(NM, colors.WAVELENGTHS, axis, left=0) for axis in colors.OBSERVER.values.T])
LANES = {"bands": 32}
POWER = "a quantum yield of power, and not of photons"
# Relative to the largest number of a color.
EXACT = 1e-5


class Dye(NamedTuple):
    """Gaussian bells of absorption, 0.9 at most, and of emission in photons: their middle and deviation in nm."""

    name: str
    absorbs: tuple[float, float]
    shines: tuple[float, float]
    quantum_yield: float

    @property
    def absorbed(self):
        return 0.9 * bell(*self.absorbs)

    @property
    def glow(self):
        """Emitted power per nm, with a total of 1."""
        power = bell(*self.shines) / NM
        return power / power.sum()

    @property
    def excited(self):
        """Emitted power for a power of 1 at each wavelength."""
        photons = bell(*self.shines)
        return self.quantum_yield * self.absorbed * NM * (photons / NM).sum() / photons.sum()

    @property
    def in_power(self):
        """Emitted power, if the quantum yield were mistaken for a yield of power."""
        return self.quantum_yield * self.absorbed

    @property
    def paper(self):
        """Reflectance of the paper."""
        return 0.92 - self.absorbed

    def material(self, paper=None, absorbed=None, covers=1.0):
        """Returns the dye on paper, or on another reflectance.

        For a wall that covers only a share `covers` of its area, both are scaled as if it covered all."""
        paper = self.paper if paper is None else paper
        absorbed = self.absorbed if absorbed is None else absorbed
        curve = lambda values: {"samples": samples(values)}  # noqa: E731
        dye = {
            "absorption": curve(absorbed / covers),
            "emission": curve(1000 * bell(*self.shines) / NM),
            "quantum_yield": self.quantum_yield,
        }
        reflectance = curve(paper / covers)
        return {"diffuse": {"reflectance": reflectance, "fluorescence": dye}}


def samples(values):
    return np.column_stack([NM, values]).tolist()


def bell(middle, deviation):
    return np.exp(-0.5 * ((NM - middle) / deviation) ** 2)


DYES = (
    Dye("yellow dye", (450, 25), (520, 20), 0.9),
    Dye("red dye", (540, 25), (600, 20), 0.8),
    Dye("brightener", (365, 20), (440, 22), 0.85),
)


def illuminant(name):
    """Returns the power per nm with Y = 1, including ultraviolet light."""
    table = colors.colour.SDS_ILLUMINANTS[name]
    power = np.interp(NM, table.wavelengths, table.values, left=0, right=0)
    return power / (OBSERVER[1] @ power)


def room(dye, excited, opacity, outside):
    """Returns XYZ inside a closed room that the dye covers with an opacity, into which light comes from outside."""
    left = 1 - opacity * dye.paper
    brightness = (excited * outside / left).sum() / (1 - opacity * (excited * dye.glow / left).sum())
    return OBSERVER @ ((outside + opacity * brightness * dye.glow) / left)


def rows(quick):
    for dye in DYES:
        for name in ("D65", "A", "FL11"):
            yield patch(dye, name)
            yield paper(dye, name)
            yield glowing(dye, name)
        yield lit_by_lines(dye)
        yield ball(dye, quick)
        yield closed(dye, quick)
        yield closed_paper(dye, quick)
    for least in (360, 380):
        yield sharper(DYES[2], least)


def row(name, formula, scene, expected, mistaken, words, seeds=1, guards=POWER, told=8 * EXACT):
    """Returns a row that ignores what the mistake changes by less than `told` of the largest number."""
    largest = np.abs(expected).max()
    mistaken = np.where(np.abs(mistaken - expected) > told * largest, mistaken, expected)
    return Row(
        "dyes",
        name,
        formula,
        scene,
        readers.colors,
        expected,
        guards,
        mistaken,
        words,
        seeds,
        rounding=np.full(3, EXACT / LIMIT * largest),
    )


def under(material, light):
    """Returns a patch under a uniform sky."""
    scene = colors.patches_scene([0], light, LANES, XYZ)
    scene["material"] = {"m0": material}
    scene["render"]["samples"] = 1
    return scene


def described(dye, paper="reflects 0.92 - a and "):
    return (
        f"A diffuse patch that {paper}has a dye of absorption a = 0.9 exp(-((nm - {dye.absorbs[0]}) / "
        f"{dye.absorbs[1]})^2 / 2), emission in photons exp(-((nm - {dye.shines[0]}) / {dye.shines[1]})^2 / 2) and "
        f"quantum yield {dye.quantum_yield}"
    )


def patch(dye, name):
    light = illuminant(name)
    expected, mistaken = (
        OBSERVER @ (dye.paper * light + (excited @ light) * dye.glow) for excited in (dye.excited, dye.in_power)
    )
    guards = POWER
    if np.abs(mistaken - expected).max() < 8 * EXACT * expected.max():
        guards, mistaken = "a dye that does not shine", OBSERVER @ (dye.paper * light)
    words = f"{described(dye)}, under an even sky of {name}, Y = 1, in CIE XYZ."
    formula = "sum of light x (reflectance + Q a e i / o) x observer"
    scene = under(dye.material(), {"illuminant": name})
    return row(f"{dye.name} under {name}", formula, scene, expected, mistaken, words, guards=guards)


def paper(dye, name):
    light = illuminant(name)
    expected = OBSERVER @ (dye.paper * light)
    reflectance = {"samples": samples(dye.paper)}
    return row(
        f"the paper of the {dye.name} under {name}",
        "sum of light x reflectance x observer",
        under({"diffuse": {"reflectance": reflectance}}, {"illuminant": name}),
        expected,
        expected + (dye.excited @ light) * (OBSERVER @ dye.glow),
        f"The same patch without its dye, under an even sky of {name}, Y = 1, in CIE XYZ.",
        guards="light that shines where no dye is",
    )


def glowing(dye, name):
    """Returns a row for the dye on black: no lane stands for what it reflects."""
    light = illuminant(name)
    expected, mistaken = ((excited @ light) * (OBSERVER @ dye.glow) for excited in (dye.excited, dye.in_power))
    return row(
        f"{dye.name} alone under {name}",
        "sum of light x Q a e i / o x observer",
        under(dye.material(0 * NM), {"illuminant": name}),
        expected,
        mistaken,
        f"{described(dye, 'reflects nothing and ')}, under an even sky of {name}, Y = 1, in CIE XYZ.",
    )


def lit_by_lines(dye):
    lines = np.array([365.0, 436.0, 546.0])
    at = lambda values: np.interp(lines, NM, values)  # noqa: E731
    reflected = observer(colors.OBSERVER, lines) @ at(dye.paper)
    glow = observer(colors.OBSERVER, NM) @ dye.glow
    expected, mistaken = (reflected + at(excited).sum() * glow for excited in (dye.excited, dye.in_power))
    return row(
        f"{dye.name} under three lines",
        "sum of lines x (reflectance + Q a e i / o) x observer",
        under(dye.material(), {"lines": [[float(nm), 1] for nm in lines]}),
        expected,
        mistaken,
        f"{described(dye)}, under an even sky of lines at {lines.tolist()} nm, in CIE XYZ.",
    )


def sharper(dye, least):
    """Returns a row for a dye that only longer waves excite."""
    light = illuminant("D65")
    absorbed = np.where(NM < least, 0, dye.absorbed)
    expected, mistaken = (
        OBSERVER @ (dye.paper * light + (excited @ light) * dye.glow)
        for excited in (np.where(NM < least, 0, dye.excited), dye.excited)
    )
    return row(
        f"{dye.name} that absorbs from {least} nm on",
        "sum of light x (reflectance + Q a e i / o) x observer",
        under(dye.material(absorbed=absorbed), {"illuminant": "D65"}),
        expected,
        mistaken,
        f"{described(dye)}, whose a is 0 below {least} nm, under an even sky of D65, Y = 1, in CIE XYZ.",
        guards="ultraviolet light that excites all the same",
    )


def within(material, opacity, size, samples, scale=1.0):
    """Returns a scene with the camera inside a ball with holes in its wall, under a uniform sky of D65."""
    return view(
        {"dyed": material, "wall": {"mask": {"material": "dyed", "opacity": opacity}}},
        [("wall", sphere())],
        [{"environment": {"radiance": {"illuminant": "D65", "scale": scale}}}],
        eye=(0, 0, 0),
        target=(0, 0, 1),
        fov=20,
        size=size,
        space=XYZ,
        samples=samples,
        model=LANES,
    )


def ball(dye, quick, opacity=0.8):
    outside = (1 - opacity) * illuminant("D65")
    expected, mistaken = (room(dye, excited, opacity, outside) for excited in (dye.excited, dye.in_power))
    words = (
        f"The inside of a ball whose wall covers {opacity} of all directions with the {dye.name} of the row above, and "
        f"lets the rest of the light through; outside an even sky of D65, Y = 1, in CIE XYZ."
    )
    formula = "(1 - opacity (reflectance + Q a e i / o))^-1 (1 - opacity) E"
    scene = within(dye.material(), opacity, *((16, 128) if quick else (24, 256)))
    return row(f"ball of {dye.name} with holes", formula, scene, expected, mistaken, words, 2, told=0.0024)


# The share of a closed room's wall that is holes, through which its light comes.
HOLES = 0.05


def few(quick):
    """Returns pixels along a side and samples; paths in closed rooms are long."""
    return (16, 12) if quick else (16, 64)


def closed(dye, quick):
    """Returns a row for a room that acts as if it had no holes and its wall emitted light.

    The wall is scaled up in reflectance and absorption to make up for its holes."""
    expected, mistaken = (room(dye, excited, 1, illuminant("D65")) for excited in (dye.excited, dye.in_power))
    return row(
        f"closed room of {dye.name}",
        "(1 - reflectance - Q a e i / o)^-1 E",
        within(dye.material(covers=1 - HOLES), 1 - HOLES, *few(quick), 1 / HOLES),
        expected,
        mistaken,
        f"The inside of a ball; reflectance and absorption of the {dye.name} are divided by {1 - HOLES}, of which the "
        f"wall covers all directions; outside an even sky of D65, Y = {1 / HOLES:g}, in CIE XYZ.",
        2,
        told=0.04,
    )


def closed_paper(dye, quick):
    light = illuminant("D65")
    reflectance = {"samples": samples(dye.paper / (1 - HOLES))}
    return row(
        f"closed room of the paper of the {dye.name}",
        "(1 - reflectance)^-1 E",
        within({"diffuse": {"reflectance": reflectance}}, 1 - HOLES, *few(quick), 1 / HOLES),
        OBSERVER @ (light / (1 - dye.paper)),
        room(dye, dye.excited, 1, light),
        "The closed room above, without its dye.",
        2,
        guards="light that shines where no dye is",
        told=0.04,
    )
