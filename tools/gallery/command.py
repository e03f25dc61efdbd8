"""The gallery in scenes/: makes its meshes and images, renders every scene to a small picture, writes scenes/README.md.

    python tools/gallery.py make                # scenes/meshes, scenes/textures, scenes/generated, scenes/large/instances.toml
    python tools/gallery.py render              # every scene: scenes/pictures, then scenes/README.md
    python tools/gallery.py render gem lens     # these alone
    python tools/gallery.py render --quick      # with a quarter of the samples
    python tools/gallery.py errors              # the noise of every scene at its own samples, then scenes/README.md
    python tools/gallery.py plan                # the plan's words alone, then scenes/README.md
    python tools/gallery.py write               # scenes/README.md alone

Every run makes the same files. Needs numpy, and for pictures OpenEXR and the release build (or $RENDER).
"""

import argparse
import json
import re
import resource
import tempfile
import tomllib
from pathlib import Path

import numpy as np

from . import shapes, textures

SCENES = Path(__file__).resolve().parents[2] / "scenes"
MEASURED = SCENES / "pictures/measured.json"
FIRST = "rainbow"  # the picture on top of README.md, scenes/rainbow.png
ORDER = "gem rainbow water pond pool window lens prism bubble coatings highlighter metals illuminants still_life large/instances large/landscape cornell smallpt classic spheres".split()

PARTS = ". "  # between the lines of a plan in measured.json

HEAD = """# The gallery

Every scene in this folder, with the command that renders it. For a quick look, add `--samples 16`. All meshes and images are in the repository,
except for those of the landscape: `python tools/gallery.py make` makes them.

Times are processor time divided by two, as on two cores, at the scene's own size and samples. Where a picture shows fewer samples, its time is scaled
up in proportion. Below each picture is what `render --plan` says about color and photons.

relMSE is the noise: the mean of (x - mean)^2 / (mean^2 + 0.01) over pixels and channels. It comes from two renders with different seeds at a fifth of
the width, or at half of it for scenes with a photon map or light vertices. The last column is the time for 640 x 360 pixels to reach a relMSE of
0.01, if time and noise are in proportion to the samples. `tools/gallery.py` writes this page.
"""


def scenes():
    """Returns the names of all scenes, in the order of the gallery."""
    found = {str(path.relative_to(SCENES).with_suffix("")) for path in SCENES.rglob("*.toml")}
    return [name for name in ORDER if name in found] + sorted(found.difference(ORDER))


def first_line(name):
    """Returns a scene's first line, which says what to look for."""
    return (SCENES / f"{name}.toml").read_text("utf-8").splitlines()[0].removeprefix("# ")


def make_lenses():
    """Yields profiles: a singlet of N-SF11, an achromat of N-BK7 and N-SF11, and a ring.

    Both lenses have the focal length 1.9 by the thin-lens formula."""
    focal, crown, flint = 1.9, (1.5168, 64.17), (1.7847, 25.68)
    radius = 2 * (flint[0] - 1) * focal
    yield "singlet", shapes.lens(radius, radius, 0.34, 0.8)
    powers = [sign * v / (crown[1] - flint[1]) / focal for sign, v in ((1, crown[1]), (-1, flint[1]))]
    cement = 2 * (crown[0] - 1) / powers[0]
    yield "achromat_crown", shapes.lens(cement, cement, 0.70, 0.8)
    back = 1 / (1 / cement + powers[1] / (flint[0] - 1))
    yield "achromat_flint", shapes.flint(back, 0.12, 0.79, -0.35, -0.02)
    yield "ring", [*shapes.arc((0.86, 0), 0.085, 0, 360, 17)]


def make():
    """Makes every mesh and image that a scene reads."""
    meshes, images = SCENES / "meshes", SCENES / "textures"
    shapes.write_ply(meshes / "brilliant.ply", *shapes.brilliant())
    for name, profile in [("tumbler", shapes.tumbler()), ("water", shapes.water()), *make_lenses()]:
        shapes.write_ply(meshes / f"{name}.ply", *shapes.lathe(profile, 72))
    for name, profile in (("vase", shapes.vase()), ("bowl", shapes.bowl())):
        shapes.write_ply(meshes / f"{name}.ply", *shapes.lathe(profile, 48))
    points, faces, uv = shapes.tube()
    shapes.write_ply(meshes / "straw.ply", points, faces, uv=uv)
    shapes.write_ply(meshes / "sweep.ply", *shapes.sweep())
    shapes.write_ply(meshes / "curtain.ply", *shapes.curtain())
    shapes.write_ply(meshes / "waves.ply", *shapes.block(shapes.waves(), 5.2, 5.2, -1.5))
    for image in (textures.stripes, textures.wood, textures.tiles, textures.chart, textures.painting, textures.soap):
        textures.write_png(images / f"{image.__name__}.png", image())
    textures.write_hdr(images / "evening.hdr", textures.sky())
    make_sunflower(SCENES / "large/instances.toml")
    make_landscape()


