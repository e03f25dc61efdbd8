"""A scene file of Abbe for Mitsuba and LuxCore: the same camera, shapes, materials and lights.

    scene = mitsuba.load_dict(peers_scene.mitsuba_scene(mitsuba, "scene.toml"))
    picture = peers_scene.luxcore_picture(pyluxcore, "scene.toml", samples=64, seed=1)

Knows what the scenes of tools/peers.py hold: perspective cameras; quads, spheres and meshes; diffuse, mirror, dielectric and
emissive materials; an even sky. Spheres above a radius of 1e4, the walls of smallpt, become the squares they stand for;
`flat_lamp` lets a disc stand for the tip of a huge lamp as well.
"""

import time
import tomllib
import zlib
from pathlib import Path

import numpy as np

WALL, LAMP = 1e4, 100.0
BALL = (256, 512)  # rings and sectors of a sphere made of triangles
BUMPY = (810, 810)  # those of the bumpy ball


def read(path: Path) -> dict:
    with open(path, "rb") as file:
        return tomllib.load(file)


def rgb(value) -> list[float]:
    return [float(x) for x in (value["rgb"] if isinstance(value, dict) else [value] * 3)]


def parts(entry: dict) -> tuple[str, dict]:
    """Kind and values of a shape or a material."""
    ((kind, values),) = entry.items()
    return kind, values


def quad_triangles(center, u, v) -> tuple[np.ndarray, np.ndarray]:
    center, u, v = (np.array(x, float) for x in (center, u, v))
    return np.array([center - u - v, center + u - v, center + u + v, center - u + v]), np.array([[0, 1, 2], [0, 2, 3]])


def wall(center: np.ndarray, radius: float, room: np.ndarray) -> dict:
    """The side of the room that a huge sphere stands for, as a quad that faces inward."""
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
    """Kind, values and material of each object; huge spheres have become quads, and a huge lamp the disc of its rim."""
    found = [(*parts(entry["shape"]), entry["material"]) for entry in scene["object"]]
    huge = [values for kind, values, _ in found if kind == "sphere" and values["radius"] > WALL]
    if huge:
        room = np.array([[np.inf] * 3, [-np.inf] * 3])
        anchor = np.median([values["center"] for values in huge], axis=0)
        for values in huge:
            axis = int(np.abs(values["center"] - anchor).argmax())
            sign = np.sign(values["center"][axis] - anchor[axis])
            room[int(sign < 0), axis] = values["center"][axis] - sign * values["radius"]  # the room is inside of it
    result = []
    for kind, values, material in found:
        if kind == "sphere" and values["radius"] > WALL:
            kind, values = "quad", wall(np.array(values["center"], float), values["radius"], room)
        elif kind == "sphere" and values["radius"] > LAMP and flat_lamp:
            (x, y, z), radius = values["center"], values["radius"]
            rim = float(np.sqrt(radius**2 - (y - room[1, 1]) ** 2))
            kind, values = "disc", {"center": [x, y - radius, z], "normal": [0, -1, 0], "radius": rim}
        result.append((kind, values, material))
    return result


def mitsuba_material(entry: dict) -> dict:
    """The BSDF, with `emitter` beside it where the material shines."""
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


def mitsuba_scene(mitsuba, path: Path, flat_lamp: bool = False) -> dict:
    """The scene as mitsuba.load_dict reads it, with the multijitter sampler and the path integrator's defaults."""
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
    for number, light in enumerate(scene.get("light", [])):
        radiance = {"type": "rgb", "value": rgb(light["environment"]["radiance"])}
        result[f"light{number}"] = {"type": "constant", "radiance": radiance}
    return result


def bumpy_ball(rings: int, sectors: int) -> tuple[np.ndarray, np.ndarray]:
    """Points and triangles of a ball with bumps, closed and facing outward."""
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


def write_bumpy_ball(path: Path) -> None:
    """A bumpy ball of 1.3 million triangles as a PLY file."""
    points, faces = bumpy_ball(*BUMPY)
    records = np.zeros(len(faces), [("count", "u1"), ("corners", "<i4", 3)])
    records["count"], records["corners"] = 3, faces
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(points)}"]
    header += [f"property float {axis}" for axis in "xyz"]
    header += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header", ""]
    path.write_bytes("\n".join(header).encode() + points.astype("<f4").tobytes() + records.tobytes())


