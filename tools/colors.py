"""Renders color charts under the lights of the catalog and compares them with colour-science, nm by nm.

    python tools/colors.py          # the chart under every illuminant, then patches seen in colored mirrors

The reference is the sum over 360, 361, ... 830 nm of light x reflectance x CIE 1931 2 degree observer (CIE 15:2018,
equation 7.1). Illuminants and reflectances come from colour-science's own tables, with linear interpolation. The
renderer reads every table in this way, and CIE 15:2018, 4.1.2 defines the D illuminants between their samples by it.
Sprague's interpolation, the default of colour-science, overshoots beside the spikes of a lamp. Beyond the ends of its
table an illuminant is 0 and a reflectance is constant.
"""

import argparse
import math
import sys
import warnings
from typing import NamedTuple

import numpy as np
import render
from validation.scenes import diffuse, quad, toml_file

with warnings.catch_warnings(action="ignore"):  # missing SciPy, which nothing here needs
    import colour

OBSERVER = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
WAVELENGTHS = np.arange(360.0, 831.0)
CHART = colour.SDS_COLOURCHECKERS["ColorChecker N Ohta"]
PATCHES = tuple(CHART)
FAR = 1e4
# Light sampling alone. Paths could find the same light, but those from dark surfaces end at random.
STRAIGHT = {"diffuse_bounces": 0}

# The bar for 95 % of all patches under all illuminants, in dE2000: rounding, for any number of bands.
CHART_BANDS, CHART_BAR = (8, 12, 16, 32), 1e-4


class Light(NamedTuple):
    """A light, both as a scene writes it and as numbers."""

    name: str
    curve: dict
    nm: np.ndarray
    power: np.ndarray  # per nm, or of each ideal line

    def xyz(self, *patches):
        """Returns XYZ of this light after reflection by each of `patches` in turn; without any, of the light itself."""
        reflectance = np.prod([reflectances(patch, self.nm) for patch in patches], axis=0)
        sensitivity = np.stack([np.interp(self.nm, WAVELENGTHS, axis) for axis in OBSERVER.values.T])
        return sensitivity @ (self.power * reflectance)


def reflectances(patch, nm):
    return np.interp(nm, CHART[patch].wavelengths, CHART[patch].values)


def illuminant(name):
    """Returns a light of the catalog, scaled to Y = 1."""
    table = colour.SDS_ILLUMINANTS[name]
    power = np.interp(WAVELENGTHS, table.wavelengths, table.values, left=0, right=0)
    return Light(name, {"illuminant": name}, WAVELENGTHS, power / (OBSERVER.values[:, 1] @ power))


def lines(name, *pairs):
    """Returns ideal lines (nm, power), in the unit in which a spectrum of 1 everywhere has Y = 1."""
    nm, power = np.transpose(pairs).astype(float)
    return Light(name, {"lines": [list(pair) for pair in pairs]}, nm, power / OBSERVER.values[:, 1].sum())


def catalog():
    """Returns the names of all illuminants, as the renderer lists them."""
    return [line.split()[0] for line in render.said("catalog", "illuminant").splitlines()]


def rec709():
    """Returns the matrix from XYZ to linear Rec.709."""
    space = colour.RGB_COLOURSPACES["ITU-R BT.709"].copy()
    space.use_derived_transformation_matrices(True)
    return space.matrix_XYZ_to_RGB


def lab(xyz, white):
    """Returns L*a*b* relative to a white (CIE 15:2018, equations 8.3 to 8.9)."""
    t = xyz / white
    f = np.where(t > (6 / 29) ** 3, np.cbrt(t), t * (29 / 6) ** 2 / 3 + 4 / 29)
    x, y, z = np.moveaxis(f, -1, 0)
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=-1)


def row_of(count, distance=FAR):
    """Returns a camera that sees `count` places a unit apart along x, each in one pixel, their x, and the film.

    The camera is so far away that all rays are nearly parallel."""
    camera = {
        "position": [0, 0, distance],
        "look_at": [0, 0, 0],
        "vertical_fov": 2 * math.degrees(math.atan(0.5 / distance)),
    }
    return camera, [i - (count - 1) / 2 for i in range(count)], {"width": count, "height": 1, "filter": "center"}


def patches_scene(reflectances, radiance, model, color_space, sky=0):
    """Returns a scene of diffuse patches side by side under a uniform sky, followed by `sky` pixels of the sky itself.

    A lone flat patch sees only the sky, and directions are sampled by the cosine: each sample is exactly reflectance x
    sky."""
    camera, places, film = row_of(len(reflectances) + sky)
    names = [f"m{i}" for i in range(len(reflectances))]
    material = {name: diffuse(what) for name, what in zip(names, reflectances, strict=True)}
    shapes = [quad([x, 0, 0], [0.4, 0, 0], [0, 0.4, 0]) for x in places[: len(names)]]
    return {
        "camera": camera,
        "film": {**film, "color_space": color_space},
        "render": {"model": model, **STRAIGHT},
        "material": material,
        "object": [{"material": name, "shape": shape} for name, shape in zip(names, shapes, strict=True)],
        "light": [{"environment": {"radiance": radiance}}],
    }


