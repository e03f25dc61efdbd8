"""Optics II: where rays go. Angles and places are read off a screen (bench.py), never from the renderer's internals."""

import numpy as np

from . import formulas
from .bench import FINE, THICK, Experiment, Screen, bench, column_ratios, drop, middles, prism, ratios
from .color import line_powers
from .formulas import C_LINE, D_LINE, F_LINE, RED_GREEN_BLUE
from .row import Row
from .scenes import extrude, glass, sphere

FAR = 1000.0
COATED = {"reflectance": 0}
BENCH = (
    "Rays along -z, parallel, in planes of constant y; the upper half of the picture sees a diffuse screen whose "
    "reflectance "
    "rises from 0.1 to 0.9, the lower half an even one of 0.5, both lit by parallel light; what the glass reflects "
    "is black. "
)


def window(angles, half_width=5.0):
    """Returns a screen around a direction. Its rising half covers `half_width` degrees on either side."""
    return Screen(round(float(np.mean(angles)), 1), FAR, 2 * FAR * float(np.tan(np.radians(half_width))))


def degrees_of_rounding(screen, factor=1.0):
    return factor * np.degrees(screen.rounding() / screen.distance)


def together(measured, expected):
    """Returns an explanation if colors that should separate do not."""
    if np.ptp(measured) < 0.1 * np.ptp(expected):
        angles = ", ".join(f"{value:.2f}" for value in expected)
        return f"all three lanes leave at the same angle {measured.mean():.1f}; expected {angles}: no dispersion"
    return None


def prism_rgb(name, apex=60.0):
    """Returns a row for a prism at minimum deviation of the d line; red, green and blue are the lines C, e and F."""
    incidence = formulas.least_incidence(formulas.index(name, D_LINE), apex)
    indices = formulas.index(name, np.array(RED_GREEN_BLUE))
    expected = formulas.prism_deviation(indices, apex, incidence)
    screen = window(expected)
    scene = bench([prism(indices[1], apex, incidence, 0.1)], screen, glass(name, **COATED))
    words = BENCH + (
        f"A {apex:g} degree prism of {name} (C, e, F: {', '.join(f'{n:.5f}' for n in indices)} for red, green, blue) "
        f"at "
        f"{incidence:.4f} degrees; the screens stand at {screen.degrees} degrees, {FAR:g} away, "
        f"{2 * screen.half_width:.2f} wide."
    )
    return Row(
        "optics",
        f"prism {name} rgb",
        "i + asin(n sin(A - asin(sin i / n))) - A",
        scene,
        lambda image: screen.angle(column_ratios(image)),
        expected,
        "no dispersion: one index for all lanes",
        formulas.prism_deviation(formulas.index(name, D_LINE), apex, incidence),
        words,
        rounding=degrees_of_rounding(screen),
        explain=together,
    )


def line_row(
    name, experiments, screen, lines, pick, expected, mistake, guards, formula, title, words, reader=None, fine=FINE
):
    """Returns a row for a bench in the light of spectral lines; `pick` lists experiment and line of each value."""
    powers, amplified = line_powers(lines)
    light = {"lines": [[nm, 1] for nm in lines]}

    def read(image):
        pixels = middles(image) @ powers.T  # of every line
        ratio = pixels[0::2] / pixels[1::2]
        return np.array([[(reader or screen.angle)(ratio[e, line]) for e, line in pick]])

    scene = bench(
        experiments, screen, glass(name, **COATED), light, space="lin_ciexyzd65_scene", model={"bands": 8}, fine=fine
    )
    rounding = degrees_of_rounding(screen, amplified) if reader is None else screen.rounding() * amplified
    return Row("optics", title, formula, scene, read, expected, guards, mistake, BENCH + words, rounding=rounding)


def least_deviation(name):
    """Returns a row for the lines F, d and C, each at its own minimum deviation: three prisms, three lines."""
    lines = (F_LINE, D_LINE, C_LINE)
    indices = formulas.index(name, np.array(lines))
    apex = 60.0 if indices.max() < 1.9 else 20.0
    incidences = formulas.least_incidence(indices, apex)
    expected = 2 * incidences - apex
    screen = window(expected)
    experiments = [prism(n, apex, i) for n, i in zip(indices, incidences, strict=True)]
    words = f"Three {apex:g} degree prisms of {name}, in the light of the lines F, d and C of equal power."
    return line_row(
        name,
        experiments,
        screen,
        lines,
        [(0, 0), (1, 1), (2, 2)],
        expected,
        expected.mean(),
        "one index for all wavelengths",
        "2 asin(n sin(A / 2)) - A",
        f"prism {name} least deviation F d C",
        words,
    )


