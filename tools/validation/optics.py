"""Optics: how much light surfaces reflect and transmit. Where it goes is in angles.py.

Light that has met one surface at an angle is partly polarized, and a second surface in the same plane reflects more or
less of it. A plate of index 1.5 at 60 degrees transmits 0.8481 of unpolarized light, the mean of both polarizations;
averages at each surface would give 0.8362. So the rows with more than one surface turn polarization on.
"""

import numpy as np

import colors

from . import angles, formulas, readers
from .plates import BANDS, LAMPS, looking_down, pile
from .row import ROUNDING, Row
from .scenes import cube, glass, glow, plane, rgb, sun, view

GROUP = "optics"
FLOOR = plane((0, 0, 0), (0, 1, 0))


def reflection(name, material, degrees, expected, formula, guards, mistake, what, reader=readers.colors):
    scene = view(
        {"surface": material, "glow": glow()},
        [("surface", FLOOR), ("glow", LAMPS["R"])],
        eye=looking_down(degrees),
        up=(0, 0, 1),
    )
    words = (
        f"The flat surface of a half space of {what}, seen at {degrees:.6g} degrees; above it a plane of "
        f"radiance 1, below black."
    )
    return Row(GROUP, name, formula, scene, reader, expected, guards, mistake, words)


def fresnel(quick):
    """Yields single surfaces: the mean of s and p."""
    indices = np.array(BANDS)
    for degrees in (0, 15, 30, 45, 60, 75, 85, 89):
        expected = formulas.fresnel(indices, degrees)
        guards, mistake = "Schlick's approximation", formulas.schlick(indices, degrees)
        if degrees == 0:
            guards, mistake = "the square of n - 1 alone, without n + 1", (indices - 1) ** 2
        yield reflection(
            f"Fresnel at {degrees} degrees",
            glass(rgb(BANDS)),
            degrees,
            expected,
            "(r_s^2 + r_p^2) / 2",
            guards,
            mistake,
            f"indices {BANDS}",
        )
    for degrees in (30, 60, 75):
        s, p = formulas.both_polarizations(1.5, degrees)
        yield reflection(
            f"Fresnel of index 1.5 at {degrees} degrees",
            glass(1.5),
            degrees,
            (s + p) / 2,
            "(r_s^2 + r_p^2) / 2",
            "s alone, or s for p",
            s,
            "index 1.5",
            readers.gray,
        )
    for name in ("water", "N-BK7", "N-SF11", "diamond", "fused silica", "sapphire"):
        n = float(np.round(formulas.index(name, formulas.D_LINE), 6))
        expected = 0.5 * ((n**2 - 1) / (n**2 + 1)) ** 2
        degrees = float(np.degrees(np.arctan(n)))
        yield reflection(
            f"Brewster angle of {name}",
            glass(n),
            degrees,
            expected,
            "((n^2 - 1) / (n^2 + 1))^2 / 2 at tan i = n",
            "Schlick's approximation",
            formulas.schlick(n, degrees),
            f"index {n}",
            readers.gray,
        )
    for name in ("water", "N-BK7", "N-SF11", "diamond"):
        yield normal(name)
    for name in ("N-BK7", "N-SF11", "diamond"):
        for degrees in (0, 45, 60):
            yield daylight(name, degrees, "R")
            yield daylight(name, degrees, "T")


def by_wavelength(name, degrees, share):
    """Returns CIE XYZ of D65 after `share`, a function of the reflectance at each wavelength, and of D65 itself."""
    light = colors.illuminant("D65")
    both = formulas.both_polarizations(formulas.index(name, light.nm), degrees)
    power = np.stack([light.power * sum(map(share, both)) / 2, light.power])
    return power @ colors.OBSERVER.values


def normal(name):
    """Returns a row without dispersion: lanes share a direction, and each band reflects its mean under white."""
    space = colors.colour.RGB_COLOURSPACES["ITU-R BT.709"]
    reflected, white = by_wavelength(name, 0, lambda r: r) @ space.matrix_XYZ_to_RGB.T
    at_d = float(formulas.index(name, formulas.D_LINE))
    return reflection(
        f"normal reflection of {name}",
        glass(name),
        0,
        reflected / white,
        "((n - 1) / (n + 1))^2, the mean over each band of white",
        "the index of the d line in every band",
        np.full(3, ((at_d - 1) / (at_d + 1)) ** 2),
        name,
    )._replace(rounding=1e-5 * reflected / white)


