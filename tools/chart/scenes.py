"""What tools/chart.py charts: each chart's scene, its series, and the numbers of samples of each.

A series is a renderer with its settings. The first series of a chart is the one to which the others are compared. If
`common` names a series, its converged picture is the reference for all of them, so their bias and the light that they
miss count as error; otherwise each is judged by its own. The lamp of the Cornell box is also rendered as emissive glass
of index 1, which is not sampled as a light and is only hit by chance.
"""

from pathlib import Path
from typing import NamedTuple

import render
from peers import scene as peers_scene

PEERS = render.ROOT / "tools/peers"


class Series(NamedTuple):
    """A renderer with its settings, and the samples per pixel of its points."""

    label: str
    renderer: str
    samples: tuple[int, ...]
    variant: str = ""
    settings: dict[str, str] = {}  # keys of the table [render], for Abbe
    edits: tuple[tuple[str, str], ...] = ()  # text of the scene file and its replacement, for Abbe
    flat_lamp: bool = False


class Chart(NamedTuple):
    """A chart of error against processor time. `size` is that of --quick."""

    name: str
    title: str
    scene: Path
    size: tuple[int, int]
    series: tuple[Series, ...]
    common: str | None = None
    longer: int = 1  # factor on the samples of its converged pictures
    bumps: tuple[int, int] | None = None  # rings and sectors of the bumpy ball, if it is in the scene


class Profile(NamedTuple):
    """How much to render: the picture's sides and the samples, relative to a chart's own, and the number of repeats."""

    side: float
    left_out: int  # number of points, those with the most samples, that are not rendered
    reference: int  # samples of half a reference, as a multiple of the longest point's
    repeats: int


LEAST = 4  # pixels along a side
FULL = Profile(8, 1, 2, 3)
QUICK = Profile(1, 0, 3, 3)

MODELS = {"rgb": '"rgb"', **{f"{n} bands": f"{{ bands = {n} }}" for n in (8, 12, 16, 32)}, "heroes": '"hero"'}
AIMED = 'emissive = { radiance = { rgb = [17, 12, 4] }, sides = "front" }'
BY_CHANCE = "dielectric = { index = 1, reflectance = 0, transmittance = 0, emission = { rgb = [17, 12, 4] } }"


def abbe(label: str, *samples: int, **settings: str) -> Series:
    return Series(label, "abbe", samples, settings=settings)


def models(*samples: int, first: str) -> tuple[Series, ...]:
    """Returns one series for every color model, with `first` first."""
    names = [first, *(name for name in MODELS if name != first)]
    return tuple(abbe(f"Abbe, {name}", *samples, model=MODELS[name]) for name in names)


def mitsuba(variant: str, *samples: int, flat_lamp: bool = False) -> Series:
    kind, *_, colors = variant.split("_")
    label = f"Mitsuba {'LLVM' if kind == 'llvm' else kind}, {colors}"
    return Series(label, "mitsuba", samples, variant, flat_lamp=flat_lamp)


def luxcore(*samples: int, variant: str = "PATHCPU", label: str = "LuxCore", flat_lamp: bool = False) -> Series:
    return Series(label, "luxcore", samples, variant, flat_lamp=flat_lamp)


def cycles(*samples: int, flat_lamp: bool = False) -> Series:
    return Series("Blender Cycles", "cycles", samples, "CPU", flat_lamp=flat_lamp)


