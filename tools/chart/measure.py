"""Errors and processor seconds of the series of a chart.

    measured = measure(renderers, chart, profile)       # label -> Measured

The error is the root of the mean of (x - r)^2 / (r^2 + 0.01) over pixels and channels of linear Rec.709, unclamped, box
filter; RMS is the root mean square of x - r. r is a converged picture, rendered as two halves with different seeds.
(x - r)^2 is computed as the product of the differences from both halves, so their noise does not raise it. Seconds are
user and system time: of the whole process, or, if a renderer lives in a Python process, of rendering there. The
smallest of the repeats counts. The time before the first sample is found from the shortest and the longest run, and
reported separately.
"""

import os
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np
from .scenes import Chart, Profile, Series

HALVES = (10_000, 20_000)


class Point(NamedTuple):
    """The smallest time of the repeats at a number of samples, and the medians of their errors.

    `common` is the error against the common reference."""

    samples: int
    cpu_seconds: float
    error: float
    rms: float
    common: float


class Reference(NamedTuple):
    """A converged picture as two halves with different seeds, each (height, width, 3)."""

    first: np.ndarray
    second: np.ndarray

    @property
    def mean(self) -> np.ndarray:
        return (self.first + self.second) / 2


class Measured(NamedTuple):
    """The points of a series, in seconds without `start`, and how its converged picture differs from the common one."""

    points: list[Point]
    start: float
    reference: Reference | None
    difference: float
    unseen: float  # the largest difference that noise alone could show
    brightness: float


def root_mean(squared: np.ndarray) -> float:
    return float(np.sqrt(max(np.nanmean(squared), 0)))


def weight(reference: Reference) -> np.ndarray:
    return 1 / (reference.mean**2 + 0.01)


def error(picture: np.ndarray, reference: Reference) -> tuple[float, float]:
    """Returns the relative and absolute RMS error, from the differences to both halves, whose noise is independent."""
    squared = (picture - reference.first) * (picture - reference.second)
    return root_mean(squared * weight(reference)), root_mean(squared)


def difference(one: Reference, common: Reference) -> tuple[float, float]:
    """Returns the relative RMS difference of two converged pictures, and the largest that noise alone could show.

    The noise of the halves cancels in the mean, even if both pictures share seeds. The second value is the root of two
    standard errors of that mean."""
    squared = np.mean((one.first - common.first) * (one.second - common.second) * weight(common), axis=-1)
    pixels = squared[np.isfinite(squared)]
    return root_mean(pixels), float(np.sqrt(2 * pixels.std() / np.sqrt(pixels.size)))


def start_of(samples: list[int], seconds: list[float]) -> float:
    """Extrapolates the seconds for no samples, on the line through the shortest and the longest run."""
    rate = (seconds[-1] - seconds[0]) / (samples[-1] - samples[0]) if len(samples) > 1 else 0.0
    return float(np.clip(seconds[0] - rate * samples[0], 0.0, seconds[0] / 1.01)) if rate > 0 else 0.0


def converged(renderer, samples: int) -> Reference:
    return Reference(*(renderer.run(samples, seed)[0] for seed in HALVES))


def or_none(label: str, render, *arguments):
    """Returns what a renderer makes. If it fails, prints the reason in a line and returns None; the others go on."""
    try:
        return render(*arguments)
    except (RuntimeError, OSError, ValueError) as words:
        print(f"{label} is left out, as it failed: {reason(str(words).removeprefix(f'{label} failed: '))}", flush=True)
        return None


def reason(said: str) -> str:
    """Returns the line with the reason: the last about an error, unless a signal came last; else the last."""
    lines = [line.strip() for line in said.splitlines() if line.strip()] or ["it said nothing"]
    errors = [line for line in lines if "error" in line.lower()]
    return errors[-1] if errors and "signal" not in lines[-1] else lines[-1]


def repeat(renderer, one: Series, seed: int) -> list[tuple[np.ndarray, float]]:
    """Returns a picture and its seconds for each number of samples."""
    return [renderer.run(samples, seed) for samples in one.samples]


def measure(renderers: dict, chart: Chart, profile: Profile) -> dict[str, Measured]:
    """Measures each series at each number of samples; a series that fails is left out.

    The series take turns, so that all meet the same conditions of the machine. The converged pictures, whose time does
    not count, are rendered in parallel."""
    series = {one.label: one for one in chart.series if one.label in renderers}
    seeded = [label for label, one in series.items() if one.renderer != "povray"]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        longest = [profile.reference * chart.longer * series[label].samples[-1] for label in seeded]
        found = pool.map(or_none, seeded, [converged] * len(seeded), (renderers[label] for label in seeded), longest)
        references = {label: one for label, one in zip(seeded, found, strict=True) if one is not None}
    if not references:
        return {}
    common = references[chart.common if chart.common in references else next(iter(references))]
    runs = {label: {n: [] for n in one.samples} for label, one in series.items()
            if label in references or label not in seeded}  # fmt: skip
    for label, one in series.items():
        if one.renderer == "mitsuba" and label in runs:  # warm-up: it compiles for each length
            if or_none(label, repeat, renderers[label], one, 1000) is None:
                del runs[label]
    for seed in range(1, profile.repeats + 1):
        for label, own in list(runs.items()):
            judge = common if chart.common else references.get(label, common)
            pictures = or_none(label, repeat, renderers[label], series[label], seed)
            if pictures is None:
                del runs[label]
                continue
            for results, (picture, seconds) in zip(own.values(), pictures, strict=True):
                results.append((seconds, *error(picture, judge), error(picture, common)[0]))
    return {label: summary(own, references.get(label), common, label in seeded) for label, own in runs.items()}


def summary(runs: dict[int, list], reference: Reference | None, common: Reference, counts: bool) -> Measured:
    """Summarizes a series. `counts` says whether its seconds grow with its samples, so that the start can be found."""
    medians = {samples: np.median(results, axis=0).tolist() for samples, results in runs.items()}
    least = [min(seconds for seconds, *_ in results) for results in runs.values()]  # other programs only add to them
    start = start_of(list(runs), least) if counts else 0.0
    points = [
        Point(samples, seconds - start, *row[1:])
        for (samples, row), seconds in zip(medians.items(), least, strict=True)
    ]
    if reference is None:
        return Measured(points, start, None, float("nan"), float("nan"), float("nan"))
    brightness = float(np.nanmean(reference.mean) / np.nanmean(common.mean))
    return Measured(points, start, reference, *difference(reference, common), brightness)
