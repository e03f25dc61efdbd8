"""Caustics: light redirected by glass and mirrors, and found by photons, keeps its energy.

Rows in which light crosses more than one surface of glass turn polarization on, as their formulas do.
"""

import numpy as np

from . import formulas, readers
from .row import Row
from .scenes import cube, diffuse, extrude, glass, quad, rgb, sphere, sun, view

GROUP = "caustics"
# So dark that light which it sends up, and the glass down again, some tenth of it, does not affect any result.
DARK = 1e-4
FLOOR = quad((0, 0, 0), (6, 0, 0), (0, 0, -6))


def lit(
    name,
    objects,
    materials,
    lights,
    patch,
    expected,
    formula,
    guards,
    mistake,
    words,
    quick,
    reader=readers.gray,
    **camera,
):
    """Returns a row for the mean irradiance of a square of the floor, measured by its radiance."""
    samples, seeds, size = (64, 6, 12) if quick else (1024, 8, 16)
    camera = {"eye": (0, 0.5, 0), "target": (0, 0, 0), "up": (0, 0, -1), "height": patch} | camera
    scene = view(materials | {"floor": diffuse(DARK)}, objects, lights, size=size, samples=samples, **camera)
    factor = DARK / np.pi

    def read(image):
        return reader(image).mean(axis=0, keepdims=True) / factor

    return Row(GROUP, name, formula, scene, read, expected, guards, mistake, words, seeds)


def slabs(quick):
    """Yields a floor under a glass roof: the sun comes through it as through a plate, with all interreflections."""
    indices = (1.333, 1.52, 2.42)
    for degrees in (0, 45, 60):
        cosine = np.cos(np.radians(degrees))
        roof = cube((0, 0.22, 0), [1.4, 0.04, 1.4])
        transmitted = formulas.slab(np.array(indices), degrees)[1]
        once = 1 - formulas.fresnel(np.array(indices), degrees)
        words = (
            f"A roof of glass 1.4 x 0.04 x 1.4 at height 0.2 over a floor of reflectance {DARK}, parallel light "
            f"at {degrees} degrees."
        )
        yield lit(
            f"sun through a glass roof at {degrees} degrees",
            [("floor", FLOOR), ("glass", roof)],
            {"glass": glass(rgb(indices))},
            [sun(degrees)],
            0.3,
            transmitted * cosine,
            "E cos t (1 - r) / (1 + r), the mean of both polarizations",
            "Fresnel at one face alone",
            once * cosine,
            words,
            quick,
            readers.colors,
            eye=(0, 0.1, 0),
            polarization="on",
        )


def mirrors(quick):
    """Yields the sun with a mirror that stands upright beside the floor: as if a second sun shone from that side."""
    for degrees, reflectance in ((30, 0.8), (60, 0.5)):
        angle = np.radians(degrees)
        expected = np.cos(angle) * (1 + reflectance)
        objects = [("floor", FLOOR), ("mirror", quad((-1, 2, 0), (0, 2, 0), (0, 0, 2)))]
        words = (
            f"A floor of reflectance {DARK}; a mirror of {reflectance} upright at x = -1, 4 high; parallel light "
            f"at {degrees} degrees."
        )
        yield lit(
            f"sun by a mirror at {degrees} degrees",
            objects,
            {"mirror": {"mirror": {"reflectance": reflectance}}},
            [sun(degrees)],
            0.5,
            expected,
            "E cos t (1 + R)",
            "a mirror that throws no light",
            np.cos(angle),
            words,
            quick,
        )


def pieces(quick):
    """Yields the sun and a mirror on a floor laid in pieces, seen in another mirror, so that photons are gathered."""
    angle, reflectance = np.radians(60), 0.8
    for count in (40, 400):
        half = 1 / count
        laths = [("floor", quad((-1 + (2 * i + 1) * half, 0, 0), (half, 0, 0), (0, 0, 1))) for i in range(count)]
        mirrors = [quad((-1, 2, 0), (0, 2, 0), (0, 0, 2)), quad((0, 0.5, 0), (0.25, 0, 0), (0, 0.25, 0.25))]
        words = (
            f"A floor of reflectance {DARK} in {count} pieces, 2 wide together, seen in a mirror at 45 degrees; a mirror of "
            f"{reflectance} upright at x = -1, 4 high; parallel light at 60 degrees."
        )
        yield lit(
            f"sun by a mirror onto {count} pieces",
            laths + [("mirror", mirrors[0]), ("window", mirrors[1])],
            {"mirror": {"mirror": {"reflectance": reflectance}}, "window": {"mirror": {"reflectance": 1}}},
            [sun(60)],
            0.4,
            np.cos(angle) * (1 + reflectance),
            "E cos t (1 + R)",
            "photons that end with their piece",
            np.cos(angle),
            words,
            quick,
            eye=(0, 0.5, 1),
            target=(0, 0.5, 0),
            up=(0, 1, 0),
        )


