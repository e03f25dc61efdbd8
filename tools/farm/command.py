"""How many parts of an image make sense on a farm.

    python tools/farm.py scenes/cornell.toml                 # renders all tiles twice, and what parts repeat 15 times
    python tools/farm.py scenes/cornell.toml --samples 64    # more flags of render may follow
    python tools/farm.py scenes/cornell.toml --verify 1 4 16 64
    python tools/farm.py scenes/cornell.toml --chart farm.png

Measures on this machine the work that every part repeats and the work that parts share. From these it forecasts, for 1
to 10,000 parts, processor time, time on as many machines, and the share of processor time that is overhead.
`tools/farm/model.py` has the formulas. `--verify` renders the given numbers of parts one after another, and says how
far off the forecast was.
"""

import argparse
import sys
import tempfile
from pathlib import Path

from .measure import Renderer, measure
from .model import fastest, forecast, most, slowest

COUNTS = [1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 10_000]


def spoken(seconds):
    for limit, size, unit in ((0.1, 1e-3, "ms"), (120, 1, "s"), (7200, 60, "min")):
        if seconds < limit:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 3600:.3g} h"


def counted(parts):
    return f"{parts} part{'s' if parts > 1 else ''}"


def told(work):
    """Returns what was measured, one line each."""
    rows = [
        ("start of the command", work.start),
        ("reading the scene", work.load),
        ("planning", work.plan),
        ("photons and all else that parts do alike", work.photons),
        ("every part repeats", work.repeated),
        (f"{work.count} tiles", work.tiles),
        ("merging", work.merge),
        ("merging, for each part", work.merge_part),
    ]
    width = max(len(name) for name, _ in rows)
    lines = [f"{name:{width}}  {spoken(seconds):>9}" for name, seconds in rows]
    return [*lines, f"{'a tile differs from the mean by':{width}}  {100 * work.variation:7.0f} %"]


def table(work):
    rows = [f"{'parts':>6} {'processor time':>15} {'time':>10} {'speed':>8} {'overhead':>9}"]
    alone = forecast(work, 1).time
    for parts in COUNTS:
        _, processor, time, overhead = forecast(work, parts)
        speed = f"{alone / time:.1f} x"
        rows.append(f"{parts:6} {spoken(processor):>15} {spoken(time):>10} {speed:>8} {100 * overhead:7.1f} %")
    return rows


def advice(work):
    best = fastest(work, COUNTS[-1])
    quarter, half = most(work, 0.25), most(work, 0.5)
    limits = f"overhead is at most a quarter of the processor time up to {counted(quarter)}, and at most half up to {half}"
    if quarter == 0:
        limits = "more than a quarter of the processor time is overhead in one render already"
    return f"{limits}; the image is there first with {counted(best)}, after {spoken(forecast(work, best).time)}"


def verify(work, renderer, counts):
    """Renders these numbers of parts one after another, and returns the times beside the forecast."""
    lines = [f"{'parts':>6} {'processor time':>15} {'forecast':>10} {'off':>8} {'slowest part':>13} {'forecast':>10}"]
    for count in counts:
        parts = [renderer.part(number, count) for number in range(1, count + 1)]
        took = sum(parts) + (renderer.merge(count) if count > 1 else 0.0)
        processor = forecast(work, count).processor
        longest = work.repeated + slowest(work, count) * work.tiles / count
        off = f"{100 * (processor / took - 1):+.1f} %"
        lines.append(
            f"{count:6} {spoken(took):>15} {spoken(processor):>10} {off:>8} {spoken(max(parts)):>13} {spoken(longest):>10}"
        )
        same = (renderer.folder / "image.exr").read_bytes() == (renderer.folder / "whole.exr").read_bytes()
        if count > 1 and not same:
            sys.exit(f"{count} parts are together another image than one render makes")
    return lines


def draw(work, path):
    # Only the chart needs matplotlib.
    from matplotlib.figure import Figure

    rows = [forecast(work, parts) for parts in COUNTS]
    figure = Figure(figsize=(7, 4.5), layout="constrained")
    axes = figure.subplots()
    axes.loglog(COUNTS, [row.processor for row in rows], "o-", color="#D55E00", label="processor time of all machines")
    axes.loglog(COUNTS, [row.time for row in rows], "o-", color="#0072B2", label="time until the image is there")
    ideal = [(work.repeated + work.tiles) / parts for parts in COUNTS]
    axes.loglog(COUNTS, ideal, ":", color="#6b6b6b", label="if nothing were repeated")
    axes.set(xlabel="parts, each on a machine of its own", ylabel="seconds", title=advice(work).replace("; ", "\n"))
    axes.title.set_fontsize(9)
    axes.grid(alpha=0.3)
    axes.legend()
    figure.savefig(path, dpi=150)


def several(text):
    if (count := int(text)) < 1:
        raise ValueError(text)
    return count


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", type=Path)
    parser.add_argument("--threads", type=int, default=1, help="of each part; 1 if absent, which is measured best")
    parser.add_argument("--samples", type=int, help="of each pixel, instead of the scene's")
    parser.add_argument("--verify", type=several, nargs="+", metavar="N", default=[], help="render so many parts and compare")
    parser.add_argument("--chart", type=Path, metavar="FILE.png", help="draw it")
    options, flags = parser.parse_known_args()
    with tempfile.TemporaryDirectory() as folder:
        renderer = Renderer(options.scene, Path(folder), options.threads, options.samples, tuple(flags))
        work = measure(renderer)
        print("\n".join(told(work)), end="\n\n")
        print("\n".join(table(work)), end="\n\n")
        print(advice(work), flush=True)
        if options.verify:
            print("\n" + "\n".join(verify(work, renderer, options.verify)))
    if options.chart:
        draw(work, options.chart)
