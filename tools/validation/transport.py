"""Transport: how much light goes from one surface to another."""

import numpy as np

from . import formulas, readers
from .row import Row
from .scenes import diffuse, disc, glow, plane, quad, sphere, sun, view

GROUP = "transport"
FLOOR = plane((0, 0, 0), (0, 1, 0))
ONCE = {"diffuse_bounces": 0}


def lit(name, lamp, irradiance, formula, guards, mistake, quick, words, normal=(0, 1, 0), samples=512):
    """Returns a row for a point of a white diffuse plane, lit by a lamp of radiance 1: irradiance / pi."""
    materials = {"floor": diffuse(1), "lamp": glow()}
    # The camera looks from the side, above the floor and below the lamp.
    eye = np.array([9.0, 1.0, 0.0]) if normal == (0, 1, 0) else 3 * np.array(normal) + np.array([0.5, 0.1, 0.2])
    size = 8 if quick else 24
    scene = view(
        materials, [("floor", plane((0, 0, 0), normal)), ("lamp", lamp)], eye=eye, size=size, samples=samples, **ONCE
    )
    return Row(
        GROUP,
        name,
        formula,
        scene,
        readers.gray,
        irradiance / np.pi,
        guards,
        mistake / np.pi,
        f"One point of a white diffuse plane of normal {normal}, the origin, under {words} of radiance 1; direct "
        f"light alone.",
        2,
        every_pixel=False,
    )


def lamps(quick):
    for radius, height in ((1, 2), (0.1, 1), (5, 1)):
        yield lit(
            f"floor under a disc of radius {radius}, {height} up",
            disc((0, height, 0), (0, -1, 0), radius),
            formulas.irradiance_under_disc(radius, height),
            "pi r^2 / (r^2 + d^2)",
            "the disc taken as a small one",
            np.pi * radius**2 / height**2,
            quick,
            f"a disc of radius {radius} at height {height}",
        )
    for half, height in ((1, 1), (0.2, 1), (4, 1)):
        yield lit(
            f"floor under a square of side {2 * half}, {height} up",
            quad((0, height, 0), (half, 0, 0), (0, 0, half)),
            formulas.irradiance_under_square(half, height),
            "4 x atan x, x = a / sqrt(a^2 + d^2)",
            "the square taken as a small one",
            (2 * half / height) ** 2,
            quick,
            f"a square of side {2 * half} at height {height}",
        )
    for radius, distance, tilt in ((0.5, 2, 0), (0.5, 2, 45), (1.9, 2, 0), (0.01, 5, 30)):
        angle = np.radians(tilt)
        center = (distance * np.sin(angle), distance * np.cos(angle), 0)
        expected = formulas.irradiance_under_sphere(radius, distance) * np.cos(angle)
        beyond = np.sqrt(distance**2 - radius**2)
        yield lit(
            f"floor under a ball of radius {radius}, {distance} away at {tilt} degrees",
            sphere(center, radius),
            expected,
            "pi (r / d)^2 cos t",
            "the ball taken as the solid angle of a disc at its center",
            np.pi * radius**2 / (radius**2 + distance**2) * np.cos(angle)
            if radius > 0.1
            else expected * (beyond - radius) / distance,
            quick,
            f"a ball of radius {radius} at {center}",
        )
    yield lit(
        "floor under a huge ball",
        sphere((0, 2e6, 0), 1e6),
        formulas.irradiance_under_sphere(1, 2),
        "pi (r / d)^2",
        "the ball taken as a disc at its center",
        np.pi / 5,
        quick,
        "a ball of radius 1e6, its center 2e6 above",
    )


