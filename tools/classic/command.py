"""A classic backward ray tracer, written independently from its formulas, as a reference for the renderer's images.

    python tools/classic.py [scenes/classic.toml]    # renders it both ways; exit code 1 if they disagree

Rays start at pixel centers and carry one weight per band. Each generation of rays is one set of arrays: find the
nearest surface, add its emission and direct light, split into reflected and transmitted rays, and continue until the
weights are small. There are no random numbers. Diffuse surfaces are lit by point lights only. The index outside of all
bodies is 1, and bodies do not overlap.
"""

import argparse
from pathlib import Path
from typing import NamedTuple

import numpy as np
import render

from .scene import bands, dot, read_scene, unit

SMALLEST_WEIGHT = 1e-9
TOLERANCE, FLOOR = 1e-5, 1e-3


class Rays(NamedTuple):
    pixel: np.ndarray
    origin: np.ndarray
    direction: np.ndarray
    weight: np.ndarray  # per band, without the factor that refraction puts on radiance
    scale: np.ndarray  # the factor from refraction: the product of all (n1 / n2)^2
    body: np.ndarray  # the material around the ray, -1 outside
    last: np.ndarray  # the surface that it leaves, -1 at the camera

    def pick(self, rows, **changes):
        return Rays(*(values[rows] for values in self))._replace(**changes)


def camera_rays(camera, film):
    """Returns one ray through the center of each pixel, rows from the top."""
    width, height = film["width"], film["height"]
    position, target = np.array(camera["position"], float), np.array(camera["look_at"], float)
    forward = unit(target - position)
    right = unit(np.cross(forward, np.array(camera.get("up", [0, 1, 0]), float)))
    y, x = np.divmod(np.arange(width * height), width)
    half_height = np.tan(np.radians(camera["vertical_fov"]) / 2)
    sx = (2 * (x + 0.5) / width - 1) * half_height * width / height
    sy = (1 - 2 * (y + 0.5) / height) * half_height
    direction = unit(forward + sx[:, None] * right + sy[:, None] * np.cross(right, forward))
    origin = position + direction * (camera.get("near", 0) / (direction @ forward))[:, None]
    pixel = np.arange(width * height)
    nothing = np.full_like(pixel, -1)
    return Rays(pixel, origin, direction, np.ones((len(pixel), 3)), np.ones(len(pixel)), nothing, nothing)


def nearest(scene, rays):
    """Returns the distance and the number of the first surface on each ray."""
    distances = [shape.distance(rays.origin, rays.direction, rays.last == i) for i, shape in enumerate(scene.shapes)]
    surface = np.argmin(distances, axis=0)
    return np.min(distances, axis=0), surface


def direct_light(scene, rays, point, normal, reflectance):
    """Returns Lambert reflection of point lights: reflectance / pi x intensity x cos / d^2, or 0 in shadow."""
    total = np.zeros_like(point)
    for light in scene.lights:
        to_light = np.array(light["position"], float) - point
        distance = np.linalg.norm(to_light, axis=-1)
        shadow = rays._replace(origin=point, direction=to_light / distance[:, None])
        lit = nearest(scene, shadow)[0] >= distance
        cosine = np.maximum(dot(shadow.direction, normal), 0)
        total += (lit * cosine / distance**2)[:, None] * reflectance / np.pi * bands(light["intensity"])
    return total


def fresnel(cosine, n1, n2):
    """Returns unpolarized reflectance and cosine of refraction, 1 and 0 at total reflection (Hecht, Optics, 4.6)."""
    cosine = cosine[:, None]
    cosine_t = np.sqrt(np.maximum(1 - (n1 / n2) ** 2 * (1 - cosine**2), 0))
    s = (n1 * cosine - n2 * cosine_t) / (n1 * cosine + n2 * cosine_t)
    p = (n2 * cosine - n1 * cosine_t) / (n2 * cosine + n1 * cosine_t)
    return np.where(cosine_t > 0, (s**2 + p**2) / 2, 1.0), cosine_t


def reflected(rays, normal, weight):
    direction = rays.direction - 2 * dot(rays.direction, normal)[:, None] * normal
    return rays._replace(direction=unit(direction), weight=weight)


