"""Renders a scene file of Abbe in LuxCore, on one thread.

    picture = luxcore.Renderer("PATHCPU", Path("scene.toml")).picture(samples=64, seed=1)

Uses its Sobol sampler, no clamping, and paths of up to 64 surfaces. The variants: PATHCPU, its path tracer; BIDIRCPU,
bidirectional path tracing; "PATHCPU hybrid", its path tracer with half of the paths from the lights, for caustics;
"PATHCPU photons", its path tracer with its cache of caustic photons, whose radius shrinks.
"""

import atexit
import time
from pathlib import Path

import numpy as np
from .scene import parts, read, rgb, shapes, triangles

DEPTH = 64
WAYS = {
    "": {},
    "hybrid": {"path.hybridbackforward.enable": True, "path.hybridbackforward.partition": 0.5},
    "photons": {
        "path.photongi.sampler.type": "RANDOM",
        "path.photongi.photon.maxcount": 1_000_000,
        "path.photongi.photon.maxdepth": 16,
        "path.photongi.caustic.enabled": True,
        "path.photongi.caustic.maxsize": 100_000,
        "path.photongi.caustic.lookup.radius": 0.01,
        "path.photongi.caustic.updatespp": 8,
        "path.photongi.caustic.updatespp.radiusreduction": 0.96,
    },
}


class Renderer:
    """A scene in LuxCore, which is parsed anew for every picture."""

    def __init__(self, engine: str, path: Path, flat_lamp: bool = False):
        import pyluxcore

        pyluxcore.Init(lambda message: None)
        atexit.register(pyluxcore.SetLogHandler, None)  # otherwise its threads call a dead handler
        self.luxcore, self.path, self.flat_lamp = pyluxcore, path, flat_lamp
        self.engine, _, self.way = engine.partition(" ")

    def picture(self, samples: int, seed: int) -> np.ndarray:
        film = read(self.path)["film"]
        values = {
            "renderengine.type": self.engine,
            "renderengine.seed": seed,
            "native.threads.count": 1,
            "sampler.type": "SOBOL",
            "sampler.sobol.adaptive.strength": 0.0,
            "film.width": film["width"],
            "film.height": film["height"],
            "film.filter.type": "NONE",
            "film.outputs.0.type": "RGB",
            "film.outputs.0.filename": "unused.exr",
            "batch.haltspp": samples,
            **{f"path.pathdepth.{kind}": DEPTH for kind in ("total", "diffuse", "glossy", "specular")},
            "path.maxdepth": DEPTH,
            "light.maxdepth": DEPTH,
            **WAYS[self.way],
        }
        scene = luxcore_scene(self.luxcore, self.path, self.flat_lamp)
        session = self.luxcore.RenderSession(self.luxcore.RenderConfig(properties(self.luxcore, values), scene))
        session.Start()
        while not session.HasDone():
            time.sleep(0.02)
            session.UpdateStats()
        session.Stop()
        picture = np.zeros((film["height"], film["width"], 3), np.float32)
        session.GetFilm().GetOutputFloat(self.luxcore.FilmOutputType.RGB, picture)
        return upright(picture)


def upright(picture: np.ndarray) -> np.ndarray:
    """Returns the picture with the top row first.

    Without a filter LuxCore's rows lie one too high. The last row, which it lacks, becomes NaN."""
    result = np.roll(picture[::-1], -1, axis=0).astype(np.float64)
    result[-1] = np.nan
    return result


def properties(luxcore, values: dict):
    result = luxcore.Properties()
    for key, value in values.items():
        result.Set(luxcore.Property(key, value))
    return result


def luxcore_material(name: str, entry: dict) -> dict:
    kind, values = parts(entry)
    key = f"scene.materials.{name}"
    if kind == "diffuse":
        return {f"{key}.type": "matte", f"{key}.kd": rgb(values["reflectance"])}
    if kind == "mirror":
        return {f"{key}.type": "mirror", f"{key}.kr": rgb(values["reflectance"])}
    if kind == "dielectric":
        kr, kt = (rgb(values.get(way, 1.0)) for way in ("reflectance", "transmittance"))
        clear = {f"{key}.type": "glass", f"{key}.kr": kr, f"{key}.kt": kt}
        if isinstance(values["index"], dict):
            a, b = values["index"]["cauchy"]
            return {**clear, f"{key}.interiorior": a, f"{key}.cauchyb": b}
        return {**clear, f"{key}.interiorior": float(values["index"])}
    black = {f"{key}.type": "matte", f"{key}.kd": [0.0] * 3}
    return {**black, f"{key}.emission": rgb(values["radiance"]), f"{key}.emission.gain": [1.0] * 3}


def luxcore_light(light: dict) -> dict:
    if "environment" in light:
        return {".type": "constantinfinite", ".color": rgb(light["environment"]["radiance"]), ".gain": [1.0] * 3}
    spot = light["spot"]
    return {
        ".type": "spot",
        ".position": spot["position"],
        ".target": [place + way for place, way in zip(spot["position"], spot["toward"], strict=True)],
        ".coneangle": spot["cone_angle"] / 2,
        ".conedeltaangle": 0.0,
        ".color": rgb(spot["intensity"]),
        ".gain": [1.0] * 3,
    }


def luxcore_scene(luxcore, path: Path, flat_lamp: bool):
    scene = read(path)
    camera, film = scene["camera"], scene["film"]
    wider = max(film["width"] / film["height"], 1.0)  # its field of view is along the longer side
    half = np.tan(np.radians(camera["vertical_fov"]) / 2) * wider
    values = {
        "scene.camera.type": "perspective",
        "scene.camera.lookat.orig": camera["position"],
        "scene.camera.lookat.target": camera["look_at"],
        "scene.camera.up": camera.get("up", [0, 1, 0]),
        "scene.camera.fieldofview": float(2 * np.degrees(np.arctan(half))),
        "scene.camera.autofocus.enable": False,
    }
    if "near" in camera:
        values |= {"scene.camera.cliphither": float(camera["near"])}
    for number, light in enumerate(scene.get("light", [])):
        key = f"scene.lights.light{number}"
        values.update({key + name: value for name, value in luxcore_light(light).items()})
    for name, entry in scene["material"].items():
        values.update(luxcore_material(name, entry))
    result = luxcore.Scene()
    for number, (kind, shape, material) in enumerate(shapes(scene, flat_lamp)):
        if "file" in shape:
            values |= {f"scene.shapes.mesh{number}.type": "mesh"}
            values |= {f"scene.shapes.mesh{number}.ply": str(path.parent / shape["file"])}
        else:
            points, faces, normals = triangles(kind, shape, path.parent)
            rows = lambda array, of: [tuple(map(of, row)) for row in array]  # noqa: E731
            normals = None if normals is None else rows(normals, float)
            result.DefineMesh(f"mesh{number}", rows(points, float), rows(faces, int), normals, None, None, None)
        values[f"scene.objects.object{number}.shape"] = f"mesh{number}"
        values[f"scene.objects.object{number}.material"] = material
    result.Parse(properties(luxcore, values))
    return result
