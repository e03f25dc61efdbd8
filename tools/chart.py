"""Charts error against CPU time on scenes/smallpt.toml: Abbe beside the 99-line program smallpt.

    python tools/chart.py                  # at most 10 minutes on one core; target/chart/smallpt.png and smallpt.csv
    python tools/chart.py --quick          # under 90 seconds: a smaller picture, fewer samples

Both run on one thread. Each is judged against its own converged picture, rendered with other seeds under the same box
filter, linear and unclamped, on the pixels that do not see the glass ball; that picture's noise is subtracted. CPU time
is user and system time of the whole process: starting, reading the scene and writing the file count as well, and the
run of one sample shows how much that is.
"""

import argparse
import csv
import resource
import subprocess
import tempfile
from pathlib import Path
from typing import NamedTuple

import numpy as np
import render
import smallpt_reference
from matplotlib.figure import Figure
from smallpt_regions import scene_text, sees_glass

REPEATS = 3
REFERENCE_SEEDS = (101, 102)
COMPARED = 64


class Setting(NamedTuple):
    """How large the pictures are, and how many samples they take."""

    size: tuple[int, int]
    samples: tuple[int, ...]
    half_reference: int


FULL = Setting((256, 192), (4, 16, 64, 256), 256)
QUICK = Setting((128, 96), (4, 16, 64), 256)


class Abbe:
    """Our renderer: one process for each picture."""

    name = "Abbe"
    color = "#1b6ca8"
    label_offset = (4, 6)

    def __init__(self, folder: Path, size: tuple[int, int]):
        self.scene = folder / "scene.toml"
        self.scene.write_text(scene_text(*size))
        self.out = folder / "abbe.exr"

    def command(self, samples: int, seed: int) -> list:
        flags = ["--samples", samples, "--seed", seed, "--threads", 1]
        return [render.binary(), self.scene, "--exr", self.out, *flags]

    def picture(self) -> np.ndarray:
        return render.read(self.out).rgb

    def version(self) -> str:
        return first_line([render.binary(), "--version"])


class Smallpt:
    """The 99-line program."""

    name = "smallpt"
    color = "#c4572b"
    label_offset = (-14, -12)

    def __init__(self, folder: Path, size: tuple[int, int]):
        self.binary = smallpt_reference.compile_program(folder)
        self.size = size
        self.out = folder / "smallpt.pfm"

    def command(self, samples: int, seed: int) -> list:
        return [self.binary, samples, *self.size, seed, self.out, *smallpt_reference.EXACT_FLAGS]

    def picture(self) -> np.ndarray:
        return smallpt_reference.read_pfm(self.out).astype(np.float64)

    def version(self) -> str:
        flags = " ".join(("g++ -O3 -march=native, run with", *smallpt_reference.EXACT_FLAGS))
        return f"tools/smallpt.cpp, {flags}; {first_line(['g++', '--version'])}"


class Run(NamedTuple):
    """One picture: what it took and how far it is off."""

    renderer: str
    samples: int
    seed: int
    cpu_seconds: float
    rms: float
    relative: float


def first_line(command: list) -> str:
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()[0]


def cpu_seconds(command: list) -> float:
    """Runs a command and counts its user and system time."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([str(word) for word in command], check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


class Reference:
    """A renderer's converged picture, of two halves whose difference tells its noise."""

    def __init__(self, renderer, setting: Setting):
        halves = []
        for seed in REFERENCE_SEEDS:
            cpu_seconds(renderer.command(setting.half_reference, seed))
            halves.append(renderer.picture())
        self.judged = ~sees_glass(*setting.size)
        self.mean = (halves[0] + halves[1]) / 2
        self.noise = (halves[0] - halves[1]) ** 2 / 4

    def errors(self, picture: np.ndarray) -> tuple[float, float]:
        """Root of the mean squared error, and the mean of (x - r)^2 / (r^2 + 0.01)."""
        squared = ((picture - self.mean) ** 2 - self.noise)[self.judged]
        relative = squared / (self.mean**2 + 0.01)[self.judged]
        return float(np.sqrt(max(squared.mean(), 0))), float(max(relative.mean(), 0))


def measure(renderers: list, setting: Setting) -> list[Run]:
    """Every renderer at every number of samples, the renderers in turn so that both meet the same machine."""
    references = [Reference(renderer, setting) for renderer in renderers]
    runs = []
    for seed in range(1, REPEATS + 1):
        for samples in setting.samples:
            for renderer, reference in zip(renderers, references, strict=True):
                seconds = cpu_seconds(renderer.command(samples, seed))
                runs.append(Run(renderer.name, samples, seed, seconds, *reference.errors(renderer.picture())))
    return runs


