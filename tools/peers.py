"""Measures Abbe beside Mitsuba 3, LuxCore and smallpt: processor seconds to an equal error.

    python tools/peers.py --scene cornell --quick       # a quarter of the picture's side, one repeat
    python tools/peers.py                               # every scene: half an hour on two cores
    python tools/peers.py --scene glass --pictures      # also write what each renderer sees, to look at side by side

All read the same scene file, Abbe itself and the others by way of peers_scene.py. Needs the packages mitsuba and
pyluxcore, and for Mitsuba's llvm variants the library LLVM 16 or newer (DRJIT_LIBLLVM_PATH if it is in an unusual
place); a package that is missing is named, and its renderers are left out.

The error is the mean of (x - r)^2 / (r^2 + 0.01) over pixels and channels of linear Rec.709, unclamped, box filter. r is
the renderer's own converged picture at the same resolution, of two halves of other seeds whose difference tells its
noise, which is subtracted. CPU seconds are user and system time of all cores. What a renderer takes before its first
sample (reading, trees, compiling) is found from runs of two lengths and told apart. Seconds to an error are read off
between the measured points; beyond them the error of independent samples falls as one over their number.
"""

import argparse
import atexit
import importlib.util
import os
import platform
import resource
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path
from typing import NamedTuple

import numpy as np
import peers_scene
import render
import smallpt_reference

FOLDER = render.ROOT / "tools/peers"
REFERENCE_SEEDS = (10_000, 20_000)
ERRORS = (1e-2, 1e-3)


class Comparison(NamedTuple):
    """A scene and who renders it: the samples whose errors are measured, and how many runs of the most make half a reference.

    `shrink` divides the picture's sides, so that a converged one can be had; seconds are told for the full picture."""

    scene: Path
    shrink: int
    renderers: dict[str, tuple[tuple[int, ...], int]]
    bars: dict[str, float]


COMPARISONS = {
    "cornell": Comparison(
        FOLDER / "cornell.toml",
        4,
        {
            "abbe": ((2, 8, 32), 8),
            "llvm_ad_spectral": ((4, 16, 64), 12),
            "scalar_spectral": ((4, 16), 8),
        },
        {"llvm_ad_spectral": 1.0, "scalar_spectral": 0.15},
    ),
    "smallpt": Comparison(
        render.SCENES / "smallpt.toml",
        8,
        {
            "abbe": ((8, 32, 128), 8),
            "llvm_ad_rgb": ((16, 64, 256), 16),
            "llvm_ad_rgb/disc": ((16, 64, 256), 8),
            "smallpt": ((64, 256), 6),
        },
        {"llvm_ad_rgb": 0.5, "llvm_ad_rgb/disc": 0.5, "smallpt": 0.05},
    ),
    "glass": Comparison(
        FOLDER / "glass.toml",
        4,
        {"abbe": ((8, 32, 128), 3), "luxcore": ((64, 256), 4)},
        {"luxcore": 0.05},
    ),
    "mesh": Comparison(
        FOLDER / "mesh.toml",
        2,
        {"abbe": ((4, 36), 2), "llvm_ad_spectral": ((4, 36), 2), "scalar_spectral": ((4, 36), 2)},
        {"llvm_ad_spectral": 1.0, "scalar_spectral": 0.15},
    ),
}


def seconds_used(who: int) -> float:
    usage = resource.getrusage(who)
    return usage.ru_utime + usage.ru_stime


class Program:
    """A renderer that is a process for each picture."""

    def run(self, samples: int, seed: int) -> tuple[np.ndarray, float]:
        """The picture, and the processor seconds that it took."""
        before = seconds_used(resource.RUSAGE_CHILDREN)
        subprocess.run([str(word) for word in self.command(samples, seed)], check=True, capture_output=True)
        return self.picture(), seconds_used(resource.RUSAGE_CHILDREN) - before


class Abbe(Program):
    """Our renderer, on one thread."""

    def __init__(self, name: str, scene: Path, folder: Path):
        self.scene, self.out = scene, folder / "abbe.exr"
        self.version = subprocess.run([render.binary(), "--version"], capture_output=True, text=True).stdout.strip()

    def command(self, samples: int, seed: int) -> list:
        return [render.binary(), self.scene, "--exr", self.out, "--samples", samples, "--seed", seed, "--threads", 1]

    def picture(self) -> np.ndarray:
        return render.read(self.out).rgb


