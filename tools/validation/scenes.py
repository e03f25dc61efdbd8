"""Scenes as dictionaries, and their conversion to the TOML that the renderer reads.

text = toml_file(view({}, [], [SKY], eye=(0, 0, 1)))
"""

import numpy as np

SKY = {"environment": {"radiance": 1}}


def toml_file(scene):
    return "".join(f"{key} = {toml(value)}\n" for key, value in scene.items())


def toml(value):
    """Returns an inline TOML value."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {toml(item)}" for key, item in value.items()) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(toml, value)) + "]"
    if isinstance(value, (bool, str)):
        return f'"{value}"' if isinstance(value, str) else str(value).lower()
    return repr(value) if isinstance(value, int) else repr(float(value))


def rgb(values):
    return {"rgb": [float(value) for value in values]}


def vector(values):
    return [float(value) for value in values]


def view(
    materials,
    objects,
    lights=(),
    *,
    eye,
    target=(0, 0, 0),
    up=(0, 1, 0),
    fov=1e-4,
    height=None,
    size=(1, 1),
    near=0,
    space=None,
    **settings,
):
    """Returns a scene; `objects` pairs each material's name with a shape.

    The camera is orthographic if a `height` is given, else a pinhole. Without `samples`, one ray goes through each
    pixel's center, so nothing is random if all surfaces are smooth."""
    size = (size, size) if isinstance(size, int) else size
    camera = {"position": vector(eye), "look_at": vector(target), "up": vector(up), "near": near}
    lens = {"vertical_fov": fov} if height is None else {"projection": "orthographic", "height": height}
    film = {"width": size[0], "height": size[1], "filter": "box" if "samples" in settings else "center"}
    return {
        "camera": camera | lens,
        "film": film | ({"color_space": space} if space else {}),
        "render": {"model": "rgb"} | settings,
        "material": materials,
        "object": [{"material": name, "shape": shape} for name, shape in objects],
        "light": list(lights),
    }


def sphere(center=(0, 0, 0), radius=1.0):
    return {"sphere": {"center": vector(center), "radius": radius}}


def cube(center=(0, 0, 0), size=1.5):
    return {"cube": {"center": vector(center), "size": size}}


def plane(point, normal):
    return {"plane": {"point": vector(point), "normal": vector(normal)}}


def quad(center, u, v):
    return {"quad": {"center": vector(center), "u": vector(u), "v": vector(v)}}


def disc(center, normal, radius):
    return {"disc": {"center": vector(center), "normal": vector(normal), "radius": radius}}


def diffuse(reflectance):
    return {"diffuse": {"reflectance": reflectance}}


def glow(radiance=1, **more):
    return {"emissive": {"radiance": radiance, **more}}


def sun(degrees, irradiance=1.0, angular_diameter=0):
    """Returns a sun at an angle from straight above, toward +x."""
    angle = np.radians(degrees)
    toward = [float(np.sin(angle)), float(np.cos(angle)), 0.0]
    return {"sun": {"toward": toward, "angular_diameter": angular_diameter, "irradiance": irradiance}}


def glass(index, **more):
    return {"dielectric": {"index": index, **more}}


def extrude(polygon, y, half_height):
    """Returns a mesh over a convex polygon of (x, z), with its faces outward."""
    low, high = ([[x, y + side * half_height, z] for x, z in polygon] for side in (-1, 1))
    points, n = np.array(low + high, float), len(polygon)
    faces = [[0, i, i + 1] for i in range(1, n - 1)] + [[n, n + i, n + i + 1] for i in range(1, n - 1)]
    for i in range(n):
        j = (i + 1) % n
        faces += [[i, j, n + j], [i, n + j, n + i]]
    center = points.mean(axis=0)
    for face in faces:
        a, b, c = points[face]
        if np.dot(np.cross(b - a, c - a), a - center) < 0:
            face[1], face[2] = face[2], face[1]
    return {"mesh": {"points": points.tolist(), "faces": faces}}
