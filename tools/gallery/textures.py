"""The images of the gallery: everything in scenes/textures but the measured spectra, and the sky."""

import struct
import zlib

import numpy as np
from .shapes import noise


def write_png(path, image):
    """Writes a PNG of an image height x width (gray), x 3 (color) or x 4 (with alpha).

    It has 8 bits, or 16 if the image has 16. Floats are shares of 1, and become 8 bits."""
    pixels = np.round(np.clip(image, 0, 1) * 255).astype(np.uint8) if image.dtype.kind == "f" else image
    height, width = pixels.shape[:2]
    kind, bits = 0 if pixels.ndim == 2 else {3: 2, 4: 6}[pixels.shape[2]], 8 * pixels.itemsize
    pixels = pixels.astype(f">u{pixels.itemsize}").view(np.uint8)
    # Each row minus the one above it (filter 2) compresses best for pictures and patterns alike.
    rows = pixels.reshape(height, -1)
    rows = rows - np.vstack([np.zeros_like(rows[:1]), rows[:-1]])
    data = np.hstack([np.full((height, 1), 2, np.uint8), rows]).tobytes()

    def chunk(name, body):
        return struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))

    head = struct.pack(">IIBBBBB", width, height, bits, kind, 0, 0, 0)
    path.parent.mkdir(exist_ok=True)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(data, 9)) + chunk(b"IEND", b""))


