"""The regions of scenes/smallpt.toml, and which of its pixels see the glass or the black front wall.

    from smallpt.regions import region_means, scene_text, sees_glass
    region_means(image)["floor"]            # R, G, B

Six regions sample the picture. The glass ball is separate, because it shows the 99-line program's Schlick
approximation.
"""

import tomllib
from pathlib import Path
from typing import NamedTuple

import numpy as np

SCENE = Path(__file__).resolve().parents[2] / "scenes/smallpt.toml"

# Left, top, right, bottom in pixels of 1024 x 768, y down.
SIX_REGIONS = {
    "left wall": (16, 176, 240, 608),
    "right wall": (784, 176, 1008, 608),
    "back wall": (280, 184, 744, 432),
    "ceiling": (128, 0, 896, 80),
    "floor": (176, 704, 856, 768),
    "mirror ball": (300, 472, 436, 608),
}
REGIONS = {**SIX_REGIONS, "glass ball": (592, 484, 752, 640)}


class Sphere(NamedTuple):
    """A sphere of the scene."""

    center: np.ndarray
    radius: float


def region_means(image: np.ndarray) -> dict[str, np.ndarray]:
    """Returns the mean of each region and band of an image (height, width, 3), the top row first."""
    height, width = image.shape[:2]
    means = {}
    for name, (left, top, right, bottom) in REGIONS.items():
        rows = slice(round(top * height / 768), round(bottom * height / 768))
        columns = slice(round(left * width / 1024), round(right * width / 1024))
        means[name] = image[rows, columns].mean(axis=(0, 1), dtype=np.float64)
    return means


def mean_and_error(runs: list[dict[str, np.ndarray]]) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Returns the mean over independent runs and its standard error, for each region and band."""
    pooled = {}
    for name in REGIONS:
        values = np.array([run[name] for run in runs])
        pooled[name] = values.mean(axis=0), values.std(axis=0, ddof=1) / np.sqrt(len(runs))
    return pooled


def scene_text(width: int, height: int) -> str:
    """Returns the text of the scene at another size."""
    text = SCENE.read_text("utf-8")
    return text.replace("width = 1024", f"width = {width}").replace("height = 768", f"height = {height}")


def spheres() -> dict[str, Sphere]:
    """Returns the spheres of the scene by name."""
    with SCENE.open("rb") as file:
        objects = tomllib.load(file)["object"]
    balls = {entry["name"]: entry["shape"]["sphere"] for entry in objects}
    return {name: Sphere(np.array(ball["center"], float), ball["radius"]) for name, ball in balls.items()}


def camera_rays(width: int, height: int) -> tuple[np.ndarray, np.ndarray]:
    """Returns the origins and the unit directions of the rays through the pixel centers, each (height, width, 3)."""
    with SCENE.open("rb") as file:
        camera = tomllib.load(file)["camera"]
    position = np.array(camera["position"], float)
    forward = np.array(camera["look_at"]) - position
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, (0, 1, 0))
    right /= np.linalg.norm(right)
    half = np.tan(np.radians(camera["vertical_fov"]) / 2)
    across = (2 * (np.arange(width) + 0.5) / width - 1) * half * width / height
    up = (1 - 2 * (np.arange(height) + 0.5) / height) * half
    toward = forward + across[None, :, None] * right + up[:, None, None] * np.cross(right, forward)
    return position + camera["near"] * toward, toward / np.linalg.norm(toward, axis=-1, keepdims=True)


def distances(sphere: Sphere, origin: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """Returns the distance to the first crossing ahead, infinite where there is none."""
    offset = sphere.center - origin
    middle = (offset * direction).sum(axis=-1)
    squared = sphere.radius**2 - (np.cross(offset, direction) ** 2).sum(axis=-1)
    half = np.sqrt(np.maximum(squared, 0))
    near, far = middle - half, middle + half
    ahead = np.where(near > 1e-6, near, np.where(far > 1e-6, far, np.inf))
    return np.where(squared > 0, ahead, np.inf)


def sees_glass(width: int, height: int) -> np.ndarray:
    """Returns the pixels that see the glass ball directly, or come within some one and a half pixels of its edge."""
    origin, direction = camera_rays(width, height)
    glass = spheres()["glass ball"]
    pixel_size = np.linalg.norm(direction[0, 0] - direction[0, 1]) * np.linalg.norm(glass.center - origin[0, 0])
    return np.isfinite(distances(Sphere(glass.center, glass.radius + 2 * pixel_size), origin, direction))


def sees_front_wall(width: int, height: int) -> np.ndarray:
    """Returns the pixels whose center shows the black front wall in the mirror ball."""
    origin, direction = camera_rays(width, height)
    scene = spheres()
    names = list(scene)
    ahead = np.array([distances(sphere, origin, direction) for sphere in scene.values()])
    on_mirror = ahead.argmin(axis=0) == names.index("mirror ball")
    points = (origin + ahead.min(axis=0)[..., None] * direction)[on_mirror]
    normals = (points - scene["mirror ball"].center) / scene["mirror ball"].radius
    incoming = direction[on_mirror]
    reflected = incoming - 2 * (incoming * normals).sum(axis=-1, keepdims=True) * normals
    behind = np.array([distances(sphere, points, reflected) for sphere in scene.values()])
    seen = np.zeros((height, width), bool)
    seen[on_mirror] = behind.argmin(axis=0) == names.index("front wall")
    return seen