class Smallpt(Program):
    """The 99-line program."""

    version = f"tools/smallpt.cpp, {' '.join(smallpt_reference.EXACT_FLAGS)}"

    def __init__(self, name: str, scene: Path, folder: Path):
        self.binary, self.out = smallpt_reference.compile_program(folder), folder / "smallpt.pfm"
        film = tomllib.loads(scene.read_text())["film"]
        self.size = film["width"], film["height"]

    def command(self, samples: int, seed: int) -> list:
        return [self.binary, samples, *self.size, seed, self.out, *smallpt_reference.EXACT_FLAGS]

    def picture(self) -> np.ndarray:
        return smallpt_reference.read_pfm(self.out).astype(np.float64)


class Mitsuba:
    """A variant of Mitsuba 3 in this process; `/disc` makes the tip of a huge lamp flat, so that it is aimed at well."""

    def __init__(self, name: str, scene: Path, folder: Path):
        import mitsuba

        self.mitsuba, self.variant = mitsuba, name.split("/")[0]
        mitsuba.set_variant(self.variant)
        self.scene = mitsuba.load_dict(peers_scene.mitsuba_scene(mitsuba, scene, name.endswith("/disc")))
        self.version = f"Mitsuba {mitsuba.__version__} {name}"

    def run(self, samples: int, seed: int) -> tuple[np.ndarray, float]:
        self.mitsuba.set_variant(self.variant)
        before = seconds_used(resource.RUSAGE_SELF)
        picture = np.array(self.mitsuba.render(self.scene, spp=samples, seed=seed), np.float64)
        return picture, seconds_used(resource.RUSAGE_SELF) - before


class LuxCore:
    """LuxCore's path tracer, which stays in this process."""

    def __init__(self, name: str, scene: Path, folder: Path):
        import pyluxcore

        pyluxcore.Init(lambda message: None)
        atexit.register(pyluxcore.SetLogHandler, None)  # else its threads call a handler that is gone
        self.luxcore, self.scene = pyluxcore, scene
        self.version = f"LuxCore {pyluxcore.Version()} PATHCPU"

    def run(self, samples: int, seed: int) -> tuple[np.ndarray, float]:
        before = seconds_used(resource.RUSAGE_SELF)
        picture = peers_scene.luxcore_picture(self.luxcore, self.scene, samples, seed)
        return picture, seconds_used(resource.RUSAGE_SELF) - before


OTHERS = {"abbe": Abbe, "smallpt": Smallpt, "luxcore": LuxCore}
PACKAGES = {"abbe": None, "smallpt": None, "luxcore": "pyluxcore"}


class Point(NamedTuple):
    """Medians at a number of samples."""

    samples: int
    seconds: float
    error: float


class Measured(NamedTuple):
    """A renderer's points, whose seconds are without the start, and its reference."""

    points: list[Point]
    start: float
    mean: np.ndarray


def measure(renderers: dict, comparison: Comparison, repeats: int) -> dict[str, Measured]:
    """Every renderer at every number of samples, in turn so that all meet the same machine."""
    references = {}
    for name, renderer in renderers.items():
        samples, runs = comparison.renderers[name][0][-1], comparison.renderers[name][1]
        halves = [[renderer.run(samples, seed + i)[0] for i in range(runs)] for seed in REFERENCE_SEEDS]
        first, second = np.mean(halves, axis=1)
        references[name] = (first + second) / 2, (first - second) ** 2 / 4
    runs = {name: {samples: [] for samples in comparison.renderers[name][0]} for name in renderers}
    for name, renderer in renderers.items():
        for samples in runs[name]:
            renderer.run(samples, 1000)  # compiles what is compiled for this length
    for seed in range(1, repeats + 1):
        for name, renderer in renderers.items():
            mean, noise = references[name]
            for samples, results in runs[name].items():
                picture, seconds = renderer.run(samples, seed)
                results.append((seconds, (((picture - mean) ** 2 - noise) / (mean**2 + 0.01)).mean()))
    measured = {}
    for name, own in runs.items():
        points = [Point(samples, *np.median(results, axis=0)) for samples, results in own.items()]
        rate = (points[-1].seconds - points[0].seconds) / (points[-1].samples - points[0].samples)
        start = max(points[0].seconds - rate * points[0].samples, 0.0)
        measured[name] = Measured([p._replace(seconds=rate * p.samples) for p in points], start, references[name][0])
    return measured


