"""Polarization at flat surfaces of glass: one of them, total reflection, piles of plates, a pane."""

from typing import NamedTuple

import numpy as np

from . import formulas
from .plates import LAMPS, looking_down, pile
from .polarized_row import AVERAGED, RIGHT, components, row, untraced
from .row import ROUNDING
from .scenes import disc, glass, glow, plane
from .stokes import Light, unit

STOKES = {"stokes": True}
VERDET = "r_p with the sign that other textbooks give it"
UP = np.array([0.0, 0, 1])
S = np.array([0.0, 1, 0])


def along(degrees, side):
    """Returns a direction in the plane y = 0, at an angle from the normal on one side of z = 0."""
    angle = np.radians(degrees)
    return np.array([np.sin(angle), 0, side * np.cos(angle)])


class Stage(NamedTuple):
    """A camera and a lamp above or below z = 0, and between them a sheet that polarizes halfway between s and p."""

    eye: np.ndarray
    onward: np.ndarray  # toward the lamp
    light: Light  # behind the sheet, before it meets the surface
    materials: dict
    objects: list

    @classmethod
    def of(cls, seen, lit, lamp=None):
        """Returns a stage; `seen` and `lit` have the angle and the side of camera and lamp."""
        onward = along(*lit) * [-1, 1, 1]
        axis = unit(S + np.cross(S, onward))
        light = Light.unpolarized(-onward).through_polarizer(axis, -onward)
        materials = {"sheet": {"polarizer": {"axis": axis.tolist()}}, "glow": lamp or glow()}
        objects = [(name, disc(far * onward, -onward, 0.3)) for name, far in (("sheet", 2), ("glow", 3))]
        return cls(along(*seen), onward, light, materials, objects)


def surface(name, formula, index, seen, lit, guards, wrong, words):
    """Returns a row for the surface z = 0 of glass below it; `wrong` maps S0 to S3 to the values of the mistake."""
    stage = Stage.of(seen, lit)
    around, beyond = (1, index) if lit[1] > 0 else (index, 1)
    to, returns = complex(beyond / around), seen[1] == lit[1]
    light = stage.light.reflected(UP, to) if returns else stage.light.crossing(UP, to)
    # Radiance scales with the square of the index.
    expected = light.stokes(RIGHT) * (1.0 if returns else to.real**2)
    return row(
        name,
        formula,
        stage.materials | {"glass": glass(index)},
        [*stage.objects, ("glass", plane((0, 0, 0), UP))],
        expected,
        guards,
        wrong(expected),
        words,
        lights=[],
        film=STOKES,
        eye=stage.eye,
    )


def amplitudes(quick):
    """Yields the formulas of Fresnel 1823, from both sides: reflected and refracted."""
    index = 1.5
    brewster = float(np.degrees(np.arctan(index)))
    averaged = lambda stokes: stokes * [1, 0, 0, 0]  # noqa: E731
    for degrees in (0.0, 30.0, 45.0, brewster, 60.0, 75.0):
        below = float(np.degrees(np.arcsin(np.sin(np.radians(degrees)) / index)))
        air, inside = (degrees, 1), (below, -1)
        for which, seen, lit in (
            ("reflected by glass", air, air),
            ("reflected inside glass", inside, inside),
            ("into air", air, inside),
            ("into glass", inside, air),
        ):
            reflected = seen == lit
            verdet = reflected and degrees != brewster
            yield surface(
                f"light at 45 degrees {which} at {degrees:.6g} degrees",
                "<E E*> by r_s and r_p" if reflected else "<E E*> by t_s and t_p, times the square of the index",
                index,
                seen,
                lit,
                VERDET if verdet else AVERAGED,
                (lambda stokes: stokes * [1, 1, -1, -1]) if verdet else averaged,
                f"Light polarized halfway between s and p, {which} at a flat surface of index {index}, at "
                f"{degrees:.6g} degrees in air; S0 to S3.",
            )


