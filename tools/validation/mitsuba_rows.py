"""Cross-checks with Mitsuba 3 where both model the same physics: every pixel of both pictures, with its own noise.

    python tools/validate.py --with-mitsuba       # pip install mitsuba==3.9.1

Both render the same scene from eight seeds. A pixel's z is the difference of the two means over their joint standard
error, from the spread of the seeds. It follows Student's t with 14 degrees of freedom, of which one in twenty is beyond
2.145. A scene passes if its mean agrees in every channel within 4 standard errors, and if at most 8 % of the pixels
with noise are beyond 2.145; pixels without noise must agree to rounding. These scenes are counted separately, and are
not part of the tests.

Rough glass is nearly smooth here: Mitsuba drops light that meets a second facet, 3 % at a roughness of 0.3, while Abbe
gives it back, as its furnaces show. Scenes in which Mitsuba 3.9.1 deviates from its own formulas are left out: a mix of
a mirror and something rough is not the sum of its parts there, the two colors of a checker are swapped as an opacity, a
ball that emits by an image is sampled wrongly, and a lamp is seen through what is just in front of it.

Caustics are compared with Mitsuba's particle tracer, where many directional lights stand for the sun. It shows only
what the camera sees directly, so the glass is outside of the picture. Means of 16 x 16 blocks are compared.
"""

import tempfile
from pathlib import Path

import numpy as np

import render

from .scenes import SKY, cube, diffuse, glass, glow, quad, rgb, sphere, toml_file, view

SEEDS, BEYOND, MOST = 8, 2.145, 0.08
SUN = {"toward": [-0.8, 0.6, 0.1], "angular_diameter": 1.0, "irradiance": rgb((3.0, 2.8, 2.5))}
DIRECTIONS = 200  # directional lights that stand for the sun in Mitsuba
PARTICLES = 4096  # per pixel
PLASTIC = {"plastic": {"reflectance": rgb((0.6, 0.3, 0.1)), "index": 1.5}}
EYE = {"eye": (1.7, 1.3, 3.1), "fov": 38}


def scenes(samples, size):
    """Yields name and scene, with materials and shapes that both renderers have."""
    common = EYE | {"samples": samples, "size": size}
    room = [("white", quad((0, -1, 0), (3, 0, 0), (0, 0, -3))), ("lamp", quad((0, 3, 0), (0.6, 0, 0), (0, 0, 0.6)))]
    whites = {"white": diffuse(0.7), "lamp": glow(10)}
    metal = {"conductor": {"n": rgb((0.43, 0.2, 1.4)), "k": rgb((2.455, 3.9, 7.6))}}
    yield "furnace cube, diffuse", view({"b": diffuse(rgb((0.5, 0.2, 0.9)))}, [("b", cube())], [SKY], **common)
    yield (
        "diffuse cube on a floor",
        view(whites | {"b": diffuse(rgb((0.5, 0.2, 0.9)))}, [("b", cube()), *room], **common),
    )
    yield "diffuse ball on a floor", view(whites | {"b": diffuse(0.5)}, [("b", sphere()), *room], **common)
    yield (
        "smooth metal ball on a floor",
        view(whites | {"b": metal}, [("b", sphere()), *room], caustics="off", **common),
    )
    yield "smooth glass ball in a sky", view({"b": glass(1.5)}, [("b", sphere())], [SKY], **common)
    yield "metal ball in a sky", view({"b": metal}, [("b", sphere())], [SKY], **common)
    yield (
        "clear rough ball over a lit floor",
        view(
            {"b": glass(1.5, roughness=0.1), "white": diffuse(0.7)},
            [("b", sphere()), room[0]],
            [SKY],
            caustics="off",
            **common,
        ),
    )
    yield from more_scenes(common, room, whites)


def more_scenes(common, room, whites):
    """Yields the other cameras, lamps and materials that both renderers have."""
    shapes = [("b", cube()), *room]
    yield "plastic ball on a floor", view(whites | {"b": PLASTIC}, [("b", sphere()), *room], caustics="off", **common)
    at_a_point = {"point": {"position": [-1.5, 3.0, 1.0], "intensity": rgb((20, 15, 10))}}
    yield "diffuse cube under a point", view(whites | {"b": diffuse(0.5)}, shapes[:2], [at_a_point], **common)
    half_open = {"matte": diffuse(rgb((0.8, 0.4, 0.2))), "b": {"mask": {"material": "matte", "opacity": 0.4}}}
    yield "half open ball over a floor", view(whites | half_open, [("b", sphere()), room[0]], [SKY], **common)
    one_in_another = whites | {"outer": glass(1.5), "inner": glass(1.2, priority=1), "b": diffuse(0.6)}
    balls = [("outer", sphere()), ("inner", sphere((0.2, 0.1, 0.0), 0.6)), ("b", sphere((-0.55, -0.3, 0.3), 0.25))]
    within = [*balls, room[0]]
    yield "balls in a smooth glass ball", view(one_in_another, within, [SKY], caustics="off", **common)
    parallel = common | {"height": 4.0}
    yield "by parallel rays", view(whites | {"b": diffuse(rgb((0.5, 0.2, 0.9)))}, shapes, [SKY], **parallel)
    through_a_lens = view(whites | {"b": diffuse(rgb((0.5, 0.2, 0.9)))}, shapes, [SKY], **common)
    through_a_lens["camera"]["lens"] = {"radius": 0.3, "focus_distance": 2.5}
    yield "through a lens", through_a_lens


