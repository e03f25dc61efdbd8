"""Findings of a chart in words, computed from its points: the ratio of times to equal error, and where curves cross.

    seconds_to(0.02, curve)                     # (0.8, "measured")
    compare("Abbe", ours, "LuxCore", theirs)    # "To 5 % Abbe takes 0.52 x the CPU time of LuxCore (..): ahead."

A curve is a list of (seconds, error), in ascending order of seconds. It is interpolated linearly in log-log. Beyond its
ends the error is taken to fall as one over the square root of the time, which is called extrapolated. Times within a
factor of 1.2 are a tie.
"""

import math
from itertools import pairwise

LEVELS = (0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001)
TIE = 1.2

Curve = list[tuple[float, float]]


def falling(curve: Curve) -> Curve:
    """Returns the points with a smaller error than all before them: the best that a series reaches within a time."""
    best, kept = math.inf, []
    for seconds, error in curve:
        if 0 < error < best:
            best = error
            kept.append((seconds, error))
    return kept


def steady(curve: Curve) -> bool:
    """Whether the error falls at least as fast as time^(-1/4). An error dominated by rare paths does not."""
    if len(curve) < 2:
        return False
    (t0, e0), (t1, e1) = curve[0], curve[-1]
    return min(e0, e1) > 0 and math.log(e1 / e0) <= -0.25 * math.log(t1 / t0)


def unsteady_words(name: str) -> str:
    return f"The error of {name} does not fall steadily with its time here: rare bright paths decide it"


def seconds_to(error: float, curve: Curve) -> tuple[float, str]:
    """Returns the seconds needed to reach an error, and whether that is measured or extrapolated."""
    curve = falling(curve)
    for (t0, e0), (t1, e1) in pairwise(curve):
        if e1 <= error <= e0:
            share = math.log(error / e0) / math.log(e1 / e0)
            return t0 * (t1 / t0) ** share, "measured"
    end = curve[0] if error >= curve[0][1] else curve[-1]
    if math.isclose(error, end[1]):
        return end[0], "measured"
    return end[0] * (end[1] / error) ** 2, "extrapolated"


def crossings(first: Curve, second: Curve) -> list[tuple[float, float]]:
    """Returns errors and seconds at which one curve overtakes the other, where both are measured.

    The largest error comes first. Curves that only touch do not cross: on either side of a crossing, one must somewhere
    take longer by more than a tie."""
    first, second = falling(first), falling(second)
    if min(len(first), len(second)) < 2:
        return []
    low, high = max(first[-1][1], second[-1][1]), min(first[0][1], second[0][1])
    knots = sorted({low, high, *(e for _, e in first + second if low < e < high)}, reverse=True)
    gap = lambda e: math.log(seconds_to(e, first)[0] / seconds_to(e, second)[0])  # noqa: E731
    clear = [(error, gap(error)) for error in knots if abs(gap(error)) > math.log(TIE)]
    found = []
    for (early, before), (late, after) in pairwise(clear):
        if before * after > 0:
            continue
        inside = [error for error in knots if late <= error <= early]
        for high, low in pairwise(inside):
            a, b = gap(high), gap(low)
            if a * after <= 0 <= b * after:
                error = math.exp(math.log(high) + a / (a - b) * math.log(low / high)) if a != b else low
                found.append((error, seconds_to(error, first)[0]))
                break
    return found


def percent(error: float) -> str:
    return f"{100 * error:.2g} %" if error < 0.995 else f"{100 * error:.0f} %"


def times(ratio: float) -> str:
    return f"{ratio:.0f} x" if ratio >= 99.5 else f"{ratio:.2g} x"


def rank(ratio: float) -> str:
    return "ahead" if ratio < 1 / TIE else "behind" if ratio > TIE else "a tie"


def levels_for(first: Curve, second: Curve) -> list[float]:
    """Returns the smallest and the largest round error that both curves reach as measured.

    Without one, returns where they come closest: if their errors do not overlap, that is the first point of the better
    curve. Extrapolating it to larger errors would mean nothing, because even little work may take this long to start.
    """
    ends = [falling(curve) for curve in (first, second)]
    low, high = max(curve[-1][1] for curve in ends), min(curve[0][1] for curve in ends)
    if both := [level for level in LEVELS if low <= level <= high]:
        return sorted({min(both), max(both)})
    if low <= high:
        return [low]
    return [high]


def ratio_at(error: float, first: Curve, second: Curve) -> tuple[float, str]:
    """Returns the ratio of the first curve's seconds to the second's, and whether it is measured or extrapolated."""
    (ours, sure), (theirs, also) = seconds_to(error, first), seconds_to(error, second)
    return ours / theirs, "extrapolated" if "extrapolated" in (sure, also) else "measured"


def compare(name: str, ours: Curve, other: str, theirs: Curve) -> str:
    """Compares the times to an equal error in words, and says where the curves cross."""
    if not falling(ours) or not falling(theirs):
        return f"{name} and {other} cannot be compared: the error of one is below the noise of the reference."
    error, *coarser = levels_for(ours, theirs)
    seconds = [seconds_to(error, curve) for curve in (ours, theirs)]
    ratio, sure = ratio_at(error, ours, theirs)
    figures = " for ".join(f"{value:.2g} s" for value, _ in seconds)
    note = "" if sure == "measured" else ", extrapolated"
    words = f"To {percent(error)} {name} takes {times(ratio)} the CPU time of {other} ({figures}{note}): {rank(ratio)}"
    for level in coarser:
        words += f"; to {percent(level)} {times(ratio_at(level, ours, theirs)[0])}"
    words += "."
    for at, when in crossings(ours, theirs):
        better = name if ratio_at(at * 0.98, ours, theirs)[0] < 1 else other
        words += f" They cross at {percent(at)} and {when:.2g} s; below that error {better} is faster."
    return words


def title_for(name: str, ours: Curve, others: dict[str, Curve]) -> str:
    """Returns one line with the least and the greatest ratio of our time to that of another."""
    ratios = {}
    for other, curve in others.items():
        if falling(ours) and falling(curve):
            error = levels_for(ours, curve)[0]
            ratios[other] = ratio_at(error, ours, curve)[0], error
    if not ratios:
        return f"{name} alone"
    ends = sorted(ratios, key=lambda other: ratios[other][0])
    said = (f"{times(ratio)} the time of {other} to {percent(error)}" for other, (ratio, error) in
            ((other, ratios[other]) for other in dict.fromkeys((ends[0], ends[-1]))))  # fmt: skip
    return f"{name} takes " + ", ".join(said)
