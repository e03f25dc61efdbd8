"""A color chart under three lamps: compares each rendered patch with its color as computed by colour-science.

pip install colour-science
python examples/python/color_chart.py [chart.png]
"""

import sys

import abbe
import colour
import numpy as np

LAMPS = ("D65", "A", "FL11")
PATCHES = [name for name in abbe.catalog.reflectances() if name.startswith("colorchecker/")]
COLUMNS, ROWS = 6, 4
# Pixels along each side of a patch. The outermost ones straddle the patch's edge.
SIDE = 8
NM = colour.SpectralShape(360, 830, 1)
OBSERVER = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(NM).values


def chart(lamp):
    """Returns a scene of all patches side by side, which reflect a uniform sky with the lamp's spectrum."""
    squares = [
        {"shape": {"quad": {"center": [x, -y, 0], "u": [0.45, 0, 0], "v": [0, 0.45, 0]}}, "material": patch}
        for (y, x), patch in zip(np.ndindex(ROWS, COLUMNS), PATCHES, strict=True)
    ]
    return {
        "camera": {
            "position": [(COLUMNS - 1) / 2, -(ROWS - 1) / 2, 5],
            "look_at": [(COLUMNS - 1) / 2, -(ROWS - 1) / 2, 0],
            "projection": "orthographic",
            "height": ROWS,
        },
        "film": {"width": SIDE * COLUMNS, "height": SIDE * ROWS},
        "render": {"samples": 1024, "model": {"bands": 32}},
        "material": {patch: {"diffuse": {"reflectance": patch}} for patch in PATCHES},
        "object": squares,
        "light": [{"environment": {"radiance": {"illuminant": lamp}}}],
    }


def exact(lamp):
    """Returns XYZ of each patch and of the lamp, whose luminance is 1, by integrals over the tables of the catalog."""
    light = abbe.catalog.illuminant(lamp).power(NM.wavelengths)
    reflectances = [abbe.catalog.reflectance(patch).reflectance(NM.wavelengths) for patch in PATCHES]
    xyz = np.array([*reflectances, np.ones_like(light)]) * light @ OBSERVER
    return xyz[:-1] / xyz[-1, 1], xyz[-1] / xyz[-1, 1]


def rendered(image):
    """Returns XYZ of each patch: the mean of its pixels, without the outermost ones."""
    patches = image.rgb.reshape(ROWS, SIDE, COLUMNS, SIDE, 3)[:, 1:-1, :, 1:-1]
    return patches.mean(axis=(1, 3)).reshape(-1, 3) @ colour.RGB_COLOURSPACES["ITU-R BT.709"].matrix_RGB_to_XYZ.T


def differences(lamp, image):
    """Returns CIEDE2000 of each patch, for an observer adapted to the lamp as white."""
    expected, white = exact(lamp)
    lab = [colour.XYZ_to_Lab(xyz, colour.XYZ_to_xy(white)) for xyz in (expected, rendered(image))]
    return colour.delta_E(*lab, method="CIE 2000")


def main(png=None):
    worst = {}
    for lamp in LAMPS:
        image = abbe.render(chart(lamp))
        apart = differences(lamp, image)
        worst[lamp] = apart.max()
        print(f"{lamp:5} mean dE2000 {apart.mean():.3f}, worst {apart.max():.3f} ({PATCHES[apart.argmax()]})")
        if png and lamp == LAMPS[0]:
            image.to_png(png)
    return worst


if __name__ == "__main__":
    main(*sys.argv[1:2])
