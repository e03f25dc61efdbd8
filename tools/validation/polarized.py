"""Polarization: sheets, wave plates, mirrors, prisms and drops, along one ray, against the electric field in space."""

import numpy as np

from . import formulas, surfaces
from .polarized_row import AVERAGED, DOWN, NOT_TURNED, RIGHT, components, in_plane, polarizer, row, untraced
from .plates import looking_down
from .scenes import disc, extrude, glass, glow, plane, quad, sphere, sun
from .stokes import Light, unit

GOLD, SILVER, ALUMINUM = 0.43 - 2.455j, 0.06 - 3.586j, 1.015 - 6.627j


def sheets(name, formula, stack, guards, mistake, words, degrees=0.0, **more):
    """Returns a row for sheets before a uniform sky, from the camera on, seen at an angle in the plane of x = y."""
    aslant = np.radians(degrees)
    eye = np.array([np.sin(aslant) * 0.5**0.5, np.sin(aslant) * 0.5**0.5, np.cos(aslant)])
    materials, objects, light = {}, [], Light.unpolarized(eye)
    for number, sheet in enumerate(stack):
        materials[f"sheet-{number}"] = sheet
        objects.append((f"sheet-{number}", quad((0, 0, -number), (40, 0, 0), (0, 40, 0))))
    for sheet in reversed(stack):
        ((kind, keys),) = sheet.items()
        if kind == "polarizer":
            light = light.through_polarizer(keys["axis"], (0, 0, 1), keys.get("extinction", 0))
        else:
            light = light.through_retarder(keys["axis"], keys["retardance"])
    return row(name, formula, materials, objects, light.stokes(RIGHT), guards, mistake, words, eye=10 * eye, **more)


def retarder(degrees, retardance):
    return {"retarder": {"axis": in_plane(degrees), "retardance": float(retardance)}}


def malus(quick):
    """Yields the law of Malus 1809, also for sheets that leak."""
    for degrees in (0, 15, 30, 45, 60, 75, 90):
        for leak in (0, 1e-4):
            guards, mistake = (AVERAGED, ((1 + leak) / 2) ** 2) if degrees != 45 else ("sheets that are crossed", 0)
            yield sheets(
                f"two polarizers at {degrees} degrees" + (", which leak" if leak else ""),
                "(1 + k)^2 / 4 + (1 - k)^2 cos(2 angle) / 4",
                [polarizer(degrees, extinction=leak), polarizer(0, extinction=leak)],
                guards,
                mistake,
                f"Two sheets whose axes are {degrees} degrees apart before an even sky of radiance 1; of crossed light "
                f"they let {leak} through.",
            )
    yield sheets(
        "three polarizers at 0, 45 and 90 degrees",
        "1 / 8",
        [polarizer(degrees) for degrees in (0, 45, 90)],
        "the sheet between them left out",
        0,
        "Three sheets whose axes are at 0, 45 and 90 degrees before an even sky of radiance 1.",
    )
    for degrees in (15, 30, 45, 60):
        yield sheets(
            f"crossed polarizers seen at {degrees} degrees",
            "what each absorbs lies across its axis and within it",
            [polarizer(0), polarizer(90)],
            "axes that stay crossed",
            0,
            f"Two crossed sheets before an even sky, seen {degrees} degrees from their normal, halfway between both "
            f"axes.",
            degrees=degrees,
        )


