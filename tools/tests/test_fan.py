"""A thin white beam through a prism lands on a screen as a continuous rainbow, as Snell, Fresnel and the light predict.

    pytest tools/tests/test_fan.py -s     # prints the largest difference and the standard error

The spectrum is computed without the renderer. Rays from all over the beam, half a nanometer apart, are refracted by
Snell's law with Schott's Sellmeier coefficients of N-SF11, reflected inside the prism any number of times, attenuated
by Fresnel's equations at every face, and counted in the pixels where they land. Light is unpolarized at every face, as
the scene asks for.
"""

import math
from functools import cache

import numpy as np
import render
from colors import OBSERVER, WAVELENGTHS, colour, illuminant, lab
from validation.scenes import toml_file

POINTS, ROWS, SEEDS, SAMPLES = 81, 5, 4, 200
HALF_APEX, EDGE = math.radians(30), 0.5
# The beam is 0.01 wide where it meets the prism. The screen is a few times the prism's size behind it.
BEAM, DISTANCE, SCREEN = 0.01, 4.0, 3.0
ENDS = (400.0, 700.0)
# The apex is the origin, the faces are symmetric about -y, and everything is centered in z = 0.
LEFT = np.array([-math.cos(HALF_APEX), math.sin(HALF_APEX), 0])
RIGHT = LEFT * [-1, 1, 1]
FACES = np.array([LEFT, RIGHT, [0, -1, 0]])
OFFSETS = np.array([0, 0, EDGE * math.cos(HALF_APEX)])
ENTRY = 0.5 * EDGE * np.array([-math.sin(HALF_APEX), -math.cos(HALF_APEX), 0])


def flint(nm):
    """Returns the index of N-SF11 (SCHOTT, optical glass data sheets)."""
    squared = (np.asarray(nm) / 1000) ** 2
    terms = ((1.73759695, 0.013188707), (0.313747346, 0.0623068142), (1.89878101, 155.23629))
    return np.sqrt(1 + sum(b * squared / (squared - c) for b, c in terms))


def dot(a, b):
    return np.sum(a * b, axis=-1, keepdims=True)


def refract(way, normal, eta):
    """Returns the refracted direction by Snell's law, and the Fresnel transmittance of unpolarized light.

    `eta` is the index in front over the one behind; `normal` points to where the light comes from. Total reflection
    transmits 0."""
    cos_i = -dot(way, normal)
    squared = 1 - eta**2 * (1 - cos_i**2)
    cos_t = np.sqrt(np.maximum(squared, 0))
    s = (eta * cos_i - cos_t) / (eta * cos_i + cos_t)
    p = (cos_i - eta * cos_t) / (cos_i + eta * cos_t)
    return eta * way + (eta * cos_i - cos_t) * normal, np.where(squared > 0, 1 - (s**2 + p**2) / 2, 0)


def exits(origin, way, index, surfaces=8):
    """Yields origin, direction and share of the light that leaves the prism after 0, 1, 2 ... reflections inside.

    The light enters through the left face."""
    origin = origin - way * dot(origin, LEFT) / dot(way, LEFT)
    way, share = refract(way, LEFT, 1 / index)
    for _ in range(surfaces):
        steps = (OFFSETS - origin @ FACES.T) / np.maximum(way @ FACES.T, 1e-12)
        face = np.argmin(np.where(way @ FACES.T > 1e-12, steps, np.inf), axis=-1)
        origin = origin + way * np.take_along_axis(steps, face[:, None], axis=-1)
        normal = FACES[face]
        out, passed = refract(way, -normal, index)
        yield origin, out, (share * passed)[:, 0]
        way, share = way - 2 * dot(way, normal) * normal, share * (1 - passed)


def unit(vector):
    return vector / np.linalg.norm(vector)


