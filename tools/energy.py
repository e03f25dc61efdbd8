"""Renders scenes whose answer is known in closed form and judges them, band by band.

    python tools/energy.py              # the whole table
    python tools/energy.py --quick      # fewer bodies and angles, fewer pixels

Prints row, expected, measured, standard error, z and verdict; exit code 1 if a row fails. A row passes if it misses by
no more than z standard errors (3 sigma, Sidak-corrected for the number of judged values) plus rounding, and if its
standard error is at most 1e-3 of it. The standard error comes from two renders with different seeds.
"""

import argparse
import sys
import warnings
from statistics import NormalDist
from typing import NamedTuple

import numpy as np
import render
from energy_rows import rows, sky

# A value is a product of up to some 30 factors held in 32 bits, each rounded by at most 2^-24, and stored in 32 bits.
ROUNDING = 32 * 2.0**-24
STANDARD_ERROR = 1e-3
THREE_SIGMA = 0.0027
# How far one pixel may be off, in standard deviations of the pixels: behind glass they are not alike.
WORST_PIXEL = 30
COLOR = "color of a sky of (0.25, 0.5, 2) by the file's chromaticities"


class Measurement(NamedTuple):
    mean: np.ndarray  # per band
    standard_error: np.ndarray
    worst: float  # the largest miss of one pixel, in units of what WORST_PIXEL and rounding allow


def measure(row):
    """Pixels of both seeds, and from their differences an error that holds whatever the pixels' own means are."""
    pairs = [[render.render(toml_file(view), seed=seed) for seed in (1, 2)] for view in row.views]
    shares = [np.minimum(*(image.channels["A"] for image in pair)) for pair in pairs]
    covered = [share > 0 if row.holes else share == 1 for share in shares]
    views = list(zip(pairs, covered, strict=True))
    first, second = (np.concatenate([pair[i].rgb[rows] for pair, rows in views]) for i in (0, 1))
    pixels = (first + second) / 2
    deviation = np.sqrt(np.mean((first - second) ** 2, axis=0)) / 2
    misses = np.abs(pixels - row.expected) / (WORST_PIXEL * deviation + ROUNDING * np.abs(row.expected))
    return Measurement(pixels.mean(axis=0), deviation / np.sqrt(len(pixels)), misses.max())


def toml_file(scene):
    return "".join(f"{key} = {toml(value)}\n" for key, value in scene.items())


def toml(value):
    """An inline TOML value."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {toml(item)}" for key, item in value.items()) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(toml, value)) + "]"
    return f'"{value}"' if isinstance(value, str) else repr(value)


def z_limit(count):
    """What |z| of none of `count` independent values exceeds but with the probability of 3 sigma (Sidak 1967)."""
    return NormalDist().inv_cdf(0.5 + (1 - THREE_SIGMA) ** (1 / count) / 2)


def judge(row, limit):
    """Prints one line per band and answers whether the row passes."""
    expected = np.broadcast_to(row.expected, 3)
    result = measure(row)
    passes = np.abs(result.mean - expected) <= limit * result.standard_error + ROUNDING * np.abs(expected)
    passes &= result.standard_error <= STANDARD_ERROR * np.abs(expected)
    passes &= result.worst <= 1 or not row.every_pixel
    show(row.name, "RGB", expected, result.mean, result.standard_error, passes)
    return passes.all()


def colour_science():
    """The package, without its remark at import that SciPy is not there: nothing here needs it."""
    with warnings.catch_warnings(action="ignore"):
        import colour
    return colour


def judge_color():
    """The color that a file's chromaticities give its numbers, against colour-science's ITU-R BT.709."""
    colour = colour_science()
    numbers = np.array([0.25, 0.5, 2.0])
    image = render.render(toml_file(sky(numbers.tolist())))
    stored = np.array(image.header["chromaticities"]).reshape(4, 2)
    measured = colour.normalised_primary_matrix(stored[:3], stored[3]) @ image.rgb[0, 0]
    space = colour.RGB_COLOURSPACES["ITU-R BT.709"].copy()
    space.use_derived_transformation_matrices(True)
    expected = space.matrix_RGB_to_XYZ @ numbers
    passes = np.abs(measured - expected) <= ROUNDING * expected
    show(COLOR, "XYZ", expected, measured, np.zeros(3), passes)
    return passes.all()


def show(name, letters, expected, measured, errors, passes):
    for letter, truth, value, error, good in zip(letters, expected, measured, errors, passes, strict=True):
        z = f"{(value - truth) / error:6.2f}" if error > ROUNDING * abs(truth) / 10 else " exact"
        print(f"{name:66} {letter} {truth:10.7f} {value:10.7f} {error:8.1e} {z}  {'ok' if good else 'FAIL'}")


def main(arguments=None):
    parser = argparse.ArgumentParser(description="Judges renders of scenes with known answers.")
    parser.add_argument("--quick", action="store_true", help="fewer bodies and angles, fewer pixels")
    table = rows(parser.parse_args(arguments).quick)
    limit = z_limit(3 * len(table))
    print(f"{'row':68} {'expected':>10} {'measured':>10} {'error':>8} {'z':>6}  verdict (|z| at most {limit:.2f})")
    failed = [row.name for row in table if not judge(row, limit)]
    failed += [] if judge_color() else [COLOR]
    print(f"{len(table) + 1 - len(failed)} of {len(table) + 1} rows pass", *failed, sep="\n  FAILED: ")
    return int(bool(failed))


if __name__ == "__main__":
    sys.exit(main())