def plates(quick):
    """Yields wave plates, behind a polarizer and between two."""
    with_stokes = {"film": {"stokes": True}}
    for axis, retardance, name in (
        (45, 90, "quarter"),
        (135, 90, "quarter"),
        (22.5, 180, "half"),
        (45, 180, "half"),
        (45, 60, "sixth"),
    ):
        yield sheets(
            f"polarized light through a {name} wave at {axis} degrees",
            "its axis is ahead by the retardance",
            [retarder(axis, retardance), polarizer(0)],
            "a retardance of the other sign, or none",
            [0.5, 0.5, 0, 0],
            f"A {name}-wave plate, its fast axis at {axis} degrees, before a polarizer at 0 and an even sky.",
            **with_stokes,
        )
    for retardance in (30, 60, 90, 120, 180):
        yield sheets(
            f"a retardance of {retardance} degrees between crossed polarizers",
            "sin^2(retardance / 2) / 2",
            [polarizer(0), retarder(45, retardance), polarizer(90)],
            "light that the plate leaves as it is",
            0,
            f"A plate of {retardance} degrees at 45 degrees between crossed sheets before an even sky.",
        )


def mirrored(name, formula, normals, index, guards, words, *, mistake=None, **more):
    """Returns a row for mirrors 1 apart along the camera's ray, which comes from above, and a lamp at its end."""
    direction, at, objects = DOWN, np.zeros(3), []
    for normal in map(unit, normals):
        objects.append(("mirror", disc(at, normal, 0.3)))
        direction = direction - 2 * (direction @ normal) * normal
        at = at + direction
    objects.append(("glow", disc(at + direction, -direction, 0.3)))
    light = averaged = Light.unpolarized(-direction)
    for normal in reversed(normals):
        light, averaged = light.reflected(normal, index), averaged.reflected(normal, index).depolarized()
    mirror = {"conductor": {"n": index.real, "k": -index.imag}} if index.imag else glass(index.real)
    wrong = averaged.stokes(RIGHT) if mistake is None else mistake
    settings = {"eye": (0, 0, 1), "max_bounces": len(normals), "lights": []} | more
    materials = {"mirror": mirror, "glow": glow()}
    return row(name, formula, materials, objects, light.stokes(RIGHT), guards, wrong, words, **settings)


def turning(degrees, *turns):
    """Returns normals of mirrors that a ray from above meets at an angle, each plane turned by one of `turns`."""
    direction, s, normals = DOWN, np.array([0.0, 1, 0]), []
    angle = np.radians(degrees)
    for turn in (0, *turns):
        s = rotation(direction, turn) @ s
        normals.append(np.sin(angle) * np.cross(direction, s) - np.cos(angle) * direction)
        direction = direction + 2 * np.cos(angle) * normals[-1]
    return normals


def mirrors(quick):
    with_stokes = {"film": {"stokes": True}}
    near, next_to_it = (0.965925826, 0, 0.258819045), (0.462096828, 0.683012702, 0.565650219)
    turned = (np.cos(np.pi / 6), np.sin(np.pi / 6), 1)
    up = np.array([0, 1, 1]) / 2**0.5 - np.array([1, 0, 0])
    third = (-0.159272307, -0.985466895, 0.059053637)
    for name, index in (("gold", GOLD), ("silver", SILVER), ("aluminum", ALUMINUM)):
        for which, normals in (
            ("a mirror at 45 degrees", [(1, 0, 1)]),
            ("a mirror at 45 degrees, its plane turned by 30", [turned]),
            ("a mirror at 75 degrees", turning(75)),
            ("two mirrors at 45 degrees", [(1, 0, 1), up]),
            ("two mirrors at 75 degrees", [near, next_to_it]),
            ("two mirrors at 45 degrees in a plane", turning(45, 0)),
            ("two mirrors at 75 degrees in a plane", turning(75, 0)),
            ("two crossed mirrors at 45 degrees", turning(45, 90)),
            ("two crossed mirrors at 75 degrees", turning(75, 90)),
            ("three mirrors at 75 degrees", [near, next_to_it, third]),
            ("three mirrors at 75 degrees, each turned by 45", turning(75, 45, 45)),
        ):
            yield mirrored(
                f"{which} of {name}",
                "<E E*> by r_s and r_p of n - ik",
                normals,
                index,
                AVERAGED,
                f"{which.capitalize()} of {name} (n - ik = {index.real} - {-index.imag}i), 1 apart, before a lamp of "
                f"radiance 1; S0 to S3.",
                **with_stokes,
            )
    for degrees in (45.0, float(np.degrees(np.arctan(1.5)))):
        s, p = formulas.both_polarizations(1.5, degrees)
        for turn in (0, 30, 45, 60, 90):
            yield mirrored(
                f"two surfaces of glass at {degrees:.6g} degrees, planes {turn} degrees apart",
                "((R_s^2 + R_p^2) cos^2 + 2 R_s R_p sin^2) / 2",
                turning(degrees, turn),
                1.5 + 0j,
                AVERAGED if turn != 45 else NOT_TURNED,
                f"Light that two surfaces of index 1.5 reflect at {degrees:.6g} degrees, the planes of incidence "
                f"{turn} degrees apart.",
                mistake=None if turn != 45 else (s**2 + p**2) / 2,
            )