def chart_scene(radiance, model, color_space="lin_ciexyzd65_scene"):
    """Returns a scene of the patches side by side, then white, then the sky itself."""
    return patches_scene([*PATCHES, 1], radiance, model, color_space, sky=1)


class Chart(NamedTuple):
    """The result for the chart under one light."""

    delta_e: np.ndarray  # dE2000 of each patch
    white: float  # largest relative error of a channel of white, and of the sky


def chart(light, bands):
    """Renders and judges the chart under a light."""
    pixels = render.render(toml_file(chart_scene(light.curve, {"bands": bands})), samples=1).rgb[0]
    white = light.xyz()
    expected = np.array([light.xyz(patch) for patch in PATCHES])
    found = lab(pixels[: len(PATCHES)], white)
    delta_e = colour.delta_E(lab(expected, white), found, method="CIE 2000")
    return Chart(delta_e, np.max(np.abs(pixels[len(PATCHES) :] / white - 1)))


def mirror_scene(irradiance, pairs, model):
    """Returns a scene of diffuse patches, each seen in a small colored mirror far away: (patch, mirror) for each pixel.

    The mirrors stand in a row and reflect the camera's rays up to the patches, which face down. A sun of parallel light
    shines on the patches from below and in front, past the mirrors. Nothing is random."""
    camera, places, film = row_of(len(pairs))
    used = sorted({name for pair in pairs for name in pair}, key=PATCHES.index)
    material = {f"d{PATCHES.index(name)}": diffuse(name) for name in used}
    material |= {f"m{PATCHES.index(name)}": {"mirror": {"reflectance": name}} for name in used}
    objects = []
    for x, (patch, mirror) in zip(places, pairs, strict=True):
        # The rays have spread to twice the width when they hit the patches.
        patch_shape = quad([2 * x, FAR, 0], [0.9, 0, 0], [0, 0, 9])
        objects.append({"material": f"m{PATCHES.index(mirror)}", "shape": quad([x, 0, 0], [0.4, 0, 0], [0, -0.3, 0.3])})
        objects.append({"material": f"d{PATCHES.index(patch)}", "shape": patch_shape})
    return toml_file(
        {
            "camera": camera,
            "film": film,
            "render": {"model": model, **STRAIGHT},
            "material": material,
            "object": objects,
            "light": [{"sun": {"toward": [0, -1, 1], "angular_diameter": 0, "irradiance": irradiance}}],
        }
    )


def interreflection(light, pairs, bands):
    """Renders pairs and returns the relative error of each: the worst channel of linear Rec.709 over the brightest."""
    found = render.render(mirror_scene(light.curve, pairs, {"bands": bands})).rgb[0]
    lambert = math.cos(math.radians(45)) / math.pi
    expected = lambert * np.array([rec709() @ light.xyz(*pair) for pair in pairs])
    return np.max(np.abs(found - expected), axis=1) / np.max(expected, axis=1)


def all_pairs():
    return [(patch, mirror) for patch in PATCHES for mirror in PATCHES]


LASERS = lines("RGB lasers", (445, 1), (532, 1), (638, 1))
SODIUM = lines("sodium", (589.0, 2), (589.6, 1))
# The bars for 95 % of all pairs at 12 bands.
MIRROR_BARS = {"FL11": 0.01, LASERS.name: 0.002, SODIUM.name: 0.002}


def verdict(name, errors, bar):
    """Prints one line and returns whether 95 % of the errors stay below the bar."""
    middle, high, worst = np.percentile(errors, [50, 95, 100])
    passes = bar is None or high <= bar
    limit = "" if bar is None else f" (bar {bar:7.4f})  {'ok' if passes else 'FAIL'}"
    print(f"{name:40} median {middle:9.6f}  p95 {high:9.6f}  worst {worst:9.6f}{limit}")
    return passes


def judge_charts():
    """Judges the whole chart under every illuminant. Prints a line for each, and returns the names of failures."""
    failed = []
    for bands in CHART_BANDS:
        charts = {name: chart(illuminant(name), bands) for name in catalog()}
        for name, one in charts.items():
            verdict(f"bands {bands}, {name}, dE2000", one.delta_e, None)
        name = f"bands {bands}, all illuminants, dE2000"
        failed += [] if verdict(name, np.concatenate([one.delta_e for one in charts.values()]), CHART_BAR) else [name]
        name, worst = f"bands {bands}, white of all illuminants", max(one.white for one in charts.values())
        print(f"{name:40} worst {worst:.1e}  {'ok' if worst <= 1e-6 else 'FAIL'}")
        failed += [] if worst <= 1e-6 else [name]
    return failed


def judge_mirrors():
    """Judges every patch in a mirror of every patch. Prints a line for each light, and returns names of failures."""
    failed = []
    for light in (illuminant("FL11"), LASERS, SODIUM):
        name = f"bands 12, patches in mirrors, {light.name}"
        passes = verdict(name, interreflection(light, all_pairs(), 12), MIRROR_BARS[light.name])
        failed += [] if passes else [name]
    return failed


def main():
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    failed = judge_charts() + judge_mirrors()
    print("all pass" if not failed else "", *failed, sep="\n  FAILED: ")
    return int(bool(failed))


if __name__ == "__main__":
    sys.exit(main())
