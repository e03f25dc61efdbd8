"""Reads a scene file of Abbe for other renderers: its camera, shapes, materials and lights, and spheres as triangles.

    shapes(read("scene.toml"))      # [(kind, values, material), ..]

Supports what the scenes of tools/chart/scenes.py use: perspective cameras; quads, cubes, spheres and meshes; diffuse,
mirror, dielectric, thin and emissive materials; a uniform sky and a sun. Spheres above a radius of 1e4, the walls of
smallpt, become the squares that they stand for. `flat_lamp` also replaces the tip of a huge spherical lamp by a disc,
which every renderer can sample.
"""

import tomllib
from pathlib import Path

import numpy as np
from gallery.shapes import write_ply

WALL, LAMP = 1e4, 100.0
BALL = (256, 512)  # rings and sectors of a triangulated sphere
BUMPY = (810, 810)  # rings and sectors of the bumpy ball


def read(path: Path) -> dict:
    with open(path, "rb") as file:
        return tomllib.load(file)


def rgb(value) -> list[float]:
    return [float(x) for x in (value["rgb"] if isinstance(value, dict) else [value] * 3)]


def parts(entry: dict) -> tuple[str, dict]:
    """Returns kind and values of a shape or a material."""
    ((kind, values),) = entry.items()
    return kind, values


def quad_triangles(center, u, v) -> tuple[np.ndarray, np.ndarray]:
    center, u, v = (np.array(x, float) for x in (center, u, v))
    return np.array([center - u - v, center + u - v, center + u + v, center - u + v]), np.array([[0, 1, 2], [0, 2, 3]])


def box(center, size) -> dict:
    """Returns the mesh of a cube, facing outward."""
    half = np.broadcast_to(np.array(size, float), 3) / 2
    ends = np.array(center, float) - half, np.array(center, float) + half
    points = [[float(ends[corner >> axis & 1][axis]) for axis in range(3)] for corner in range(8)]
    sides = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
    return {"points": points, "faces": [face for a, b, c, d in sides for face in ([a, b, c], [a, c, d])]}


def lights(scene: dict, kind: str) -> list[dict]:
    """Returns the values of all lights of a kind, without emissive objects."""
    return [light[kind] for light in scene.get("light", []) if kind in light]


def wall(center: np.ndarray, radius: float, room: np.ndarray) -> dict:
    """Returns the side of the room that a huge sphere stands for, as a quad that faces inward."""
    middle = room.mean(axis=0)
    axis = int(np.abs(center - middle).argmax())
    sign = np.sign(center - middle)[axis]
    half = (room[1] - room[0]) / 2
    at = middle.copy()
    at[axis] = center[axis] - sign * radius
    u, v = np.zeros(3), np.zeros(3)
    u[(axis + 1) % 3], v[(axis + 2) % 3] = half[(axis + 1) % 3] * -sign, half[(axis + 2) % 3]
    return {"center": at, "u": u, "v": v}


def shapes(scene: dict, flat_lamp: bool = False) -> list[tuple[str, dict, str]]:
    """Returns kind, values and material of each object; huge spheres are quads, a huge lamp the disc of its rim."""
    found = [(*parts(entry["shape"]), entry["material"]) for entry in scene["object"]]
    huge = [values for kind, values, _ in found if kind == "sphere" and values["radius"] > WALL]
    if huge:
        room = np.array([[np.inf] * 3, [-np.inf] * 3])
        anchor = np.median([values["center"] for values in huge], axis=0)
        for values in huge:
            axis = int(np.abs(values["center"] - anchor).argmax())
            sign = np.sign(values["center"][axis] - anchor[axis])
            room[int(sign < 0), axis] = values["center"][axis] - sign * values["radius"]  # the room is inside it
    result = []
    for kind, values, material in found:
        if kind == "sphere" and values["radius"] > WALL:
            kind, values = "quad", wall(np.array(values["center"], float), values["radius"], room)
        elif kind == "sphere" and values["radius"] > LAMP and flat_lamp:
            (x, y, z), radius = values["center"], values["radius"]
            rim = float(np.sqrt(radius**2 - (y - room[1, 1]) ** 2))
            kind, values = "disc", {"center": [x, y - radius, z], "normal": [0, -1, 0], "radius": rim}
        elif kind == "cube":
            kind, values = "mesh", box(values["center"], values["size"])
        result.append((kind, values, material))
    return result


