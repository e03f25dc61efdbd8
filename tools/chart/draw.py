"""Draws what tools/chart.py measured: error against processor time, one picture per chart and an overview of several.

    draw([panel], Path("cornell"))      # cornell.png and cornell.svg
"""

import textwrap
from pathlib import Path
from typing import NamedTuple

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
from PIL import Image

# The palette of Okabe and Ito 2008, which is safe for color-blind readers. Abbe's own series are blue.
BLUES = ("#0072B2", "#56B4E9", "#004066")
COLORS = {"mitsuba": ("#D55E00", "#E69F00", "#8c3d00"), "luxcore": ("#009E73", "#00553D", "#5BC4A3")}
COLORS |= {"cycles": ("#CC79A7",), "smallpt": ("#000000",), "povray": ("#6b6b6b",)}
MODELS = {"rgb": "#E69F00", "8 bands": "#56B4E9", "12 bands": "#009E73", "16 bands": "#0072B2", "32 bands": "#CC79A7"}
MODELS |= {"heroes": "#D55E00"}
MARKERS = ("o", "s", "^", "D", "v", "P")


class Line(NamedTuple):
    """A series to draw; `renderer` chooses the color."""

    label: str
    renderer: str
    points: list[tuple[float, float]]


class Panel(NamedTuple):
    """One pair of axes."""

    title: str
    finding: str
    lines: list[Line]


def styles(lines: list[Line]) -> list[dict]:
    """Returns color, marker and width of each line: one hue per renderer, and shades of it for further series."""
    ours = all(line.renderer == "abbe" for line in lines)
    seen: dict[str, int] = {}
    result = []
    for number, line in enumerate(lines):
        palette = BLUES if line.renderer == "abbe" else COLORS[line.renderer]
        place = seen.setdefault(line.renderer, 0)
        seen[line.renderer] += 1
        first = line.renderer == "abbe" and place == 0
        result.append({
            "color": MODELS.get(line.label, palette[place % len(palette)]),
            "marker": MARKERS[(number if ours else place) % len(MARKERS)],
            "linewidth": 2.6 if first else 1.5,
            "markersize": 6 if first else 4.5,
            "zorder": 4 if first else 3,
            "linestyle": "-" if place == 0 or ours else "--",
        })  # fmt: skip
    return result


def spread(places: list[float], gap: float, low: float, high: float) -> list[float]:
    """Returns heights of labels near the wanted ones, in the same order, at least `gap` apart and within the axes."""
    order = np.argsort(places)
    wanted = np.array(places, float)[order]
    gap = min(gap, (high - low) / max(len(places) - 1, 1))
    for _ in range(200):
        for i in range(1, len(wanted)):
            if (short := gap - (wanted[i] - wanted[i - 1])) > 0:
                wanted[i - 1] -= short / 2
                wanted[i] += short / 2
        wanted = np.clip(wanted, low, high)
    result = np.empty(len(wanted))
    result[order] = wanted
    return result.tolist()


def percent(error: float, _=None) -> str:
    return f"{100 * error:g} %"


def seconds(value: float, _=None) -> str:
    return f"{value:g} s"


