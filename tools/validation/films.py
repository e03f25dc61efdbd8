"""Films with interference, against the matrices of Abeles (1950), at single wavelengths and in daylight.

A layer of n - i k and thickness D has M = [[cos d, i sin d / y], [i y sin d, cos d]], d = 2 pi q D / wavelength, with
q = n cos and the admittances y = q of s, n^2 / q of p. With (B, C) = M (1, y of the body), the reflected amplitude is
(y B - C) / (y B + C), for p with the other sign.
"""

import numpy as np

import colors

from . import formulas, readers
from .color import XYZ, line_powers
from .plates import LAMPS, looking_down
from .polarized_row import RIGHT
from .row import LIMIT, ROUNDING, Row
from .scenes import disc, glass, glow, plane, quad, sphere, view
from .stokes import unit
from .surfaces import STOKES, UP, S, Stage

GROUP = "films"
LINES = (450.0, 550.0, 650.0)
UNCOATED = "the surface without its layers"
PANE = "a pane in which light does not interfere"
QUARTER = 550 / 4
# The largest error allowed for single wavelengths, in standard errors of rounding.
EXACT = 1e-5 / LIMIT


def amplitudes(layers, body, degrees, nm, around=1.0):
    """Returns the reflected and the transmitted amplitude of s and of p, at each wavelength.

    Light goes from a medium through layers (index n - i k, thickness in nm, from the outside inward) into a body. The
    squares of the transmitted amplitudes are fluxes."""
    along = (around * np.sin(np.radians(degrees))) ** 2
    found = []
    for p in (False, True):

        def root(index):
            # Waves decay in the direction of propagation.
            q = np.sqrt(np.asarray(index, complex) ** 2 - along)
            return np.where(q.imag > 0, -q, q)

        def admittance(index):
            return np.asarray(index, complex) ** 2 / root(index) if p else root(index)

        start, end = admittance(around), admittance(body) + 0 * nm
        b, c = np.ones_like(end), end
        for index, thickness in reversed(layers):
            y, phase = admittance(index), 2 * np.pi * root(index) * thickness / nm
            b, c = np.cos(phase) * b + 1j * np.sin(phase) / y * c, 1j * y * np.sin(phase) * b + np.cos(phase) * c
        whole = start * b + c
        sign = -1 if p else 1
        found.append((sign * (start * b - c) / whole, 2 * np.sqrt(start.real * end.real) / whole))
    return np.array(found)


def shares(layers, body, degrees, nm):
    """Returns the reflectance and the transmittance for unpolarized light from air."""
    return np.mean(np.abs(amplitudes(layers, body, degrees, nm)) ** 2, axis=0)


def coating(layers):
    return [
        {"index": index.real, "k": -index.imag, "thickness_nm": thickness}
        for index, thickness in ((complex(index), float(thickness)) for index, thickness in layers)
    ]


def exactly(amplified):
    """Returns a bound on the effect of rounding on the share of a line."""
    return min(ROUNDING * amplified, EXACT)


def seen(name, material, degrees, expected, guards, mistake, words, *, behind=False, lines=LINES, body=None):
    """Returns a row for a flat surface with a lamp of spectral lines in front or behind, and the share of each line.

    With the index of a `body` below, there are lamps on both sides."""
    powers, amplified = line_powers(lines)
    light = {"lines": [[nm, 1] for nm in lines]}
    surface = plane((0, 0, 0), (0, 1, 0))
    if behind:
        surface = {"quad": {"center": [0.0, 0.0, 0.0], "u": [90.0, 0.0, 0.0], "v": [0.0, 0.0, -90.0]}}
    materials, objects = {"surface": material, "glow": glow(light)}, [("surface", surface), ("glow", LAMPS["T" if behind else "R"])]
    if body:
        # Radiance scales with the square of the index.
        materials["below"] = glow({"lines": [[nm, body**2] for nm in lines]})
        objects.append(("below", LAMPS["T"]))
    scene = view(materials, objects, eye=looking_down(degrees), up=(0, 0, 1), model="auto", space=XYZ)
    words = f"{words}, at {degrees} degrees, in the light of lines at {lines} nm; in CIE XYZ."
    read = lambda image: readers.colors(image) @ powers.T  # noqa: E731
    return Row(
        GROUP, name, "matrices of Abeles", scene, read, expected, guards, mistake, words, rounding=exactly(amplified)
    )