def caustics(samples, size):
    """Yields name and scene: the floor where glass focuses the light of the sun."""
    common = {"eye": (4.4, 2.8, 2), "target": (2.6, 0, -0.2), "fov": 36, "samples": samples, "size": size}
    floor = ("white", quad((0, 0, 0), (5, 0, 0), (0, 0, -5)))
    for name, body, one in (
        ("the sun through a glass ball", glass(1.5), sphere((0, 1.6, 0))),
        ("the sun through a glass cube", glass(1.33), cube((0, 1.6, 0), 1.6)),
    ):
        materials = {"white": diffuse(rgb((0.6, 0.4, 0.2))), "b": body}
        yield name, view(materials, [floor, ("b", one)], [{"sun": SUN}], **common)


def ours(scene, folder, seed):
    (folder / "scene.toml").write_text(toml_file(scene), "utf-8")
    render.write(folder / "scene.toml", folder / "scene.exr", seed=seed)
    return render.read(folder / "scene.exr").rgb


def color(value, kind="rgb"):
    return {"type": kind, "value": [float(x) for x in value["rgb"]] if isinstance(value, dict) else [float(value)] * 3}


def material(name, values, materials):
    """Converts a material for Mitsuba; alpha is the square of Abbe's roughness."""
    if name == "diffuse":
        return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": color(values["reflectance"])}}
    if name == "conductor":
        return {"type": "conductor", "eta": color(values["n"]), "k": color(values["k"])}
    if name == "plastic":
        base, index = {"diffuse_reflectance": color(values["reflectance"])}, values["index"]
        return {"type": "plastic", "int_ior": index, "ext_ior": 1.0, "nonlinear": True, **base}
    if name == "mask":
        ((kind, within),) = materials[values["material"]].items()
        return {"type": "mask", "opacity": values["opacity"], "bsdf": material(kind, within, materials)}
    # Glass of a higher priority is inside the only other glass.
    around = materials["outer"]["dielectric"]["index"] if "priority" in values else 1.0
    indices = {"int_ior": values["index"], "ext_ior": around}
    if "roughness" in values:
        alpha = values["roughness"] ** 2
        return {"type": "roughdielectric", "distribution": "ggx", "alpha": alpha, **indices}
    return {"type": "dielectric", **indices}


def shape(mitsuba, entry):
    transform = mitsuba.ScalarTransform4f
    ((kind, values),) = entry.items()
    if kind == "sphere":
        return {"type": "sphere", "center": values["center"], "radius": values["radius"]}
    if kind == "cube":
        half = values["size"] / 2
        return {"type": "cube", "to_world": transform().translate(values["center"]).scale([half] * 3)}
    u, v = np.array(values["u"]), np.array(values["v"])
    axes = np.column_stack([u, v, np.cross(u, v) / np.linalg.norm(np.cross(u, v)), values["center"]])
    return {"type": "rectangle", "to_world": transform(np.vstack([axes, [0, 0, 0, 1]]))}


def sensor(mitsuba, camera, film):
    """Converts camera and film. A lens is in focus at a distance along the view, as in Abbe."""
    transform, picture = mitsuba.ScalarTransform4f, {"width": film["width"], "height": film["height"]}
    look = transform().look_at(camera["position"], camera["look_at"], camera["up"])
    common = {"film": {"type": "hdrfilm", "rfilter": {"type": "box"}, **picture}}
    if "height" in camera:
        half = camera["height"] / 2 * film["width"] / film["height"]
        return {"type": "orthographic", "to_world": look @ transform().scale([half, half, 1]), **common}
    common |= {"fov": camera["vertical_fov"], "fov_axis": "y", "to_world": look}
    if "lens" in camera:
        radius, distance = camera["lens"]["radius"], camera["lens"]["focus_distance"]
        return {"type": "thinlens", "aperture_radius": radius, "focus_distance": distance, **common}
    return {"type": "perspective", **common}