def fan(name, incidence, lines, label):
    expected = formulas.prism_deviation(formulas.index(name, np.array(lines)), 60, incidence)
    screen = window(expected)
    experiments = [prism(formulas.index(name, lines[1]), 60, incidence)]
    straight = formulas.index(name, F_LINE) + (np.array(lines) - F_LINE) / (C_LINE - F_LINE) * (
        formulas.index(name, C_LINE) - formulas.index(name, F_LINE)
    )
    words = f"A 60 degree prism of {name} at {incidence:.5f} degrees, in the light of {lines} nm of equal power."
    return line_row(
        name,
        experiments,
        screen,
        lines,
        [(0, 0), (0, 1), (0, 2)],
        expected,
        formulas.prism_deviation(straight, 60, incidence),
        "an index on a straight line from F to C",
        "i + asin(n sin(A - asin(sin i / n))) - A",
        f"prism {name} fan {label}",
        words,
    )


def rainbow(reflections, index, name=None):
    """Returns a row for the ray of the bow and two at 2 degrees of incidence beside it, which must deviate more."""
    steep = formulas.bow_incidence(index, reflections)
    incidences = [steep - 2, steep, steep + 2]
    turned = np.array([formulas.drop_deviation(index, i, reflections) for i in incidences])
    screen = window(turned, 0.25)
    experiments = [drop(index, i, reflections) for i in incidences]
    # Measured from the direction opposite to the sun.
    bow = np.abs(180 - turned) if reflections == 1 else np.abs(turned - 180)
    scene = bench(experiments, screen, glass(index))
    words = BENCH.replace("; what the glass reflects is black", "") + (
        f"Three drops of index {index}, met at {', '.join(f'{i:.4f}' for i in incidences)} degrees; light that is "
        f"reflected inside "
        f"{reflections} x falls on the screens, which stand at {screen.degrees} degrees."
    )
    ordinal = {1: "primary", 2: "secondary"}[reflections]
    return Row(
        "optics",
        f"rainbow {ordinal} index {index}",
        "2 (i - r) + k (180 - 2 r), cos^2 i = (n^2 - 1) / (k (k + 2))",
        scene,
        lambda image: np.abs(180 - screen.angle(ratios(image)[None, :, 1])),
        bow,
        "the index of the next color, 0.003 beside",
        np.abs(180 - np.array([formulas.drop_deviation(index + 0.003, i, reflections) for i in incidences])),
        words,
        rounding=degrees_of_rounding(screen),
    )


def colored_bow(reflections, lines, label):
    """Returns a row for the bow of water: each line is read at the incidence of its own bow."""
    indices = formulas.index("water", np.array(lines))
    steep = formulas.bow_incidence(indices, reflections)
    turned = formulas.drop_deviation(indices, steep, reflections)
    screen = window(turned, 3.0 if reflections == 1 else 2.0)
    experiments = [drop(n, i, reflections) for n, i in zip(indices, steep, strict=True)]
    row = line_row(
        "water",
        experiments,
        screen,
        lines,
        [(0, 0), (1, 1), (2, 2)],
        np.abs(turned - 180),
        np.abs(turned - 180).mean(),
        "one bow for all colors",
        "2 (i - r) + k (180 - 2 r)",
        f"rainbow of water, {label}",
        f"Three drops of water, each met where the bow of its line ({lines} nm) is.",
        lambda ratio: np.abs(screen.angle(ratio) - 180),
        3 * FINE,
    )
    row.scene["material"]["glass"] = glass("water")
    return row._replace(rounding=degrees_of_rounding(screen, line_powers(lines)[1]))