def polarized(name, material, degrees, both, guards, mistake, words, *, way="R", index=1.0, surface=None):
    """Returns a row for a surface in light at 45 degrees to s and p, S0 to S3 of each line.

    `both` and `mistake` are amplitudes of s and p. The camera is on the lamp's side, behind the surface, or behind it
    in a body with an index. Otherwise, `index` is that of a glass around both."""
    powers, amplified = line_powers(LINES)
    around = index if way != "body" else 1.0
    below = float(np.degrees(np.arcsin(np.sin(np.radians(degrees)) / index)))
    camera = {"R": (degrees, 1), "T": (degrees, -1), "body": (below, -1)}[way]
    stage = Stage.of(camera, (degrees, 1), glow({"lines": [[nm, 1] for nm in LINES]}))
    factor = index**2 if way == "body" else 1.0

    def stokes(both):
        sent = [stage.light.sent(unit(stage.eye), S, pair) for pair in both.T]
        return factor * np.array([light.stokes(RIGHT) for light in sent]).T.ravel()

    def read(image):
        parts = [image.rgb, *(np.stack([readers.need(image, f"S{i}.{c}") for c in "RGB"], -1) for i in (1, 2, 3))]
        return np.concatenate([part.reshape(-1, 3) @ powers.T for part in parts], -1)

    objects = [*stage.objects, ("surface", surface or plane((0, 0, 0), UP))]
    materials = stage.materials | {"surface": material}
    if around != 1.0:
        materials["glass"] = glass(around)
        # Off center, so that no light that its wall reflects comes back.
        objects.append(("glass", sphere((0, 40, 0), 100)))
    expected, wrong = np.round(stokes(both), 12), np.round(stokes(mistake), 12)
    scene = view(materials, objects, eye=stage.eye, model="auto", space=XYZ, polarization="on")
    scene["film"] |= STOKES
    bound = exactly(amplified)
    return Row(
        GROUP,
        name,
        "<E E*> by the matrices of Abeles",
        scene,
        read,
        expected,
        guards,
        np.where(np.abs(wrong - expected) > 8 * bound, wrong, expected),
        f"{words}, in light polarized halfway between s and p, at {degrees} degrees, of lines at {LINES} nm; S0 to S3 "
        f"in CIE XYZ.",
        rounding=bound,
    )


def coated(name, layers, body, index, angles, words):
    """Yields rows for a coated body; `index` is the body's at the lines."""
    nm = np.array(LINES)
    ((kind, keys),) = body.items()
    for degrees in angles:
        expected, bare = (shares(stack, index, degrees, nm)[0] for stack in (layers, []))
        material = {kind: keys | {"coating": coating(layers)}}
        yield seen(f"{name} at {degrees} degrees", material, degrees, expected, UNCOATED, bare, words)
        r, _ = np.moveaxis(amplitudes(layers, index, degrees, nm), 1, 0)
        verdet = r * [[1], [-1]]
        yield polarized(
            f"{name} at {degrees} degrees, S0 to S3", material, degrees, r, "r_p of the sign of r_s", verdet, words
        )


MAGNESIUM_FLUORIDE = [(1.38, QUARTER / 1.38)]
ABSORBING = [(2.3 - 0.1j, 100)]


def quarter_waves(pairs):
    high, low = (2.35, QUARTER / 2.35), (1.38, QUARTER / 1.38)
    return [high, low] * pairs + [high]


def stacks(quick):
    crown = formulas.index("N-BK7", np.array(LINES))
    yield from coated(
        "a quarter wave of magnesium fluoride on N-BK7",
        MAGNESIUM_FLUORIDE,
        glass("N-BK7"),
        crown,
        (0, 30, 45, 60, 75),
        "N-BK7 under a layer of index 1.38, a quarter wave thick at 550 nm",
    )
    for pairs in (1, 3, 5, 9):
        yield from coated(
            f"a mirror of {2 * pairs + 1} layers",
            quarter_waves(pairs),
            glass(1.52),
            1.52,
            (0, 45),
            f"Glass of index 1.52 under {2 * pairs + 1} layers of 2.35 and 1.38 in turn, quarter waves at 550 nm",
        )
    yield from coated(
        "a layer that absorbs",
        ABSORBING,
        glass(1.5),
        1.5,
        (0, 30, 60),
        "Glass of index 1.5 under 100 nm of 2.3 - 0.1i",
    )
    metal = 1.015 - 6.627j
    yield from coated(
        "glass on aluminum",
        [(1.46, 100)],
        {"conductor": {"n": metal.real, "k": -metal.imag}},
        metal,
        (0, 60, 75),
        "A metal of 1.015 - 6.627i under 100 nm of index 1.46",
    )