def glare(quick):
    """Yields what a filter on the lens leaves of light reflected by glass."""
    for degrees in (45.0, float(np.degrees(np.arctan(1.5))), 65.0):
        angle = np.radians(degrees)
        normal = (np.sin(angle), 0, np.cos(angle))
        both = formulas.both_polarizations(1.5, degrees)
        for kept, axis, share in zip("sp", (90, 0), both, strict=True):
            row = mirrored(
                f"{kept} of glass at {degrees:.6g} degrees through a filter",
                f"R_{kept} / 2",
                [normal],
                1.5 + 0j,
                "half of all that is reflected",
                f"A surface of index 1.5 before a lamp, seen at {degrees:.6g} degrees through a filter that keeps "
                f"{kept}.",
                mistake=sum(both) / 4,
                camera={"polarizer": {"axis": axis}},
            )
            yield row._replace(expected=share / 2)
        yield mirrored(
            f"glass at {degrees:.6g} degrees without a filter",
            "(R_s + R_p) / 2, (R_s - R_p) / 2",
            [normal],
            1.5 + 0j,
            AVERAGED,
            f"A surface of index 1.5 before a lamp, seen at {degrees:.6g} degrees; S0 to S3.",
            film={"stokes": True},
        )


def refracted(direction, normal, index):
    """Returns the refracted direction into a medium of `index` relative to this one."""
    normal = -normal if normal @ direction > 0 else normal
    cos = -normal @ direction
    return direction / index + (cos / index - np.sqrt(1 - (1 - cos**2) / index**2)) * normal


def through(name, formula, bodies, index, way, directions, words, sheet=None, **more):
    """Returns a row for a ray from the camera through glass to a lamp.

    `way` has the place and the normal of each surface and whether light crosses it; `directions` has the ray before,
    between and behind them. A sheet in front of the lamp, across z, has an axis at an angle."""
    light = Light.unpolarized(-directions[-1])
    averaged = light = light if sheet is None else light.through_polarizer(in_plane(sheet), DOWN)
    inside = False
    for _, normal, crosses in reversed(way):
        to = (1 / index if inside else index) + 0j
        step = Light.crossing if crosses else Light.reflected
        light, averaged = step(light, normal, to), step(averaged, normal, to).depolarized()
        inside = inside != crosses
    (first, *_), (last, *_) = way[0], way[-1]
    materials = {"glass": glass(index), "glow": glow()}
    objects = [*(("glass", body) for body in bodies)]
    objects.append(("glow", disc(last + 3 * directions[-1], -directions[-1], 0.1)))
    if sheet is not None:
        materials["sheet"] = polarizer(sheet)
        objects.append(("sheet", quad(last + directions[-1], (1, 0, 0), (0, 1, 0))))
    return row(
        name,
        formula,
        materials,
        objects,
        light.stokes(RIGHT),
        AVERAGED,
        averaged.stokes(RIGHT),
        words,
        lights=[],
        eye=first - 5 * directions[0],
        target=first,
        max_bounces=len(way),
        **more,
    )


