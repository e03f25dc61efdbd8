"""Charts speed against accuracy: Abbe's models and methods, and other renderers that anyone can install.

    python tools/chart.py --list                 # which renderers are installed, and how to install the others
    python tools/chart.py --quick                # every chart, small: under 10 minutes on two cores
    python tools/chart.py                        # eight times the side, without the longest runs: two hours
    python tools/chart.py --scene cornell --side 512
    python tools/chart.py --only abbe --quick    # Abbe's own series alone
    python tools/chart.py --redraw               # pictures and words of what was measured last

Writes into target/chart a PNG and an SVG for each chart, overview.png with the main charts, chart.csv, chart.json and
table.md, the table of benches/README.md, and prints the findings in words. Charts that chart.json already holds are
kept unless they are measured again, so a quiet hour can be spent on a single chart. A renderer that fails is reported
in one line and left out. tools/chart/scenes.py defines the charts, tools/chart/measure.py what the error is and what
counts as time, tools/chart/findings.py what the words mean. Every renderer runs on one thread and renders the same
scene file; tools/peers translates it for the others.
"""

import argparse
import csv
import json
import math
import os
import platform
import resource
import tempfile
import time
from pathlib import Path

import render

from . import draw, renderers, scenes
from .curves import title_for, unsteady_words
from .findings import curve, floor, short, table_rows, takes_no_seed, wavers, words_for
from .measure import Measured, Point, measure
from .scenes import Chart, Profile

CONVERGED = ("difference", "unseen", "brightness")  # what chart.json keeps about a converged picture
OVERVIEW = ("cornell", "ajar", "smallpt", "caustic", "window", "mesh")


def found_versions(charts: list[Chart]) -> tuple[dict[str, str], dict[str, str]]:
    """Returns the versions of installed renderers, and messages on missing ones, by renderer and variant."""
    versions, missing = {}, {}
    for renderer, variant in dict.fromkeys((one.renderer, one.variant) for chart in charts for one in chart.series):
        key = f"{renderers.NAMES[renderer]} {variant}".strip()
        try:
            versions[key] = renderers.version(renderer, variant)
        except renderers.Missing as words:
            missing[key] = str(words)
    return versions, missing


def run(chart: Chart, profile: Profile, only: list[str] | None = None) -> dict[str, Measured]:
    """Measures every series whose renderer is installed. One that cannot be opened is reported and left out."""
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        opened = {}
        for number, series in enumerate(chart.series):
            if only and series.renderer not in only:
                continue
            try:
                renderers.version(series.renderer, series.variant)
                scene = scenes.write_scene(chart, series, folder / f"scene{number}.toml")
                opened[series.label] = renderers.open_renderer(series, scene, folder / str(number))
            except (renderers.Missing, RuntimeError) as words:
                print(f"{series.label} is left out: {words}", flush=True)
        if all(isinstance(renderer, renderers.PovRay) for renderer in opened.values()):
            print("nothing is left that could be judged by its own converged picture")
            return {}
        try:
            return measure(opened, chart, profile)
        finally:
            for renderer in opened.values():
                renderer.close()


def recorded(series: dict) -> Measured:
    """Restores a series from the form in which `record` wrote it."""
    points = [Point(**point) for point in series["points"]]
    return Measured(points, series["start_seconds"], None, *(series.get(name, math.nan) for name in CONVERGED))


def panel_for(chart: Chart, found: dict[str, Measured]) -> draw.Panel:
    kinds = {one.label: one.renderer for one in chart.series}
    first, *others = found
    own = all(kinds[label] == "abbe" for label in others)
    judged = [label for label in others if not takes_no_seed(found[label]) and (own or kinds[label] != "abbe")]
    curves = {label: curve(found[label]) for label in judged if not wavers(found[label])}
    finding = title_for(first, curve(found[first]), curves)
    if wavers(found[first]):
        finding = unsteady_words(first)
    if chart.common and len(others) > 1:
        floors = (f"{short(label)} {floor(found[label])}" for label in others)
        finding = f"Converged, off {short(first)} by: {', '.join(floors)}".replace("less than", "<")
    name = short if set(kinds.values()) == {"abbe"} else str
    lines = [draw.Line(name(label), kinds[label], curve(measured)) for label, measured in found.items()]
    return draw.Panel(chart.title, finding, lines)