def make_landscape():
    """Makes two million triangles and their colors, in scenes/generated: they are too large for the repository."""
    heights = shapes.landscape()
    points, faces, uv = shapes.sheet(heights, 24, 24)
    shapes.write_ply(SCENES / "generated/landscape.ply", points, faces, uv=uv)
    textures.write_png(SCENES / "generated/landscape.png", textures.ground(heights, water=0.5))


def needs_making(name):
    """Whether a scene reads files that are not kept in the repository."""
    return "generated/" in (SCENES / f"{name}.toml").read_text("utf-8")


def make_sunflower(path, count=2000):
    """Writes the beads' places after the line that marks them, each turned by the golden angle (Vogel 1979)."""
    mark = "# What follows is written by tools/gallery.py.\n"
    head, found, _ = path.read_text("utf-8").partition(mark)
    if not found:
        raise SystemExit(f"{path} has no line {mark!r}")
    kinds = ("ruby", "amber", "clear", "sea", "cobalt")
    text = head + mark
    for kind, name in enumerate(kinds):
        places = []
        for k in range(kind, count, len(kinds)):
            turn, out = 2.399963 * (k + 0.5), np.sqrt((k + 0.5) / count)
            size = 0.72 + 0.28 * out
            x, z, y = 4 * out * np.cos(turn), 4 * out * np.sin(turn), 0.7 * (1 - out**2) + 0.08 * size
            places.append(f"  [{{ scale = {size:.3f} }}, {{ translate = [{x:.3f}, {y:.3f}, {z:.3f}] }}],\n")
        text += f'\n[[object]]\nname = "{name} beads"\nshape.sphere = {{ center = [0, 0, 0], radius = 0.08 }}\n'
        text += f'material = "{name}"\ninstances = [\n{"".join(places)}]\n'
    path.write_text(text, "utf-8")


def shrink(rgb, width):
    """Returns an sRGB picture of at most `width` columns, each pixel the mean over its area."""
    height, full = rgb.shape[:2]
    if full <= width:
        return encode(rgb)

    def means(count, total):
        edges = np.linspace(0, total, count + 1)
        cells = np.arange(total)
        cover = np.clip(np.minimum(edges[1:, None], cells + 1) - np.maximum(edges[:-1, None], cells), 0, 1)
        return cover / cover.sum(axis=1, keepdims=True)

    rows = means(round(height * width / full), height)
    return encode(np.einsum("ij,jkc,lk->ilc", rows, np.clip(rgb, 0, 1), means(width, full), optimize=True))


def encode(rgb):
    """Converts linear colors to sRGB (IEC 61966-2-1)."""
    rgb = np.clip(rgb, 0, 1)
    return np.where(rgb <= 0.0031308, 12.92 * rgb, 1.055 * rgb ** (1 / 2.4) - 0.055)


