"""The scenes of tools/energy.py: what is rendered and what must come out.

    from energy_rows import rows
    rows(quick=True)

To add a row: describe its scene as the TOML would, and compute its answer in tools/optics.py.
"""

from typing import NamedTuple

import numpy as np
import optics

BANDS = (1.333, 1.52, 2.42)
SPREAD = (1.1, 1.5, 2.5)
METAL_N, METAL_K = (0.43, 0.2, 1.4), (2.455, 3.9, 7.6)
WHITE_SKY = {"environment": {"radiance": 1}}


class Row(NamedTuple):
    name: str
    views: list  # scenes; their pixels count together
    expected: np.ndarray  # per band, or one number
    every_pixel: bool = True  # each pixel has the expected value, not only their mean
    holes: bool = False  # pixels count that are covered in part, too


def rgb(values):
    return {"rgb": list(values)}


def scene(materials, objects, lights=(), *, eye, target=(0, 0, 0), up=(0, 1, 0), fov=1e-4, size=1, **settings):
    """A square picture; `objects` pairs each material's name with a shape. A single pixel, and no `samples`: one ray
    through each pixel's center, which leaves nothing to chance where all surfaces are smooth."""
    return {
        "camera": {"position": eye, "look_at": target, "up": up, "vertical_fov": fov},
        "film": {"width": size, "height": size, "filter": "box" if "samples" in settings else "center"},
        "render": {"model": "rgb", **settings},
        "material": materials,
        "object": [{"material": name, "shape": shape} for name, shape in objects],
        "light": list(lights),
    }


def sphere(center=(0, 0, 0), radius=1.0):
    return {"sphere": {"center": center, "radius": radius}}


def cube(center=(0, 0, 0), size=1.5):
    return {"cube": {"center": center, "size": size}}


def plane(point, normal):
    return {"plane": {"point": point, "normal": normal}}


def sky(radiance):
    """Nothing but a sky."""
    return scene({}, [], [{"environment": {"radiance": rgb(radiance)}}], eye=(0, 0, 1))


BODIES = {"sphere": sphere(), "cube": cube()}


def lossless(name, body, index, size, **settings):
    """Light neither starts nor ends in clear glass: under a uniform sky every ray brings the sky's radiance."""
    materials = {"glass": {"dielectric": {"index": index}}}
    view = scene(materials, [("glass", body)], [WHITE_SKY], eye=(1.7, 1.3, 3.1), fov=38, size=size, **settings)
    return Row(f"lossless {name} under a sky of 1, {label(index)}{chance(settings)}", [view], 1.0)


def lossless_beside_white(name, body, index, size):
    """A white diffuse ball under the sky has the sky's radiance too."""
    materials = {"glass": {"dielectric": {"index": index}}, "white": {"diffuse": {"reflectance": 1}}}
    objects = [("glass", body), ("white", sphere((2.0, -0.7, -1.2)))]
    view = scene(materials, objects, [WHITE_SKY], eye=(1.7, 1.3, 3.1), fov=42, size=size, samples=256)
    return Row(f"lossless {name} beside a white ball, {label(index)}", [view], 1.0)


def inside_lamp(name, material, expected, size):
    """A ball in a closed cube that glows: the furnace, lit by a surface instead of the sky."""
    materials = {"ball": material, "lamp": {"emissive": {"radiance": 1}}}
    objects = [("ball", sphere(radius=0.6)), ("lamp", cube((0.3, 0.2, -0.1), (5, 4, 6)))]
    view = scene(materials, objects, eye=(0.9, 0.4, 1.6), fov=25, size=size, samples=256)
    return Row(f"{name} in a glowing cube", [view], expected)


def white_plastic(name, body, roughness, index, size):
    """A white base gives back all that its clear coat lets in."""
    plastic = {"plastic": {"reflectance": 1, "index": index, "roughness": roughness}}
    looking = {"eye": (1.7, 1.3, 3.1), "fov": 38, "size": size, "samples": 256}
    view = scene({"white": plastic}, [("white", body)], [WHITE_SKY], **looking)
    what = f"white plastic {name} of roughness {roughness}, {label(index)} under a sky of 1"
    return Row(what, [view], 1.0, every_pixel=False)


def plastic_in_lamp(size):
    """A smooth coat over a base of reflectance r in an even sky shows F + (1 - F) r (1 - R) / (1 - r R), where R is
    what the coat reflects of diffuse light from inside (Duntley 1942); seen along the normal."""
    index, reflectance = 1.5, 0.5
    kept = optics.inner_diffuse_reflectance(index)
    fresnel = ((index - 1) / (index + 1)) ** 2
    seen = fresnel + (1 - fresnel) * reflectance * (1 - kept) / (1 - reflectance * kept)
    materials = {"paint": {"plastic": {"reflectance": reflectance}}}
    floor = [("paint", plane((0, 0, 0), (0, 1, 0)))]
    view = scene(materials, floor, [WHITE_SKY], eye=(0, 3, 0), up=(0, 0, 1), size=size, samples=256)
    return Row("plastic of reflectance 0.5 under a sky of 1, along its normal", [view], seen)


