"""Color: the value in the file is the sum over wavelengths of light, reflectance and observer.

The reference is colour-science, nm by nm from 360 to 830, CIE 1931 2 degrees (CIE 15:2018, equation 7.1); colors.py
says how its tables are interpolated.
"""

import numpy as np

import colors

from . import readers
from .row import Row
from .scenes import rgb, view

XYZ = "lin_ciexyzd65_scene"
ILLUMINANTS = (
    "A",
    "C",
    "D50",
    "D55",
    "D65",
    "D75",
    "E",
    "FL2",
    "FL7",
    "FL11",
    "FL3.12",
    "HP2",
    "HP5",
    "LED-B1",
    "LED-B5",
    "LED-V2",
)
SPACES = {"rec709": "ITU-R BT.709", "rec2020": "ITU-R BT.2020", "p3d65": "P3-D65", "ap1": "ACEScg", "ap0": "ACES2065-1"}
WIDE = colors.colour.MSDS_CMFS["CIE 1964 10 Degree Standard Observer"]


def observer(table, nm):
    """Returns sensitivities X, Y, Z at wavelengths, 3 x n, such that a spectrum of 1 everywhere has Y = 1."""
    values = np.stack([np.interp(colors.WAVELENGTHS, table.wavelengths, axis, 0, 0) for axis in table.values.T])
    return np.stack([np.interp(nm, colors.WAVELENGTHS, axis) for axis in values]) / values[1].sum()


def line_powers(lines):
    """Returns the matrix from XYZ to powers of a few lines, and its amplification of rounding at equal powers."""
    matrix = observer(colors.OBSERVER, np.array(lines))
    inverse = np.linalg.pinv(matrix)
    return inverse, float((np.abs(inverse) @ matrix.sum(axis=1)).max())


def sky(radiance, **settings):
    return view({}, [], [{"environment": {"radiance": radiance}}], eye=(0, 0, 1), **settings)


def with_samples(scene, count=1):
    """Returns the scene with `count` samples: one is enough for patches under a uniform sky, where each is exact."""
    return scene | {"render": scene["render"] | {"samples": count}}


def by_ten_degrees(light, reflectances):
    """Returns sums over light and reflectance with the observer of 1964."""
    values = observer(WIDE, light.nm)
    return (light.power * reflectances) @ values.T / (light.power @ values[1])


def chart(name):
    light = colors.illuminant(name)
    scene = with_samples(colors.chart_scene(light.curve, "rgb"))
    reflectances = np.array(
        [colors.reflectances(patch, light.nm) for patch in colors.PATCHES] + [np.ones_like(light.nm)] * 2
    )
    expected = np.array([*(light.xyz(patch) for patch in colors.PATCHES), light.xyz(), light.xyz()])
    words = (
        "The 24 patches of the ColorChecker (Ohta), diffuse, side by side, then white, then the sky itself, under an "
        "even sky of "
        f"illuminant {name} with Y = 1: a picture of 26 x 1 pixels in CIE XYZ."
    )
    return Row(
        "color",
        f"ColorChecker under {name}",
        "sum of light x reflectance x observer",
        scene,
        readers.columns,
        expected.ravel(),
        "the 10 degree observer of 1964",
        by_ten_degrees(light, reflectances).ravel(),
        words,
    )


def planck(kelvin):
    """Returns a row for radiance by Planck's law (c2 = 0.01438776877 m K), Y = 1."""
    nm = colors.WAVELENGTHS
    power = 1 / (nm**5 * np.expm1(1.438776877e7 / (nm * kelvin)))
    light = colors.Light(f"{kelvin} K", {"blackbody": kelvin}, nm, power / (colors.OBSERVER.values[:, 1] @ power))
    old = 1 / (nm**5 * np.expm1(1.435e7 / (nm * kelvin)))
    mistaken = colors.OBSERVER.values.T @ old / (colors.OBSERVER.values[:, 1] @ old)
    words = f"Nothing but a sky of a blackbody of {kelvin} K, Y = 1, in CIE XYZ."
    return Row(
        "color",
        f"blackbody of {kelvin} K",
        "1 / (l^5 (exp(c2 / l T) - 1)), Y = 1",
        sky(light.curve, space=XYZ),
        lambda image: readers.colors(image)[:, [0, 2]],
        light.xyz()[[0, 2]],
        "c2 of 1931 (0.01435), with which A was defined",
        mistaken[[0, 2]],
        words,
    )


def emission(name, *pairs):
    light = colors.lines(name, *pairs)
    nm, power = np.transpose(pairs).astype(float)
    expected = light.xyz()
    shifted = observer(colors.OBSERVER, np.round(nm / 5) * 5 + 5 * (nm % 5 == 0)) @ power
    words = f"Nothing but a sky of ideal lines (nm, power) {pairs}, in CIE XYZ, a flat spectrum of 1 having Y = 1."
    return Row(
        "color",
        f"emission lines: {name}",
        "sum of power x observer",
        sky(light.curve, space=XYZ),
        readers.colors,
        expected,
        "lines that fall into bins of 5 nm",
        shifted,
        words,
    )