def lens(quick):
    """Yields crown glass, bare and with a coating for one wavelength, at other wavelengths."""
    for nm in (400.0, 450.0, 500.0, 550.0, 600.0, 650.0, 700.0):
        index = formulas.index("N-BK7", nm)
        bare, dark = (shares(stack, index, 0, np.array([nm]))[0] for stack in ([], MAGNESIUM_FLUORIDE))
        material = glass("N-BK7", coating=coating(MAGNESIUM_FLUORIDE))
        words = "N-BK7 under a layer of index 1.38, a quarter wave thick at 550 nm"
        yield seen(f"a darkened lens at {nm:g} nm", material, 0, dark, UNCOATED, bare, words, lines=(nm,))
        at_d = formulas.fresnel(formulas.index("N-BK7", formulas.D_LINE), 0)
        guards = "the index of the d line at every wavelength"
        yield seen(f"a bare lens at {nm:g} nm", glass("N-BK7"), 0, bare, guards, at_d, "N-BK7", lines=(nm,))


def both_ways(quick):
    """Yields transmission through layers, and the balance of clear layers, which lose nothing."""
    nm = np.array(LINES)
    for degrees in (0, 30, 60):
        crossing, bare = (amplitudes(stack, 1.5, degrees, nm)[:, 1] for stack in (ABSORBING, []))
        yield polarized(
            f"through a layer that absorbs at {degrees} degrees, S0 to S3",
            glass(1.5, coating=coating(ABSORBING)),
            degrees,
            crossing,
            UNCOATED,
            bare,
            "Glass of index 1.5 under 100 nm of 2.3 - 0.1i, seen from within",
            way="body",
            index=1.5,
        )
    for count, layers in ((1, MAGNESIUM_FLUORIDE), (19, quarter_waves(9))):
        for degrees in (0, 45, 75):
            reflected, crossing = shares(layers, 1.52, degrees, nm)
            yield seen(
                f"all light at {count} clear {'layers' if count > 1 else 'layer'} at {degrees} degrees",
                glass(1.52, coating=coating(layers)),
                degrees,
                reflected + crossing,
                "light that crosses as if there were no layers",
                reflected + shares([], 1.52, degrees, nm)[1],
                f"Glass of index 1.52 under {count} clear layers, white on both sides",
                body=1.52,
            )._replace(formula="R + T = 1")


def gaps(quick):
    """Yields no film, and air in glass beyond the critical angle (frustrated total reflection: Newton 1704)."""
    nm = np.array(LINES)
    for degrees in (0, 45):
        for which, behind, expected in (("R", False, 0.0), ("T", True, 1.0)):
            material = {"thin": {"index": 1.33, "thickness_nm": 0}}
            wrong = formulas.slab(1.33, degrees)[int(behind)]
            yield seen(
                f"{which} of no soap at {degrees} degrees",
                material,
                degrees,
                np.full(3, expected),
                PANE,
                wrong,
                "A soap film of index 1.33 and no thickness",
                behind=behind,
            )._replace(formula=f"{expected:g}", rounding=EXACT)
    for gap in (50, 100, 200, 500):
        for number, way in enumerate("RT"):
            both = amplitudes([(1.0, gap)], 1.5, 60, nm, around=1.5)[:, number]
            total = amplitudes([], 1.0, 60, nm, around=1.5)[:, number]
            yield polarized(
                f"{way} of {gap} nm of air in glass at 60 degrees, S0 to S3",
                {"thin": {"index": 1, "thickness_nm": gap}},
                60,
                both,
                "total reflection without what lies beyond",
                total,
                f"A gap of {gap} nm of air in glass of index 1.5",
                way=way,
                index=1.5,
                surface=disc((0, 0, 0), UP, 0.9),
            )