def lossless_mix(name, body, size):
    """White and a perfect mirror on shares of one surface, and holes in a mirror."""
    materials = {
        "white": {"diffuse": {"reflectance": 1}},
        "mirror": {"mirror": {"reflectance": 1}},
        "both": {"mix": {"materials": ["white", "mirror"], "amount": rgb((0.2, 0.5, 0.9))}},
        "net": {"mask": {"material": "both", "opacity": 0.6}},
    }
    view = scene(materials, [("net", body)], [WHITE_SKY], eye=(1.7, 1.3, 3.1), fov=38, size=size, samples=256)
    return Row(f"mask over a mix of white and mirror, {name} under a sky of 1", [view], 1.0, every_pixel=False, holes=True)


def diffuse(name, body, size):
    """A convex Lambertian body under a uniform sky of 1 shows its reflectance."""
    reflectance = (0.5, 0.2, 0.9)
    materials = {"gray": {"diffuse": {"reflectance": rgb(reflectance)}}}
    view = scene(materials, [("gray", body)], [WHITE_SKY], eye=(1.7, 1.3, 3.1), fov=38, size=size, samples=128)
    return Row(f"diffuse {name} under a sky of 1", [view], np.array(reflectance))


def plate(kind, degrees, index=BANDS, optical_depth=0.0, surfaces=None, **settings):
    """Rays through a plate of thickness 0.01 toward a plane that glows, before it (R), behind it (T), or one on each
    side (R+T); the rest is black."""
    angle = np.radians(degrees)
    glass = {"dielectric": {"index": rgb(index), "absorption": optical_depth / 0.01}}
    glow = {"R": plane((0, 30, 0), (0, -1, 0)), "T": plane((0, -5, 0), (0, 1, 0))}
    materials = {"glass": glass, "glow": {"emissive": {"radiance": 1}}}
    surfaces = surfaces or [cube((0, -0.005, 0), (40, 0.01, 40))]
    objects = [*(("glass", surface) for surface in surfaces), *(("glow", glow[side]) for side in kind.split("+"))]
    eye = (10 * float(np.sin(angle)), 10 * float(np.cos(angle)), 0)
    answer = dict(zip("RT", optics.slab(np.array(index), degrees, optical_depth), strict=True))
    what = f"{kind} of a plate" + (f" of optical depth {optical_depth:g}" if optical_depth else "")
    what += " made of two discs" if len(surfaces) > 1 else ""
    view = scene(materials, objects, eye=eye, up=(0, 0, 1), **settings)
    return Row(f"{what}, {degrees} degrees{chance(settings)}", [view], sum(answer[side] for side in kind.split("+")))


def two_discs():
    tops = [((0, 0, 0), (0, 1, 0)), ((0, -0.01, 0), (0, -1, 0))]
    return [{"disc": {"center": center, "normal": normal, "radius": 20}} for center, normal in tops]


def metal(degrees):
    """A metal plane under a sky of 1 shows its reflectance."""
    angle = np.radians(degrees)
    materials = {"metal": {"conductor": {"n": rgb(METAL_N), "k": rgb(METAL_K)}}}
    eye = (10 * float(np.sin(angle)), 10 * float(np.cos(angle)), 0)
    view = scene(materials, [("metal", plane((0, 0, 0), (0, 1, 0)))], [WHITE_SKY], eye=eye, up=(0, 0, 1))
    expected = optics.fresnel(np.array(METAL_N) + 1j * np.array(METAL_K), degrees)
    return Row(f"metal plane, {degrees} degrees", [view], expected)


def rough_metal(name, body, roughness, size):
    """A metal that takes nothing, however rough, cannot be told from an even sky of 1: what meets a second facet is given
    back (Kulla & Conty 2017)."""
    lossless = {"conductor": {"n": 1e-6, "k": 100, "roughness": roughness}}
    view = scene({"metal": lossless}, [("metal", body)], [WHITE_SKY], eye=(1.7, 1.3, 3.1), fov=38, size=size, samples=256)
    return Row(f"lossless metal {name} of roughness {roughness} under a sky of 1", [view], 1.0, every_pixel=False)