def daylight(name, degrees, kind):
    """Returns a row for a plate of glass whose lanes stay together: each wavelength has its own share."""
    share = (lambda r: (1 - r) / (1 + r)) if kind == "T" else (lambda r: 2 * r / (1 + r))
    expected, _ = by_wavelength(name, degrees, share)
    n = formulas.index(name, formulas.D_LINE)
    mistake = colors.illuminant("D65").xyz() * share(formulas.fresnel(n, degrees))
    scene = view(
        {"glass": glass(name), "glow": glow({"illuminant": "D65"})},
        [("glass", cube((0, -0.005, 0), [400.0, 0.01, 400.0])), ("glow", LAMPS[kind])],
        eye=looking_down(degrees),
        up=(0, 0, 1),
        model={"bands": 16},
        space="lin_ciexyzd65_scene",
        polarization="on",
    )
    words = (
        f"A plate of {name} 0.01 thick, seen at {degrees} degrees, in 16 bands; a plane of D65 "
        f"{'before' if kind == 'R' else 'behind'} it, else black; in CIE XYZ."
    )
    return Row(
        GROUP,
        f"{kind} of a plate of {name} at {degrees} degrees in daylight",
        {"T": "(1 - r) / (1 + r)", "R": "2 r / (1 + r)"}[kind] + " at each wavelength, the mean of both polarizations",
        scene,
        readers.colors,
        expected,
        "the index of the d line in every lane",
        mistake,
        words,
        rounding=BANDS_16 * expected,
    )


# The measured relative error of 16 wavelengths for a smooth spectrum.
BANDS_16 = 4e-5


def inside(quick):
    """Yields the surface from inside: n^2 (1 - R), and nothing beyond the critical angle."""
    index = 1.5
    for degrees in (0, 25, 40, 41.8, 42, 60, 85):
        reflected = formulas.inside_fresnel(index, degrees)
        angle = np.radians(degrees)
        scene = view(
            {"glass": glass(index), "glow": glow()},
            [("glass", FLOOR), ("glow", LAMPS["R"])],
            eye=(-np.sin(angle), -np.cos(angle), 0),
            up=(0, 0, 1),
        )
        words = (
            f"A camera in a half space of index {index} looks up at its surface at {degrees} degrees; above it a "
            f"plane of radiance 1."
        )
        total = reflected == 1
        yield Row(
            GROUP,
            f"through the surface from inside at {degrees} degrees",
            "0" if total else "n^2 (1 - R)",
            scene,
            readers.gray,
            index**2 * (1 - reflected),
            "light that leaves at any angle" if total else "the forgotten factor n^2",
            0.5 if total else 1 - reflected,
            words,
            rounding=ROUNDING * index**2,
        )


def critical(name):
    """Returns a row for the angle where total reflection begins, in a fan of rays, for three lanes."""
    indices = formulas.index(name, np.array(formulas.RED_GREEN_BLUE))
    expected = np.degrees(np.arcsin(1 / indices))
    middle, count, fov = float(np.round(expected.mean(), 1)), 4001, 4.0
    angle, half = np.radians(middle), np.tan(np.radians(fov / 2))
    scene = view(
        {"glass": glass(name), "glow": glow()},
        [("glass", FLOOR), ("glow", LAMPS["R"])],
        eye=(-np.sin(angle), -np.cos(angle), 0),
        fov=fov,
        size=(1, count),
    )

    def read(image):
        lit = np.count_nonzero(image.rgb[:, :1] > 0, axis=0) / len(image.rgb)
        return middle - np.degrees(np.arctan(half * (1 - 2 * lit)))

    words = (
        f"A camera in a half space of {name} looks up at its surface at {middle} degrees, {fov} degrees from top to "
        f"bottom in {count} "
        "rows; above it a plane of radiance 1. The rows that are not black tell the angle to half a row."
    )
    return Row(
        GROUP,
        f"critical angle of {name}",
        "asin(1 / n) at C, e, F",
        scene,
        read,
        expected,
        "one index for all lanes",
        np.degrees(np.arcsin(1 / formulas.index(name, formulas.D_LINE))),
        words,
        rounding=fov / count / 2,
    )