def metamers(name):
    """Returns a row for two paints that match under D65 and not under another light: their difference in X, Y and Z."""
    nm = np.arange(400.0, 701.0, 20)
    day, other = colors.illuminant("D65"), colors.illuminant(name)
    base = 0.35 + 0.15 * np.sin(nm / 40)
    hats = np.array([np.interp(colors.WAVELENGTHS, nm, row) for row in np.eye(len(nm))])
    seen = hats @ (colors.OBSERVER.values * day.power[:, None])
    wiggle = 0.25 * np.cos(nm / 25)
    hidden = wiggle - seen @ np.linalg.lstsq(seen.T @ seen, seen.T @ wiggle, rcond=None)[0]
    hidden *= 0.3 / np.abs(hidden).max()
    paints = [np.round(base + sign * hidden / 2, 9) for sign in (-1, 1)]
    light = {"A": other, "D65": day}[name]
    xyz = [
        (colors.OBSERVER.values * light.power[:, None]).T @ np.interp(colors.WAVELENGTHS, nm, paint) for paint in paints
    ]
    curves = [{"samples": [[float(x), float(y)] for x, y in zip(nm, paint, strict=True)]} for paint in paints]
    scene = with_samples(colors.patches_scene(curves, light.curve, "rgb", XYZ))
    expected = xyz[0] - xyz[1]
    # Under A, three numbers made for daylight would still match. Under D65, the other observer would see a difference.
    wide = observer(WIDE, colors.WAVELENGTHS)
    wide = (wide / (wide[1] @ light.power)) @ (light.power * (np.interp(colors.WAVELENGTHS, nm, paints[0] - paints[1])))
    guards, mistake = (
        ("the 10 degree observer", wide) if name == "D65" else ("colors carried as three numbers of daylight", 0.0)
    )
    words = (
        f"Two diffuse patches of the spectra {curves} side by side under an even sky of {name}, Y = 1; left "
        f"minus right."
    )
    return Row(
        "color",
        f"metameric pair under {name}",
        "sum of light x (difference) x observer",
        scene,
        lambda image: (image.rgb[0, 0] - image.rgb[0, 1])[None],
        expected,
        guards,
        mistake,
        words,
        rounding=2 * 32 * 2.0**-24 * np.abs(xyz[0]),
    )


def srgb(linear):
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def files():
    """Yields rows that show that the file holds radiance itself, in the primaries that its header names."""
    for numbers in ((0.25, 0.5, 2.0), (1e-3, 0.18, 100.0), (1e-20, 1e20, 1e3)):
        numbers = np.array(numbers)
        yield Row(
            "color",
            f"a sky of {'/'.join(f'{x:g}' for x in numbers)} in the file",
            "what the scene says",
            sky(rgb(numbers)),
            readers.colors,
            numbers,
            "the sRGB curve in a linear file",
            srgb(numbers),
            f"Nothing but a sky of {numbers.tolist()} in linear Rec.709.",
        )
    space = colors.colour.RGB_COLOURSPACES["ITU-R BT.709"].copy()
    space.use_derived_transformation_matrices(True)
    numbers = np.array([0.25, 0.5, 2.0])

    def xyz(image):
        stored = np.array(image.header["chromaticities"]).reshape(4, 2)
        return (colors.colour.normalised_primary_matrix(stored[:3], stored[3]) @ image.rgb.reshape(-1, 3).T).T

    yield Row(
        "color",
        "color of a sky by the file's chromaticities",
        "ITU-R BT.709 to XYZ",
        sky(rgb(numbers)),
        xyz,
        space.matrix_RGB_to_XYZ @ numbers,
        "primaries of Rec.2020 in the header",
        colors.colour.RGB_COLOURSPACES["ITU-R BT.2020"].matrix_RGB_to_XYZ @ numbers,
        "Nothing but a sky of (0.25, 0.5, 2) in linear Rec.709; CIE XYZ by the chromaticities in the header.",
    )
    for name, title in SPACES.items():
        for model in ("rgb", {"bands": 16}, "hero"):
            called = model if isinstance(model, str) else "16 bands"
            chance = {"samples": 4} if model == "hero" else {}
            yield Row(
                "color",
                f"white of {title}, {called}",
                "R = G = B = 1",
                sky(1, space=f"lin_{name}_scene", model=model, **chance),
                readers.colors,
                1.0,
                "no adaptation of white, 0.5 % at least",
                0.995,
                f"A sky of 1 in {title}.",
            )


def rows(quick):
    for name in ILLUMINANTS:
        yield chart(name)
    for kelvin in (1500, 2000, 2856, 4000, 6500, 15000):
        yield planck(kelvin)
    yield emission("sodium D", (588.995, 2), (589.592, 1))
    yield emission("mercury", (404.656, 0.42), (435.833, 1.0), (546.074, 0.8), (578.2, 0.35))
    yield emission("RGB lasers", (445.3, 1), (532.1, 1), (637.8, 1))
    yield emission("hydrogen F and C", (486.13, 1), (656.27, 3))
    yield metamers("D65")
    yield metamers("A")
    yield from files()