def balls(quick):
    """Yields row T1 of the literature on light tracing: a ball under a lamp."""
    for index, half_side in ((1.5, 0.8), (1.5, 0.2), (1.333, 0.5)):
        expected = formulas.through_ball(index, 1.5, 7.0, half_side)
        light = {"point": {"position": [0.0, 7.0, 0.0], "intensity": 1}}
        words = (
            f"A ball of radius 1 and index {index}, its center 1.5 above a floor, a point light of intensity 1 "
            f"at height 7."
        )
        yield lit(
            f"ball of index {index} under a point, square of {2 * half_side}",
            [("floor", FLOOR), ("glass", sphere((0, 1.5, 0), 1))],
            {"glass": glass(index)},
            [light],
            2 * half_side,
            expected,
            "integral of I (1 - r)^2 r^k over the cone of the ball, the mean of both polarizations",
            "reflection at its faces left out",
            expected / (1 - formulas.fresnel(index, 0)) ** 2,
            words,
            quick,
            polarization="on",
        )


def beam(quick):
    """Yields all light that leaves a prism, plus direct light of the sun."""
    index, apex, face = 1.5168, np.radians(60), 1.0
    incidence = np.radians(formulas.least_incidence(index, 60))
    deviation = 2 * incidence - apex
    first = np.array([np.cos(incidence), np.sin(incidence)])
    second = np.array([np.cos(incidence - apex), np.sin(incidence - apex)])
    middle = (first + second) / 2 * face
    polygon = [face * 0 * first - middle, face * first - middle, face * second - middle]
    prism = extrude(polygon, 0.0, 0.5)
    along, across = np.array([np.sin(deviation), -np.cos(deviation)]), np.array([np.cos(deviation), np.sin(deviation)])
    exit_middle = 0.5 * face * second - middle
    place = exit_middle + 6 * along
    side = 2.0
    patch = quad((place[0], 0, place[1]), side * np.array([across[0], 0, across[1]]), (0, side, 0))
    each = formulas.both_polarizations(index, np.degrees(incidence))
    # Light reflected by all three faces, each at 30 degrees, leaves in the same direction again.
    through = sum((1 - r) ** 2 / (1 - r**3) for r in each) / 2
    power = face * np.cos(incidence) * 1.0 * through
    direct, area = np.cos(deviation), side**2
    light = {"sun": {"toward": [0.0, 0.0, 1.0], "angular_diameter": 0, "irradiance": 1}}
    start = place - 1.0 * along
    words = (
        "A 60 degree prism of index 1.5168, faces of 1 x 1, its third one black, at least deviation in parallel "
        "light of irradiance 1; the mean over a "
        f"square of {side:g} across its beam, 6 behind it, which the sun lights straight as well."
    )
    # The third face is black, because the sun would shine through it as well.
    ends = [polygon[1], polygon[2]]
    normal = np.array([ends[1][1] - ends[0][1], ends[0][0] - ends[1][0]])
    base = (ends[0] + ends[1]) / 2 + 1e-3 * normal * np.sign(normal @ (ends[0] - polygon[0]))
    reach = (ends[1] - ends[0]) / 2
    black = quad((base[0], 0, base[1]), (reach[0], 0, reach[1]), (0, 0.5, 0))
    yield lit(
        "beam of a prism",
        [("floor", patch), ("glass", prism), ("black", black)],
        {"glass": glass(index), "black": diffuse(0)},
        [light],
        side,
        direct + power / area,
        "E cos d + E A cos i (1 - r)^2 / (1 - r^3) / S, the mean of both polarizations",
        "reflection at its faces left out",
        direct + power / through / area,
        words,
        quick,
        eye=(start[0], 0, start[1]),
        target=(place[0], 0, place[1]),
        up=(0, 1, 0),
        polarization="on",
    )


def rows(quick):
    for part in (slabs, mirrors, pieces, balls, beam):
        yield from part(quick)
