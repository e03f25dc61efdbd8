"""How often `--error` keeps its promise: many small renders, each compared with a long one by another method.

    python tools/stopping.py                            five scenes, 40 renders each
    python tools/stopping.py --renders 8 smooth lamp    fewer, of some
    python tools/stopping.py --json stopping.json       the figures as well as the table

An error is the root of the mean square over all pixels and channels, relative to that of the image. A scene's column
"kept" is the share of its renders whose true error is at most the error that was asked for; "bound" is the share whose
true error is at most the bound that stopped the render. The bound is smaller than the error asked for, partly by
chance, so no render promises it. True errors are differences from a long reference: caustics without photons, the room
without light vertices, and all scenes with other seeds and one sequence for all samples of a pixel. The error of the
reference itself is estimated by the spread of its parts, and its square is subtracted.

"cost" is the number of samples relative to that of the rule that most renderers use: look after every 16 samples, and
stop as soon as the variance of the samples says that the error is small enough.

The command fails if fewer than 91.9 % of a scene's renders keep the promise (95 % less two standard errors of 200
renders), or fewer than 95 % of all, if the median ratio of true to asked error is less than 0.4, or if a render does
not reach its error.
"""

import argparse
import json
import os
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

import numpy as np
import render

HEAD = """
camera = { position = [0, 1.2, 5], look_at = [0, 0.8, 0], vertical_fov = 40 }
film = { width = 32, height = 32 }
render = { model = "MODEL" }
"""
FLOOR = """
[[object]]
shape.plane = { point = [0, 0, 0], normal = [0, 1, 0] }
material = "floor"
"""
SMOOTH = HEAD + """
[material]
floor.diffuse.reflectance = 0.5
clay.diffuse.reflectance = { rgb = [0.7, 0.4, 0.3] }
[[object]]
shape.sphere = { center = [0, 0.8, 0], radius = 0.8 }
material = "clay"
[[light]]
environment.radiance = 1
""" + FLOOR
# A small lamp that lights little of the scene: most of its light comes through a slit.
LAMP = HEAD + """
[material]
floor.diffuse.reflectance = 0.5
wall.diffuse.reflectance = 0.2
lamp.emissive.radiance = 200
[[object]]
shape.sphere = { center = [0, 2.5, -1], radius = 0.06 }
material = "lamp"
[[object]]
shape.quad = { center = [-1.1, 1.8, 0], u = [1, 0, 0], v = [0, 0, 2] }
material = "wall"
[[object]]
shape.quad = { center = [1.1, 1.8, 0], u = [1, 0, 0], v = [0, 0, 2] }
material = "wall"
""" + FLOOR
CAUSTIC = HEAD + """
[material]
floor.diffuse.reflectance = 0.5
glass.dielectric.index = INDEX
lamp.emissive.radiance = 30
[[object]]
shape.sphere = { center = [0, 0.9, 0], radius = 0.8 }
material = "glass"
[[object]]
shape.sphere = { center = [1.5, 3.2, 0.5], radius = 0.35 }
material = "lamp"
""" + FLOOR
# A room lit by a lamp behind a screen, through reflection by the ceiling.
INTERIOR = """
camera = { position = [0, 1.5, 1.9], look_at = [0, 1.2, 0], vertical_fov = 60 }
film = { width = 32, height = 32 }
render = { model = "rgb" }
[material]
white.diffuse.reflectance = 0.7
red.diffuse.reflectance = { rgb = [0.6, 0.1, 0.1] }
lamp.emissive = { radiance = 40, sides = "front" }
[[object]]
shape.cube = { center = [0, 2, 0], size = 4 }
material = "white"
[[object]]
shape.quad = { center = [0.9, 1.8, -1.2], u = [0.4, 0, 0], v = [0, 0, -0.4] }
material = "lamp"
[[object]]
shape.sphere = { center = [-0.6, 0.6, -0.6], radius = 0.6 }
material = "red"
"""


class Scene(NamedTuple):
    text: str
    error: float
    # Samples of each part of the reference, the number of parts, and flags that make it find its light in another way.
    samples: int
    parts: int
    other: dict


OFF = {"set": "render.caustics=off"}
SCENES = {
    "smooth": Scene(SMOOTH.replace("MODEL", "rgb"), 0.01, 1024, 16, {}),
    "lamp": Scene(LAMP.replace("MODEL", "rgb"), 0.02, 1024, 24, {}),
    "caustic": Scene(CAUSTIC.replace("MODEL", "rgb").replace("INDEX", "1.5"), 0.03, 8192, 32, OFF),
    # An image of fewer than a million samples has no light vertices.
    "interior": Scene(INTERIOR, 0.03, 960, 64, {}),
    "dispersive": Scene(CAUSTIC.replace("MODEL", "hero").replace("INDEX", '"N-SF11"'), 0.04, 8192, 32, OFF),
}