def shift(index, degrees, thickness=0.01):
    """Returns a row for the parallel displacement by a tilted plate."""
    expected = formulas.slab_shift(index, degrees, thickness)
    angle = np.radians(degrees)
    normal, side = np.array([-np.sin(angle), np.cos(angle)]), np.array([np.cos(angle), np.sin(angle)])
    polygon = [
        10 * thickness * s * side - depth * normal for s, depth in ((-1, 0), (1, 0), (1, thickness), (-1, thickness))
    ]
    screen = Screen(0.0, 1.0, 4 * thickness)
    scene = bench([Experiment(lambda y: extrude(polygon, y, THICK), (0, 0))], screen, glass(index, **COATED))
    words = (
        BENCH + f"A plate of index {index}, {thickness} thick, tilted by {degrees} degrees; the screens are "
        f"{4 * thickness} half wide."
    )
    return Row(
        "optics",
        f"shift by a plate of index {index} at {degrees} degrees",
        "d sin t (1 - cos t / sqrt(n^2 - sin^2 t))",
        scene,
        lambda image: screen.place(ratios(image)[:, 1:2]),
        expected,
        "refraction by the angle instead of its sine",
        thickness * np.sin(angle - angle / index) / np.cos(angle / index),
        words,
        rounding=screen.rounding(),
    )


def ball(name, height):
    """Returns a row for the focus of a ball of radius 1: where a ray off the axis crosses it, for three lines."""
    lines, radius = (F_LINE, D_LINE, C_LINE), 0.008
    indices = formulas.index(name, np.array(lines))
    expected = formulas.ball_focus(indices, height)
    distance = 3 * radius
    # The ball is placed so that the ray meets it `height` radii from its axis, on the -x side, which bends it toward
    # +x.
    center = height * radius
    turned = np.arcsin(height / expected)
    place = radius * (3 * np.sin(turned) - height) / np.cos(turned)
    screen = Screen(0.0, distance, 3 * float(np.abs(place).max()))
    body = Experiment(lambda y: sphere((center, y, 0), radius), (center, 0))

    def focus(place):
        """Returns the focus from a place on the screen: the ray leaves as far from the center as it arrived."""
        place, turned = place / radius, 0.5
        for _ in range(200):  # place = (3 sin d - h) / cos d
            turned = np.arcsin(np.clip((place * np.cos(turned) + height) / 3, -1, 1))
        return height / np.sin(turned)

    far = height > 0.05
    row = line_row(
        name,
        [body],
        screen,
        lines,
        [(0, 0), (0, 1), (0, 2)],
        expected,
        formulas.ball_focus(indices, 1e-9) if far else expected.mean(),
        "paraxial optics far from the axis" if far else "one focus for all colors",
        "h / sin(2 (asin h - asin(h / n))), n / (2 (n - 1)) near the axis",
        f"ball lens {name} at height {height}",
        f"A ball of {name} and radius {radius}, met {height} radii from its axis; the screens are {distance} behind "
        f"its "
        f"center and {screen.half_width} half wide.",
        lambda ratio: focus(screen.place(ratio)),
        # Near the axis colors separate little, and details below a fifth of a pixel are not modelled.
        FINE if far else 3 * FINE,
    )
    return row._replace(rounding=np.abs(focus(place + row.rounding) - focus(place)))


def rows(quick):
    for name in ("N-BK7", "N-SF11", "fused silica"):
        yield prism_rgb(name)
    for name in (
        "N-BK7",
        "N-SF11",
        "fused silica",
        "water",
        "diamond",
        "sapphire",
        "schott/F2",
        "N-FK51A",
        "N-LASF9",
        "N-SF10",
        "N-BAK4",
        "N-K5",
    ):
        yield least_deviation(name)
    at_d = formulas.least_incidence(formulas.index("N-BK7", D_LINE), 60)
    yield fan("N-BK7", float(at_d), (404.66, 546.07, 700.0), "404 to 700 nm")
    yield fan("N-BK7", float(at_d), (435.83, 546.07, 632.8), "436 to 633 nm")
    yield fan("N-SF11", 70.0, (404.66, 546.07, 700.0), "at 70 degrees")
    for index in (1.331, 1.333, 1.3435):
        yield rainbow(1, index)
        yield rainbow(2, index)
    yield colored_bow(1, (435.83, 546.07, 656.27), "primary")
    yield colored_bow(1, (404.66, 501.57, 700.0), "primary, from violet to deep red")
    for index, degrees in ((1.5168, 45), (1.5168, 60), (1.78472, 30), (2.4175, 75)):
        yield shift(index, degrees)
    for height in (0.02, 0.3, 0.6):
        yield ball("N-BK7", height)
    yield ball("N-SF11", 0.3)