def seconds_to(error: float, points: list[Point]) -> float:
    """Linear in log-log between the points, as one over the seconds beyond the ends."""
    x, y = (np.log([getattr(point, key) for point in points][::-1]) for key in ("error", "seconds"))
    wanted = np.clip(np.log(error), x[0], x[-1])
    return float(np.exp(np.interp(wanted, x, y) + wanted - np.log(error)))


def report(comparison: Comparison, measured: dict[str, Measured], scale: float) -> None:
    """Points, seconds to the errors for the full picture, and whether the bars are met."""
    print(f"{'renderer':<18}{'samples':>8}{'CPU s':>9}{'error':>11}    start, CPU s")
    for renderer, result in measured.items():
        for point in result.points:
            start = f"{result.start:>12.2f}" if point is result.points[0] else ""
            print(f"{renderer:<18}{point.samples:>8}{point.seconds:>9.2f}{point.error:>11.5f}{start}")
    print(f"\nCPU s of the full picture, without start, to an error of {' and '.join(map(str, ERRORS))}")
    needed = {key: [scale * seconds_to(error, result.points) for error in ERRORS] for key, result in measured.items()}
    for renderer, seconds in needed.items():
        line = f"{renderer:<18}" + "".join(f"{value:>9.4g}" for value in seconds)
        if bar := comparison.bars.get(renderer) if "abbe" in needed else None:
            ratios = [ours / theirs for ours, theirs in zip(needed["abbe"], seconds, strict=True)]
            line += f"    Abbe: {ratios[0]:.2f} and {ratios[1]:.2f} x; at most {bar} x is asked for: "
            line += "met" if max(ratios) <= bar else "not met"
        print(line, flush=True)


def scene_at(comparison: Comparison, shrink: int, folder: Path) -> tuple[Path, float]:
    """The scene at its reduced size, and how many times more pixels the full one has."""
    text = comparison.scene.read_text("utf-8")
    film = tomllib.loads(text)["film"]
    for key in ("width", "height"):
        text = text.replace(f"{key} = {film[key]}", f"{key} = {film[key] // shrink}")
    path = folder / comparison.scene.name
    path.write_text(text, "utf-8")
    return path, float(shrink**2)


def compare(name: str, arguments: argparse.Namespace) -> None:
    comparison = COMPARISONS[name]
    shrink = comparison.shrink * (2 if arguments.quick else 1)
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        scene, scale = scene_at(comparison, shrink, folder)
        if name == "mesh":
            peers_scene.write_bumpy_ball(folder / "bumpy.ply")
        renderers = {}
        for key in comparison.renderers:
            if arguments.only and key not in arguments.only:
                continue
            package = PACKAGES.get(key, "mitsuba")
            if package and importlib.util.find_spec(package) is None:
                print(f"{key} is left out: the Python package {package} is missing")
                continue
            renderers[key] = OTHERS.get(key, Mitsuba)(key, scene, folder)
        print(f"\n== {name}, the picture's sides divided by {shrink}, seconds of the full one {scale:.0f}-fold")
        for renderer in renderers.values():
            print(renderer.version)
        measured = measure(renderers, comparison, 1 if arguments.quick else arguments.repeats)
    report(comparison, measured, scale)
    arguments.out.mkdir(parents=True, exist_ok=True)
    for key, result in measured.items() if arguments.pictures else ():
        peers_scene.write_png(arguments.out / f"{name}-{key.replace('/', '-')}.png", result.mean)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scene", choices=COMPARISONS, action="append", help="only this one; may be repeated")
    parser.add_argument("--only", action="append", metavar="RENDERER", help="only this renderer; may be repeated")
    parser.add_argument("--quick", action="store_true", help="half the side of the picture again, and one repeat")
    parser.add_argument("--repeats", type=int, default=3, help="runs whose median counts")
    parser.add_argument("--pictures", action="store_true", help="write a PNG of every renderer's reference")
    parser.add_argument("--out", type=Path, default=render.ROOT / "target/peers", help="folder for the pictures")
    arguments = parser.parse_args()
    scenes = arguments.scene or list(COMPARISONS)
    if len(scenes) == 1:
        print(f"{platform.machine()}, {os.cpu_count()} cores")
        return compare(scenes[0], arguments)
    # A process for each scene: Mitsuba and LuxCore bring libraries that do not share one.
    rest = [word for word in sys.argv[1:] if word != "--scene" and word not in scenes]
    for name in scenes:
        subprocess.run([sys.executable, __file__, "--scene", name, *rest], check=True)


if __name__ == "__main__":
    main()
