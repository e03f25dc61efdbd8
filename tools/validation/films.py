"""Films in which light interferes, against the matrices of Abeles (1950), at single wavelengths and in daylight.

A layer of n - i k and thickness D has M = [[cos d, i sin d / y], [i y sin d, cos d]], d = 2 pi q D / wavelength, with
q = n cos and the admittances y = q of s, n^2 / q of p; (B, C) = M (1, y of the body) reflects the share
|(y B - C) / (y B + C)|^2.
"""

import numpy as np

import colors

from . import formulas, readers
from .color import XYZ, line_powers
from .plates import looking_down
from .row import ROUNDING, Row
from .scenes import glass, glow, plane, view

GROUP = "films"
LINES = (450.0, 550.0, 650.0)
UNCOATED = "the surface without its layers"
PANE = "a pane in which light does not interfere"
QUARTER = 550 / 4


def shares(layers, body, degrees, nm):
    """What is reflected of unpolarized light and what crosses, at each wavelength, from air by layers (index n - i k,
    thickness in nm, from the outside inward) into a body."""
    along = np.sin(np.radians(degrees)) ** 2
    found = []
    for p in (False, True):

        def root(index):
            # Waves fade out in the direction in which light goes.
            q = np.sqrt(np.asarray(index, complex) ** 2 - along)
            return np.where(q.imag > 0, -q, q)

        def admittance(index):
            return np.asarray(index, complex) ** 2 / root(index) if p else root(index)

        start, end = admittance(1), admittance(body) + 0 * nm
        b, c = np.ones_like(end), end
        for index, thickness in reversed(layers):
            y, phase = admittance(index), 2 * np.pi * root(index) * thickness / nm
            b, c = np.cos(phase) * b + 1j * np.sin(phase) / y * c, 1j * y * np.sin(phase) * b + np.cos(phase) * c
        whole = start * b + c
        found.append((np.abs((start * b - c) / whole) ** 2, 4 * start.real * end.real / np.abs(whole) ** 2))
    return np.mean(found, axis=0)


def coating(layers):
    return [
        {"index": index.real, "k": -index.imag, "thickness_nm": thickness}
        for index, thickness in ((complex(index), float(thickness)) for index, thickness in layers)
    ]


def seen(name, material, degrees, expected, guards, mistake, words, *, behind=False):
    """A flat surface in the light of three lines, and the share of each."""
    powers, amplified = line_powers(LINES)
    lamp = plane((0, -5, 0), (0, 1, 0)) if behind else plane((0, 30, 0), (0, -1, 0))
    surface = plane((0, 0, 0), (0, 1, 0))
    if behind:
        surface = {"quad": {"center": [0.0, 0.0, 0.0], "u": [90.0, 0.0, 0.0], "v": [0.0, 0.0, -90.0]}}
    scene = view(
        {"surface": material, "glow": glow({"lines": [[nm, 1] for nm in LINES]})},
        [("surface", surface), ("glow", lamp)],
        eye=looking_down(degrees),
        up=(0, 0, 1),
        model="auto",
        space=XYZ,
    )
    words = f"{words}, at {degrees} degrees, in the light of lines at {LINES} nm; in CIE XYZ."
    read = lambda image: readers.colors(image) @ powers.T  # noqa: E731
    return Row(
        GROUP, name, "matrices of Abeles", scene, read, expected, guards, mistake, words, rounding=ROUNDING * amplified
    )


def coated(name, layers, body, index, angles, words):
    """Of an index at the lines."""
    nm = np.array(LINES)
    ((kind, keys),) = body.items()
    for degrees in angles:
        expected, bare = (shares(stack, index, degrees, nm)[0] for stack in (layers, []))
        material = {kind: keys | {"coating": coating(layers)}}
        yield seen(f"{name} at {degrees} degrees", material, degrees, expected, UNCOATED, bare, words)


