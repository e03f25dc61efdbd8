"""The image of three flat-colored spheres equals the book's, pixel by pixel.

    pytest tools/tests/test_spheres.py

Gambetta, Computer Graphics from Scratch (2021), chapter 2, listings 2-3 to 2-6: CanvasToViewport, TraceRay,
IntersectRaySphere, evaluated at the centers of square pixels.
"""

import numpy as np
import render

SIZE = 600
WHITE = (1, 1, 1)
SPHERES = [
    ((0, -1, 3), 1, (1, 0, 0)),
    ((2, 0, 4), 1, (0, 0, 1)),
    ((-2, 0, 4), 1, (0, 1, 0)),
]


def canvas_to_viewport():
    """Returns D = (x, y, d) on the 1 x 1 viewport at d = 1, y up, for every pixel."""
    centers = (np.arange(SIZE) + 0.5) / SIZE - 0.5
    x, y = np.meshgrid(centers, -centers)
    return np.stack([x, y, np.ones_like(x)], axis=-1)


def intersect_ray_sphere(direction, center, radius):
    """Returns t1 and t2 of |O + t D - C| = r with O = 0, infinite where there are none."""
    offset = -np.array(center, float)
    a = np.sum(direction * direction, axis=-1)
    b = 2 * direction @ offset
    c = offset @ offset - radius * radius
    discriminant = b * b - 4 * a * c
    root = np.sqrt(np.where(discriminant < 0, np.inf, discriminant))
    return (-b + root) / (2 * a), np.where(discriminant < 0, np.inf, (-b - root) / (2 * a))


def trace_ray(direction, t_min, t_max):
    """Returns the color of the closest sphere with t in t_min..t_max, or the background."""
    closest = np.full(direction.shape[:-1], np.inf)
    color = np.full(direction.shape, WHITE, float)
    for center, radius, flat in SPHERES:
        for t in intersect_ray_sphere(direction, center, radius):
            nearer = (t_min <= t) & (t <= t_max) & (t < closest)
            closest[nearer] = t[nearer]
            color[nearer] = flat
    return color


def test_every_pixel_of_the_three_spheres_equals_the_listing():
    image = render.render(render.SCENES / "spheres.toml").rgb
    expected = trace_ray(canvas_to_viewport(), 1, np.inf)
    assert 0.4 < np.mean(np.any(expected != WHITE, axis=-1)) < 0.6
    assert np.count_nonzero(np.any(image != expected, axis=-1)) == 0