def translated(mitsuba, scene):
    """Converts the scene for mitsuba.load_dict, with the same field of view, film and lights."""
    integrator = {"type": "path", "max_depth": -1, "rr_depth": 100}
    result = {"type": "scene", "integrator": integrator, "sensor": sensor(mitsuba, scene["camera"], scene["film"])}
    for number, entry in enumerate(scene["object"]):
        ((kind, values),) = scene["material"][entry["material"]].items()
        one = shape(mitsuba, entry["shape"])
        if kind == "emissive":
            # Abbe's lamp emits from both sides. Of one at the ceiling only the lower side is seen, which is its front.
            one |= {"emitter": {"type": "area", "radiance": color(values["radiance"])}}
            one |= {"bsdf": {"type": "diffuse", "reflectance": color(0)}}
        else:
            one["bsdf"] = material(kind, values, scene["material"])
        result[f"object{number}"] = one
    for light in scene["light"]:
        if "environment" in light:
            result["sky"] = {"type": "constant", "radiance": color(light["environment"]["radiance"])}
        elif "point" in light:
            at, intensity = light["point"]["position"], color(light["point"]["intensity"])
            result["point"] = {"type": "point", "position": at, "intensity": intensity}
        else:
            result |= sun_of_directions(**light["sun"]) | {"integrator": {"type": "ptracer", "max_depth": 40}}
    return result


def sun_of_directions(toward, angular_diameter, irradiance):
    """Returns directional lights, spread evenly over the disc of the sun by the golden angle."""
    z = np.array(toward) / np.linalg.norm(toward)
    x = np.cross(z, (0, 1, 0)) / np.linalg.norm(np.cross(z, (0, 1, 0)))
    number = np.arange(DIRECTIONS)
    radius = np.tan(np.radians(angular_diameter) / 2) * np.sqrt((number + 0.5) / DIRECTIONS)
    angle = number * np.pi * (3 - 5**0.5)
    away = -(z + np.outer(radius * np.cos(angle), x) + np.outer(radius * np.sin(angle), np.cross(z, x)))
    share = color(rgb(np.array(irradiance["rgb"]) / DIRECTIONS))
    return {f"sun{i}": {"type": "directional", "direction": away[i].tolist(), "irradiance": share} for i in number}


def blocks(pictures, number=16):
    """Returns the means of `number` x `number` blocks of pixels."""
    seeds, height, width, channels = pictures.shape
    shape = (seeds, number, height // number, number, width // number, channels)
    return pictures.reshape(shape).mean(axis=(2, 4))


def compare(first, second):
    """Compares two sets of pictures.

    Returns both means, their difference in standard errors, the share of noisy pixels beyond 2.145, and the worst z of
    the others."""
    mean = [np.mean(pictures, axis=0) for pictures in (first, second)]
    variance = sum(np.var(pictures, axis=0, ddof=1) / len(pictures) for pictures in (first, second))
    totals = [np.mean(pictures, axis=(1, 2)) for pictures in (first, second)]
    error = np.sqrt(sum(total.var(axis=0, ddof=1) / len(total) for total in totals))
    rounding = 32 * 2.0**-24 * np.abs(mean[1])  # of the 32-bit values that both store
    z = (mean[0] - mean[1]) / np.sqrt(variance + rounding**2 + 1e-60)
    noisy = variance > rounding**2
    overall = (totals[0].mean(axis=0) - totals[1].mean(axis=0)) / np.hypot(error, rounding.mean(axis=(0, 1)))
    beyond = np.mean(np.abs(z[noisy]) > BEYOND) if noisy.any() else 0.0
    return [picture.mean() for picture in mean], overall, beyond, np.abs(z[~noisy]).max(initial=0)


def main(quick):
    try:
        import mitsuba
    except ImportError:
        raise SystemExit("the Python package mitsuba is missing: pip install mitsuba==3.9.1") from None
    mitsuba.set_variant("llvm_ad_rgb" if "llvm_ad_rgb" in mitsuba.variants() and has_llvm(mitsuba) else "scalar_rgb")
    print(f"Mitsuba {mitsuba.__version__} {mitsuba.variant()}")
    samples, size = (64, 32) if quick else (256, 64)
    failed = []
    with tempfile.TemporaryDirectory() as folder:
        for name, scene in [*scenes(samples, size), *caustics(samples, size)]:
            loaded = mitsuba.load_dict(translated(mitsuba, scene))
            sun = any("sun" in light for light in scene["light"])
            theirs = [
                np.array(mitsuba.render(loaded, spp=PARTICLES if sun else samples, seed=seed), float)[..., :3]
                for seed in range(1, SEEDS + 1)
            ]
            pictures = [ours(scene, Path(folder), seed) for seed in range(1, SEEDS + 1)]
            both = np.array(pictures), np.array(theirs)
            if sun:
                both = map(blocks, both)
            means, overall, beyond, exact = compare(*both)
            passes = np.abs(overall).max() <= 4 and beyond <= MOST and exact <= 4
            failed += [] if passes else [name]
            print(
                f"{name:36} Abbe {means[0]:.6f}  Mitsuba {means[1]:.6f}  z of the means {np.round(overall, 2)}  "
                f"pixels beyond {BEYOND}: {100 * beyond:.1f} %  {'ok' if passes else 'FAIL'}"
            )
    print("all agree" if not failed else "", *failed, sep="\n  FAILED: ")
    return int(bool(failed))


def has_llvm(mitsuba):
    try:
        mitsuba.set_variant("llvm_ad_rgb")
        mitsuba.load_dict({"type": "sphere"})
        return True
    except Exception:  # the library reports a missing LLVM by more than one kind of error
        return False