def small_lights(quick):
    """Yields points, spots and suns; nothing is random, except for suns with an extent."""

    def row(name, light, expected, formula, guards, mistake, words):
        scene = view({"floor": diffuse(1)}, [("floor", FLOOR)], [light], eye=(9, 1, 0), **ONCE)
        return Row(
            GROUP,
            name,
            formula,
            scene,
            readers.gray,
            expected / np.pi,
            guards,
            mistake / np.pi,
            f"One point of a white diffuse floor, the origin, under {words}.",
        )

    for distance in (0.01, 1, 3, 1000):
        for tilt in (0, 60):
            angle = np.radians(tilt)
            place = [float(distance * np.sin(angle)), float(distance * np.cos(angle)), 0.0]
            light = {"point": {"position": place, "intensity": 2}}
            yield row(
                f"point light {distance} away at {tilt} degrees",
                light,
                2 * np.cos(angle) / distance**2,
                "I cos t / d^2",
                "1 / d, or the cosine left out",
                2 * np.cos(angle) ** 2 / distance**2 * (1 if tilt else 1.01),
                f"a point light of intensity 2 at {place}",
            )
    for tilt in (0, 30, 80):
        angle = np.radians(tilt)
        light = sun(tilt, 3)
        yield row(
            f"parallel light at {tilt} degrees",
            light,
            3 * np.cos(angle),
            "E cos t",
            "the cosine left out, or its square",
            3 * np.cos(angle) ** 2 if tilt else 3 / np.pi,
            f"parallel light of irradiance 3 toward {light['sun']['toward']}",
        )
    for degrees in (0, 14, 18, 25):
        angle, t = np.radians(degrees), (30 - degrees) / 15
        blend = 1.0 if degrees <= 15 else t * t * (3 - 2 * t)
        toward = [float(np.sin(angle)), float(-np.cos(angle)), 0.0]
        light = {
            "spot": {"position": [0.0, 2.0, 0.0], "toward": toward, "cone_angle": 60, "blend": 0.5, "intensity": 8}
        }
        yield row(
            f"spot, {degrees} degrees from its axis",
            light,
            2 * blend,
            "I b / d^2, b = 3 t^2 - 2 t^3 beyond half the cone",
            "a cone without a soft edge" if degrees > 15 else "power instead of intensity",
            2.0 if degrees > 15 else 2 / np.pi,
            f"a spot 2 above it, full cone 60 degrees, soft from 15 degrees on, {degrees} degrees off",
        )
    for diameter in (0.533, 20, 90):
        samples, size = (256, 8) if quick else (1024, 16)
        scene = view(
            {"floor": diffuse(1)}, [("floor", FLOOR)], [sun(0, 3, diameter)], eye=(9, 1, 0), samples=samples, size=size, **ONCE
        )
        solid = 2 * np.pi * (1 - np.cos(np.radians(diameter / 2)))
        radiance = 3 / (np.pi * np.sin(np.radians(diameter / 2)) ** 2)
        yield Row(
            GROUP,
            f"sun of {diameter} degrees overhead",
            "E",
            scene,
            readers.gray,
            3 / np.pi,
            "radiance times solid angle, without the cosine"
            if diameter > 1
            else "an irradiance that is spread over pi",
            radiance * solid / np.pi if diameter > 1 else 3 / np.pi**2,
            f"One point of a white diffuse floor under a sun of {diameter} degrees and irradiance 3 straight above.",
            2,
        )


def exchange(name, receiver, lamp, factor, formula, guards, mistake, camera, quick, words, round_receiver=False):
    """Returns a row for the mean of a receiver of reflectance 1 that fills the picture: its view factor to the lamp."""
    size, samples = (16, 128) if quick else (32, 512)
    settings = {"size": size, "samples": samples} | ONCE
    scene = view(
        {"receiver": diffuse(1), "lamp": glow()}, [("receiver", receiver), ("lamp", lamp)], **camera, **settings
    )
    reader, seeds = (readers.per_coverage, 6) if round_receiver else (readers.gray, 2)
    return Row(
        GROUP,
        name,
        formula,
        scene,
        reader,
        factor,
        guards,
        mistake,
        words + " Mean over the receiver, direct light alone.",
        seeds,
    )


def factors(quick):
    """Yields view factors: the mean irradiance of one surface by another."""
    small = "the factor of its middle point taken for all"
    down = {"up": (0, 0, -1), "target": (0, 0, 0)}
    for side, height in ((2, 2), (2, 0.5), (1, 3)):
        half = side / 2
        middle = formulas.irradiance_under_square(half, height) / np.pi
        name = "cube faces, opposite" if side == height else f"parallel squares of side {side}, {height} apart"
        yield exchange(
            name,
            quad((0, 0, 0), (half, 0, 0), (0, 0, -half)),
            quad((0, height, 0), (half, 0, 0), (0, 0, half)),
            formulas.parallel_squares(side, height),
            "C-11 of Howell",
            small,
            middle,
            {"eye": (0, height / 2, 0), "height": side} | down,
            quick,
            f"A square of side {side} seen from above; a lamp of the same size {height} over it.",
        )
    for width, length, height in ((2, 2, 2), (2, 1, 3), (1, 4, 0.5)):
        name = (
            "cube faces, adjacent"
            if width == length == height
            else f"perpendicular rectangles {length} and {height}, common edge {width}"
        )
        # The receiver fills the picture if both have the same proportions.
        receiver = quad((0, 0, length / 2), (width / 2, 0, 0), (0, 0, -length / 2))
        lamp = quad((0, height / 2, 0), (width / 2, 0, 0), (0, height / 2, 0))
        row = exchange(
            name,
            receiver,
            lamp,
            formulas.perpendicular_rectangles(width, length, height),
            "C-14 of Howell",
            small,
            formulas.point_beside_rectangle(width, length / 2, height),
            {"eye": (0, height / 4, length / 2), "height": length, "up": (0, 0, -1), "target": (0, 0, length / 2)},
            quick,
            f"A rectangle {width} x {length} seen from above; a lamp {width} x {height} stands on its edge.",
        )
        rows = row.scene["film"]["height"]
        row.scene["film"] |= {"width": max(1, round(rows * width / length)), "height": rows}
        yield row
    for first, second, height in ((1, 1, 1), (1, 0.5, 0.5), (0.5, 2, 1)):
        yield exchange(
            f"coaxial discs of radii {first} and {second}, {height} apart",
            disc((0, 0, 0), (0, 1, 0), first),
            disc((0, height, 0), (0, -1, 0), second),
            formulas.coaxial_discs(first, second, height),
            "C-41 of Howell",
            small,
            formulas.irradiance_under_disc(second, height) / np.pi,
            {"eye": (0, height / 2, 0), "height": 2 * first} | down,
            quick,
            f"A disc of radius {first} seen from above; a disc lamp of radius {second} {height} over it.",
            True,
        )


def rows(quick):
    for part in (lamps, small_lights, factors):
        yield from part(quick)
