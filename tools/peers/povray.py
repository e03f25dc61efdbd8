"""Writes a scene file of Abbe in POV-Ray 3.7's language, and the command that renders it at one of several qualities.

    command = povray.command(Path("scene.toml"), quality=2, seed=1, folder=Path("out"))

POV-Ray has no path tracer. Lamps become area lights of many points, whose beams fall off with the cosine and the
squared distance. Light between matte surfaces is radiosity, interpolated between samples, to a limited depth. It takes
no seed, so its noise cannot be separated from its bias, and only a common reference can judge it. Quality, 1 to 4,
raises the number of points of the lamp, the rays and the density of radiosity, and the samples of a pixel. Only scenes
of diffuse and emissive quads and meshes are supported. Its photons for caustics are another approximation, left out.
"""

import subprocess
from pathlib import Path

import numpy as np
import render

from .scene import parts, read, rgb, shapes, triangles


def version() -> str:
    run = subprocess.run(["povray", "--version"], capture_output=True, text=True, check=False)
    return next(line.strip() for line in (run.stderr + run.stdout).splitlines() if line.startswith("POV-Ray"))


def vector(values) -> str:
    return "<" + ", ".join(f"{float(x):.9g}" for x in values) + ">"


def camera_text(camera: dict, film: dict) -> str:
    position = np.array(camera["position"], float)
    forward = np.array(camera["look_at"], float) - position
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, camera.get("up", [0, 1, 0]))
    right /= np.linalg.norm(right)
    height = 2 * np.tan(np.radians(camera["vertical_fov"]) / 2)
    right, up = right * height * film["width"] / film["height"], np.cross(right, forward) * height
    return (
        f"camera {{ location {vector(position)} right {vector(right)} up {vector(up)} direction {vector(forward)} }}\n"
    )


def mesh_text(mesh: tuple, material: str) -> str:
    points, faces, _ = mesh
    corners = ("triangle { " + ", ".join(vector(points[i]) for i in face) + " }" for face in faces)
    return "mesh {\n" + "\n".join(corners) + "\n" + material + "}\n"


def lamp_text(quad: dict, radiance: list[float], side: int) -> str:
    """Returns a parallelogram that emits to its front: points whose light falls off with cosine and distance^2."""
    center, u, v = (np.array(quad[key], float) for key in ("center", "u", "v"))
    normal = np.cross(u, v)
    area = 4 * np.linalg.norm(normal)
    normal /= np.linalg.norm(normal)
    tiny = 1e-3 * np.sqrt(area)  # the fall-off is 2 / (1 + (d / fade_distance)^2)
    color = np.array(radiance) * area / np.pi / (2 * tiny**2)
    beam = f"spotlight radius -90 falloff 90 tightness 1 point_at {vector(center + normal)}"
    points = f"area_light {vector(2 * u)}, {vector(2 * v)}, {side}, {side} jitter area_illumination on"
    fall = f"fade_distance {tiny:.9g} fade_power 2"
    return f"light_source {{ {vector(center)}, rgb {vector(color)} {beam} {points} {fall} }}\n"


def scene_text(path: Path, quality: int) -> str:
    scene = read(path)
    rays = 50 * 2 ** (quality - 1)
    finer = 2 ** ((1 - quality) / 2)
    radiosity = (
        f"count {rays} error_bound {0.8 * finer:.3f} nearest_count 8 recursion_limit {3 + quality} gray_threshold 0 "
        f"pretrace_start 0.08 pretrace_end {0.04 * finer:.4f} minimum_reuse {0.015 * finer:.4f} brightness 1 "
        "low_error_factor 0.5 adc_bailout 0.001"
    )
    limits = f"max_trace_level {8 + quality} adc_bailout 0.0001"
    text = [f"#version 3.7;\nglobal_settings {{ assumed_gamma 1 {limits} radiosity {{ {radiosity} }} }}\n"]
    text.append(camera_text(scene["camera"], scene["film"]))
    for kind, values, name in shapes(scene):
        of, material = parts(scene["material"][name])
        mesh = triangles(kind, values, path.parent)
        if of == "diffuse":
            finish = "finish { ambient 0 diffuse 1 }"
            text.append(mesh_text(mesh, f"pigment {{ rgb {vector(rgb(material['reflectance']))} }} {finish} "))
        else:
            text.append(lamp_text(values, rgb(material["radiance"]), 2 + 2 * quality))
            glow = f"pigment {{ rgb {vector(rgb(material['radiance']))} }} finish {{ ambient 0 diffuse 0 emission 1 }} "
            text.append(mesh_text(mesh, glow + "no_shadow no_radiosity "))
    return "".join(text)


def command(path: Path, quality: int, seed: int, folder: Path) -> list:
    """Writes the scene and returns the command that renders it. POV-Ray takes no seed, so `seed` has no effect."""
    source = folder / "scene.pov"
    source.write_text(scene_text(path, quality), "utf-8")
    film = read(path)["film"]
    size = [f"+W{film['width']}", f"+H{film['height']}"]
    samples = ["+AM1", "+A0.0", f"+R{2 + quality}", "-J"]
    out = [f"+I{source}", f"+O{folder / 'povray.exr'}", "+FE", "File_Gamma=1.0", "-D", "-GA"]
    return ["povray", *out, *size, *samples, "+WT1"]


def read_picture(folder: Path) -> np.ndarray:
    return render.read(folder / "povray.exr").rgb
