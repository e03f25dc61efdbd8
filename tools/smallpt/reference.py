"""Means of the 99-line program (tools/smallpt/smallpt.cpp) in regions of scenes/smallpt.toml, and Abbe's.

    python tools/smallpt_reference.py             # say what each habit of the program changes, region by region
    python tools/smallpt_reference.py --compare   # render with Abbe and compare it with the program (20 CPU minutes)
    python tools/smallpt_reference.py --render    # run the program anew into smallpt/reference.json (15 CPU minutes)

All pictures are 256 x 192, from eight seeds whose spread gives the standard errors.
"""

import argparse
import json
import os
import re
import subprocess
from pathlib import Path

import numpy as np
import render

from .regions import REGIONS, mean_and_error, region_means, scene_text

FOLDER = Path(__file__).resolve().parent
PROGRAM = FOLDER / "smallpt.cpp"
REFERENCE = FOLDER / "reference.json"

SIZE = (256, 192)
SEEDS = range(1, 9)
LONG, SHORT = 512, 64
EXACT_FLAGS = ("--box", "--no-clamp")
# For each habit, the samples and the flags of the run that is compared with EXACT_FLAGS at equal samples.
HABITS = {
    "tent filter": (SHORT, ("--no-clamp",)),
    f"clamp at {SHORT} samples": (SHORT, ("--box",)),
    f"all as in the original, at {SHORT} samples": (SHORT, ()),
    "offset 1e-6 in place of 1e-4": (SHORT, (*EXACT_FLAGS, "--offset", "1e-6")),
    "Fresnel in place of Schlick": (LONG, (*EXACT_FLAGS, "--exact-fresnel")),
}


def compile_program(folder: Path) -> Path:
    """Compiles the 99-line program with g++'s full optimization for this machine."""
    binary = folder / "smallpt"
    subprocess.run(["g++", "-O3", "-march=native", "-o", binary, PROGRAM], check=True)
    return binary


def read_pfm(path: Path) -> np.ndarray:
    """Returns the image in a little-endian color PFM, the top row first."""
    with path.open("rb") as file:
        if file.readline() != b"PF\n":
            raise ValueError(f"{path} is no color PFM")
        width, height = map(int, file.readline().split())
        file.readline()
        return np.frombuffer(file.read(), "<f4").reshape(height, width, 3)[::-1]


def run_program(binary: Path, samples: int, seed: int, flags: tuple[str, ...]) -> np.ndarray:
    """Returns the picture of the 99-line program at the reference's size."""
    out = binary.with_name("regions.pfm")
    command = [binary, samples, *SIZE, seed, out, *flags]
    subprocess.run([str(word) for word in command], check=True, preexec_fn=lambda: os.nice(10))
    return read_pfm(out)


def tabulate(values: dict[str, tuple[np.ndarray, np.ndarray]]) -> dict:
    """Returns means and errors in the form of the JSON file."""
    return {
        name: {"mean": [float(f"{x:.5g}") for x in mean], "error": [float(f"{x:.2g}") for x in error]}
        for name, (mean, error) in values.items()
    }


def runs_of(binary: Path, samples: int, flags: tuple[str, ...]) -> list[dict[str, np.ndarray]]:
    """Returns the region means of the program's pictures, one for each seed."""
    return [region_means(run_program(binary, samples, seed, flags)) for seed in SEEDS]


def render_reference(folder: Path) -> dict:
    """Returns the means of the long run, and the relative change by each habit, with the same seeds."""
    binary = compile_program(folder)
    plain = {samples: runs_of(binary, samples, EXACT_FLAGS) for samples in (LONG, SHORT)}
    changes = {}
    for habit, (samples, flags) in HABITS.items():
        pairs = zip(runs_of(binary, samples, flags), plain[samples], strict=True)
        ratios = [{name: run[name] / base[name] - 1 for name in REGIONS} for run, base in pairs]
        changes[habit] = {"samples": samples, "flags": " ".join(flags), "regions": tabulate(mean_and_error(ratios))}
    return {
        "about": f"means of tools/smallpt/{PROGRAM.name} by region and band (R, G, B): python tools/smallpt_reference.py --render",
        "size": SIZE,
        "seeds": len(SEEDS),
        "reference": {
            "flags": " ".join(EXACT_FLAGS),
            "samples": LONG,
            "regions": tabulate(mean_and_error(plain[LONG])),
        },
        "relative_changes": changes,
    }


def line(region: str, changes, errors) -> str:
    """Returns the changes of a region in percent, each with its standard error."""
    return f"  {region:<12}" + "".join(f"  {100 * x:+8.3f} ({100 * e:.3f})" for x, e in zip(changes, errors))


def compare(reference: dict) -> str:
    """Returns the differences of Abbe's means from the program's, each with its standard error."""
    text = scene_text(*SIZE)
    runs = [region_means(render.render(text, samples=LONG, seed=seed).rgb) for seed in SEEDS]
    lines = [f"Abbe against {PROGRAM.name}, difference in percent (one standard error), R G B"]
    for name, (mean, error) in mean_and_error(runs).items():
        values = reference["reference"]["regions"][name]
        expected = np.array(values["mean"])
        lines.append(line(name, mean / expected - 1, np.hypot(error, values["error"]) / expected))
    return "\n".join(lines)


def table(reference: dict) -> str:
    """Returns the changes in percent, a line for each habit and region."""
    lines = ["changes in percent (one standard error), R G B"]
    for habit, entry in reference["relative_changes"].items():
        lines.append(f"\n{habit}")
        lines += [line(name, values["mean"], values["error"]) for name, values in entry["regions"].items()]
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--compare", action="store_true", help="render with Abbe and compare")
    parser.add_argument("--render", action="store_true", help="run the 99-line program anew")
    arguments = parser.parse_args()
    if arguments.render:
        folder = render.ROOT / "target/smallpt"
        folder.mkdir(parents=True, exist_ok=True)
        text = json.dumps(render_reference(folder), indent=1)
        REFERENCE.write_text(re.sub(r"\s*\n\s*(?=[\]\d-])", " ", text) + "\n")
    reference = json.loads(REFERENCE.read_text())
    print(compare(reference) if arguments.compare else table(reference))