class Bench:
    """The beam at minimum deviation of green, and a screen that it meets head-on."""

    def __init__(self):
        angle = math.atan2(LEFT[1], LEFT[0]) + math.asin(flint(550.0) * math.sin(HALF_APEX))
        self.way = -np.array([math.cos(angle), math.sin(angle), 0])
        self.lamp = ENTRY - DISTANCE * self.way
        leaving, out, _ = next(exits(self.lamp, self.way[None], flint(550.0)))
        self.facing = unit(out[0])
        self.across = np.array([-self.facing[1], self.facing[0], 0])
        self.foot = leaving[0] + SCREEN * self.facing
        ends = [next(self.landings(self.way[None], nm))[0][0, 0] for nm in ENDS]
        self.pixel = abs(ends[1] - ends[0]) / (POINTS - 1)
        self.foot = self.foot + self.across * (ends[0] + ends[1]) / 2

    def landings(self, ways, nm, surfaces=8):
        """Yields places on the screen, along the fan and across it, and what arrives there, for each exit."""
        for leaving, out, share in exits(self.lamp, ways, flint(nm), surfaces):
            toward = dot(out, self.facing)
            ahead = toward[:, 0] > 0.1
            landed = leaving + out * dot(self.foot - leaving, self.facing) / np.where(toward > 0.1, toward, 1) - self.foot
            yield np.stack([landed @ self.across, landed[:, 2]], axis=-1), np.where(ahead, share, 0)

    def cone(self):
        """Returns half the angle of the beam."""
        return math.atan(0.5 * BEAM / DISTANCE)

    def scene(self):
        z = [EDGE * math.sin(HALF_APEX), EDGE * math.cos(HALF_APEX)]
        points = [[x, y, side] for side in (-0.3, 0.3) for x, y in ((0, 0), (-z[0], -z[1]), (z[0], -z[1]))]
        faces = [[0, 2, 1], [3, 4, 5], [0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [2, 0, 3], [2, 3, 5]]
        screen = {"center": self.foot.tolist(), "u": (self.across * 0.6).tolist(), "v": [0, 0, 0.6]}
        camera = {
            "position": (self.foot - 0.5 * self.facing).tolist(),
            "look_at": self.foot.tolist(),
            "up": [0, 0, 1],
            "projection": "orthographic",
            "height": ROWS * self.pixel,
        }
        spot = {"position": self.lamp.tolist(), "toward": self.way.tolist(), "blend": 0, "intensity": {"illuminant": "D65"}}
        spot["cone_angle"] = 2 * math.degrees(self.cone())
        return toml_file(
            {
                "camera": camera,
                "film": {"width": POINTS, "height": ROWS, "color_space": "lin_ciexyzd65_scene"},
                "render": {"polarization": "off"},
                "material": {
                    "screen": {"diffuse": {"reflectance": 1}},
                    "flint": {"dielectric": {"index": "N-SF11"}},
                },
                "object": [
                    {"material": "screen", "shape": {"quad": screen}},
                    {"material": "flint", "shape": {"mesh": {"points": points, "faces": faces}}},
                ],
                "light": [{"spot": spot}],
            }
        )

    def expected(self, step=0.5, rings=32, surfaces=8):
        """Returns XYZ of every column, as the mean over its rows, for light that meets up to `surfaces` faces."""
        # Rays that stand for equal solid angles of the beam: rings of equal area, rotated by the golden angle.
        count = rings * rings
        radius = np.sqrt((np.arange(count) + 0.5) / count) * math.tan(self.cone())
        turn = np.arange(count) * math.pi * (3 - math.sqrt(5))
        side = np.cross(self.way, [0, 0, 1])
        ways = self.way + radius[:, None] * (np.cos(turn)[:, None] * side + np.sin(turn)[:, None] * np.array([0, 0, 1]))
        ways /= np.linalg.norm(ways, axis=1, keepdims=True)
        solid_angle = 2 * math.pi * (1 - math.cos(self.cone())) / count
        light = illuminant("D65")
        xyz = np.zeros((POINTS, 3))
        for nm in np.arange(WAVELENGTHS[0], WAVELENGTHS[-1], step) + step / 2:
            power = np.interp(nm, light.nm, light.power) * step
            sensitivity = np.array([np.interp(nm, WAVELENGTHS, axis) for axis in OBSERVER.values.T])
            for landed, share in self.landings(ways, nm, surfaces):
                column = np.floor(landed[:, 0] / self.pixel + POINTS / 2).astype(int)
                inside = (column >= 0) & (column < POINTS) & (np.abs(landed[:, 1]) < ROWS * self.pixel / 2)
                flux = np.bincount(column[inside], weights=share[inside], minlength=POINTS) * power * solid_angle
                xyz += flux[:, None] * sensitivity
        # The radiance of a white screen is irradiance over pi.
        return xyz / (math.pi * ROWS * self.pixel**2)


def red_first(image):
    """Orders the columns from red to blue: seen along the light, the fan may lead to either side."""
    blue = image[:, 2]
    return image[::-1] if blue[: POINTS // 2].sum() > blue[POINTS // 2 :].sum() else image


@cache
def measured():
    """Returns XYZ of every column as expected, and as rendered with several seeds."""
    bench = Bench()
    images = [render.render(bench.scene(), samples=SAMPLES, seed=seed).rgb.mean(axis=0) for seed in range(SEEDS)]
    return red_first(bench.expected()), np.array([red_first(image) for image in images])


def difference(expected, found):
    """Returns dE2000, with D65 as bright as the brightest place of the fan as white."""
    white = illuminant("D65").xyz() * measured()[0][:, 1].max()
    return colour.delta_E(lab(expected, white), lab(found, white), method="CIE 2000")


def equally_bright(colors):
    """Returns colors of the same chromaticities, each half as bright as the brightest place: L* = 76."""
    return colors * (0.5 * measured()[0][:, 1].max() / colors[:, 1:2])


def test_every_place_of_the_fan_has_the_color_that_snell_fresnel_and_the_light_give_it():
    expected, images = measured()
    found = images.mean(axis=0)
    spread = np.array([difference(found, image) for image in images])
    error = np.sqrt(np.sum(spread**2, axis=0) / (SEEDS - 1) / SEEDS)
    color = difference(expected, found)
    chromaticity = difference(equally_bright(expected), equally_bright(found))
    print(f"worst dE2000: color {color.max():.3f}, chromaticity {chromaticity.max():.3f}; standard error {error.max():.3f}")
    assert error.max() < 1 / 3, "too few photons to tell"
    assert color.max() < 1, f"place {color.argmax()}: {color.max()} dE2000"
    assert chromaticity.max() < 1, f"place {chromaticity.argmax()}: {chromaticity.max()} dE2000"


def test_the_fan_has_no_band_and_no_gap():
    expected, images = measured()
    found = images.mean(axis=0)
    steps = [difference(colors[:-1], colors[1:]) for colors in (expected, found)]
    print(f"from place to place: {steps[0].max():.2f} dE2000 at most; off by {np.abs(steps[0] - steps[1]).max():.3f}")
    assert np.abs(steps[0] - steps[1]).max() < 0.5
    assert np.all(found[:, 1] > 0.9 * expected[:, 1])
    # From red to violet, the hue turns in one direction around the white of D65.
    x, y = (colors / found.sum(axis=1) for colors in found.T[:2])
    turns = np.diff(np.unwrap(np.arctan2(y - 0.329, x - 0.3127)))
    assert turns.min() > -0.005, f"the hue turns back by {turns.min()}"


def test_light_of_three_reflections_inside_the_prism_is_a_part_of_the_fan():
    """These are closed paths in an equilateral prism.

    Without them the expectation is off by several dE2000 at some places, so the other tests would notice if they were
    left out."""
    expected = measured()[0]
    straight = red_first(Bench().expected(surfaces=1))
    assert difference(straight, expected).max() > 3