def fringe(quick):
    """Returns a row: the mean over thicknesses spread evenly over a fringe is that of a pane (Born and Wolf 7.6.1)."""
    nm, index, count = 550.0, 1.33, 16
    objects, materials = [], {"glow": glow({"lines": [[nm, 1]]})}
    for number in range(count):
        materials[f"film-{number}"] = {
            "thin": {"index": index, "thickness_nm": 300 + nm / (2 * index) * number / count}
        }
        objects.append((f"film-{number}", quad((number - (count - 1) / 2, 0, 0), (0.5, 0, 0), (0, 0.5, 0))))
    objects.append(("glow", plane((0, 0, 30), (0, 0, -1))))
    scene = view(materials, objects, eye=(0, 0, 5), height=1.0, size=(count, 1), model="auto", space=XYZ)
    powers, amplified = line_powers((nm,))
    r = formulas.fresnel(index, 0)
    return [
        Row(
            GROUP,
            "the mean of soap over one fringe",
            "2 r / (1 + r)",
            scene,
            lambda image: (readers.colors(image) @ powers.T).mean(axis=0)[None],
            2 * r / (1 + r),
            "two waves that interfere, without those that go to and fro",
            2 * r,
            f"{count} soap films of index {index} side by side, whose thicknesses are evenly spread over {nm:g} nm / 2 "
            f"n from 300 nm on, at normal incidence in the light of a line at {nm:g} nm.",
            rounding=exactly(amplified),
        )
    ]


def soap(quick):
    """Yields free-standing films, in reflection and in transmission."""
    nm = np.array(LINES)
    for thickness in (100, 200, 400, 1000):
        material = {"thin": {"index": 1.33, "thickness_nm": thickness}}
        words = f"A soap film of index 1.33, {thickness} nm thick"
        for degrees in (0, 45):
            both = shares([(1.33, thickness)], 1.0, degrees, nm)
            pane = formulas.slab(1.33, degrees)
            for which, behind in (("R", False), ("T", True)):
                name = f"{which} of {thickness} nm of soap at {degrees} degrees"
                told = [values[int(behind)] for values in (both, pane)]
                yield seen(name, material, degrees, told[0], PANE, told[1], words, behind=behind)


def lab(xyz, white):
    return colors.colour.XYZ_to_Lab(xyz, colors.colour.XYZ_to_xy(white))


def under_d65(layers, body, degrees):
    """Returns CIE XYZ of layers on a body, of white, and of the gray with the mean reflectance at every wavelength."""
    light = colors.illuminant("D65")
    reflected = shares(layers, body(light.nm), degrees, light.nm)[0]
    return [(light.power * share) @ colors.OBSERVER.values for share in (reflected, 1, reflected.mean())]


def daylight(name, material, layers, body, degrees, words):
    """Returns a row for a film's color under D65, in the lanes that the plan chooses: at most 0.5 dE2000 off."""
    expected, white, gray = under_d65(layers, body, degrees)
    scene = view(
        {"film": material, "glow": glow({"illuminant": "D65"})},
        [("film", plane((0, 0, 0), (0, 1, 0))), ("glow", LAMPS["R"])],
        eye=looking_down(degrees),
        up=(0, 0, 1),
        model="auto",
        space=XYZ,
    )

    def away(xyz):
        return colors.colour.delta_E(lab(xyz, white), lab(expected, white), method="CIE 2000")

    return Row(
        GROUP,
        f"{name} at {degrees} degrees in daylight",
        "dE2000 from the sum of light x reflectance x observer: 0",
        scene,
        lambda image: away(readers.colors(image)).reshape(-1, 1),
        0.0,
        "the gray of its mean reflectance",
        float(away(gray)),
        f"{words}, under D65 at {degrees} degrees, in the lanes that the plan chooses; in CIE XYZ.",
        rounding=0.5 / 4,
    )


def air(nm):
    return np.ones_like(nm)


def in_daylight(quick):
    for thickness in (100, 150, 200, 250, 300, 400, 500, 600, 1000):
        for degrees in (0, 45):
            yield daylight(
                f"{thickness} nm of soap",
                {"thin": {"index": 1.33, "thickness_nm": thickness}},
                [(1.33, thickness)],
                air,
                degrees,
                f"A soap film of index 1.33, {thickness} nm thick",
            )
    for thickness in (0, 20, 30, 40, 50, 60, 80, 100, 120, 140, 160):
        layers = [(2.4, thickness)] if thickness else []
        yield daylight(
            f"titanium under {thickness} nm of oxide",
            {"conductor": {"metal": "Ti", "coating": coating([(2.4, thickness)])}},
            layers,
            formulas.titanium,
            0,
            f"Titanium (Johnson and Christy 1974) under {thickness} nm of a clear oxide of index 2.4",
        )


def rows(quick):
    for part in (stacks, lens, both_ways, gaps, fringe, soap, in_daylight):
        yield from part(quick)