def write_hdr(path, rgb):
    """Writes a Radiance picture of linear colors, without run-length encoding."""
    exponent = np.ceil(np.log2(np.maximum(rgb.max(axis=-1, keepdims=True), 1e-30)) + 1e-6)
    mantissa = np.floor(rgb * 256 / 2**exponent)
    data = np.concatenate([mantissa, exponent + 128], axis=-1).astype(np.uint8)
    height, width = rgb.shape[:2]
    path.parent.mkdir(exist_ok=True)
    path.write_bytes(f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n".encode() + data.tobytes())


def stripes():
    """Returns red stripes on white that wind once around a straw in a unit of its length."""
    s, t = np.meshgrid(np.linspace(0, 1, 128, endpoint=False), np.linspace(0, 1, 128, endpoint=False))
    edge = np.clip((np.abs((s + t) % 1 - 0.5) - 0.25) * 64 + 0.5, 0, 1)[..., None]
    return edge * [0.93, 0.92, 0.88] + (1 - edge) * [0.72, 0.06, 0.08]


def wood(size=256):
    """Returns wooden boards with grain along the width, as sRGB."""
    long, cross = np.meshgrid(np.linspace(0, 1, size, endpoint=False), np.linspace(0, 1, size, endpoint=False))
    board = (cross * 4).astype(int)
    bend = noise(size, 3, 1) * 0.05 + noise(size, 6, 2) * 0.012
    grain = 0.5 + 0.5 * np.sin((cross + bend) * 130 + board * 2.1)
    fibre = noise(size, 96, 3)[:, :1] + 0.4 * noise(size, 40, 4)
    tone = 0.72 + 0.10 * grain + 0.06 * fibre + np.array([0.0, -0.09, 0.05, -0.04])[board]
    tone = np.where((cross * 4) % 1 < 0.02, 0.35, tone)
    return np.round(tone[..., None] * [0.56, 0.38, 0.25] * 128) / 128


def tiles(size=256, count=8):
    """Returns the tiles of a pool with their joints, in varying shades of blue, as sRGB."""
    s, t = np.meshgrid(np.linspace(0, count, size, endpoint=False), np.linspace(0, count, size, endpoint=False))
    shade = np.random.default_rng(11).uniform(-1, 1, (count, count))[t.astype(int), s.astype(int)]
    image = np.array([0.55, 0.77, 0.80]) + shade[..., None] * [0.06, 0.045, 0.03]
    joint = np.minimum(s % 1, t % 1) < 0.09
    return np.where(joint[..., None], [0.86, 0.87, 0.84], image)


def chart(size=512):
    """Returns a test chart, white on black: a checkerboard and two dartboards; gray."""
    x, y = np.meshgrid(np.linspace(-2, 2, 2 * size), np.linspace(1, -1, size))
    image = np.where((np.floor(x * 4) + np.floor(y * 4)) % 2 == 0, 1.0, 0.0)
    for middle in (-1, 1):
        distance, angle = np.hypot(x - middle, y), np.arctan2(y, x - middle)
        board = np.sin(angle * 10) * np.sin(np.pi * distance / 0.09) * distance
        image = np.where(distance < 0.72, np.clip(board * 60 + 0.5, 0, 1), image)
    return image


def painting(size=256):
    """Returns a sunset over hills, in flat shapes, as sRGB."""
    s, t = np.meshgrid(np.linspace(0, 1, size), np.linspace(0, 1, size))
    top, low = np.array([0.13, 0.18, 0.42]), np.array([0.98, 0.62, 0.35])
    band = np.floor(np.clip(t / 0.62, 0, 1) * 7) / 7
    image = top + (low - top) * band[..., None]
    sun = np.hypot(s - 0.63, t - 0.45)
    for radius, color in ((0.2, [0.99, 0.72, 0.42]), (0.13, [1.0, 0.86, 0.55])):
        image = np.where((sun < radius)[..., None], color, image)
    hills = [(0.60, 0.06, 5, 0.3, [0.45, 0.28, 0.42]), (0.70, 0.07, 7, 1.9, [0.29, 0.20, 0.36]), (0.82, 0.06, 4, 4.0, [0.14, 0.13, 0.27])]
    for height, swing, waves, phase, color in hills:
        edge = height + swing * np.sin(waves * s + phase) + 0.3 * swing * np.sin(2.7 * waves * s + phase)
        image = np.where((t > edge)[..., None], color, image)
    return image


def sky(size=64):
    """Returns a clear evening sky by latitude and longitude, +z in the middle: linear, without the sun."""
    up = np.cos((np.arange(size) + 0.5) * np.pi / size)[:, None, None]
    turn = ((np.arange(2 * size) + 0.5) * np.pi / size)[None, :, None]
    haze = np.exp(-np.maximum(up, 0) * 5)
    near = 0.5 + 0.5 * np.cos(turn - 4.1)
    color = np.array([0.16, 0.30, 0.62]) * (1 - haze) + haze * (np.array([0.62, 0.60, 0.66]) + near**3 * np.array([0.75, 0.42, 0.12]))
    return np.where(up > 0, color, np.array([0.10, 0.11, 0.13])) * np.ones((size, 2 * size, 1))


def soap(size=160):
    """Returns the thickness of a soap bubble by longitude and latitude, in 16 bits.

    It has drained to a black film at the top, is thick below, and is stirred."""
    up = np.linspace(1, 0, size)[:, None] * np.ones((1, 2 * size))
    turn = np.linspace(0, 2 * np.pi, 2 * size, endpoint=False)[None, :] * np.ones((size, 1))
    # Swirls that join where the longitude wraps around: waves of whole numbers, bent by each other.
    bend, stir = np.zeros_like(up), np.random.default_rng(5)
    for order in range(1, 9):
        around, along, phase = stir.integers(1, order + 2), stir.uniform(2, 3 * order + 2), stir.uniform(0, 2 * np.pi, 2)
        bend += np.sin(around * turn + 2.4 * bend + phase[0]) * np.sin(along * np.pi * up + 1.6 * bend + phase[1]) / order
    still = np.sin(np.pi * up) ** 0.7
    thickness = 0.06 + 0.80 * (1 - up) ** 1.15 + 0.085 * bend * still
    return np.round(np.clip(thickness, 0.01, 1) * 65535).astype(np.uint16)


def ground(heights, water):
    """Returns the colors of the landscape, as sRGB: sand, meadow, rock where it is steep, snow on top."""
    slope = np.hypot(*np.gradient(heights, 24 / heights.shape[0]))
    patchy = noise(heights.shape[0], 40, 7) * 0.12 + noise(heights.shape[0], 160, 8) * 0.08
    above = heights - water + patchy * 0.5
    share = lambda x, a, b: np.clip((x - a) / (b - a), 0, 1)[..., None]
    color = np.array([0.58, 0.52, 0.40]) + share(above, 0.03, 0.10) * (np.array([0.24, 0.33, 0.14]) - [0.58, 0.52, 0.40])
    rock = np.array([0.40, 0.37, 0.35]) * (1 + patchy[..., None])
    color = color + share(slope + patchy, 0.75, 1.15) * (rock - color)
    snow = share(above - 0.35 * slope, 1.0, 1.35)
    return color + snow * (np.array([0.93, 0.95, 0.98]) - color)