def stacks(quick):
    crown = formulas.index("N-BK7", np.array(LINES))
    yield from coated(
        "a quarter wave of magnesium fluoride on N-BK7",
        [(1.38, QUARTER / 1.38)],
        glass("N-BK7"),
        crown,
        (0, 30, 45, 60, 75),
        "N-BK7 under a layer of index 1.38, a quarter wave thick at 550 nm",
    )
    for pairs in (1, 3, 5, 9):
        high, low = (2.35, QUARTER / 2.35), (1.38, QUARTER / 1.38)
        yield from coated(
            f"a mirror of {2 * pairs + 1} layers",
            [high, low] * pairs + [high],
            glass(1.52),
            1.52,
            (0, 45),
            f"Glass of index 1.52 under {2 * pairs + 1} layers of 2.35 and 1.38 in turn, quarter waves at 550 nm",
        )
    yield from coated(
        "a layer that absorbs",
        [(2.3 - 0.1j, 100)],
        glass(1.5),
        1.5,
        (0, 30, 60),
        "Glass of index 1.5 under 100 nm of 2.3 - 0.1i",
    )
    metal = 1.015 - 6.627j
    yield from coated(
        "glass on aluminum",
        [(1.46, 100)],
        {"conductor": {"n": metal.real, "k": -metal.imag}},
        metal,
        (0, 60, 75),
        "A metal of 1.015 - 6.627i under 100 nm of index 1.46",
    )


def soap(quick):
    """Films that stand free, reflected and seen through; and their colors."""
    nm = np.array(LINES)
    for thickness in (100, 200, 400, 1000):
        material = {"thin": {"index": 1.33, "thickness_nm": thickness}}
        words = f"A soap film of index 1.33, {thickness} nm thick"
        for degrees in (0, 45):
            both = shares([(1.33, thickness)], 1.0, degrees, nm)
            pane = formulas.slab(1.33, degrees)
            for which, behind in (("R", False), ("T", True)):
                name = f"{which} of {thickness} nm of soap at {degrees} degrees"
                told = [values[int(behind)] for values in (both, pane)]
                yield seen(name, material, degrees, told[0], PANE, told[1], words, behind=behind)


def lab(xyz, white):
    return colors.colour.XYZ_to_Lab(xyz, colors.colour.XYZ_to_xy(white))


def daylight(name, material, layers, body, degrees, words):
    """The color of a film under D65 in the lanes that the plan chooses: at most 0.5 dE2000 away."""
    light = colors.illuminant("D65")
    reflected = shares(layers, body(light.nm), degrees, light.nm)[0]
    of = lambda share: (light.power * share) @ colors.OBSERVER.values  # noqa: E731
    expected, white, gray = of(reflected), of(1), of(reflected.mean())
    scene = view(
        {"film": material, "glow": glow(light.curve)},
        [("film", plane((0, 0, 0), (0, 1, 0))), ("glow", plane((0, 30, 0), (0, -1, 0)))],
        eye=looking_down(degrees),
        up=(0, 0, 1),
        model="auto",
        space=XYZ,
    )

    def away(xyz):
        return colors.colour.delta_E(lab(xyz, white), lab(expected, white), method="CIE 2000")

    return Row(
        GROUP,
        f"{name} at {degrees} degrees in daylight",
        "dE2000 from the sum of light x reflectance x observer: 0",
        scene,
        lambda image: away(readers.colors(image)).reshape(-1, 1),
        0.0,
        "the gray of its mean reflectance",
        float(away(gray)),
        f"{words}, under D65 at {degrees} degrees, in the lanes that the plan chooses; in CIE XYZ.",
        rounding=0.5 / 4,
    )


def in_daylight(quick):
    for thickness in (100, 150, 200, 250, 300, 400, 500, 600, 1000):
        for degrees in (0, 45):
            yield daylight(
                f"{thickness} nm of soap",
                {"thin": {"index": 1.33, "thickness_nm": thickness}},
                [(1.33, thickness)],
                lambda nm: np.ones_like(nm),
                degrees,
                f"A soap film of index 1.33, {thickness} nm thick",
            )


def rows(quick):
    for part in (stacks, soap, in_daylight):
        yield from part(quick)
