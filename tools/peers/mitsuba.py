"""Renders a scene file of Abbe in Mitsuba 3: in any of its variants, on one thread.

    picture = mitsuba.Renderer("llvm_ad_rgb", Path("scene.toml")).picture(samples=64, seed=1)
"""

import zlib
from pathlib import Path

import numpy as np
from .scene import lights, parts, read, rgb, shapes


class Renderer:
    """A scene loaded into a variant of Mitsuba."""

    def __init__(self, variant: str, path: Path, flat_lamp: bool = False):
        import drjit
        import mitsuba

        mitsuba.set_variant(variant)
        drjit.set_thread_count(1)
        self.render = mitsuba.render
        self.scene = mitsuba.load_dict(mitsuba_scene(mitsuba, path, flat_lamp))

    def picture(self, samples: int, seed: int) -> np.ndarray:
        return np.array(self.render(self.scene, spp=samples, seed=seed), np.float64)


def mitsuba_material(entry: dict) -> dict:
    """Returns the BSDF, and an `emitter` if the material emits light."""
    kind, values = parts(entry)
    color = lambda value: {"type": "rgb", "value": rgb(value)}  # noqa: E731
    if kind == "diffuse":
        inside = {"type": "diffuse", "reflectance": color(values["reflectance"])}
        return {"bsdf": {"type": "twosided", "inside": inside}}
    if kind == "mirror":
        metal = {"type": "conductor", "material": "none", "specular_reflectance": color(values["reflectance"])}
        return {"bsdf": {"type": "twosided", "inside": metal}}
    if kind == "dielectric":
        ways = {f"specular_{way}": color(values.get(way, 1.0)) for way in ("reflectance", "transmittance")}
        return {"bsdf": {"type": "dielectric", "int_ior": values["index"], "ext_ior": 1.0, **ways}}
    if kind == "thin":
        return {"bsdf": {"type": "thindielectric", "int_ior": values["index"], "ext_ior": 1.0}}
    black = {"type": "diffuse", "reflectance": color(0.0)}
    return {"bsdf": black, "emitter": {"type": "area", "radiance": color(values["radiance"])}}


def mitsuba_shape(mitsuba, kind: str, values: dict, folder: Path) -> dict:
    transform = mitsuba.ScalarTransform4f
    if kind == "quad":
        center, u, v = (np.array(values[key], float) for key in ("center", "u", "v"))
        normal = np.cross(u, v)
        matrix = np.eye(4)
        matrix[:3] = np.stack([u, v, normal / np.linalg.norm(normal), center], axis=1)
        return {"type": "rectangle", "to_world": transform(matrix)}
    if kind == "sphere":
        return {"type": "sphere", "center": [float(x) for x in values["center"]], "radius": float(values["radius"])}
    if kind == "disc":
        center, normal = np.array(values["center"], float), np.array(values["normal"], float)
        look = transform().look_at(origin=center, target=center + normal, up=np.roll(normal, 1))
        return {"type": "disk", "to_world": look.scale(values["radius"])}
    if "file" in values:
        return {"type": "ply", "filename": str(folder / values["file"]), "face_normals": True}
    path = folder / f"mesh{zlib.crc32(repr(values).encode())}.obj"
    points = (f"v {x} {y} {z}" for x, y, z in values["points"])
    faces = (f"f {a + 1} {b + 1} {c + 1}" for a, b, c in values["faces"])
    path.write_text("\n".join([*points, *faces]) + "\n")
    return {"type": "obj", "filename": str(path), "face_normals": True}


def far_disc(mitsuba, sun: dict, distance: float = 1e4) -> dict:
    """Returns a sun as a distant disc, which paths can also hit by chance: Mitsuba samples no light behind a pane."""
    toward = np.array(sun["toward"], float) / np.linalg.norm(sun["toward"])
    half = np.radians(sun.get("angular_diameter", 0.533)) / 2
    at = toward * distance
    look = mitsuba.ScalarTransform4f().look_at(origin=at, target=[0, 0, 0], up=np.roll(toward, 1))
    radiance = [x / (np.pi * np.sin(half) ** 2) for x in rgb(sun["irradiance"])]
    emitter = {"type": "area", "radiance": {"type": "rgb", "value": radiance}}
    return {"type": "disk", "to_world": look.scale(float(distance * np.tan(half))), "emitter": emitter}


def mitsuba_scene(mitsuba, path: Path, flat_lamp: bool = False) -> dict:
    """Returns the scene for mitsuba.load_dict, with the multijitter sampler and the path integrator's defaults."""
    scene = read(path)
    camera, film = scene["camera"], scene["film"]
    look = mitsuba.ScalarTransform4f().look_at(
        origin=camera["position"], target=camera["look_at"], up=camera.get("up", [0, 1, 0])
    )
    picture = {"width": film["width"], "height": film["height"], "pixel_format": "rgb"}
    result = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": -1},
        "sensor": {
            "type": "perspective",
            "fov": camera["vertical_fov"],
            "fov_axis": "y",
            "near_clip": camera.get("near", 1e-2),
            "to_world": look,
            "film": {"type": "hdrfilm", **picture, "rfilter": {"type": "box"}, "component_format": "float32"},
            "sampler": {"type": "multijitter"},
        },
    }
    for number, (kind, values, material) in enumerate(shapes(scene, flat_lamp)):
        shape = mitsuba_shape(mitsuba, kind, values, Path(path).parent)
        result[f"object{number}"] = {**shape, **mitsuba_material(scene["material"][material])}
    for number, sky in enumerate(lights(scene, "environment")):
        result[f"sky{number}"] = {"type": "constant", "radiance": {"type": "rgb", "value": rgb(sky["radiance"])}}
    for number, sun in enumerate(lights(scene, "sun")):
        result[f"sun{number}"] = far_disc(mitsuba, sun)
    return result