def render_picture(name, quick):
    """Renders a scene, writes its picture, below 150 kB, and returns what was measured."""
    import render

    scene = SCENES / f"{name}.toml"
    samples = tomllib.loads(scene.read_text("utf-8"))["render"]["samples"]
    share = max(1, samples // 4) if quick else samples
    plan = plan_of(name)
    with tempfile.TemporaryDirectory() as folder:
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        render.write(scene, Path(folder) / "scene.exr", threads=2, samples=share)
        seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
        rgb = render.read(Path(folder) / "scene.exr").rgb
    if name == FIRST and not quick:
        textures.write_png(SCENES / f"{name}.png", shrink(rgb, 720))
    picture = SCENES / f"pictures/{Path(name).name}.png"
    for width in (480, 440, 400, 360, 320, 280):
        textures.write_png(picture, shrink(rgb, width))
        if picture.stat().st_size <= 150_000:
            break
    return {"samples": share, "seconds": round(seconds / 2 * samples / share, 1), "plan": words(plan)}


def plan_of(name):
    """Returns the output of `render --plan` for a scene."""
    import render

    return render.said("--plan", SCENES / f"{name}.toml")


def words(plan):
    """Returns the lines of a plan that the page quotes: the color model, and the photons if there are any."""
    return PARTS.join(line for line in plan.splitlines() if line.startswith(("model ", "photon tracing: ", "photon map: ")))


def reduced(name, share=5):
    """Returns a scene's text with its picture `share` times smaller each way, and absolute paths of its files."""
    scene = SCENES / f"{name}.toml"
    text = scene.read_text("utf-8")
    text = re.sub(r'"([^"\n]+\.(?:ply|png|hdr|csv))"', lambda found: f'"{(scene.parent / found[1]).resolve()}"', text)
    return re.sub(r"(?m)^(width|height) = (\d+)", lambda found: f"{found[1]} = {int(found[2]) // share}", text)


def noise(first, second):
    """Returns the relMSE of either of two renders that differ only in their seeds: half of that between them."""
    mean = (first + second) / 2
    return float(np.mean((first - second) ** 2 / 2 / (mean**2 + 0.01)))


def measure_error(name):
    """Returns the noise of a scene at its own samples."""
    import render

    plan = plan_of(name)
    # A small image would have other numbers of photons and passes of a photon map, and no light vertices.
    share = 2 if "photon map: " in plan or "light vertices" in plan else 5
    first, second = (render.render(reduced(name, share), seed=seed, threads=2).rgb for seed in (1, 2))
    return {"error": float(f"{noise(first, second):.2g}")}


def seconds_to_bar(name, measured):
    """Returns the time that a scene takes on two cores at 640 x 360 to a relMSE of 0.01."""
    film = tomllib.loads((SCENES / f"{name}.toml").read_text("utf-8"))["film"]
    return measured["seconds"] * 640 * 360 / film["width"] / film["height"] * measured["error"] / 0.01


def table(measured):
    """Returns a table of the time and the error of every measured scene."""
    text = "\n| scene | samples | time, s | relMSE | s to 0.01 |\n|---|---|---|---|---|\n"
    for name in scenes():
        if {"error", "seconds"} <= measured.get(name, {}).keys():
            found, own = measured[name], tomllib.loads((SCENES / f"{name}.toml").read_text("utf-8"))["render"]["samples"]
            bar = seconds_to_bar(name, found)
            text += f"| [{name}](#{name.replace('/', '')}) | {own} | {found['seconds']:.3g} | {found['error']:.2g} | {bar:.2g} |\n"
    return text


def readme():
    """Returns the text of scenes/README.md."""
    measured = json.loads(MEASURED.read_text("utf-8"))
    text = HEAD + table(measured)
    for name in scenes():
        line = first_line(name)
        text += f"\n## [{name}]({name}.toml)\n\n"
        if (SCENES / f"pictures/{Path(name).name}.png").is_file():
            text += f"![{line}](pictures/{Path(name).name}.png)\n\n"
        text += f"{line}\n\n```sh\n"
        if needs_making(name):
            text += "python tools/gallery.py make\n"
        text += f"render --exr scenes/{name}.toml\n```\n"
        if "plan" in measured.get(name, {}):
            samples, seconds, plan = (measured[name][key] for key in ("samples", "seconds", "plan"))
            shown = "1 sample" if samples == 1 else f"{samples} samples"
            text += f"\nAbout {max(1, round(seconds))} s; the picture shows {shown}. The plan:\n\n"
            text += "".join(f"- {part}\n" for part in plan.split(PARTS))
    return text


def main():
    parser = argparse.ArgumentParser(description="Makes and renders the gallery in scenes/.")
    parser.add_argument("what", choices=["make", "render", "errors", "plan", "write"])
    parser.add_argument("names", nargs="*", help="scenes to render or measure, without .toml; all if none is given")
    parser.add_argument("--quick", action="store_true", help="a quarter of the samples, four times the measured time")
    arguments = parser.parse_intermixed_args()
    if arguments.what == "make":
        make()
        return
    MEASURED.parent.mkdir(exist_ok=True)
    for name in (arguments.names or scenes()) if arguments.what != "write" else []:
        match arguments.what:
            case "errors":
                found = measure_error(name)
            case "plan":
                found = {"plan": words(plan_of(name))}
            case _:
                found = render_picture(name, arguments.quick)
        print(name, found, flush=True)
        measured = json.loads(MEASURED.read_text("utf-8")) if MEASURED.is_file() else {}
        found = measured.get(name, {}) | found
        MEASURED.write_text(json.dumps(measured | {name: found}, indent=1, sort_keys=True) + "\n", "utf-8")
    (SCENES / "README.md").write_text(readme(), "utf-8")
