"""Renders scenes whose answer is known in closed form and judges them, band by band.

    python tools/energy.py              # the whole table
    python tools/energy.py --quick      # fewer bodies and angles, fewer pixels

Prints row, expected, measured, standard error, z and verdict; exit code 1 if a row fails. A row passes if it misses by
no more than z standard errors (3 sigma, Sidak-corrected for the number of judged values) plus rounding, and if its
standard error is at most 1e-3 of it. The standard error comes from two renders with different seeds.
"""

import argparse
import sys
from statistics import NormalDist
from typing import NamedTuple

import numpy as np
import render
from energy_rows import rows

# A value is a product of up to some 30 factors held in 32 bits, each rounded by at most 2^-24, and is stored in 32 bits.
ROUNDING = 32 * 2.0**-24
STANDARD_ERROR = 1e-3
THREE_SIGMA = 0.0027
# Where every pixel has the same expected value: how far one may be off, in standard deviations of the pixels.
WORST_PIXEL = 10


class Measurement(NamedTuple):
    mean: np.ndarray  # per band
    standard_error: np.ndarray
    worst: float  # the largest miss of one pixel, in units of what WORST_PIXEL and rounding allow


def measure(row):
    """Pixels of both seeds, and from their differences an error that holds whatever the pixels' own means are."""
    pairs = [[render.render(toml_file(view), seed=seed) for seed in (1, 2)] for view in row.views]
    covered = [np.minimum(*(image.channels["A"] for image in pair)) == 1 for pair in pairs]
    first, second = (np.concatenate([pair[i].rgb[rows] for pair, rows in zip(pairs, covered)]) for i in (0, 1))
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
    result = measure(row)
    expected = np.broadcast_to(row.expected, 3)
    difference = result.mean - expected
    passes = np.abs(difference) <= limit * result.standard_error + ROUNDING * np.abs(expected)
    passes &= result.standard_error <= STANDARD_ERROR * np.abs(expected)
    if row.every_pixel:
        passes &= result.worst <= 1
    for band, name in enumerate("RGB"):
        error = result.standard_error[band]
        z = f"{difference[band] / error:6.2f}" if error > ROUNDING * abs(expected[band]) / 10 else " exact"
        verdict = "ok" if passes[band] else "FAIL"
        print(f"{row.name:66} {name} {expected[band]:10.7f} {result.mean[band]:10.7f} {error:8.1e} {z}  {verdict}")
    return passes.all()


def main(arguments=None):
    parser = argparse.ArgumentParser(description="Judges renders of scenes with known answers.")
    parser.add_argument("--quick", action="store_true", help="fewer bodies and angles, fewer pixels")
    table = rows(parser.parse_args(arguments).quick)
    limit = z_limit(3 * len(table))
    print(f"{'row':68} {'expected':>10} {'measured':>10} {'error':>8} {'z':>6}  verdict (|z| at most {limit:.2f})")
    failed = [row.name for row in table if not judge(row, limit)]
    print(f"{len(table) - len(failed)} of {len(table)} rows pass", *failed, sep="\n  FAILED: ")
    return int(bool(failed))


if __name__ == "__main__":
    sys.exit(main())
