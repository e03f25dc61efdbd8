"""What merging the parts of an image costs: memory and time, beside the size of a part and of the image.

    python tools/merging.py                   # 256 parts of 1920 x 1080 pixels with all layers, some 3 minutes
    python tools/merging.py --parts 2000      # more parts than a process may have files open

The size of the image is that of its channels in memory, each number as wide as in the file. The merged file is compared
with that of one render, byte by byte. The system counts the memory of this script as the minimum of its children's,
some 30 MB.
"""

import argparse
import sys
import tempfile
from pathlib import Path

import OpenEXR
import render

SCENE = """
camera = { position = [0, 1.6, 6], look_at = [0, 0.7, 0], vertical_fov = 38 }
film = { width = WIDTH, height = HEIGHT, precision = "PRECISION" }
render = { samples = 1, seed = 3, caustics = "off" }
material.floor.diffuse.reflectance = { rgb = [0.7, 0.5, 0.3] }
material.glass.dielectric.index = 1.5
material.gold.conductor = { metal = "Au", roughness = 0.3 }
material.lamp.emissive.radiance = 30
object = [
    { name = "floor", shape.disc = { center = [0, 0, 0], normal = [0, 1, 0], radius = 4 }, material = "floor" },
    { name = "glass", shape.sphere = { center = [-0.8, 0.8, 0], radius = 0.8 }, material = "glass" },
    { name = "gold", shape.sphere = { center = [0.9, 0.7, 0], radius = 0.7 }, material = "gold" },
    { name = "lamp", shape.sphere = { center = [-2, 3, 1], radius = 0.3 }, material = "lamp" },
]
light = [
    { environment.radiance = 0.3 },
    { sun = { toward = [1, 2, 1], irradiance = 3 } },
]
"""


# The memory that a merge may take, in units of 64 rows and two parts: 64 rows are held both as numbers and packed.
MOST = 2


def image_bytes(path):
    """Returns the size of a file's numbers in memory."""
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return sum(channel.pixels.nbytes for part in file.parts for channel in part.channels.values())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--parts", type=int, default=256)
    parser.add_argument("--width", type=int, default=1920)
    parser.add_argument("--height", type=int, default=1080)
    parser.add_argument("--precision", choices=["half", "float"], default="float")
    arguments = parser.parse_args()
    text = SCENE
    for key in ("width", "height", "precision"):
        text = text.replace(key.upper(), str(getattr(arguments, key)))
    with tempfile.TemporaryDirectory() as folder:
        scene, whole, merged = (Path(folder) / name for name in ("s.toml", "whole.exr", "merged.exr"))
        scene.write_text(text, "utf-8")
        rendered = [scene, "--layers", "all", "--exr"]
        numbers = range(1, arguments.parts + 1)
        for number in numbers:
            render.spent(*rendered, Path(folder) / "part.exr", "--shard", f"{number}/{arguments.parts}")
        parts = [Path(folder) / f"part.{number}-of-{arguments.parts}.part" for number in numbers]
        merging = render.spent("merge", merged, *parts)
        render.spent(*rendered, whole)
        peak, least = merging.peak, render.spent("--version").peak
        same = whole.read_bytes() == merged.read_bytes()
        part, image = max(path.stat().st_size for path in parts), image_bytes(whole)
        rows = image * min(64 / arguments.height, 1) + 2 * part
        print(f"{arguments.parts} parts of {arguments.width} x {arguments.height} pixels, all layers, {arguments.precision}")
        print(f"image {image / 1e6:.0f} MB, part {part / 1e6:.1f} MB, merged in {merging.wall:.1f} s")
        print(f"peak {peak / 1e6:.0f} MB, {(peak - least) / rows:.2f} times as much as 64 rows and two parts")
        print("the bytes of one render" if same else "OTHER BYTES than of one render")
    return 0 if same and peak - least <= MOST * rows else 1


if __name__ == "__main__":
    sys.exit(main())