def bumpy_ball(rings: int, sectors: int) -> tuple[np.ndarray, np.ndarray]:
    """Returns points and triangles of a ball with bumps, closed and facing outward."""
    theta = np.pi * (np.arange(1, rings) / rings)[:, None]
    phi = 2 * np.pi * (np.arange(sectors) / sectors)[None]
    bumps = np.sin(9 * theta) * np.sin(12 * phi) + 0.3 * np.sin(61 * theta) * np.sin(80 * phi)
    radius = 1 + 0.12 * bumps * np.sin(theta) ** 2
    directions = np.stack([np.sin(theta) * np.cos(phi), np.cos(theta) + 0 * phi, np.sin(theta) * np.sin(phi)], -1)
    points = np.concatenate([[[0, 1, 0]], (radius[..., None] * directions).reshape(-1, 3), [[0, -1, 0]]])
    ring, sector = np.mgrid[0 : rings - 2, 0:sectors]
    a, b = (1 + ring * sectors + place for place in (sector, (sector + 1) % sectors))
    quads = [np.stack(corners, -1).reshape(-1, 3) for corners in ((a, b, b + sectors), (a, b + sectors, a + sectors))]
    here, there, last = np.arange(sectors), (np.arange(sectors) + 1) % sectors, len(points) - 1
    low = 1 + (rings - 2) * sectors
    poles = [np.stack([0 * here, 1 + there, 1 + here], -1), np.stack([last + 0 * here, low + here, low + there], -1)]
    return points, np.concatenate(quads + poles)


def write_bumpy_ball(path: Path, rings: int = BUMPY[0], sectors: int = BUMPY[1]) -> None:
    """Writes a bumpy ball, by default of 1.3 million triangles, as a PLY file."""
    write_ply(path, *bumpy_ball(rings, sectors))


def ball(center, radius: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Returns points, triangles and normals of a sphere."""
    rings, sectors = BALL
    theta, phi = np.pi * np.arange(rings + 1)[:, None] / rings, 2 * np.pi * np.arange(sectors + 1)[None] / sectors
    normals = np.stack([np.sin(theta) * np.cos(phi), np.cos(theta) + 0 * phi, np.sin(theta) * np.sin(phi)], -1)
    ring, sector = (index.ravel() for index in np.mgrid[0:rings, 0:sectors])
    corner = ring * (sectors + 1) + sector
    below = corner + sectors + 1
    upper, lower = np.stack([corner, corner + 1, below + 1], -1), np.stack([corner, below + 1, below], -1)
    faces = np.concatenate([upper[ring > 0], lower[ring < rings - 1]])
    return np.array(center) + radius * normals.reshape(-1, 3), faces, normals.reshape(-1, 3)


def read_ply(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Returns points and triangles of a file from write_bumpy_ball."""
    header, body = path.read_bytes().split(b"end_header\n", 1)
    count = int(header.split(b"element vertex ")[1].split()[0])
    points = np.frombuffer(body[: 12 * count], "<f4").reshape(-1, 3)
    faces = np.frombuffer(body[12 * count :], [("count", "u1"), ("corners", "<i4", 3)])["corners"]
    return points.astype(float), faces


def disc_triangles(center, normal, radius: float, sectors: int = 256) -> tuple[np.ndarray, np.ndarray]:
    """Returns a triangle fan that faces along the normal and has the area of the disc."""
    normal = np.array(normal, float) / np.linalg.norm(normal)
    u = np.cross(normal, np.roll(normal, 1))
    u /= np.linalg.norm(u)
    angle = 2 * np.pi / sectors * np.arange(sectors)[:, None]
    outer = radius * np.sqrt(2 * np.pi / sectors / np.sin(2 * np.pi / sectors))
    rim = np.array(center) + outer * (np.cos(angle) * u + np.sin(angle) * np.cross(normal, u))
    number = np.arange(sectors)
    faces = np.stack([0 * number, 1 + number, 1 + (number + 1) % sectors], -1)
    return np.concatenate([[np.array(center, float)], rim]), faces


def triangles(kind: str, values: dict, folder: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
    """Returns points, faces and, for smooth shapes, normals of any shape."""
    if kind == "sphere":
        return ball(**values)
    if kind == "disc":
        return *disc_triangles(**values), None
    if kind == "quad":
        return *quad_triangles(**values), None
    if "file" in values:
        return *read_ply(folder / values["file"]), None
    return np.array(values["points"], float), np.array(values["faces"]), None