def medians(runs: list[Run], renderer: str) -> list[Run]:
    """The median of the repeats at each number of samples."""
    own = [run for run in runs if run.renderer == renderer]
    result = []
    for samples in sorted({run.samples for run in own}):
        columns = zip(*(run[3:] for run in own if run.samples == samples), strict=True)
        result.append(Run(renderer, samples, 0, *(float(np.median(column)) for column in columns)))
    return result


def time_to(error: float, points: list[Run], measure_name: str) -> float:
    """CPU seconds to an error, linear in log-log between the points and beyond the ends."""
    x = np.log([getattr(point, measure_name) for point in points])[::-1]
    y = np.log([point.cpu_seconds for point in points])[::-1]
    i = int(np.clip(np.searchsorted(x, np.log(error)), 1, len(x) - 1))
    slope = (y[i] - y[i - 1]) / (x[i] - x[i - 1])
    return float(np.exp(y[i] + slope * (np.log(error) - x[i])))


def verdict(ours: list[Run], target: Run, measure_name: str, title: str) -> str:
    """The ratio of CPU times at equal error in words."""
    error = getattr(target, measure_name)
    seconds = time_to(error, ours, measure_name)
    return (
        f"to {title} {error:.4g}, which smallpt reaches with {target.samples} samples in {target.cpu_seconds:.2f} s, "
        f"Abbe needs {seconds:.2f} s: {seconds / target.cpu_seconds:.2f} x the CPU time"
    )


def draw(points: dict[str, list[Run]], renderers: list, note: str, path: Path) -> None:
    """Both measures of error against CPU time."""
    figure = Figure(figsize=(11, 4.8), layout="constrained")
    panels = figure.subplots(1, 2)
    titles = {"rms": "RMS error", "relative": "mean of (x - r)² / (r² + 0.01)"}
    for panel, (measure_name, title) in zip(panels, titles.items(), strict=True):
        for renderer in renderers:
            own = points[renderer.name]
            places = [(point.cpu_seconds, getattr(point, measure_name)) for point in own]
            panel.loglog(*zip(*places, strict=True), "o-", color=renderer.color, label=renderer.name)
            beside = {"xytext": renderer.label_offset, "textcoords": "offset points", "fontsize": 8}
            for point, place in zip(own, places, strict=True):
                panel.annotate(str(point.samples), place, color=renderer.color, **beside)
        panel.margins(0.08)
        panel.set(xlabel="CPU seconds, one thread", ylabel=title)
        panel.grid(which="both", color="0.9")
        panel.legend()
    figure.suptitle(f"scenes/smallpt.toml without the glass ball: error against CPU time\n{note}", fontsize=10)
    figure.savefig(path, dpi=150)


def report(points: dict[str, list[Run]], start: float, setting: Setting) -> None:
    """The medians as a table, and what they mean in words."""
    print(f"\n{setting.size[0]} x {setting.size[1]}, one thread, medians of {REPEATS}")
    print(f"{'renderer':<10}{'samples':>8}{'CPU s':>9}{'RMS':>10}{'relative':>11}")
    for point in (point for own in points.values() for point in own):
        figures = f"{point.cpu_seconds:>9.2f}{point.rms:>10.4f}{point.relative:>11.5f}"
        print(f"{point.renderer:<10}{point.samples:>8}{figures}")
    print(f"\nAbbe's run of one sample, starting and writing the EXR included: {start:.2f} s")
    for measure_name, title in {"rms": "an RMS error of", "relative": "a relative squared error of"}.items():
        for target in points[Smallpt.name]:
            if target.samples >= COMPARED:
                print(verdict(points[Abbe.name], target, measure_name, title))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="a smaller picture and fewer samples, under 90 seconds")
    parser.add_argument("--out", type=Path, default=render.ROOT / "target/chart", help="folder for PNG and CSV")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    setting = QUICK if arguments.quick else FULL
    with tempfile.TemporaryDirectory() as folder:
        renderers = [Abbe(Path(folder), setting.size), Smallpt(Path(folder), setting.size)]
        for renderer in renderers:
            print(f"{renderer.name}: {renderer.version()}")
        start = float(np.median([cpu_seconds(renderers[0].command(1, seed)) for seed in range(REPEATS)]))
        runs = measure(renderers, setting)
    with (arguments.out / "smallpt.csv").open("w", newline="") as file:
        table = csv.writer(file)
        table.writerow(Run._fields)
        table.writerows(runs)
    points = {renderer.name: medians(runs, renderer.name) for renderer in renderers}
    report(points, start, setting)
    note = f"{setting.size[0]} x {setting.size[1]}, medians of {REPEATS}, samples per pixel beside the points"
    draw(points, renderers, note, arguments.out / "smallpt.png")
    print(f"wrote smallpt.png and smallpt.csv into {arguments.out}")


if __name__ == "__main__":
    main()
