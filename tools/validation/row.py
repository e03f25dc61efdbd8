"""A row of the book, and how the images of its scene are judged.

The standard error comes from the differences of two seeds pixel by pixel; from the spread of the means of more seeds,
if a photon or a light path lights many pixels; or from the spread of the pixels, if there is one image. The bound of
rounding is added to it: a stored value is a product of up to 32 factors in 32 bits, each off by at most 2^-24. If a few
pixels hold nearly all of the noise, its spread is no good estimate of its size, and the row fails.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

ROUNDING = 32 * 2.0**-24
LIMIT = 4.0
# A standard error can tell a value from that of the mistake if it is at most this share of their difference.
SHARE = 0.25
# The largest share of a row's values, of ten or more, that the mistake may happen to change less.
ALIKE = 0.1
# The fewest pixels that may carry the noise: a third of all pixels for normal noise, one for a barely sampled tail.
# With fewer than four, the estimated variance is itself off by half.
CARRIERS = 4
# The fewest pixels for which this is tested.
ASKED = 100
# The largest error of one pixel if all should be equal, in standard deviations of the pixels, which vary behind glass.
WORST_PIXEL = 30


class Row(NamedTuple):
    group: str
    name: str
    formula: str
    scene: dict
    read: Callable  # image -> estimates (how many, values); each is one measurement of all values
    expected: object  # a number, or one for each value
    guards_against: str  # a plausible mistake ..
    mistake: object  # .. and what it would measure
    words: str  # the scene in a sentence, for building it elsewhere
    seeds: int = 1  # 1: nothing is random
    rounding: object = None  # bound on the rounding error of each value, if it is not ROUNDING of the value
    every_pixel: bool = False  # each pixel has the expected value, not only their mean
    explain: Callable | None = None  # (measured, expected) -> why, in words, or none


class Judged(NamedTuple):
    row: Row
    expected: np.ndarray
    measured: np.ndarray
    standard_error: np.ndarray
    z: np.ndarray
    effect: np.ndarray
    estimates: int  # number of measurements of each value in an image
    reasons: list[str]  # why it fails; empty if it passes

    @property
    def passes(self):
        return not self.reasons


def statistics(estimates):
    """Returns mean, standard error, and standard deviation of one estimate, from the estimates of every image."""
    if len(estimates) == 2:
        first, second = estimates
        deviation = np.sqrt(np.mean((first - second) ** 2, axis=0) / 4)
        return (first + second).mean(axis=0) / 2, deviation / np.sqrt(len(first)), deviation
    if len(estimates) > 1:
        means = np.array([one.mean(axis=0) for one in estimates])
        deviation = means.std(axis=0, ddof=1)
        return means.mean(axis=0), deviation / np.sqrt(len(means)), deviation
    (only,) = estimates
    deviation = only.std(axis=0, ddof=1) if len(only) > 1 else np.zeros(only.shape[1])
    return only.mean(axis=0), deviation / np.sqrt(len(only)), deviation


def carriers(first, second):
    """Returns how many pixels carry the noise of each value, (sum d^2)^2 / sum d^4 of two images' differences d.

    The relative error of an estimated variance is about one over the root of that number."""
    squares = (first - second) ** 2
    return squares.sum(axis=0) ** 2 / np.maximum((squares**2).sum(axis=0), 1e-300)


def judge(row, images):
    """Judges a row by its images."""
    if not all(np.isfinite(image.rgb).all() for image in images):
        return unmeasured(row, "the file has values that are not finite")
    with np.errstate(all="ignore"):  # NaN is reported as such
        estimates = [np.asarray(row.read(image), float) for image in images]
    # Estimates that are NaN in one image are left out in all: pixels that a body does not cover.
    estimates = np.array([one.reshape(len(one), -1) for one in estimates])
    estimates = estimates[:, ~np.isnan(estimates).any(axis=(0, 2))]
    if not estimates.size:
        raise ValueError("no pixel holds a number that this row could be read from")
    measured, statistical, deviation = statistics(estimates)
    expected = np.broadcast_to(np.asarray(row.expected, float), measured.shape)
    mistake = np.broadcast_to(np.asarray(row.mistake, float), measured.shape)
    rounding = ROUNDING * np.abs(expected) if row.rounding is None else np.broadcast_to(row.rounding, measured.shape)
    error = np.hypot(statistical, np.maximum(rounding, 1e-30))
    effect = np.abs(mistake - expected)
    z = (measured - expected) / error
    reasons = []
    if (np.abs(z) > LIMIT).any():
        reasons.append(
            (row.explain and row.explain(measured, expected)) or why(row, measured, expected, mistake, error)
        )
    # A mistake that changes nothing, as in the Y of white, cannot be detected. Among many colors a few may be
    # unaffected.
    touched = effect > 1e-12 * np.abs(expected)
    if not touched.any() or (error > SHARE * effect)[touched].mean() > ALIKE:
        reasons.append(
            f"too noisy to tell: the standard error {most(error, effect):.2g} is wider than a quarter of what "
            f"the mistake does ({row.guards_against})"
        )
    if len(estimates) == 2 and len(estimates[0]) >= ASKED:
        carried = carriers(*estimates)[statistical > rounding].min(initial=np.inf)
        if carried < CARRIERS:
            reasons.append(
                f"a heavy tail: about {carried:.0f} of {len(estimates[0])} pixels carry the noise, so that it may be "
                f"larger than its standard error says"
            )
    if row.every_pixel and not reasons:
        pixels = np.mean(estimates, axis=0)
        worst = np.abs(pixels - expected) / (WORST_PIXEL * deviation + np.maximum(rounding, 1e-30))
        if worst.max() > 1:
            reasons.append(
                f"one pixel has {numbers(pixels[worst.max(axis=1).argmax()])}, all should have {numbers(expected)}"
            )
    return Judged(row, expected, measured, error, z, effect, estimates.shape[1], reasons)


def unmeasured(row, reason):
    """Returns a row that fails because nothing could be measured."""
    expected = np.atleast_1d(np.asarray(row.expected, float))
    nothing = np.full(expected.shape, np.nan)
    return Judged(row, expected, nothing, nothing, nothing, nothing, 0, [reason])


def most(error, effect):
    """Returns the standard error of the value in which the mistake is hardest to see."""
    return error[np.argmax(error / np.where(effect > 0, effect, np.inf))]


def why(row, measured, expected, mistake, error):
    """Says what is wrong, and whether it looks like the mistake that the row guards against."""
    text = f"{numbers(measured)} was measured; expected {numbers(expected)}"
    nearer = np.linalg.norm((measured - mistake) / error) < 0.5 * np.linalg.norm((measured - expected) / error)
    return f"{text}: as if by {row.guards_against}" if nearer else text


def numbers(values):
    """Formats a few numbers for reading."""
    values = np.unique(np.round(np.atleast_1d(values), 10)) if np.ptp(values) == 0 else np.atleast_1d(values)
    return ", ".join(f"{value:.7g}" for value in values)