def record(chart: Chart, found: dict[str, Measured], made_by: str) -> dict:
    """Returns the chart in the form that chart.json stores."""
    kinds = {one.label: "abbe" if one.renderer == "abbe" else "other" for one in chart.series}
    series = []
    for label, measured in found.items():
        points = [point._asdict() for point in measured.points]
        extra = {"start_seconds": measured.start}
        if not takes_no_seed(measured):
            extra |= {name: getattr(measured, name) for name in CONVERGED}
        series.append({"label": label, "kind": kinds[label], **extra, "points": points})
    pictures = {"svg": f"{chart.name}.svg", "png": f"{chart.name}.png"}
    head = {"name": chart.name, "title": chart.title, "size": chart.size, "made_by": made_by}
    return head | {"words": words_for(chart, found), "series": series, **pictures}


def table(found: dict[str, Measured]) -> str:
    lines = [f"{'series':<28}{'samples':>8}{'CPU s':>9}{'error':>9}{'RMS':>9}    start, CPU s"]
    for label, measured in found.items():
        for point in measured.points:
            start = f"{measured.start:>12.2f}" if point is measured.points[0] else ""
            figures = f"{point.cpu_seconds:>9.3f}{point.error:>9.4f}{point.rms:>9.4f}"
            lines.append(f"{label:<28}{point.samples:>8}{figures}{start}")
    return "\n".join(lines)


def read_data(out: Path) -> dict:
    """Returns the contents of chart.json: `versions`, `made_by` of the latest measurement, and `scenes`."""
    path = out / "chart.json"
    return json.loads(path.read_text("utf-8")) if path.exists() else {"versions": {}, "made_by": "", "scenes": []}


def with_record(data: dict, versions: dict, entry: dict) -> dict:
    """Returns the data with a newly measured chart. It replaces an older one of its name; charts keep their order."""
    every = {one["name"]: one for one in [*data["scenes"], entry]}
    kept = [every[chart.name] for chart in scenes.CHARTS if chart.name in every]
    return {"versions": data["versions"] | versions, "made_by": entry["made_by"], "scenes": kept}


def write_data(out: Path, data: dict) -> None:
    with (out / "chart.csv").open("w", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(("chart", "series", "samples", "cpu_seconds", "error", "rms", "error_against_common"))
        for one in data["scenes"]:
            for series in one["series"]:
                rows.writerows(
                    (one["name"], series["label"], *map(rounded, point.values())) for point in series["points"]
                )
    (out / "chart.json").write_text(json.dumps(data, indent=1, default=str) + "\n", "utf-8")


def rounded(value: float) -> float:
    return float(f"{value:.5g}")


def write_picture(out: Path, chart: Chart, found: dict[str, Measured]) -> None:
    from matplotlib.image import imsave

    for label, measured in found.items():
        if measured.reference is not None:
            linear = measured.reference.mean.clip(0, 1)
            name = "".join(c if c.isalnum() else "-" for c in label.lower())
            imsave(out / f"{chart.name}-{name}.png", linear ** (1 / 2.2))


def overview(out: Path, panels: dict[str, draw.Panel], note: str) -> None:
    if wanted := [panels[name] for name in OVERVIEW if name in panels]:
        draw.draw_overview(wanted, out / "overview", note)


def draw_all(out: Path) -> list[dict]:
    """Draws pictures and writes words and table.md from what chart.json holds."""
    data = read_data(out)
    charts = {chart.name: chart for chart in scenes.CHARTS}
    records, panels = [], {}
    rows = ["| scene | beside | time that Abbe takes | pictures apart |", "|---|---|---|---|"]
    for one in data["scenes"]:
        chart = charts[one["name"]]
        chart = chart._replace(size=one.get("size", chart.size))
        found = {series["label"]: recorded(series) for series in one["series"]}
        panels[chart.name] = panel_for(chart, found)
        note = one.get("made_by", data["made_by"])
        records.append(record(chart, found, note))
        rows += table_rows(chart, found)
        draw.draw([panels[chart.name]], out / chart.name, note)
    overview(out, panels, f"python tools/chart.py, {data['made_by'].partition(', ')[2]}")
    (out / "table.md").write_text("\n".join(rows) + "\n", "utf-8")
    write_data(out, data | {"scenes": records})
    return records


def vectors() -> str:
    """Returns the processor's architecture and its widest vectors, which natively compiled renderers may use."""
    try:
        said = Path("/proc/cpuinfo").read_text("utf-8")
    except OSError:
        return platform.machine()
    flags = set(next((line for line in said.splitlines() if line.startswith("flags")), "").split())
    widest = [name for flag, name in (("avx512f", "AVX-512"), ("avx2", "AVX2")) if flag in flags]
    return f"{platform.machine()} with {widest[0]}" if widest else platform.machine()


def load() -> str:
    """Returns the load of the machine before the chart adds its own work."""
    return f"load average {os.getloadavg()[0]:.1f} before"


def processor_seconds() -> float:
    """Returns the CPU time of this process and of its child processes that have ended."""
    usages = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)