def rendered(text, seed, **flags):
    """Returns the image, and the report of the render."""
    with tempfile.TemporaryDirectory() as folder:
        exr, report = Path(folder, "image.exr"), Path(folder, "report.json")
        render.write(text, exr, seed=seed, threads=1, report=report, **flags)
        return render.read(exr).rgb, json.loads(report.read_text("utf-8"))


def reference(scene, pool):
    """Returns the mean of several long renders, and the square of its error."""
    parts = pool.map(lambda seed: rendered(scene.text, 1000 + seed, samples=scene.samples, **scene.other)[0], range(scene.parts))
    parts = np.stack(list(parts))
    mean = parts.mean(axis=0)
    return mean, parts.var(axis=0, ddof=1).mean() / scene.parts


def naive(scene, seed):
    """Returns the number of samples after which the rule of most renderers would stop."""
    error = scene.error * (8 / 9) ** 0.5
    count = 64
    while True:
        with tempfile.TemporaryDirectory() as folder:
            exr = Path(folder, "image.exr")
            render.write(scene.text, exr, seed=seed, threads=1, samples=count, layers="variance")
            image = render.read(exr)
        variance = np.stack([image.channels[f"variance.{name}"] for name in "RGB"]).mean()
        ratio = variance / (image.rgb**2).mean() / error**2
        if ratio <= 1:
            return count
        # The rule looks after every 16 samples. Looks long before the end are skipped here.
        count = max(count + 16, int(count * min(ratio, 4)) // 16 * 16)


def judged(name, renders, pool):
    """Returns the figures of a scene."""
    scene = SCENES[name]
    truth, of_truth = reference(scene, pool)
    power = (truth**2).mean()

    def one(seed):
        image, report = rendered(scene.text, seed, error=scene.error)
        said = report["report"]["error"]
        true = np.sqrt(max(((image - truth) ** 2).mean() - of_truth, 0) / power)
        return [true, said["noise_at_most"], said["samples_per_pixel"], said["is_reached"]]

    true, bound, samples, reached = np.array(list(pool.map(one, range(renders)))).T
    plain = np.median(list(pool.map(lambda seed: naive(scene, seed), range(5))))
    return {
        "asked": scene.error,
        "reference": float(np.sqrt(of_truth / power)),
        "reached": float(reached.mean()),
        "kept": float((true <= scene.error).mean()),
        "bound": float((true <= bound).mean()),
        "median": float(np.median(true) / scene.error),
        "worst": float(true.max() / scene.error),
        "median_of_bound": float(np.median(true / bound)),
        "samples": float(np.median(samples)),
        "cost": float(np.median(samples) / plain),
    }


def faults(found, renders):
    """Returns what is wrong with the figures."""
    said = [f"{name}: kept in {row['kept']:.1%} of the renders" for name, row in found.items() if row["kept"] < 0.919]
    said += [f"{name}: median {row['median']:.2f} of what is asked for" for name, row in found.items() if row["median"] < 0.4]
    said += [f"{name}: not reached in all renders" for name, row in found.items() if row["reached"] < 1]
    kept = np.mean([row["kept"] for row in found.values()])
    if kept < 0.95:
        said.append(f"kept in {kept:.1%} of {renders * len(found)} renders")
    return said


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=", ".join(SCENES))
    parser.add_argument("--renders", type=int, default=40, help="of each scene")
    parser.add_argument("--json", type=Path, help="where the figures go")
    arguments = parser.parse_args()
    if unknown := [name for name in arguments.scenes if name not in SCENES]:
        parser.error(f"there is no scene {unknown[0]}: {', '.join(SCENES)}")
    found = {}
    print("scene       asked  ref.    kept   bound  true/asked  worst  true/bound  samples  cost", flush=True)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for name in arguments.scenes or SCENES:
            row = found[name] = judged(name, arguments.renders, pool)
            print(
                f"{name:10}  {row['asked']:5.1%}  {row['reference']:.2%}  {row['kept']:5.1%}  {row['bound']:5.1%}"
                f"  {row['median']:10.2f}  {row['worst']:5.2f}  {row['median_of_bound']:10.2f}  {row['samples']:7.0f}  {row['cost']:4.2f}",
                flush=True,
            )
    if arguments.json:
        arguments.json.write_text(json.dumps(found, indent=1) + "\n", "utf-8")
    said = faults(found, arguments.renders)
    print("\n".join(said) if said else "every scene keeps its word")
    return bool(said)


if __name__ == "__main__":
    sys.exit(main())