def rough_glass(name, body, index, roughness, size):
    """Clear glass, however rough, cannot be told from an even sky of 1: what its facets block is given back."""
    glass = {"dielectric": {"index": index, "roughness": roughness}}
    view = scene({"glass": glass}, [("glass", body)], [WHITE_SKY], eye=(1.7, 1.3, 3.1), fov=38, size=size, samples=512)
    return Row(f"lossless {name} of roughness {roughness}, {label(index)}", [view], 1.0, every_pixel=False)


def lit(name, lamp, irradiance, size):
    """One point of a diffuse floor of reflectance 1, straight under a lamp of radiance 1: irradiance / pi."""
    materials = {"floor": {"diffuse": {"reflectance": 1}}, "lamp": {"emissive": {"radiance": 1}}}
    objects = [("floor", plane((0, 0, 0), (0, 1, 0))), ("lamp", lamp)]
    view = scene(materials, objects, eye=(9, 1, 0), size=size, samples=256, diffuse_bounces=0)
    return Row(f"floor under {name}", [view], irradiance / np.pi)


def closed_box(size):
    """The walls of a diffuse box around a point light, seen from its center: evenly in area on each square wall."""
    reflectance, intensity, edge = np.array([0.2, 0.5, 0.8]), 1.0, 2.0
    materials = {"wall": {"diffuse": {"reflectance": rgb(reflectance.tolist())}}}
    light = {"point": {"position": (0.3, -0.2, 0.4), "intensity": intensity}}
    views = []
    for axis in np.eye(3):
        for target in (axis, -axis):
            camera = {"eye": (0, 0, 0), "target": target.tolist(), "up": np.roll(axis, 1).tolist(), "fov": 90}
            views.append(scene(materials, [("wall", cube(size=edge))], [light], **camera, size=size, samples=256))
    irradiance = optics.irradiance_in_box(4 * np.pi * intensity, 6 * edge**2, reflectance)
    return Row("closed diffuse box around a point light", views, irradiance * reflectance / np.pi, every_pixel=False)


def label(index):
    return f"n = {index['rgb'] if isinstance(index, dict) else index}"


def chance(settings):
    return ", at random" if "samples" in settings else ""


def rows(quick):
    """The whole table, or a quick part of it."""
    size = 16 if quick else 40
    indices = [rgb(SPREAD)] if quick else [1.1, 1.5, 2.5, rgb(SPREAD), rgb((1.3, 1.31, 1.8))]
    angles = [45] if quick else [0, 30, 45, 60, 70]
    bodies = [(name, body, index) for name, body in BODIES.items() for index in indices]
    table = [lossless(*body, size) for body in bodies]
    table += [lossless(*body, size, samples=128) for body in bodies]
    table += [lossless_beside_white(*body, size) for body in bodies]
    table += [plate(kind, degrees) for degrees in angles for kind in ("R", "T", "R+T")]
    table += [plate(kind, 60, size=size, samples=1024) for kind in "RT"]
    table += [plate(kind, 60, surfaces=two_discs()) for kind in "RT"]
    table += [plate(kind, degrees, (1.5,) * 3, 1.0) for degrees in (0, 60) for kind in ("R", "T", "R+T")]
    table += [metal(degrees) for degrees in (0, 60)]
    roughnesses = [0.4] if quick else [0.05, 0.2, 0.4, 0.7, 1.0]
    table += [rough_metal(*body, roughness, size) for body in BODIES.items() for roughness in roughnesses]
    table += [rough_glass(*body, 1.5, roughness, size) for body in BODIES.items() for roughness in roughnesses[:3]]
    coats = [(0.4, rgb(SPREAD))] if quick else [(0, 1.5), (0.1, rgb(SPREAD)), (0.4, rgb(SPREAD)), (1, rgb(SPREAD))]
    table += [white_plastic(*body, *coat, size) for body in BODIES.items() for coat in coats]
    table += [plastic_in_lamp(size)]
    table += [lossless_mix(name, body, size) for name, body in BODIES.items()]
    table += [diffuse(name, body, size) for name, body in BODIES.items()]
    table += [inside_lamp("diffuse ball", {"diffuse": {"reflectance": 0.5}}, 0.5, size)]
    table += [inside_lamp("glass ball", {"dielectric": {"index": rgb(SPREAD)}}, 1.0, size)]
    table += [closed_box(size)]
    disc = {"disc": {"center": (0, 2, 0), "normal": (0, -1, 0), "radius": 1}}
    square = {"quad": {"center": (0, 1, 0), "u": (1, 0, 0), "v": (0, 0, 1)}}
    table += [lit("a disc lamp", disc, optics.irradiance_under_disc(1, 2), size)]
    table += [lit("a square lamp", square, optics.irradiance_under_square(1, 1), size)]
    table += [lit("a ball lamp", sphere((0, 2, 0), 0.5), optics.irradiance_under_sphere(0.5, 2), size)]
    return table