def ball(center, radius: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points, triangles and normals of a sphere."""
    rings, sectors = BALL
    theta, phi = np.pi * np.arange(rings + 1)[:, None] / rings, 2 * np.pi * np.arange(sectors + 1)[None] / sectors
    normals = np.stack([np.sin(theta) * np.cos(phi), np.cos(theta) + 0 * phi, np.sin(theta) * np.sin(phi)], -1)
    ring, sector = (index.ravel() for index in np.mgrid[0:rings, 0:sectors])
    corner = ring * (sectors + 1) + sector
    below = corner + sectors + 1
    upper, lower = np.stack([corner, corner + 1, below + 1], -1), np.stack([corner, below + 1, below], -1)
    faces = np.concatenate([upper[ring > 0], lower[ring < rings - 1]])
    return np.array(center) + radius * normals.reshape(-1, 3), faces, normals.reshape(-1, 3)


def luxcore_mesh(kind: str, values: dict) -> tuple:
    """Points, triangles and normals (or None) as LuxCore takes them."""
    normals = None
    if kind == "quad":
        points, faces = quad_triangles(**values)
    elif kind == "sphere":
        points, faces, normals = ball(**values)
    else:
        points, faces = values["points"], values["faces"]
    rows = lambda array, of: [tuple(map(of, row)) for row in array]  # noqa: E731
    return rows(points, float), rows(faces, int), None if normals is None else rows(normals, float)


def luxcore_material(name: str, entry: dict) -> dict:
    kind, values = parts(entry)
    key = f"scene.materials.{name}"
    if kind == "diffuse":
        return {f"{key}.type": "matte", f"{key}.kd": rgb(values["reflectance"])}
    if kind == "dielectric":
        a, b = values["index"]["cauchy"]
        clear = {f"{key}.type": "glass", f"{key}.kr": [1.0] * 3, f"{key}.kt": [1.0] * 3}
        return {**clear, f"{key}.interiorior": a, f"{key}.cauchyb": b}
    black = {f"{key}.type": "matte", f"{key}.kd": [0.0] * 3}
    return {**black, f"{key}.emission": rgb(values["radiance"]), f"{key}.emission.gain": [1.0] * 3}


def luxcore_scene(luxcore, path: Path):
    scene = read(path)
    camera = scene["camera"]
    values = {
        "scene.camera.type": "perspective",
        "scene.camera.lookat.orig": camera["position"],
        "scene.camera.lookat.target": camera["look_at"],
        "scene.camera.up": camera.get("up", [0, 1, 0]),
        "scene.camera.fieldofview": camera["vertical_fov"],
        "scene.camera.autofocus.enable": False,
    }
    for number, light in enumerate(scene.get("light", [])):
        key = f"scene.lights.light{number}"
        sky = {".type": "constantinfinite", ".color": rgb(light["environment"]["radiance"]), ".gain": [1.0] * 3}
        values.update({key + name: value for name, value in sky.items()})
    for name, entry in scene["material"].items():
        values.update(luxcore_material(name, entry))
    result = luxcore.Scene()
    for number, (kind, shape, material) in enumerate(shapes(scene)):
        points, faces, normals = luxcore_mesh(kind, shape)
        result.DefineMesh(f"mesh{number}", points, faces, normals, None, None, None)
        values[f"scene.objects.object{number}.shape"] = f"mesh{number}"
        values[f"scene.objects.object{number}.material"] = material
    result.Parse(properties(luxcore, values))
    return result


def properties(luxcore, values: dict):
    result = luxcore.Properties()
    for key, value in values.items():
        result.Set(luxcore.Property(key, value))
    return result


def luxcore_picture(luxcore, path: Path, samples: int, seed: int) -> np.ndarray:
    """The picture of LuxCore's path tracer with its Sobol sampler and without a limit to brightness; paths of up to 64 surfaces."""
    film = read(path)["film"]
    depth = {f"path.pathdepth.{kind}": 64 for kind in ("total", "diffuse", "glossy", "specular")}
    values = {
        "renderengine.type": "PATHCPU",
        "renderengine.seed": seed,
        "sampler.type": "SOBOL",
        "sampler.sobol.adaptive.strength": 0.0,
        "film.width": film["width"],
        "film.height": film["height"],
        "film.filter.type": "NONE",
        "film.outputs.0.type": "RGB",
        "film.outputs.0.filename": "unused.exr",
        "batch.haltspp": samples,
        **depth,
    }
    session = luxcore.RenderSession(luxcore.RenderConfig(properties(luxcore, values), luxcore_scene(luxcore, path)))
    session.Start()
    while not session.HasDone():
        time.sleep(0.02)
        session.UpdateStats()
    session.Stop()
    picture = np.zeros((film["height"], film["width"], 3), np.float32)
    session.GetFilm().GetOutputFloat(luxcore.FilmOutputType.RGB, picture)
    return picture[::-1].astype(np.float64)


def write_png(path: Path, picture: np.ndarray) -> None:
    """An 8-bit sRGB picture to look at."""
    x = np.clip(picture, 0, 1)
    encoded = np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)
    rows = (255 * encoded + 0.5).astype(np.uint8)
    packed = b"".join(b"\0" + row.tobytes() for row in rows)
    chunk = lambda kind, data: (  # noqa: E731
        len(data).to_bytes(4, "big") + kind + data + zlib.crc32(kind + data).to_bytes(4, "big")
    )
    size = rows.shape[1].to_bytes(4, "big") + rows.shape[0].to_bytes(4, "big") + bytes([8, 2, 0, 0, 0])
    content = chunk(b"IHDR", size) + chunk(b"IDAT", zlib.compress(packed)) + chunk(b"IEND", b"")
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + content)