def total_reflection(quick):
    """Yields the phase between s and p in total reflection (Born and Wolf 1.5.4), including its maximum."""
    largest = float(np.degrees(np.arcsin(np.sqrt(2 / (1 + 1.5**2)))))
    for index, degrees in ((1.5, 45.0), (1.5, largest), (1.5, 60.0), (1.5, 75.0), (1.51, 54.6)):
        yield surface(
            f"light at 45 degrees totally reflected at {degrees:.6g} degrees in {index}",
            "tan(delta / 2) = cos sqrt(sin^2 - 1 / n^2) / sin^2",
            index,
            (degrees, -1),
            (degrees, -1),
            "a phase of the other sign",
            lambda stokes: stokes * [1, 1, 1, -1],
            f"Light polarized halfway between s and p, reflected inside index {index} at {degrees:.6g} degrees; S0 to "
            f"S3.",
        )


def piles(quick):
    """Yields S0 and S1 of light through plates in a row (Stokes 1862)."""
    brewster = [float(np.degrees(np.arctan(index))) for index in (1.5, 1.5168)]
    for index, degrees, counts in (
        (1.5, 45.0, (1, 4)),
        (1.5, brewster[0], (1, 4, 10)),
        (1.5, 60.0, (1,)),
        (1.5168, 45.0, (1, 4, 10)),
        (1.5168, brewster[1], (1, 4, 10)),
        (1.5168, 75.0, (1,)),
    ):
        both = formulas.both_polarizations(index, degrees)
        for plates in counts:
            s, p = ((1 - r) / (1 + (2 * plates - 1) * r) for r in both)
            mean = sum(both) / 2
            averaged = (1 - mean) / (1 + (2 * plates - 1) * mean)
            # With more plates the plan follows only some paths of light, chosen at random.
            chance = {"size": 32, "samples": 8 if quick else 64} if plates > 1 else {}
            found = row(
                f"S0 and S1 through {plates} {'plates' if plates > 1 else 'plate'} of {index} at {degrees:.6g} degrees",
                "(1 - r) / (1 + (2 m - 1) r), of s and of p",
                {"glass": glass(index), "glow": glow()},
                [*pile(plates), ("glow", LAMPS["T"])],
                [(s + p) / 2, (p - s) / 2, 0, 0],
                AVERAGED,
                [averaged, 0, 0, 0],
                f"{plates} plates of index {index}, 0.01 thick and 0.01 apart, at {degrees:.6g} degrees before a plane "
                f"of radiance 1; S0, and S1 within the plane of incidence.",
                lights=[],
                film=STOKES,
                eye=looking_down(degrees),
                up=UP,
                **chance,
            )
            two = lambda image: components(image)[:, :2]  # noqa: E731
            found = found._replace(
                read=two,
                expected=found.expected[:2],
                mistake=found.mistake[:2],
                seeds=2 if chance else 1,
                rounding=ROUNDING,
            )
            yield found
            yield untraced(found, averaged)


def pane(quick):
    """Yields a pane that absorbs, with all reflections between its faces, one after the other."""
    index, left, degrees = 1.52, 0.9, 60.0
    for which, side in (("reflected by", 1), ("through", -1)):
        stage = Stage.of((degrees, 1), (degrees, side))
        coming = stage.light
        into, out = complex(index), complex(1 / index)
        inside = coming.crossing(UP, into)
        # One way through the pane scales <E E*> by the share `left`. Orders do not interfere.
        way = lambda light: Light(light.direction, left * light.field)  # noqa: E731
        field = coming.reflected(UP, into).field if which != "through" else 0
        for order in range(60):
            inside = way(inside)
            if (order % 2 == 0) == (which == "through"):
                field = field + inside.crossing(UP, out).field
            inside = inside.reflected(UP, out)
        expected = Light(stage.eye, field).stokes(RIGHT)
        s, p = formulas.both_polarizations(index, degrees)
        mean = (s + p) / 2
        through = (1 - mean) ** 2 * left / (1 - (mean * left) ** 2)
        averaged = through if which == "through" else mean + mean * left * through
        yield row(
            f"light at 45 degrees {which} a pane at 60 degrees",
            "the sum of <E E*> over all orders",
            stage.materials | {"pane": {"thin": {"index": index, "transmittance": left}}},
            [*stage.objects, ("pane", disc((0, 0, 0), UP, 0.5))],
            expected,
            AVERAGED,
            [averaged / 2, 0, 0, 0],
            f"Light polarized halfway between s and p, {which} a pane without thickness of index {index}, of which one "
            f"way leaves {left}, at {degrees} degrees; S0 to S3.",
            lights=[],
            film=STOKES,
            eye=stage.eye,
        )


def rows(quick):
    for part in (amplitudes, total_reflection, piles, pane):
        yield from part(quick)