def metals(quick):
    n, k = np.array([0.43, 0.2, 1.4]), np.array([2.455, 3.9, 7.6])
    material = {"conductor": {"n": rgb(n), "k": rgb(k)}}
    for degrees in (0, 30, 60, 75, 85):
        schlick = formulas.schlick(n + 1j * k, degrees)
        guards, mistake = (
            ("the absorption k left out", ((n - 1) / (n + 1)) ** 2)
            if degrees == 0
            else ("Schlick's approximation", schlick)
        )
        yield reflection(
            f"metal at {degrees} degrees",
            material,
            degrees,
            formulas.fresnel(n + 1j * k, degrees),
            "|r|^2 of n + ik, mean of s and p",
            guards,
            mistake,
            f"a metal of n = {n}, k = {k}",
        )


def piles(quick):
    """Yields plates in a row, with all reflections between them."""
    for plates, degrees in ((1, 45), (2, 45), (4, 45), (4, 0), (3, 60)):
        index = 1.5168
        # With more plates the plan follows only some paths of light, chosen at random.
        chance = {"size": 32, "samples": 16 if quick else 64} if plates > 2 else {}
        scene = view(
            {"glass": glass(index), "glow": glow()},
            [*pile(plates), ("glow", LAMPS["T"])],
            eye=looking_down(degrees),
            up=(0, 0, 1),
            polarization="on",
            **chance,
        )
        r = formulas.fresnel(index, degrees)
        words = (
            f"{plates} plates of index {index}, 0.01 thick and 0.01 apart, at {degrees} degrees before a plane "
            f"of radiance 1."
        )
        yield Row(
            GROUP,
            f"pile of {plates} plates at {degrees} degrees",
            "the mean of (1 - r) / (1 + (2 m - 1) r) over s and p",
            scene,
            readers.gray,
            formulas.pile(index, degrees, plates),
            "reflections between the plates left out",
            (1 - r) ** (2 * plates),
            words,
            seeds=2 if chance else 1,
        )._replace(rounding=4 * ROUNDING)


def panes(quick):
    """Yields the thin pane: it has all reflections between its faces, but no thickness."""
    indices = np.array(BANDS)
    for degrees in (0, 45, 60, 80):
        objects = [("pane", {"quad": {"center": [0.0, 0.0, 0.0], "u": [20.0, 0.0, 0.0], "v": [0.0, 0.0, -20.0]}})]
        objects.append(("glow", LAMPS["T"]))
        scene = view(
            {"pane": {"thin": {"index": rgb(BANDS)}}, "glow": glow()}, objects, eye=looking_down(degrees), up=(0, 0, 1)
        )
        average = formulas.fresnel(indices, degrees)
        at_right_angles = degrees == 0
        yield Row(
            GROUP,
            f"thin pane at {degrees} degrees",
            "the mean of (1 - r) / (1 + r) over s and p",
            scene,
            readers.colors,
            formulas.pile(indices, degrees, 1),
            "one passage through both faces" if at_right_angles else "the series of the averaged reflectance",
            (1 - average) ** 2 if at_right_angles else (1 - average) / (1 + average),
            f"A pane without thickness of indices {BANDS} at {degrees} degrees before a plane of radiance 1.",
        )


def window(quick):
    """Yields a floor under a pane: parallel sunlight loses what the pane reflects, once."""
    for degrees in (0, 50, 70):
        objects = [("pane", plane((0, 1, 0), (0, -1, 0))), ("floor", plane((0, 0, 0), (0, 1, 0)))]
        # The floor is so dark that light which the pane reflects back to it does not matter.
        dark = 1e-5
        materials = {"pane": {"thin": {"index": rgb(BANDS)}}, "floor": {"diffuse": {"reflectance": dark}}}
        lights = [sun(degrees, float(np.pi / dark))]
        scene = view(materials, objects, lights, eye=(0.3, 0.7, 0.2), up=(0, 0, 1), samples=16)
        index, cos = np.array(BANDS), np.cos(np.radians(degrees))
        yield Row(
            GROUP,
            f"sun through a window pane at {degrees} degrees",
            "cos times the mean of (1 - r) / (1 + r) over s and p",
            scene,
            readers.colors,
            cos * formulas.pile(index, degrees, 1),
            "one passage through both faces",
            cos * (1 - formulas.fresnel(index, degrees)) ** 2,
            f"Parallel sunlight of irradiance pi at {degrees} degrees on a white floor, behind a pane of indices {BANDS}, once reflected.",
        )


def rows(quick):
    for part in (fresnel, inside, metals, piles, panes, window):
        yield from part(quick)
    for name in ("water", "N-BK7", "N-SF11", "diamond"):
        yield critical(name)
    yield from angles.rows(quick)
