"""Energy II: R + T + A of plates, lane by lane."""

import numpy as np

from . import formulas, readers
from .row import Row
from .scenes import cube, disc, glass, glow, plane, rgb, view

BANDS = (1.333, 1.52, 2.42)
# Emissive planes that show what a surface at the origin reflects (R) and transmits (T).
LAMPS = {"R": plane((0, 30, 0), (0, -1, 0)), "T": plane((0, -5, 0), (0, 1, 0))}


def looking_down(degrees):
    angle = np.radians(degrees)
    return (10 * np.sin(angle), 10 * np.cos(angle), 0)


def pile(count):
    """Returns plates of glass 0.01 thick and 0.01 apart, the first one below the origin."""
    return [("glass", cube((0, -0.02 * number - 0.005, 0), [40.0, 0.01, 40.0])) for number in range(count)]


def plate(kind, degrees, index, optical_depth=0.0, discs=()):
    """Returns a row for a plate 0.01 thick, with an emissive plane before it (R), behind it (T), or on both sides."""
    depth = np.broadcast_to(np.asarray(optical_depth, float), 3)
    materials = {"glass": glass(rgb(index), absorption=rgb(depth / 0.01)), "glow": glow()}
    bodies = [("glass", disc) for disc in discs] or pile(1)
    objects = [*bodies, *(("glow", LAMPS[side]) for side in kind.split("+"))]
    scene = view(materials, objects, eye=looking_down(degrees), up=(0, 0, 1), polarization="on")
    answer = dict(zip("RT", formulas.slab(np.array(index), degrees, depth), strict=True))
    once = formulas.fresnel(np.array(index), degrees)
    through = np.exp(-depth / formulas.refracted_cosine(np.array(index), degrees))
    wrong = {"R": once, "T": (1 - once) ** 2 * through}
    total = kind == "R+T"
    words = (
        f"A plate 0.01 thick of indices {index} and optical depths {depth.tolist()}, seen at {degrees} degrees, "
        f"before black; a "
        f"plane of radiance 1 {'on both sides' if total else 'before it' if kind == 'R' else 'behind it'}."
    )
    name = f"{kind} of a plate at {degrees} degrees" + (", absorbing" if depth.any() else "")
    name += " of two discs" if discs else ""
    formula = "1 - A" if total else {"T": "(1 - r)^2 a / (1 - r^2 a^2)", "R": "r + r a T"}[kind]
    mistake = "reflections inside that are left out" if not total else "the light of inner reflections that is lost"
    return Row(
        "energy",
        name,
        formula + ", the mean of both polarizations",
        scene,
        readers.colors,
        sum(answer[side] for side in kind.split("+")),
        mistake,
        sum(wrong[side] for side in kind.split("+")),
        words,
    )


def rows(quick):
    for degrees in (0, 30, 45, 60, 70, 80):
        for kind in ("R", "T", "R+T"):
            yield plate(kind, degrees, BANDS)
    for degrees in (0, 60, 75):
        for kind in ("R", "T", "R+T"):
            yield plate(kind, degrees, (1.5, 1.5, 2.0), (1.0, 0.1, 0.5))
    discs = [disc((0, 0, 0), (0, 1, 0), 20), disc((0, -0.01, 0), (0, -1, 0), 20)]
    yield plate("T", 60, BANDS, discs=discs)
