"""Reads a scene file for the classic backward tracer: its shapes, by the tracer's own formulas, and its materials.

    from classic.scene import read_scene
    scene = read_scene("scenes/classic.toml")

Shapes: plane, triangle, mesh of triangles, sphere, disc. Materials: diffuse, emissive, mirror, dielectric. Lights:
point, environment.
"""

import tomllib
from typing import NamedTuple

import numpy as np


def unit(vector):
    return vector / np.linalg.norm(vector, axis=-1, keepdims=True)


def dot(a, b):
    return np.einsum("...i,...i", a, b)


class Plane:
    """The plane n.r + W = 0."""

    def __init__(self, point, normal):
        self.n = unit(np.array(normal, float))
        self.W = -dot(self.n, np.array(point, float))

    def distance(self, origin, direction, leaving):
        """Returns the distance along each ray, infinite without a hit. A ray `leaving` here never comes back."""
        t = -(origin @ self.n + self.W) / (direction @ self.n)
        return np.where((t > 0) & ~leaving & self.holds(origin + t[:, None] * direction), t, np.inf)

    def holds(self, point):
        return np.isfinite(point[:, 0])

    def normal(self, point):
        return np.broadcast_to(self.n, point.shape)


class Triangle(Plane):
    """p1 + u e1 + v e2 with u, v >= 0 and u + v <= 1; counterclockwise when seen from its front."""

    def __init__(self, points):
        self.p1, p2, p3 = np.array(points, float)
        e1, e2 = p2 - self.p1, p3 - self.p1
        s = dot(np.cross(e1, e2), np.cross(e1, e2))
        self.k1 = (dot(e2, e2) * e1 - dot(e1, e2) * e2) / s
        self.k2 = (dot(e1, e1) * e2 - dot(e1, e2) * e1) / s
        super().__init__(self.p1, np.cross(e1, e2))

    def holds(self, point):
        d = point - self.p1
        u, v = d @ self.k1, d @ self.k2
        return (u >= 0) & (v >= 0) & (u + v <= 1)


class Disc(Plane):
    """The points of a plane with |r - p1|^2 < R^2."""

    def __init__(self, center, normal, radius):
        super().__init__(center, normal)
        self.p1, self.radius = np.array(center, float), radius

    def holds(self, point):
        return dot(point - self.p1, point - self.p1) < self.radius**2


class Sphere:
    """A sphere: t = n.d -+ s with s^2 = R^2 - |d x n|^2, where d leads from the ray's origin to the center."""

    def __init__(self, center, radius):
        self.center, self.radius = np.array(center, float), radius

    def distance(self, origin, direction, leaving):
        """Returns the distance along each ray. One that is `leaving` has a root of 0, and only the other counts."""
        d = self.center - origin
        middle = dot(direction, d)
        cross = np.cross(d, direction)
        s = np.sqrt(np.maximum(self.radius**2 - dot(cross, cross), 0))
        near, far = middle - s, middle + s
        t = np.where(leaving, np.where(middle > 0, far, np.inf), np.where(near > 0, near, far))
        return np.where((s > 0) & (t > 0), t, np.inf)

    def normal(self, point):
        return unit(point - self.center)


class Material(NamedTuple):
    """A material of any kind; every quantity holds one number per band."""

    kind: str
    reflectance: np.ndarray
    transmittance: np.ndarray
    emission: np.ndarray
    absorption: np.ndarray
    index: np.ndarray
    both_sides: bool


class Scene(NamedTuple):
    shapes: list
    material_of: np.ndarray
    materials: list
    lights: list
    environment: np.ndarray
    camera: dict
    film: dict


def bands(value):
    return np.array(value["rgb"] if isinstance(value, dict) else [value] * 3, float)


def read_material(entry):
    ((kind, values),) = entry.items()
    emission = values.get("emission", values.get("radiance", 0))
    numbers = [values.get("reflectance", 1), values.get("transmittance", 1), emission, values.get("absorption", 0)]
    both_sides = values.get("sides", "both") == "both"
    return Material(kind, *map(bands, numbers), bands(values.get("index", 1)), both_sides)


def read_shapes(entry):
    ((kind, values),) = entry.items()
    if kind == "mesh":
        points = np.array(values["points"], float)
        return [Triangle(points[face]) for face in values["faces"]]
    return [{"plane": Plane, "triangle": Triangle, "disc": Disc, "sphere": Sphere}[kind](**values)]


def read_scene(path):
    with open(path, "rb") as file:
        toml = tomllib.load(file)
    names = list(toml["material"])
    shapes, material_of = [], []
    for entry in toml["object"]:
        found = read_shapes(entry["shape"])
        shapes += found
        material_of += [names.index(entry["material"])] * len(found)
    lights = [light["point"] for light in toml.get("light", []) if "point" in light]
    skies = [light["environment"] for light in toml.get("light", []) if "environment" in light]
    environment = sum((bands(sky["radiance"]) for sky in skies), np.zeros(3))
    materials = [read_material(toml["material"][name]) for name in names]
    return Scene(shapes, np.array(material_of), materials, lights, environment, toml["camera"], toml["film"])
