"""The style and the files of a stability plot: one style, an SVG and a CSV for each row.

    from stability.plot import Plot, Series, draw, write_csv

A value of 0 has no place on a logarithmic axis: it is drawn as an open mark on the axis' lower edge.
"""

import csv
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.figure import Figure

ABBE = "#1b5fa8"
NAIVE = ("#b4421c", "#8a6d00", "#7a3e8e", "#4f5b66")
MARKS = ("s", "^", "D", "v")
STYLE = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "font.size": 11,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": "#6b7280",
    "axes.labelcolor": "#1f2937",
    "xtick.color": "#374151",
    "ytick.color": "#374151",
    "axes.titlelocation": "left",
    "axes.titlesize": 12.5,
    "axes.titleweight": "bold",
    "axes.grid": True,
    "grid.color": "#e5e7eb",
    "svg.hashsalt": "abbe",
}


@dataclass
class Series:
    """One method: its values over the parameter that makes the scene hard."""

    label: str
    x: np.ndarray
    y: np.ndarray
    ours: bool = False  # measured on Abbe's own images

    def __post_init__(self):
        self.x, self.y = np.asarray(self.x, float), np.asarray(self.y, float)


@dataclass
class Plot:
    """One row of the catalog: its plot, and the words made from its data."""

    row: str
    title: str
    xlabel: str
    ylabel: str
    series: list[Series]
    words: str
    linear: bool = False  # vertical axis
    source: str = ""  # where the naive method comes from
    bound: float = 0.0  # our values stay below it
    least: float = 0.0  # values below it are drawn as 0
    z: float = 0.0  # the largest error of our values in standard errors, if they are random

    def __post_init__(self):
        self.words = self.words.replace("%", " %").replace("  %", " %")

    @property
    def abbe(self) -> np.ndarray:
        """All values of Abbe."""
        return np.concatenate([one.y for one in self.series if one.ours])

    @property
    def naive(self) -> np.ndarray:
        """All values of the methods that fail."""
        return np.concatenate([one.y for one in self.series if not one.ours])


def times(value: float) -> str:
    """Formats a factor with two digits, and no powers of ten."""
    return f"{float(f'{value:.2g}'):,.10g}"


def floor_of(plot: Plot) -> float:
    """Returns the height at which zeros are drawn: a power of ten below a third of the smallest positive value."""
    values = np.concatenate([one.y[one.y > 0] for one in plot.series] or [np.ones(1)])
    return max(plot.least, float(10.0 ** np.floor(np.log10(values.min() / 3))))


def spread_apart(places: list[float], gap: float, low: float, high: float) -> list[float]:
    """Returns heights of labels, moved apart by at least `gap` and into the axes, in the order of `places`."""
    order = np.argsort(places)
    moved = np.clip(np.array(places, float)[order], low, high)
    for i in range(1, len(moved)):
        moved[i] = max(moved[i], moved[i - 1] + gap)
    over = max(0.0, moved[-1] - high)
    moved[-1] -= over
    for i in range(len(moved) - 2, -1, -1):
        moved[i] = min(moved[i], moved[i + 1] - gap)
    result = np.empty(len(moved))
    result[order] = moved
    return result.tolist()


def draw(plot: Plot, path: Path) -> None:
    """Writes the SVG: lines labelled at their ends, ours blue and thicker."""
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(7.6, 4.3), facecolor="white")
        axes = figure.add_axes((0.115, 0.14, 0.60, 0.74))
        floor = 0.0 if plot.linear else floor_of(plot)
        ends, naive = [], iter(zip(NAIVE, MARKS, strict=True))
        for one in plot.series:
            color, mark = (ABBE, "o") if one.ours else next(naive)
            y = np.maximum(one.y, floor)
            width = 2.4 if one.ours else 1.6
            axes.plot(one.x, y, "-", color=color, linewidth=width, zorder=3 if one.ours else 2)
            zero = (one.y <= floor) & (not plot.linear)
            axes.plot(one.x[~zero], y[~zero], mark, color=color, markersize=5, zorder=4)
            axes.plot(
                one.x[zero], y[zero], mark, color=color, markersize=5, markerfacecolor="white", zorder=4, clip_on=False
            )
            last = np.argmax(one.x)
            ends.append((y[last], color, one.label + (" (0)" if one.y[last] <= 0 and not plot.linear else "")))
        axes.set_xscale("log")
        if not plot.linear:
            axes.set_yscale("log")
            axes.set_ylim(bottom=floor)
        axes.set(xlabel=plot.xlabel, ylabel=plot.ylabel)
        figure.text(0.02, 0.94, f"{plot.row}  {plot.title}", fontsize=12.5, fontweight="bold", color="#111827")
        label_ends(axes, ends)
        figure.savefig(path, metadata={"Date": None, "Creator": None})


def label_ends(axes, ends: list[tuple[float, str, str]]) -> None:
    """Writes each line's name beside its last point."""
    linear = axes.get_yscale() == "linear"
    low, high = axes.get_ylim()

    def height(y: float) -> float:
        return (y - low) / (high - low) if linear else float(np.log(y / low) / np.log(high / low))

    lines = [label.count("\n") + 1 for _, _, label in ends]
    heights = spread_apart([height(y) for y, _, _ in ends], 0.075 * max(lines), 0.03, 0.97)
    for (y, color, label), place in zip(ends, heights, strict=True):
        axes.annotate(
            label,
            (1.0, height(y)),
            (1.04, place),
            xycoords="axes fraction",
            textcoords="axes fraction",
            color=color,
            fontsize=10,
            fontweight="bold" if color == ABBE else "normal",
            va="center",
            annotation_clip=False,
            arrowprops={"arrowstyle": "-", "color": color, "linewidth": 0.7, "shrinkA": 1, "shrinkB": 0},
        )


def write_csv(plot: Plot, path: Path) -> None:
    """Writes every point: series, kind (abbe or naive), x, y."""
    with path.open("w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["series", "kind", plot.xlabel, plot.ylabel])
        for one in plot.series:
            kind = "abbe" if one.ours else "naive"
            for x, y in zip(one.x, one.y, strict=True):
                table.writerow([one.label.replace("\n", " "), kind, f"{x:.9g}", f"{y:.9g}"])