def split(rays, normal, entering, material, number):
    """Yields the reflected ray and one transmitted ray per distinct index; `normal` faces the arriving ray."""
    cosine = -dot(rays.direction, normal)
    n1 = np.where(entering[:, None], 1.0, material.index)
    n2 = np.where(entering[:, None], material.index, 1.0)
    share, cosine_t = fresnel(cosine, n1, n2)
    yield reflected(rays, normal, rays.weight * material.reflectance * share)
    for index in np.unique(material.index):
        band = np.flatnonzero(material.index == index)[0]
        eta = n1[:, band] / n2[:, band]
        bent = eta[:, None] * rays.direction + (eta * cosine - cosine_t[:, band])[:, None] * normal
        weight = rays.weight * material.transmittance * (1 - share) * (material.index == index)
        body = np.where(entering, number, -1)
        yield rays._replace(direction=unit(bent), weight=weight, scale=rays.scale * eta**2, body=body)


def scatter(scene, rays, normal, front, number):
    """Returns the light that leaves one material toward the arriving rays, and the rays that continue from there."""
    material = scene.materials[number]
    facing = np.where(front[:, None], normal, -normal)
    if material.kind == "diffuse":
        return direct_light(scene, rays, rays.origin, facing, material.reflectance), []
    if material.kind == "emissive":
        return material.emission * (front | material.both_sides)[:, None], []
    if material.kind == "mirror":
        return 0, [reflected(rays, facing, rays.weight * material.reflectance)]
    return material.emission, list(split(rays, facing, front, material, number))


def step(scene, rays, image):
    """Traces rays to their next surface, adds the light found there to the image, and returns rays that continue."""
    distance, surface = nearest(scene, rays)
    miss = np.isinf(distance)
    np.add.at(image, rays.pixel[miss], (rays.weight * rays.scale[:, None])[miss] * scene.environment)
    rays, distance, surface = rays.pick(~miss), distance[~miss], surface[~miss]
    absorption = np.array([material.absorption for material in scene.materials] + [np.zeros(3)])
    point = rays.origin + distance[:, None] * rays.direction
    weight = rays.weight * np.exp(-absorption[rays.body] * distance[:, None])
    rays = rays._replace(origin=point, weight=weight, last=surface)
    normal = np.zeros_like(point)
    for i in np.unique(surface):
        normal[surface == i] = scene.shapes[i].normal(point[surface == i])
    front = dot(rays.direction, normal) < 0
    children = [rays.pick(slice(0, 0))]
    for number in np.unique(scene.material_of[surface]):
        rows = scene.material_of[surface] == number
        arriving = rays.pick(rows)
        shining, leaving = scatter(scene, arriving, normal[rows], front[rows], number)
        np.add.at(image, arriving.pixel, arriving.weight * arriving.scale[:, None] * shining)
        children += leaving
    rays = Rays(*map(np.concatenate, zip(*children, strict=True)))
    return rays.pick(rays.weight.mean(axis=1) >= SMALLEST_WEIGHT)


def trace(scene):
    """Returns the image, height x width x 3."""
    width, height = scene.film["width"], scene.film["height"]
    image = np.zeros((width * height, 3))
    rays = camera_rays(scene.camera, scene.film)
    with np.errstate(divide="ignore", invalid="ignore"):
        while len(rays.pixel):
            rays = step(scene, rays, image)
    return image.reshape(height, width, 3)


def error(image, expected):
    """Returns the difference per pixel and band, in units of the tolerance 1e-5 x max(|expected|, 1e-3)."""
    return np.abs(image - expected) / (TOLERANCE * np.maximum(np.abs(expected), FLOOR))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", metavar="SCENE", nargs="?", default=render.SCENES / "classic.toml")
    path = parser.parse_args().scene
    expected = trace(read_scene(path))
    image = render.render(Path(path)).rgb
    errors = error(image, expected)
    y, x, band = np.unravel_index(np.argmax(errors), errors.shape)
    print(f"{np.count_nonzero(errors > 1)} of {errors.size} values disagree")
    print(f"worst: pixel ({x}, {y}) band {band}: {image[y, x, band]:.9g}, expected {expected[y, x, band]:.9g},")
    print(f"       {errors[y, x, band]:.3g} x tolerance")
    return int(errors.max() > 1)