CHARTS = (
    Chart(
        "models",
        "Models of color: paint of measured spectra under D65, FL11 and sodium",
        render.SCENES / "illuminants.toml",
        (48, 20),
        models(4, 16, 64, 256, first="32 bands"),
        common="Abbe, 32 bands",
    ),
    Chart(
        "dispersion",
        "Models of color: white lamps through a prism of N-SF11",
        render.SCENES / "prism.toml",
        (64, 36),
        models(4, 16, 64, first="heroes"),
        common="Abbe, heroes",
    ),
    Chart(
        "cornell",
        "Cornell box",
        PEERS / "cornell.toml",
        (48, 48),
        (
            abbe("Abbe", 2, 4, 16, 64, model='"rgb"'),
            abbe("Abbe, 12 bands", 2, 4, 16, 64),
            Series("Abbe, lamp met by chance", "abbe", (4, 16, 64), "", {"model": '"rgb"'}, ((AIMED, BY_CHANCE),)),
            mitsuba("llvm_ad_rgb", 16, 64, 256),
            mitsuba("llvm_ad_spectral", 16, 64, 256),
            mitsuba("scalar_rgb", 4, 16, 64),
            luxcore(4, 16, 64),
            cycles(4, 16, 64),
            Series("POV-Ray, radiosity", "povray", (1, 2)),
        ),
    ),
    Chart(
        "smallpt",
        "The box of smallpt",
        render.SCENES / "smallpt.toml",
        (48, 36),
        (
            abbe("Abbe", 1, 4, 16, 64),
            mitsuba("llvm_ad_rgb", 16, 64, 256, flat_lamp=True),
            mitsuba("scalar_rgb", 4, 16, 64, flat_lamp=True),
            luxcore(2, 8, 32, flat_lamp=True),
            cycles(4, 16, 64, flat_lamp=True),
            Series("smallpt", "smallpt", (16, 64, 256, 1024)),
        ),
    ),
    Chart(
        "caustic",
        "A ball and a prism of glass without dispersion",
        PEERS / "caustic.toml",
        (48, 48),
        (
            abbe("Abbe", 1, 4, 16, 64),
            abbe("Abbe, caustics by chance", 4, 16, 64, caustics='"off"'),
            mitsuba("llvm_ad_rgb", 16, 64, 256),
            mitsuba("scalar_rgb", 16, 64, 256),
            luxcore(16, 64, 256),
            cycles(16, 64, 256),
        ),
    ),
    Chart(
        "glass",
        "A ball and a prism of N-SF11, which disperses",
        PEERS / "glass.toml",
        (48, 48),
        (
            abbe("Abbe", 1, 4, 16, 64),
            abbe("Abbe, caustics by chance", 4, 16, 64, caustics='"off"'),
            luxcore(16, 64, 256),
        ),
    ),
    Chart(
        "beam",
        "A beam 0.01 wide through a prism of N-SF11",
        PEERS / "beam.toml",
        (24, 48),
        (
            abbe("Abbe", 16, 32),
            luxcore(256, 1024, variant="BIDIRCPU", label="LuxCore, bidirectional"),
            luxcore(64, 256, variant="PATHCPU hybrid", label="LuxCore, hybrid"),
            luxcore(4, 16, variant="PATHCPU photons", label="LuxCore, photon cache"),
        ),
    ),
    Chart(
        "window",
        "A furnished room behind a window, in sun and sky",
        PEERS / "window.toml",
        (48, 48),
        (
            abbe("Abbe", 4, 16, 64, 256, model='"rgb"'),
            mitsuba("llvm_ad_rgb", 16, 64, 256),
            mitsuba("scalar_rgb", 4, 16, 64),
            cycles(4, 16, 64, 256),
        ),
    ),
    Chart(
        "ajar",
        "A room lit through the gap of a door",
        PEERS / "ajar.toml",
        (48, 48),
        (
            abbe("Abbe", 4, 16, 64, 256, model='"rgb"'),
            mitsuba("llvm_ad_rgb", 16, 64, 256),
            mitsuba("scalar_rgb", 16, 64, 256),
            luxcore(16, 64, 256),
            cycles(16, 64, 256),
        ),
    ),
    Chart(
        "water",
        "A cylinder of water in the sun",
        PEERS / "water.toml",
        (48, 48),
        (
            abbe("Abbe", 4, 16, 64, model='"rgb"'),
            mitsuba("llvm_ad_rgb", 16, 64, 256),
            cycles(16, 64, 256),
        ),
        common="Abbe",
        longer=16,
    ),
    Chart(
        "mesh",
        "A ball of 180 000 triangles under an even sky",
        PEERS / "mesh.toml",
        (64, 64),
        (
            abbe("Abbe", 8, 32, 128, model='"rgb"'),
            mitsuba("llvm_ad_rgb", 16, 64, 256),
            mitsuba("scalar_rgb", 4, 16, 64),
            luxcore(4, 16, 64),
            cycles(4, 16, 64),
        ),
        bumps=(300, 300),
    ),
)


def scaled(chart: Chart, profile: Profile, pixels: int | None = None) -> Chart:
    """Returns the chart with the profile's samples and size, or with `pixels` along its longer side."""
    factor = pixels / max(chart.size) if pixels else profile.side
    size = tuple(max(LEAST, round(side * factor)) for side in chart.size)
    points = lambda samples: samples[: max(2, len(samples) - profile.left_out)]  # noqa: E731
    series = tuple(one._replace(samples=points(one.samples)) for one in chart.series)
    return chart._replace(size=size, series=series)


def scene_text(chart: Chart, series: Series) -> str:
    """Returns the text of a series' scene file."""
    lines = []
    settings = "".join(f"{key} = {value}\n" for key, value in series.settings.items())
    for line in chart.scene.read_text("utf-8").splitlines():
        key = line.split("=")[0].strip()
        if key in ("width", "height"):
            line = f"{key} = {chart.size[key == 'height']}"
        if key in series.settings:
            continue
        lines.append(line)
        if line.strip() == "[render]":
            lines.append(settings)
    text = "\n".join(lines)
    if "[render]" not in text:
        text += f"\n[render]\n{settings}"
    for old, new in series.edits:
        if old not in text:
            raise ValueError(f"{chart.scene.name} does not hold `{old}`")
        text = text.replace(old, new)
    return text


def write_scene(chart: Chart, series: Series, path: Path) -> Path:
    """Writes the scene file of a series and the files that it reads, and returns its path."""
    path.write_text(scene_text(chart, series), "utf-8")
    for name in ("textures", "meshes"):
        if not path.with_name(name).exists():
            path.with_name(name).symlink_to(render.SCENES / name)
    if chart.bumps and not path.with_name("bumpy.ply").exists():
        peers_scene.write_bumpy_ball(path.with_name("bumpy.ply"), *chart.bumps)
    return path
