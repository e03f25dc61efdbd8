"""The findings of a chart in sentences: first the comparisons, then how far the converged pictures agree.

    words_for(chart, {"Abbe": measured, "LuxCore": measured})
"""

import math

from . import curves
from .measure import Measured
from .scenes import Chart

SAME = 0.02  # converged pictures that differ by less than this show the same physics
LOADS = ("abbe", "luxcore", "smallpt")  # renderers whose start is loading the scene and preprocessing it


def takes_no_seed(measured: Measured) -> bool:
    return math.isnan(measured.difference)


def wavers(measured: Measured) -> bool:
    return not takes_no_seed(measured) and not curves.steady(curve(measured))


def curve(measured: Measured, key: str = "error") -> curves.Curve:
    """Returns the points of a series, without those that took no longer than the start: their time is only jitter."""
    return [(point.cpu_seconds, getattr(point, key)) for point in measured.points if point.cpu_seconds > 0]


def floor(measured: Measured) -> str:
    """Says by how much a converged picture differs, or the smallest difference that could have been detected."""
    if measured.difference > measured.unseen:
        return curves.percent(measured.difference)
    if measured.difference > SAME:
        return f"{curves.percent(measured.difference)}, which few pixels or noise decide"
    return f"less than {curves.percent(measured.unseen)}"


def physics_words(label: str, measured: Measured, against: str, ours: Measured, flat_lamp: bool) -> str:
    """Says how far a converged picture is from the common one, and how the series does if judged by the common one."""
    if takes_no_seed(measured):
        best = curves.percent(min(point.common for point in measured.points))
        return f"{label} takes no seed and is judged by the picture of {against}; its best point is {best} off."
    words = f"The converged picture of {label} differs from that of {against} by {floor(measured)}"
    if measured.difference > SAME:
        lamp = ", its lamp being a flat disc in place of a sphere's tip" if flat_lamp else ""
        return f"{words}{lamp}, so only its own picture judges it."
    if wavers(measured) or wavers(ours):
        return f"{words}."
    theirs, mine = curve(measured, "common"), curve(ours, "common")
    error = curves.levels_for(mine, theirs)[0]
    ratio, sure = curves.ratio_at(error, mine, theirs)
    note = "" if sure == "measured" else ", extrapolated"
    return f"{words}; judged by the latter alone: {curves.times(ratio)} to {curves.percent(error)}{note}."


def model_words(label: str, measured: Measured, against: str) -> str:
    best = curves.percent(min(point.error for point in measured.points))
    return f"{label}: converged, it is {floor(measured)} off {against}; its best point is {best} off."


def out_of_reach(ours: Measured, theirs: Measured) -> float | None:
    """Returns our largest error if a biased series never reaches it, so that no time can be extrapolated; else None."""
    largest = max(error for _, error in curve(ours))
    return largest if largest < min(error for _, error in curve(theirs)) else None


def with_start(ours: Measured, theirs: Measured) -> tuple[float, float] | None:
    """Returns seconds of both to an equal error including the start, if the start changes the ratio noticeably."""
    error = curves.levels_for(curve(ours), curve(theirs))[0]
    ratio = curves.ratio_at(error, curve(ours), curve(theirs))[0]
    mine, other = (curves.seconds_to(error, curve(one))[0] + one.start for one in (ours, theirs))
    change = mine / other / ratio
    return (mine, other) if max(change, 1 / change) >= curves.TIE else None


def start_words(name: str, ours: Measured, theirs: Measured) -> str:
    if seconds := with_start(ours, theirs):
        figures = " for ".join(f"{value:.2g} s" for value in seconds)
        return f" With the start of both {name} takes {curves.times(seconds[0] / seconds[1])} ({figures})."
    return ""


def unsteady_words(name: str, ours: Measured, other: str, theirs: Measured) -> str:
    """If rare paths dominate an error, says only what was observed: who has the smaller error in less time."""
    words = curves.unsteady_words(name if wavers(ours) else other)
    if not wavers(ours):
        seconds, best = min(curve(theirs), key=lambda point: point[1])
        for when, error in curve(ours):
            if error <= best and when <= seconds:
                found = f"{curves.percent(best)} in {seconds:.2g} s; {name} has {curves.percent(error)}"
                return f"{words}: no ratio is told. Its best is {found} in {when:.2g} s."
    return f"{words}, so that nothing is said of {name} and {other}."


def short(label: str) -> str:
    return label.removeprefix("Abbe, ")


def table_cell(ours: Measured, theirs: Measured) -> str:
    """Says in a table cell what fraction of the other's time ours takes."""
    mine, other = curve(ours), curve(theirs)
    times = []
    for error in curves.levels_for(mine, other):
        ratio, sure = curves.ratio_at(error, mine, other)
        note = "" if sure == "measured" else " (extrapolated)"
        times.append((ratio, f"{curves.times(ratio)} to {curves.percent(error)}{note}"))
    at = [error for error, _ in curves.crossings(mine, other)]
    crossed = "".join(f"; they cross at {curves.percent(error)}" for error in at)
    return f"{', '.join(words for _, words in times)}: {curves.rank(times[0][0])}{crossed}"


def table_rows(chart: Chart, found: dict[str, Measured]) -> list[str]:
    """Returns rows for the table of benches/README.md: scene, the other series, time ours takes, pictures apart."""
    first, *others = found
    ours, rows = found[first], []
    renderers = {one.label: one.renderer for one in chart.series}
    name = chart.title + (f": {short(first)}" if chart.common else "")
    for label in others:
        theirs = found[label]
        if not chart.common and (wavers(ours) or wavers(theirs)):
            said = unsteady_words(first, ours, label, theirs).partition(": no ratio is told. ")[2]
            cell = "no ratio: rare bright paths" + (f". {said.removesuffix('.')}" if said else "")
        elif chart.common and (error := out_of_reach(ours, theirs)):
            cell = f"it does not come to {curves.percent(error)}: ahead"
        else:
            cell = table_cell(ours, theirs)
            if not chart.common and renderers.get(label) in LOADS and (seconds := with_start(ours, theirs)):
                cell += f"; with the start {curves.times(seconds[0] / seconds[1])}"
        apart = "" if takes_no_seed(theirs) else floor(theirs).replace(", which few pixels or noise decide", " (noise)")
        rows.append(f"| {name} | {short(label) if chart.common else label} | {cell} | {apart} |")
        name = ""
    return rows


def words_for(chart: Chart, found: dict[str, Measured]) -> list[str]:
    """Returns the findings of the chart in sentences: first the comparisons, then what judges them."""
    first, *others = found
    ours = found[first]
    flat = {one.label for one in chart.series if one.flat_lamp}
    renderers = {one.label: one.renderer for one in chart.series}
    words = []
    for label in others:
        theirs = found[label]
        if not chart.common and (wavers(ours) or wavers(theirs)):
            words.append(unsteady_words(first, ours, label, theirs))
            continue
        if chart.common and (error := out_of_reach(ours, theirs)):
            words.append(f"{label} does not come to {curves.percent(error)}, where {first} begins.")
            continue
        words.append(curves.compare(first, curve(ours), label, curve(theirs)))
        falls = curves.falling(curve(ours)) and curves.falling(curve(theirs))
        if falls and not chart.common and renderers[label] in LOADS:
            words[-1] += start_words(first, ours, theirs)
    for label in others:
        if chart.common:
            words.append(model_words(label, found[label], first))
        else:
            words.append(physics_words(label, found[label], first, ours, label in flat))
    return words
