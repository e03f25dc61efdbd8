"""Dispersion by a prism, compared with Snell's law: where an edge appears through the prism at each wavelength.

    pip install matplotlib
    python examples/python/prism.py prism.png

A row of pixels looks through a prism at the edge of a lamp that is very far away. The prism deviates each wavelength by
a different angle, so each sees the edge in another pixel. The plot shows the angles of these pixels, and the curve of
Snell's law.
"""

import sys

import abbe
import numpy as np

GLASS = "N-SF11"
APEX = np.radians(30)
# The middle of the row's field of view, as an angle from the axis of the prism, and half its width.
MIDDLE, HALF = np.radians(12.5), np.radians(3)
PIXELS = 100
# The direction and the distance of the lamp's edge.
EDGE, FAR = np.radians(-13), 1e6
BANDS = {"from": 460, "to": 640, "step": 20}


def exact(nm):
    """Returns the angle at which each wavelength sees the edge: Snell's law at both faces, solved by bisection."""
    n = abbe.catalog.glass(GLASS).index(nm)

    def after(angle):
        inside = np.arcsin(np.sin(angle + APEX / 2) / n)
        return APEX / 2 - np.arcsin(n * np.sin(APEX - inside))

    low, high = np.full_like(n, MIDDLE - HALF), np.full_like(n, MIDDLE + HALF)
    for _ in range(60):
        middle = (low + high) / 2
        is_low = after(middle) < EDGE
        low, high = np.where(is_low, middle, low), np.where(is_low, high, middle)
    return (low + high) / 2


def scene():
    half = 2 * np.tan(APEX / 2)
    corners = [[1, 0], [-1, half], [-1, -half]]
    direction = lambda angle: np.array([np.sin(angle), 0, -np.cos(angle)])  # noqa: E731
    prism = {
        "points": np.array([[x, y, z] for y in (-1, 1) for x, z in corners]),
        "faces": np.array([[0, 1, 2], [3, 5, 4], [0, 3, 4], [0, 4, 1], [1, 4, 5], [1, 5, 2], [2, 5, 3], [2, 3, 0]]),
    }
    # The lamp begins at the edge and is a tenth of its distance wide.
    across = direction(EDGE + np.pi / 2) * FAR / 20
    eye = -3 * direction(MIDDLE)
    lamp = {"center": eye + FAR * direction(EDGE) + across, "u": across, "v": [0, FAR / 20, 0]}
    return {
        "camera": {
            "position": eye,
            "look_at": [0, 0, 0],
            "vertical_fov": np.degrees(2 * np.arctan(np.tan(HALF) / PIXELS)),
        },
        "film": {"width": PIXELS, "height": 1, "filter": "center", "spectral": BANDS},
        "render": {"samples": 256},
        "material": {"glass": {"dielectric": {"index": GLASS}}, "lamp": {"emissive": {"radiance": 1}}},
        "object": [{"shape": {"mesh": prism}, "material": "glass"}, {"shape": {"quad": lamp}, "material": "lamp"}],
    }


def rendered(image):
    """Returns wavelengths, and the angles at which they see the edge: where a sharp edge would be."""
    nm, radiance = image.spectra
    (row,) = radiance
    lit = row[-PIXELS // 4 :].mean(axis=0)
    edges = PIXELS - (row / lit).sum(axis=0)
    return nm, MIDDLE + np.arctan((2 * edges / PIXELS - 1) * np.tan(HALF))


def main(png=None):
    nm, seen = rendered(abbe.render(scene()))
    pixel = 2 * HALF / PIXELS
    for one, angle, expected in zip(nm, seen, exact(nm), strict=True):
        print(f"{one:.0f} nm: {np.degrees(angle):.3f} degrees, by Snell's law {np.degrees(expected):.3f}")
    if png:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots()
        fine = np.linspace(nm[0], nm[-1], 200)
        axes.plot(fine, np.degrees(exact(fine)), label=f"Snell's law, {GLASS}")
        axes.plot(nm, np.degrees(seen), "o", label="rendered")
        axes.set(xlabel="wavelength in nm", ylabel="angle of the edge in degrees")
        axes.legend()
        figure.savefig(png)
    return np.abs(seen - exact(nm)).max() / pixel


if __name__ == "__main__":
    main(*sys.argv[1:2])
