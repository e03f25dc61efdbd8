"""Energy: light neither appears nor is lost."""

import numpy as np

from . import formulas, readers
from .row import Row
from .scenes import SKY, cube, diffuse, disc, glass, glow, plane, rgb, sphere, view

BANDS = (1.333, 1.52, 2.42)
SPREAD = (1.1, 1.5, 2.5)
EYE = {"eye": (1.7, 1.3, 3.1)}
BODIES = {"sphere": (sphere(), 38), "cube": (cube(), 38)}


def furnace(name, material, body, expected, formula, mistake, guards, quick, *, samples, reader=readers.covered, more=None,
            every_pixel=False, seeds=2, lights=(SKY,), size=None, **settings):  # fmt: skip
    """A body under a sky of 1, seen whole; what it shows is known whatever its shape."""
    shape, fov = BODIES[body] if isinstance(body, str) else body
    materials = {"body": material} | (more or {})
    chance = {} if samples is None else {"samples": max(samples // 4, 16) if quick else samples}
    size = size or (16 if quick else 32)
    scene = view(materials, [("body", shape)], lights, **EYE, fov=fov, size=size, **chance, **settings)
    words = (
        f"A {body if isinstance(body, str) else 'body'} at the origin (radius 1, or edge 1.5) in an even sky of radiance 1, "
        f"from (1.7, 1.3, 3.1) toward the origin, {fov} degrees; the mean of the pixels that it covers (channel A)."
    )
    return Row("energy", name, formula, scene, reader, expected, guards, mistake, words, seeds, every_pixel=every_pixel)


def lossless(quick):
    """Clear bodies cannot be seen in an even sky, whatever their index."""
    lost = "a refraction that forgets the factor 1/n^2 on the way out, or loses a hundredth of the light"
    for index in (1.1, 1.333, 1.5, 1.7847, 2.5, SPREAD, (1.3, 1.31, 1.8)):
        many = isinstance(index, tuple)
        material = glass(rgb(index) if many else index)
        called = "three indices " + "/".join(map(str, index)) if many else f"index {index}"
        for body in BODIES:
            yield furnace(f"clear {body}, {called}, in an even sky", material, body, 1.0, "L = 1", 0.99, lost, quick,
                          samples=None, every_pixel=True, seeds=1)  # fmt: skip
        if index in (1.5, 2.5, SPREAD):
            yield furnace(f"clear sphere, {called}, at random", material, "sphere", 1.0, "L = 1", 0.98, "roulette without "
                          "compensation, or branches drawn with another probability than they are weighted by", quick,
                          samples=512, every_pixel=True)  # fmt: skip


def inside_glass(quick):
    """The radiance inside a body is n^2 times that outside."""
    for index in (1.333, 1.5, 2.42):
        scene = view({"glass": glass(index)}, [("glass", sphere())], [SKY], eye=(0.3, 0.2, 0.1), target=(1, 2, 3), fov=60, size=8)
        words = "A camera inside a clear ball of radius 1 in an even sky of 1, off its center; every pixel alike."
        yield Row("energy", f"inside a clear ball of index {index}", "L = n^2", scene, readers.gray, index**2,
                  "radiance that is not scaled by n^2 at a refraction", 1.0, words, every_pixel=True)  # fmt: skip


def matte(quick):
    for body in BODIES:
        reflectance = np.array([0.5, 0.2, 0.9])
        yield furnace(f"diffuse {body} in an even sky", diffuse(rgb(reflectance)), body, reflectance, "L = rho",
                      reflectance * 1.01, "a lobe that is not normalized, 1 % too bright", quick, samples=64,
                      every_pixel=True)  # fmt: skip
    base = {"white": diffuse(1), "mirror": {"mirror": {"reflectance": 1}}}
    both = {"mix": {"materials": ["white", "mirror"], "amount": rgb((0.2, 0.5, 0.9))}}
    for body in BODIES:
        net = {"mask": {"material": "both", "opacity": 0.6}}
        yield furnace(f"mask over a mix of white and mirror, {body}", net, body, 1.0, "L = 1", 0.97,
                      "holes or shares whose chances do not cancel, 3 % lost", quick, samples=512,
                      reader=readers.touched, more=base | {"both": both})  # fmt: skip


def plastics(quick):
    for body, roughness, index in (("sphere", 0, 1.5), ("sphere", 0.4, SPREAD), ("cube", 0.1, 1.5), ("cube", 0.4, SPREAD)):
        value = rgb(index) if isinstance(index, tuple) else index
        white = {"plastic": {"reflectance": 1, "index": value, "roughness": roughness}}
        yield furnace(f"white plastic {body}, roughness {roughness}, index {index}", white, body, 1.0, "L = 1", 0.97,
                      "light between coat and base that is given up after one turn, 3 % at least", quick, samples=256)  # fmt: skip
    index, reflectance = 1.5, 0.5
    kept, once = formulas.inner_diffuse_reflectance(index), ((index - 1) / (index + 1)) ** 2
    def seen(turns):
        return once + (1 - once) * reflectance * (1 - kept) * turns
    floor = [("paint", plane((0, 0, 0), (0, 1, 0)))]
    size, samples = (16, 256) if quick else (24, 512)
    scene = view({"paint": {"plastic": {"reflectance": reflectance}}}, floor, [SKY], eye=(0, 3, 0), up=(0, 0, 1),
                 size=size, samples=samples)  # fmt: skip
    yield Row("energy", "plastic of reflectance 0.5 along its normal", "F + (1 - F) r (1 - R) / (1 - r R), R inner diffuse "
              "(Duntley 1942)", scene, readers.gray, seen(1 / (1 - reflectance * kept)), "one turn between coat and base alone",
              seen(1), "A plane with a smooth clear coat of index 1.5 over a matte base of 0.5, in a sky of 1.", 2)  # fmt: skip


def metals(quick):
    for body, roughness in (("sphere", 0.2), ("sphere", 0.5), ("sphere", 1.0), ("cube", 0.4)):
        material = {"conductor": {"n": 1e-6, "k": 100, "roughness": roughness}}
        loss = {0.2: 0.005, 0.4: 0.05, 0.5: 0.08, 1.0: 0.3}[roughness]
        yield furnace(f"lossless metal {body}, roughness {roughness}", material, body, 1.0, "L = 1", 1 - loss,
                      f"single scattering by facets alone, which loses some {100 * loss:.1f} %", quick, samples=512)  # fmt: skip


def rough_glasses(quick):
    for body, roughness in (("sphere", 0.2), ("sphere", 0.4), ("cube", 0.4)):
        material = glass(1.5, roughness=roughness)
        loss = {0.2: 0.01, 0.4: 0.03}[roughness]
        yield furnace(f"clear rough {body}, roughness {roughness}", material, body, 1.0, "L = 1", 1 - loss,
                      f"facets that block light for good, some {100 * loss:.0f} %", quick, samples=1024)  # fmt: skip


def looking_down(degrees):
    angle = np.radians(degrees)
    return (10 * np.sin(angle), 10 * np.cos(angle), 0)


def plate(kind, degrees, index, optical_depth=0.0, surfaces=None):
    """Rays through a plate 0.01 thick toward a plane that glows, before it (R), behind it (T), or on both sides."""
    depth = np.broadcast_to(np.asarray(optical_depth, float), 3)
    materials = {"glass": glass(rgb(index), absorption=rgb(depth / 0.01)), "glow": glow()}
    planes = {"R": plane((0, 30, 0), (0, -1, 0)), "T": plane((0, -5, 0), (0, 1, 0))}
    surfaces = surfaces or [cube((0, -0.005, 0), [40.0, 0.01, 40.0])]
    objects = [*(("glass", surface) for surface in surfaces), *(("glow", planes[side]) for side in kind.split("+"))]
    scene = view(materials, objects, eye=looking_down(degrees), up=(0, 0, 1))
    answer = dict(zip("RT", formulas.slab(np.array(index), degrees, depth), strict=True))
    once = formulas.fresnel(np.array(index), degrees)
    through = np.exp(-depth / formulas.refracted_cosine(np.array(index), degrees))
    wrong = {"R": once, "T": (1 - once) ** 2 * through}
    total = kind == "R+T"
    words = (
        f"A plate 0.01 thick of indices {index} and optical depths {depth.tolist()}, seen at {degrees} degrees, before black; a "
        f"plane of radiance 1 {'on both sides' if total else 'before it' if kind == 'R' else 'behind it'}."
    )
    name = f"{kind} of a plate at {degrees} degrees" + (", absorbing" if depth.any() else "")
    name += " of two discs" if len(surfaces) > 1 else ""
    formula = "1 - A" if total else {"T": "(1 - r)^2 a / (1 - r^2 a^2)", "R": "r + r a T"}[kind]
    mistake = "reflections inside that are left out" if not total else "the light of inner reflections that is lost"
    return Row("energy", name, formula + ", unpolarized at each surface", scene, readers.colors,
               sum(answer[side] for side in kind.split("+")), mistake, sum(wrong[side] for side in kind.split("+")), words)  # fmt: skip


def plates(quick):
    for degrees in (0, 30, 45, 60, 70, 80):
        for kind in ("R", "T", "R+T"):
            yield plate(kind, degrees, BANDS)
    for degrees in (0, 60, 75):
        for kind in ("R", "T", "R+T"):
            yield plate(kind, degrees, (1.5, 1.5, 2.0), (1.0, 0.1, 0.5))
    discs = [disc((0, 0, 0), (0, 1, 0), 20), disc((0, -0.01, 0), (0, -1, 0), 20)]
    yield plate("T", 60, BANDS, surfaces=discs)


def cavities(quick):
    """Closed rooms, where every bounce counts."""
    size, samples = (12, 512) if quick else (20, 1024)
    for reflectance in (0.65, 0.8, 0.95):
        fraction = 0.05
        # A disc across a sphere is seen from every point of the wall as the cap behind it would be.
        depth = 1 - 2 * fraction
        port = disc((0, depth, 0), (0, -1, 0), np.sqrt(1 - depth**2))
        materials = {"wall": diffuse(reflectance), "port": glow()}
        scene = view(materials, [("wall", sphere()), ("port", port)], eye=(0, 0, 0), target=(0.3, -1, 0.2), fov=70, size=size,
                     samples=samples)  # fmt: skip
        bounced = reflectance * (1 - fraction)
        expected = reflectance * fraction / (1 - bounced)
        words = f"The inside of a sphere of reflectance {reflectance}; a disc across it that glows by 1 stands for a cap of 5 %."
        yield Row("energy", f"integrating sphere of reflectance {reflectance}, port of 5 %", "rho f / (1 - rho (1 - f))", scene,
                  readers.gray, expected, "paths that end after 8 bounces", expected * (1 - bounced**8), words, 2)  # fmt: skip
    for reflectance in ((0.5, 0.7, 0.8), (0.55, 0.75, 0.9)):
        yield from box(np.array(reflectance), quick)
    for name, material, expected, mistake in (
        ("diffuse ball", diffuse(0.5), 0.5, 0.51),
        ("clear ball", glass(rgb(SPREAD)), 1.0, 0.99),
    ):
        materials = {"ball": material, "lamp": glow()}
        objects = [("ball", sphere(radius=0.6)), ("lamp", cube((0.3, 0.2, -0.1), [5.0, 4.0, 6.0]))]
        scene = view(materials, objects, eye=(0.9, 0.4, 1.6), fov=18, size=size, samples=samples // 2)
        words = f"A {name} of radius 0.6 at the origin in a closed box of 5 x 4 x 6 that glows by 1."
        yield Row("energy", f"{name} in a glowing box", "L = rho" if "diffuse" in name else "L = 1", scene, readers.colors,
                  expected, "a lamp counted twice or not at all by 1 % of the paths", mistake, words, 2)  # fmt: skip


def box(reflectance, quick):
    """The walls of a diffuse cube around a point light, seen from its center evenly in area: one view, six of them."""
    materials, intensity, edge = {"wall": diffuse(rgb(reflectance))}, 1.0, 2.0
    light = {"point": {"position": (0.3, -0.2, 0.4), "intensity": intensity}}
    size, samples = (24, 256) if quick else (32, 1024)
    # An orthographic camera that stands in the room sees one wall evenly in area; symmetry of the light's place stands for
    # the others: a light in the middle lights all walls alike.
    light["point"]["position"] = (0.0, 0.0, 0.0)
    scene = view(materials, [("wall", cube(size=edge))], [light], eye=(0, 0, 0), target=(0, 0, -1), height=edge, size=size,
                 samples=samples)  # fmt: skip
    expected = formulas.irradiance_in_box(4 * np.pi * intensity, 6 * edge**2, reflectance) * reflectance / np.pi
    words = "A closed cube of edge 2, a point light of intensity 1 in its middle; one wall, seen whole by parallel rays."
    yield Row("energy", f"closed box of reflectances {'/'.join(map(str, reflectance))}", "rho Phi / (pi S (1 - rho))", scene,
              readers.colors, expected, "paths that end after 8 bounces", expected * (1 - reflectance**8), words, 2)  # fmt: skip


def rows(quick):
    for part in (lossless, inside_glass, matte, plastics, metals, rough_glasses, plates, cavities):
        yield from part(quick)