def made_by(arguments: argparse.Namespace) -> str:
    """Returns the command that repeats this measurement."""
    words = [f"--{key} {value}" for key in ("scene", "only") for value in getattr(arguments, key) or []]
    words += ["--quick"] if arguments.quick else []
    words += [f"--side {arguments.side}"] if arguments.side else []
    return " ".join(["python tools/chart.py", *words])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    names = [chart.name for chart in scenes.CHARTS]
    parser.add_argument("--scene", choices=names, action="append", help="only this chart; may be repeated")
    parser.add_argument("--only", choices=renderers.NAMES, action="append", help="only this one; may be repeated")
    parser.add_argument("--quick", action="store_true", help="small pictures, more samples")
    parser.add_argument("--side", type=int, metavar="PIXELS", help="the longer side of every picture")
    parser.add_argument("--list", action="store_true", help="say what is installed, and how to get the rest")
    parser.add_argument("--redraw", action="store_true", help="draw and say chart.json anew; measure nothing")
    parser.add_argument("--pictures", action="store_true", help="also write each converged picture")
    parser.add_argument("--out", type=Path, default=render.ROOT / "target/chart", help="folder for what is written")
    arguments = parser.parse_args()
    if arguments.side is not None and arguments.side < scenes.LEAST:
        parser.error(f"--side {arguments.side}: a picture has at least {scenes.LEAST} pixels along a side")
    profile = scenes.QUICK if arguments.quick else scenes.FULL
    charts = [chart for chart in scenes.CHARTS if not arguments.scene or chart.name in arguments.scene]
    versions, missing = found_versions(charts)
    for name, words in versions.items():
        print(f"{name}: {words}")
    for words in dict.fromkeys(missing.values()):
        print(f"left out: {words}")
    if arguments.list:
        return
    if arguments.redraw:
        if not read_data(arguments.out)["scenes"]:
            parser.error(f"{arguments.out / 'chart.json'} holds no chart to draw: measure one without --redraw")
        for one in draw_all(arguments.out):
            print(f"\n== {one['name']}: {one['title']}", *one["words"], sep="\n")
        return
    arguments.out.mkdir(parents=True, exist_ok=True)
    note = f"{made_by(arguments)}, {profile.repeats} repeats, {vectors()}, {os.cpu_count()} cores, {load()}"
    begun, measured = time.monotonic(), 0
    for chart in (scenes.scaled(one, profile, arguments.side) for one in charts):
        print(f"\n== {chart.name}: {chart.title}, {chart.size[0]} x {chart.size[1]}", flush=True)
        found = run(chart, profile, arguments.only)
        if not found:
            continue
        measured += 1
        entry = record(chart, found, note)
        print(table(found), *entry["words"], f"({time.monotonic() - begun:.0f} s so far)", sep="\n", flush=True)
        write_data(arguments.out, with_record(read_data(arguments.out), versions, entry))
        if arguments.pictures:
            write_picture(arguments.out, chart, found)
    draw_all(arguments.out)
    took = f"{time.monotonic() - begun:.0f} s, {processor_seconds():.0f} s of processor time"
    print(f"\nwrote {measured} charts, chart.csv and chart.json into {arguments.out} in {took}")