def paint(axes, panel: Panel, size: float) -> None:
    """Draws lines and their labels, a grid, and dotted lines on which four times the time halves the error."""
    every = np.array([point for line in panel.lines for point in line.points if point[1] > 0])
    low, high = every.min(axis=0), every.max(axis=0)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(low[0] / 1.4, high[0] * 1.4)
    axes.set_ylim(low[1] / 1.4, high[1] * 1.4)
    for axis, words, span in ((axes.xaxis, seconds, high[0] / low[0]), (axes.yaxis, percent, high[1] / low[1])):
        axis.set_major_locator(LogLocator(10, (1, 2, 5) if span < 100 else (1, 3), numticks=30))
        axis.set_minor_locator(LogLocator(10, range(1, 10), numticks=100))
        axis.set_major_formatter(FuncFormatter(words))
        axis.set_minor_formatter(NullFormatter())
    axes.grid(which="major", color="0.86", linewidth=0.8)
    axes.grid(which="minor", color="0.94", linewidth=0.5)
    axes.tick_params(labelsize=size - 1, which="both", length=0)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    slope = np.array([low[0] / 1.4, high[0] * 1.4])
    for start in np.geomspace(low[1] / 30, high[1] * 30, 14):
        axes.plot(
            slope, start * np.sqrt(slope[0] / slope), color="0.72", linewidth=0.6, linestyle=(0, (1, 3)), zorder=1
        )
    to_axes = lambda point: axes.transAxes.inverted().transform(axes.transData.transform(point))  # noqa: E731
    lines, looks = panel.lines, styles(panel.lines)
    ends = []
    for line, look in zip(lines, looks, strict=True):
        shown = [point for point in line.points if point[1] > 0]
        axes.plot(*zip(*shown, strict=True), **look)
        ends.append(to_axes(shown[-1]))
    gap = 1.35 * size / (axes.get_window_extent().height / axes.figure.dpi * 72)
    right = 1.03
    heights = spread([float(y) for _, y in ends], gap, gap / 2, 1 - gap / 2)
    for line, look, (x, y), height in zip(lines, looks, ends, heights, strict=True):
        axes.plot(
            [x + 0.008, right - 0.012],
            [y, height],
            color=look["color"],
            linewidth=0.6,
            alpha=0.7,
            transform=axes.transAxes,
            clip_on=False,
        )
        weight = "bold" if look["linewidth"] > 2 else "normal"
        words = {"color": look["color"], "fontsize": size, "va": "center", "fontweight": weight}
        axes.text(right, height, line.label, transform=axes.transAxes, **words)
    above = {"xy": (0, 1), "xycoords": "axes fraction", "textcoords": "offset points", "va": "bottom"}
    axes.annotate(panel.finding, xytext=(0, 5), fontsize=size - 0.5, color="0.25", **above)
    height = 8 + 1.25 * size * (panel.finding.count("\n") + 1)
    axes.annotate(panel.title, xytext=(0, height), fontsize=size + 2, fontweight="bold", **above)


def draw(panels: list[Panel], out: Path, note: str) -> None:
    """Writes `out` as PNG and SVG."""
    figure = Figure(figsize=(8.6, 5.4))
    figure.subplots_adjust(0.1, 0.13, 0.75, 0.87)
    arrange(figure, panels, 1, 10, note)
    figure.savefig(out.with_suffix(".png"), dpi=110)
    with matplotlib.rc_context({"svg.fonttype": "none", "svg.hashsalt": "chart"}):
        figure.savefig(out.with_suffix(".svg"), metadata={"Date": None})


def draw_overview(panels: list[Panel], out: Path, note: str) -> None:
    """Draws several panels in two columns and writes them as a PNG of few colors, below 150 kB."""
    rows = -(-len(panels) // 2)
    figure = Figure(figsize=(12.6, 4.5 * rows))
    figure.subplots_adjust(0.065, 0.055 + 0.05 / rows, 0.855, 1 - 0.17 / rows, wspace=0.56, hspace=0.45)
    arrange(figure, [one._replace(finding=textwrap.fill(one.finding, 60)) for one in panels], 2, 9, note)
    figure.savefig(out.with_suffix(".png"), dpi=80)
    with Image.open(out.with_suffix(".png")) as image:
        small = image.convert("RGB").quantize(128)
    small.save(out.with_suffix(".png"), optimize=True)


def arrange(figure: Figure, panels: list[Panel], columns: int, size: float, note: str) -> None:
    rows = -(-len(panels) // columns)
    for number, panel in enumerate(panels):
        axes = figure.add_subplot(rows, columns, number + 1)
        paint(axes, panel, size)
        axes.set_xlabel("CPU seconds, one thread, without the start", fontsize=size)
        if number % columns == 0:
            axes.set_ylabel("relative RMS error", fontsize=size)
    figure.text(0.99, 0.008, note, ha="right", va="bottom", fontsize=size - 2, color="0.45")
