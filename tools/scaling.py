"""How the work grows: time and memory of Abbe against triangles, lights, samples, pixels and threads.

    python tools/scaling.py                       # about 10 minutes
    python tools/scaling.py --quick               # about a minute: smaller scenes, one repeat
    python tools/scaling.py --only triangles

Each row renders one generated scene and prints the median CPU time, the wall time, the peak of memory, and the power of
the quantity by which the CPU time grew since the row above. Nothing should grow faster than n log n, which is a power
slightly above 1. The system counts the memory of this script as the minimum of its children's, some 40 MB.
"""

import argparse
import math
import tempfile
from pathlib import Path
from statistics import median

import numpy as np
import render
from gallery.shapes import write_ply

VIEW = """[camera]
position = [0, 6, 9]
look_at = [0, 0, 0]
vertical_fov = 40
[film]
width = {side}
height = {side}
"""
GREY = "[material.grey]\ndiffuse = { reflectance = 0.5 }\n"
SKY = "[[light]]\nenvironment = { radiance = 1 }\n"
FLOOR = "[[object]]\nshape.plane = { point = [0, -1, 0], normal = [0, 1, 0] }\nmaterial = \"grey\"\n"


def hills(path: Path, triangles: int):
    """Writes a binary PLY of rolling hills, 8 units on a side, of about `triangles`, and returns the exact number."""
    n = max(2, round(math.sqrt(triangles / 2)) + 1)
    x, z = np.meshgrid(np.linspace(-4, 4, n), np.linspace(-4, 4, n))
    y = 0.3 * np.sin(3 * x) * np.cos(2 * z) + 0.05 * np.sin(17 * x + 3 * z) + 0.02 * np.sin(41 * z - 5 * x)
    corner = np.arange(n * n).reshape(n, n)
    a, b, c, d = corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]
    faces = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])
    write_ply(path, np.stack([x, y, z], -1).reshape(-1, 3), faces)
    return len(faces)


def of_triangles(folder: Path, count: int):
    exact = hills(folder / "hills.ply", count)
    mesh = '[[object]]\nshape.mesh = { file = "hills.ply" }\nmaterial = "grey"\n'
    return VIEW.format(side=256) + GREY + mesh + SKY, {"samples": 4}, exact


def of_lights(_, count: int):
    """Returns a hall with a small lamp above each square of a grid. It grows with their number at equal density."""
    side = math.ceil(math.sqrt(count))
    lamps = []
    for number in range(count):
        x, z = (number % side - side / 2) * 2, (number // side - side / 2) * 2
        quad = f"center = [{x}, 3, {z}], u = [0.1, 0, 0], v = [0, 0, 0.1]"
        lamps.append(f'[[object]]\nshape.quad = {{ {quad} }}\nmaterial = "lamp"\n')
    text = VIEW.format(side=128) + GREY + "[material.lamp]\nemissive = { radiance = 10 }\n" + FLOOR + "".join(lamps)
    return text, {"samples": 16}, count


def of_samples(_, count: int):
    return box(128), {"samples": count}, count


def of_pixels(_, count: int):
    side = round(math.sqrt(count))
    return box(side), {"samples": 4}, side * side


def box(side: int):
    ball = '[[object]]\nshape.sphere = { center = [0, 0, 0], radius = 1 }\nmaterial = "glass"\n'
    return VIEW.format(side=side) + GREY + "[material.glass]\ndielectric = { index = 1.5 }\n" + FLOOR + ball + SKY


def of_threads(_, count: int):
    return box(256), {"samples": 64, "threads": count}, count


AXES = {
    "triangles": (of_triangles, [10**3, 10**4, 10**5, 10**6, 10**7], [10**3, 10**4, 10**5]),
    "lights": (of_lights, [1, 10, 100, 1000, 10**4, 10**5], [1, 10, 100, 1000]),
    "samples": (of_samples, [4, 16, 64, 256], [4, 16]),
    "pixels": (of_pixels, [128**2, 256**2, 512**2, 1024**2], [128**2, 256**2]),
    "threads": (of_threads, [1, 2], [1, 2]),
}


def measure(folder: Path, text: str, flags: dict):
    """Returns CPU seconds, wall seconds and peak memory in MB of one render."""
    scene = folder / "scene.toml"
    scene.write_text(text, "utf-8")
    words = [word for name, value in ({"threads": 1} | flags).items() for word in (f"--{name}", str(value))]
    spent = render.spent(scene, "--exr", folder / "scene.exr", *words)
    return spent.processor, spent.wall, spent.peak / 2**20


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="smaller scenes, one repeat")
    parser.add_argument("--only", choices=AXES, help="one quantity")
    options = parser.parse_args()
    for name, (make, full, quick) in AXES.items():
        if options.only not in (None, name):
            continue
        print(f"\n{name:>12} {'CPU s':>9} {'wall s':>9} {'MB':>8}  power")
        before = None
        with tempfile.TemporaryDirectory() as folder:
            for wanted in quick if options.quick else full:
                text, flags, count = make(Path(folder), wanted)
                runs = [measure(Path(folder), text, flags) for _ in range(1 if options.quick else 3)]
                cpu, wall, memory = (median(column) for column in zip(*runs, strict=True))
                power = f"{math.log(cpu / before[1]) / math.log(count / before[0]):.2f}" if before else ""
                print(f"{count:12} {cpu:9.2f} {wall:9.2f} {memory:8.0f}  {power}", flush=True)
                before = (count, cpu)


if __name__ == "__main__":
    main()
