"""Energy: light is neither created nor lost."""

import numpy as np

from . import formulas, plates, readers, rooms
from .row import Row
from .scenes import SKY, cube, diffuse, glass, plane, rgb, sphere, view

SPREAD = (1.1, 1.5, 2.5)
EYE = {"eye": (1.7, 1.3, 3.1)}
BODIES = {"sphere": (sphere(), 38), "cube": (cube(), 38)}


def furnace(
    name,
    material,
    body,
    expected,
    formula,
    mistake,
    guards,
    quick,
    *,
    samples,
    reader=readers.covered,
    more=None,
    every_pixel=False,
    seeds=2,
    lights=(SKY,),
    size=None,
    **settings,
):
    """Returns a row for a body under a sky of 1, seen as a whole; its radiance is known for any shape."""
    shape, fov = BODIES[body] if isinstance(body, str) else body
    materials = {"body": material} | (more or {})
    chance = {} if samples is None else {"samples": max(samples // 4, 16) if quick else samples}
    size = size or (16 if quick else 32)
    scene = view(materials, [("body", shape)], lights, **EYE, fov=fov, size=size, **chance, **settings)
    words = (
        f"A {body if isinstance(body, str) else 'body'} at the origin (radius 1, or edge 1.5) in an even sky of "
        f"radiance 1, "
        f"from (1.7, 1.3, 3.1) toward the origin, {fov} degrees; the mean of the pixels that it covers (channel A)."
    )
    return Row("energy", name, formula, scene, reader, expected, guards, mistake, words, seeds, every_pixel=every_pixel)


def lossless(quick):
    """Yields clear bodies, which are invisible under a uniform sky, whatever their index."""
    lost = "a refraction that forgets the factor 1/n^2 on the way out, or loses a hundredth of the light"
    for index in (1.1, 1.333, 1.5, 1.7847, 2.5, SPREAD, (1.3, 1.31, 1.8)):
        many = isinstance(index, tuple)
        material = glass(rgb(index) if many else index)
        called = "three indices " + "/".join(map(str, index)) if many else f"index {index}"
        for body in BODIES:
            yield furnace(
                f"clear {body}, {called}, in an even sky",
                material,
                body,
                1.0,
                "L = 1",
                0.99,
                lost,
                quick,
                samples=None,
                every_pixel=True,
                seeds=1,
            )
        if index in (1.5, 2.5, SPREAD):
            yield furnace(
                f"clear sphere, {called}, at random",
                material,
                "sphere",
                1.0,
                "L = 1",
                0.98,
                "roulette without compensation, or branches drawn with another probability than they are weighted by",
                quick,
                samples=512,
                every_pixel=True,
            )


def heroes(quick):
    """Yields dispersive glass whose wavelengths part: fixed and hero lanes share no path, and together see all."""
    for name, body in (("N-SF11", "sphere"), ("diamond", "sphere"), ("N-BK7", "cube")):
        yield furnace(
            f"clear {body} of {name}, drawn wavelengths",
            glass(name),
            body,
            1.0,
            "L = 1 in every channel",
            0.95,
            "wavelengths that go on alone without the weight of those that end",
            quick,
            samples=256 if quick else 1024,
            model="hero",
        )


def inside_glass(quick):
    """Yields the radiance inside a body, which is n^2 times that outside."""
    for index in (1.333, 1.5, 2.42):
        scene = view(
            {"glass": glass(index)}, [("glass", sphere())], [SKY], eye=(0.3, 0.2, 0.1), target=(1, 2, 3), fov=60, size=8
        )
        words = "A camera inside a clear ball of radius 1 in an even sky of 1, off its center; every pixel alike."
        yield Row(
            "energy",
            f"inside a clear ball of index {index}",
            "L = n^2",
            scene,
            readers.gray,
            index**2,
            "radiance that is not scaled by n^2 at a refraction",
            1.0,
            words,
            every_pixel=True,
        )


def matte(quick):
    for body in BODIES:
        reflectance = np.array([0.5, 0.2, 0.9])
        yield furnace(
            f"diffuse {body} in an even sky",
            diffuse(rgb(reflectance)),
            body,
            reflectance,
            "L = rho",
            reflectance * 1.01,
            "a lobe that is not normalized, 1 % too bright",
            quick,
            samples=64,
            every_pixel=True,
        )
    base = {"white": diffuse(1), "mirror": {"mirror": {"reflectance": 1}}}
    both = {"mix": {"materials": ["white", "mirror"], "amount": rgb((0.2, 0.5, 0.9))}}
    for body in BODIES:
        net = {"mask": {"material": "both", "opacity": 0.6}}
        yield furnace(
            f"mask over a mix of white and mirror, {body}",
            net,
            body,
            1.0,
            "L = 1",
            0.97,
            "holes or shares whose chances do not cancel, 3 % lost",
            quick,
            samples=512,
            reader=readers.touched,
            more=base | {"both": both},
        )


def plastics(quick):
    for body, roughness, index in (
        ("sphere", 0, 1.5),
        ("sphere", 0.4, SPREAD),
        ("cube", 0.1, 1.5),
        ("cube", 0.4, SPREAD),
    ):
        value = rgb(index) if isinstance(index, tuple) else index
        white = {"plastic": {"reflectance": 1, "index": value, "roughness": roughness}}
        yield furnace(
            f"white plastic {body}, roughness {roughness}, index {index}",
            white,
            body,
            1.0,
            "L = 1",
            0.97,
            "light between coat and base that is given up after one turn, 3 % at least",
            quick,
            samples=256,
        )
    index, reflectance = 1.5, 0.5
    kept, once = formulas.inner_diffuse_reflectance(index), ((index - 1) / (index + 1)) ** 2

    def seen(turns):
        return once + (1 - once) * reflectance * (1 - kept) * turns

    floor = [("paint", plane((0, 0, 0), (0, 1, 0)))]
    size, samples = (16, 256) if quick else (24, 512)
    scene = view(
        {"paint": {"plastic": {"reflectance": reflectance}}},
        floor,
        [SKY],
        eye=(0, 3, 0),
        up=(0, 0, 1),
        size=size,
        samples=samples,
    )
    yield Row(
        "energy",
        "plastic of reflectance 0.5 along its normal",
        "F + (1 - F) r (1 - R) / (1 - r R), R inner diffuse (Duntley 1942)",
        scene,
        readers.gray,
        seen(1 / (1 - reflectance * kept)),
        "one turn between coat and base alone",
        seen(1),
        "A plane with a smooth clear coat of index 1.5 over a matte base of 0.5, in a sky of 1.",
        2,
    )


def metals(quick):
    for body, roughness in (("sphere", 0.2), ("sphere", 0.5), ("sphere", 1.0), ("cube", 0.4)):
        material = {"conductor": {"n": 1e-6, "k": 100, "roughness": roughness}}
        loss = {0.2: 0.005, 0.4: 0.05, 0.5: 0.08, 1.0: 0.3}[roughness]
        yield furnace(
            f"lossless metal {body}, roughness {roughness}",
            material,
            body,
            1.0,
            "L = 1",
            1 - loss,
            f"single scattering by facets alone, which loses some {100 * loss:.1f} %",
            quick,
            samples=512,
        )


def rough_glasses(quick):
    for body, roughness in (("sphere", 0.2), ("sphere", 0.4), ("cube", 0.4)):
        material = glass(1.5, roughness=roughness)
        loss = {0.2: 0.01, 0.4: 0.03}[roughness]
        yield furnace(
            f"clear rough {body}, roughness {roughness}",
            material,
            body,
            1.0,
            "L = 1",
            1 - loss,
            f"facets that block light for good, some {100 * loss:.0f} %",
            quick,
            samples=1024,
        )
    for index, roughness in ((9.9, 0.77), (9.9, 0.99), (4.0, 0.5), (2.4, 0.99)):
        yield furnace(
            f"clear rough sphere of index {index}, roughness {roughness}",
            glass(index, roughness=roughness),
            "sphere",
            1.0,
            "L = 1",
            0.85,
            "weights that spread at each surface, so that their product has its mean in a tail that no sample finds",
            quick,
            samples=32,
        )


def rows(quick):
    for part in (lossless, heroes, inside_glass, matte, plastics, metals, rough_glasses, plates.rows, rooms.rows):
        yield from part(quick)