# A prism of 60 degrees that light crosses along x: its triangle, and the place and normal of both faces.
TRIANGLE = [(-1, -(3**-0.5)), (1, -(3**-0.5)), (0, 2 * 3**-0.5)]
FACES = [(np.array([side * 2 / 3, 0, 0]), np.array([side * 0.75**0.5, 0, 0.5])) for side in (-1, 1)]


def rotation(axis, degrees):
    """Returns the rotation matrix (Rodrigues 1840)."""
    x, y, z = unit(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = np.radians(degrees)
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def prisms(quick):
    """Yields prisms at minimum deviation, one and two in a row."""
    for glass_name, index, turns in (
        ("N-BK7", 1.5168, [None]),
        ("N-SF11", 1.78472, [None, 0, 90]),
        ("water", 1.3334, [None]),
    ):
        along = np.array([1.0, 0, 0])
        entering = -refracted(-along, FACES[0][1], 1 / index)
        leaving = refracted(along, FACES[1][1], 1 / index)
        bend = np.degrees(np.arccos(entering @ leaving))
        bodies = [extrude(TRIANGLE, 0, 0.4)]
        for turn in turns:
            stack, way = list(bodies), [(place, normal, True) for place, normal in FACES]
            directions = [entering, along, leaving]
            if turn is not None:
                # Rotated from the first prism's entering ray to its leaving ray, and then about that.
                turned = rotation(leaving, turn) @ rotation(np.cross(entering, leaving), bend)
                moved = FACES[1][0] + 3 * leaving - turned @ FACES[0][0]
                body = extrude(TRIANGLE, 0, 0.4)
                body["mesh"]["points"] = (np.array(body["mesh"]["points"]) @ turned.T + moved).tolist()
                stack.append(body)
                way += [(turned @ place + moved, turned @ normal, True) for place, normal in FACES]
                directions += [turned @ along, turned @ leaving]
            which = "a prism" if turn is None else "two prisms in a plane" if turn == 0 else "two crossed prisms"
            found = through(
                f"{which} of {glass_name} at least deviation",
                "the mean of T^2 over s and p, for each face" if turn != 90 else "T_s^2 T_p^2",
                stack,
                index,
                way,
                directions,
                f"A ray through {which} of 60 degrees and index {index} at least deviation, to a lamp of radiance 1; "
                f"S0 to S3.",
                film={"stokes": True},
            )
            yield found
            yield untraced(found, found.mistake[0])


def rainbows(quick):
    """Yields a drop in the directions of its rainbows (Descartes 1637)."""
    index, reach = 1.3334, {1: 3, 2: 8}
    for order, name in ((1, "primary"), (2, "secondary")):
        cos = np.sqrt((index**2 - 1) / reach[order])
        place, direction = np.array([np.sqrt(1 - cos**2), 0, cos]), DOWN
        way, directions = [(place, place, True)], [direction, refracted(direction, place, index)]
        for number in range(order + 1):
            direction = directions[-1]
            place = unit(place - 2 * (place @ direction) * direction)
            crosses = number == order
            way.append((place, place, crosses))
            mirrored = direction - 2 * (direction @ place) * place
            directions.append(refracted(direction, place, 1 / index) if crosses else mirrored)
        found = through(
            f"a drop at its {name} rainbow",
            f"the mean of T^2 R^{order} over s and p",
            [sphere()],
            index,
            way,
            directions,
            f"A ray of least deviation through a ball of index {index}, reflected {order} times inside, to a lamp; "
            f"S0 to S3.",
            film={"stokes": True},
        )
        yield found
        yield untraced(found, found.mistake[0])


def rhombs(quick):
    """Yields Fresnel's rhomb (1823): light polarized at 45 degrees becomes circular after two total reflections."""
    index = 1.51
    for degrees in (48.6243, 54.6, 54.623):
        angle = np.radians(degrees)
        normal = np.array([np.sin(angle), 0, -np.cos(angle)])
        across = DOWN - 2 * (DOWN @ normal) * normal
        second = across / np.cos(angle)
        side = lambda place, z: (place[0] + (z - place[2]) / np.tan(angle), z)  # noqa: E731
        top, bottom = 0.5, second[2] - 0.5
        first = 0 * second
        corners = [side(*corner) for corner in ((first, top), (first, bottom), (second, bottom), (second, top))]
        way = [
            (np.array([0, 0, top]), -DOWN, True),
            (np.zeros(3), normal, False),
            (second, -normal, False),
            (np.array([second[0], 0, bottom]), DOWN, True),
        ]
        yield through(
            f"Fresnel's rhomb of {degrees} degrees",
            "tan(delta / 2) = cos sqrt(sin^2 - 1 / n^2) / sin^2, twice",
            [extrude(corners, 0, 0.4)],
            index,
            way,
            [DOWN, DOWN, across, DOWN, DOWN],
            f"Light polarized at 45 degrees, reflected twice at {degrees} degrees inside glass of index {index}; "
            f"S0 to S3.",
            sheet=45,
            film={"stokes": True},
        )


def skies(quick):
    """Yields still water under a clear sky (Rayleigh 1871), with a real sky's degree at a right angle to the sun."""
    water, degree = 1.3334, 0.7
    for degrees in (30, 45, float(np.round(np.degrees(np.arctan(water)), 4)), 70):
        angle = np.radians(degrees)
        normal = np.array([np.sin(angle), 0, np.cos(angle)])
        toward = DOWN - 2 * (DOWN @ normal) * normal
        s = np.array([0, 1.0, 0])
        for turn in (0, 30, 45, 90):
            axis = rotation(toward, turn) @ s
            sun = np.cross(axis, toward)
            even = Light.unpolarized(-toward)
            sky = {"radiance": 1, "polarization": {"sun": sun.tolist(), "degree": degree}}
            yield row(
                f"water at {degrees} degrees under a sky polarized {turn} degrees from s",
                "R + degree d cos(2 angle), d = (R_s - R_p) / 2",
                {"water": glass(water, transmittance=0)},
                [("water", disc((0, 0, 0), normal, 0.3))],
                even.polarized(axis, degree).reflected(normal, water + 0j).stokes(RIGHT),
                "a sky that is not polarized" if turn != 45 else "light that the water does not polarize",
                even.reflected(normal, water + 0j).stokes(RIGHT) if turn != 45 else [1, 0, 0, 0],
                f"A surface of index {water} at {degrees} degrees under a sky of radiance 1 and degree {degree}, whose "
                f"light there is polarized {turn} degrees from s; S0 to S3.",
                lights=[{"environment": sky}],
                film={"stokes": True},
                eye=(0, 0, 1),
                max_bounces=1,
            )


def varnish(quick):
    """Yields plastic: light that its matte base scatters below the coat is polarized on its way out."""
    for degrees in (30, 45, 60, 75, 85):
        s, p = (1 - share for share in formulas.both_polarizations(1.5, degrees))
        found = row(
            f"the base of plastic at {degrees} degrees",
            "(T_p - T_s) / (T_p + T_s)",
            {"plastic": {"plastic": {"reflectance": 0.5, "index": 1.5}}},
            [("plastic", plane((0, 0, 0), (0, 1, 0)))],
            (p - s) / (p + s),
            "a base that leaves light unpolarized",
            0,
            f"Plastic of index 1.5 in light along its normal, seen at {degrees} degrees: S1 over S0, along the image.",
            lights=[sun(0)],
            film={"stokes": True},
            eye=looking_down(degrees),
            up=(0, 0, 1),
        )
        one = lambda image: components(image)[:, 1:2] / components(image)[:, :1]  # noqa: E731
        yield found._replace(read=one, expected=found.expected[:1], mistake=found.mistake[:1])


def rows(quick):
    for part in (malus, plates, mirrors, glare, prisms, rainbows, rhombs, skies, varnish, surfaces.rows):
        yield from part(quick)
