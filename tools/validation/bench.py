"""An optical bench: the brightness of a screen tells where a ray hits it.

Every ray is doubled. One pixel's ray lands on a screen whose reflectance rises linearly from 0.1 to 0.9; the pixel
below sends an equal ray through equal glass to a uniform screen of 0.5. Their ratio gives the place, whatever the
glass absorbs or reflects. Rays run along -z in planes of constant y, one pair of planes above the other, and are bent
toward +x.
"""

from typing import NamedTuple

import numpy as np

from .scenes import diffuse, extrude, quad, view

PITCH = 0.02  # distance of the two rays of a pair
FINE = 33  # pixels across that distance, an odd number: the middle one holds the ray
LOW, HIGH, EVEN = 0.1, 0.9, 0.5
RISING = diffuse({"image": "bench.exr", "wrap": "clamp"})
THICK = 0.4 * PITCH  # half the height of a body around its ray's plane


class Experiment(NamedTuple):
    """The body that one pair of rays meets, built around the ray at x = 0."""

    body: object  # function (y) -> the shape around the ray's plane, no higher than PITCH
    exit: tuple  # (x, z) where the screen's axis begins


class Screen(NamedTuple):
    """A screen that faces the direction `degrees` from -z toward +x, at a distance from each exit; half of it rises."""

    degrees: float
    distance: float
    half_width: float

    def place(self, ratio):
        """Returns the distance from the screen's middle, by the ratio of its brightness to the even screen's."""
        return ((ratio * EVEN - LOW) / (HIGH - LOW) - 0.5) * self.half_width

    def angle(self, ratio):
        """Returns the direction of the ray in degrees."""
        return self.degrees + np.degrees(np.arctan(self.place(ratio) / self.distance))

    def rounding(self, count=32):
        """Returns a bound on the effect of rounding on a place: two values of up to 32 factors each."""
        return 2 * count * 2.0**-24 * (HIGH / EVEN) * EVEN / (HIGH - LOW) * self.half_width


def bench(experiments, screen, material, light=1.0, fine=FINE, **settings):
    """Returns the scene: two pixels per experiment, from the top."""
    angle = np.radians(screen.degrees)
    along, across = np.array([np.sin(angle), 0, -np.cos(angle)]), np.array([np.cos(angle), 0, np.sin(angle)])
    count, objects = len(experiments), []
    for number, experiment in enumerate(experiments):
        middle = (count - 1 - 2 * number) * PITCH
        axis = np.array([experiment.exit[0], 0, experiment.exit[1]]) + along * screen.distance
        for side, name in ((0.5, "rising"), (-0.5, "even")):
            y = middle + side * PITCH
            half_height = [0, PITCH / 2, 0]
            objects.append((name, quad(axis + [0, y, 0], across * screen.half_width, half_height)))
            if experiment.body:
                objects.append(("glass", experiment.body(y)))
    materials = {"rising": RISING, "even": diffuse(EVEN), "glass": material}
    sun = {"sun": {"toward": (across / 2 - along).tolist(), "angular_diameter": 0, "irradiance": light}}
    return view(
        materials,
        objects,
        [sun],
        eye=(0, 0, 1),
        height=2 * count * PITCH,
        size=(fine, 2 * count * fine),
        diffuse_bounces=0,
        caustics="off",
        **settings,
    )


def middles(image):
    """Returns the pixels of the rays, from the top: (rays, 3)."""
    height, width = image.rgb.shape[:2]
    if width % 2 == 0 or height % (2 * width):
        raise ValueError(
            f"the picture has {width} x {height} pixels; an odd width, and a height of 2 widths or more, is needed"
        )
    return image.rgb[width // 2 :: width, width // 2]


def ratios(image):
    """Returns the ratio of rising to even screen, for every experiment and channel."""
    pixels = middles(image)
    return pixels[0::2] / pixels[1::2]


def column_ratios(image):
    """Returns the ratios of one experiment whose rays are all parallel after it: one estimate per column of pixels."""
    upper, lower = np.split(image.rgb, [len(image.rgb) // 2])
    middle = slice(len(upper) // 4, len(upper) - len(upper) // 4)
    return upper[middle].mean(axis=0) / lower[middle].mean(axis=0)


def prism(index, apex, incidence, face=0.01):
    """Returns a prism whose first face the ray meets in its middle."""
    steep, inside = np.radians(incidence), np.arcsin(np.sin(np.radians(incidence)) / index)
    first = np.array([np.cos(steep), np.sin(steep)])
    second = np.array([np.cos(steep - np.radians(apex)), np.sin(steep - np.radians(apex))])
    edge = -0.5 * face * first
    polygon = [edge, edge + face * first, edge + face * second]
    ray = np.array([np.sin(steep - inside), -np.cos(steep - inside)])
    # edge + t second = s ray
    t, _ = np.linalg.solve(np.stack([second, -ray], axis=1), -edge)
    return Experiment(lambda y: extrude(polygon, y, THICK), tuple(edge + t * second))


def drop(index, incidence, reflections, radius=0.005):
    """Returns a ball that the ray meets at an angle, on the side from which it is bent toward +x."""
    steep = np.radians(incidence)
    center = radius * np.array([np.sin(steep), -np.cos(steep)])
    chord = np.pi - 2 * np.arcsin(np.sin(steep) / index)
    at = np.pi / 2 + steep + (reflections + 1) * chord
    end = center + radius * np.array([np.cos(at), np.sin(at)])
    shape = {"radius": radius}
    return Experiment(lambda y: {"sphere": shape | {"center": [float(center[0]), y, float(center[1])]}}, tuple(end))
