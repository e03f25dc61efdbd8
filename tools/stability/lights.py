"""Stability rows A6, L1, L3, L4: lights that are small, far or close. Naive methods in numpy, ours on images."""

import numpy as np
from validation.scenes import glow, plane, quad, sphere

from .plot import Plot, Series, times
from .scenes import green, timed, view


def caustic_scene(radius: float, samples: int, caustics: str, **settings) -> str:
    """Returns a floor below a glass ball below a lamp of constant power, seen without the ball."""
    materials = {
        "glass": {"dielectric": {"index": 1.5}},
        "tiny": {"emissive": {"radiance": 1 / radius**2}},
        "floor": {"diffuse": {"reflectance": 0.7}},
    }
    objects = [
        ("glass", sphere((0, 1, 0), 0.5)),
        ("tiny", sphere((0, 5, 0), radius)),
        ("floor", plane((0, 0, 0), (0, 1, 0))),
    ]
    return view(
        objects,
        materials=materials,
        eye=(0, 0.4, 3),
        target=(0, 0, 0),
        fov=22,
        columns=24,
        rows=16,
        samples=samples,
        caustics=caustics,
        **settings,
    )


def a6(quick: bool) -> Plot:
    """A caustic, found by chance or by photons: error times processor time.

    A path by chance contributes reflectance x radiance x transmittance, or nothing. Its variance is therefore that
    product times its mean contribution, which the converged picture gives. A single picture contains far too few of the
    rare paths."""
    radii = np.array([0.3, 0.03] if quick else [1.0, 0.3, 0.1, 0.03, 0.01, 0.003])
    many, tries = (64, {"off": 64, "auto": 16}) if quick else (1024, {"off": 512, "auto": 64})
    costs: dict = {"off": [], "auto": [], "expected": []}
    for radius in map(float, radii):
        reference = np.mean([green(caustic_scene(radius, many, "auto"), seed=seed) for seed in (91, 92)], axis=0)
        direct = green(caustic_scene(radius, many // 4, "off", diffuse_bounces=0))
        square = 1e-4 * np.mean(reference) ** 2
        for kind, samples in tries.items():
            image, seconds = timed(caustic_scene(radius, samples, kind), seed=3)
            costs[kind].append(float(np.mean((image.channels["G"] - reference) ** 2)) * seconds / square)
            if kind == "off":
                variance = 0.7 * 0.92 / radius**2 * max(float(np.mean(reference - direct)), 0)
                costs["expected"].append(variance / samples * seconds / square)
    ratio = np.array(costs["expected"]) / np.array(costs["auto"])
    words = (
        f"Paths that must meet the lamp by chance need {times(ratio[0])} times Abbe's processor time for the same "
        f"error at a lamp of radius {radii[0]:g} and "
        f"{times(ratio[-1])} times at {radii[-1]:g}; with photons from the lamp 1 % takes {costs['auto'][0]:.2g} s "
        f"and {costs['auto'][-1]:.2g} s. A single "
        "picture by chance looks better than it is, since it shows few of the rare paths."
    )
    series = [
        Series("by chance, expected\n(variance computed,\ntime measured)", 1 / radii, costs["expected"]),
        Series('by chance, one picture\n(caustics = "off")', 1 / radii, costs["off"]),
        Series("Abbe, rendered", 1 / radii, costs["auto"], True),
    ]
    return Plot(
        "A6",
        "A caustic of a small lamp",
        "1 / radius of the lamp",
        "processor seconds to 1 % error",
        series,
        words,
        source="Kajiya 1986 for paths by chance",
    )


def floor_under(shape: dict, radiance: float, eye, side: int) -> float:
    """Returns the mean of a white floor around the origin, lit directly by a lamp."""
    objects = [("white", plane((0, 0, 0), (0, 1, 0))), ("shining", shape)]
    shining = {"shining": glow(radiance)}
    scene = view(objects, materials=shining, eye=eye, columns=side, rows=side, samples=64, diffuse_bounces=0)
    return float(green(scene).mean())


def l1(quick: bool) -> Plot:
    """A floor under a distant, small ball of light of constant irradiance."""
    sizes = 10.0 ** np.arange(-1, -6.1, -2 if quick else -0.5)
    lamps = [(sphere((0, 1, 0), float(size)), float(1 / size**2)) for size in sizes]
    ours = [abs(floor_under(*lamp, eye=(3, 1, 0), side=8) - 1) for lamp in lamps]
    s = sizes.astype(np.float32)
    with np.errstate(divide="ignore"):
        cone = np.float32(1) - np.sqrt(np.float32(1) - s * s)
    truth = sizes**2 / (1 + np.sqrt(1 - sizes**2))
    naive = abs(cone.astype(float) / truth - 1)
    bad = int(np.argmin(abs(sizes - 1e-3)))
    words = (
        f"1 - cos of the cone in f32 is off by {naive[bad]:.0%} at a radius of {sizes[bad]:g} of the distance and 0 "
        f"at {sizes[naive >= 1][0]:.0e}, a density of infinity; "
        f"Abbe's floors get the right irradiance within {max(ours):.1g} down to {sizes[-1]:.0e}."
    )
    return Plot(
        "L1",
        "A ball of light, far away",
        "distance / radius of the lamp",
        "relative error",
        [
            Series("solid angle by\n1 - cos, f32", 1 / sizes, naive),
            Series("irradiance,\nAbbe, rendered", 1 / sizes, ours, True),
        ],
        words,
        bound=2e-3,
        source="Shirley, Wang & Zimmerman 1996",
    )


def wall_share(h):
    """Returns the form factor of a floor point and a square of side 2 standing at distance h (Howell, B-5)."""
    far = np.hypot(h, 2)
    return (np.arctan(1 / h) - h / far * np.arctan(1 / far)) / np.pi


def area_deviation(h):
    """Returns standard deviation over mean for one point drawn uniformly on the square of `wall_share`.

    Integrates by the trapezoid rule over the logarithms."""
    y = np.geomspace(1e-9, 2, 1500)[:, None]
    z = np.geomspace(1e-9, 1, 1500)
    square = (4 * h * y / (np.pi * (h * h + y * y + z * z) ** 2)) ** 2 * y * z / 2
    second = np.trapezoid(np.trapezoid(square, np.log(z)), np.log(y[:, 0]))
    return float(np.sqrt(second / wall_share(h) ** 2 - 1))


def l3(quick: bool) -> Plot:
    """A point of the floor ever closer to a lamp that stands on it."""
    heights = 10.0 ** np.arange(0, -4.1, -2 if quick else -0.5)
    random = np.random.default_rng(2)
    count = 400_000
    naive, biases, ours, misses = [], [], [], []
    for h in heights:
        y, z = 2 * random.random(count), 2 * random.random(count) - 1
        estimate = 4 * h * y / (np.pi * (h * h + y * y + z * z) ** 2)
        exact = wall_share(h)
        naive.append(area_deviation(h))
        biases.append(estimate.mean() / exact)
        lamp = quad((0, 1, 0), (0, 0, -1), (0, 1, 0))
        scene = view(
            [("white", plane((0, 0, 0), (0, 1, 0))), ("lamp", lamp)],
            eye=(float(h), 3, 0),
            target=(float(h), 0, 0),
            up=(0, 0, 1),
            fov=1e-6,
            columns=64,
            rows=64,
            samples=1,
            diffuse_bounces=0,
        )
        shown = green(scene)
        ours.append(shown.std() / exact)
        misses.append(abs(shown.mean() / exact - 1) / (shown.std() / exact / 64))
    words = (
        f"At {heights[-1]:g} of a standing lamp's half side, points drawn evenly on it vary by {times(naive[-1])} "
        f"times their mean and find {biases[-1]:.0%} of the light in {count} samples; Abbe's samples "
        f"deviate by at most {max(ours):.2f} of the mean at any distance, and the mean is within {max(misses):.1f} "
        "standard errors."
    )
    return Plot(
        "L3",
        "A lamp that touches the floor",
        "half side of the lamp / distance",
        "standard deviation / mean of one sample",
        [
            Series("points drawn\non the lamp (exact)", 1 / heights, naive),
            Series("Abbe, rendered", 1 / heights, ours, True),
        ],
        words,
        bound=1.1,
        source="Shirley, Wang & Zimmerman 1996; Veach 1997",
        z=max(misses),
    )


def girard_f32(size: float) -> float:
    """Returns the solid angle of a triangle of edge `size` at distance 1 by its spherical excess (Girard), in f32."""
    p = triangle_points(size).astype(np.float32)
    a, b, c = (v / np.sqrt(v @ v, dtype=np.float32) for v in p)

    def angle(at, one, two):
        u, v = np.cross(at, one), np.cross(at, two)
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.arccos(np.clip((u @ v) / np.sqrt((u @ u) * (v @ v)), -1, 1), dtype=np.float32)

    return float(angle(a, b, c) + angle(b, c, a) + angle(c, a, b) - np.float32(np.pi))


def triangle_points(size: float):
    """Returns corners around (0, 1, 0), in a plane that faces down."""
    turns = np.radians([10, 130, 250])
    return np.stack([size / np.sqrt(3) * np.cos(turns), np.ones(3), size / np.sqrt(3) * np.sin(turns)], -1)


def triangle_integral(size: float, power: float) -> float:
    """Returns the integral of cos^power / r^2 over the triangle seen from the origin, by 8 x 8 Gauss points.

    Power 1 gives the solid angle."""
    nodes, weights = np.polynomial.legendre.leggauss(8)
    u, v = np.meshgrid((nodes + 1) / 2, (nodes + 1) / 2)
    w = np.outer(weights, weights).T / 4 * u
    a, b, c = triangle_points(size)
    points = a + u[..., None] * (b - a) + (u * v)[..., None] * (c - b)
    r2 = np.sum(points**2, -1)
    area = np.linalg.norm(np.cross(b - a, c - a))
    return float(np.sum(w * area * (1 / np.sqrt(r2)) ** power / r2))


def l4(quick: bool) -> Plot:
    """A floor under a small triangle of light."""
    sizes = 10.0 ** np.arange(-0.5, -5.1, -2 if quick else -0.5)
    naive, ours = [], []
    for size in sizes:
        naive.append(abs(girard_f32(size) / triangle_integral(size, 1) - 1))
        radiance = float(np.pi / triangle_integral(size, 2))
        lamp = {"triangle": {"points": triangle_points(size).tolist()}}
        ours.append(abs(floor_under(lamp, radiance, eye=(3, 0.8, 0), side=16) - 1))
    bad = int(np.argmin(abs(sizes - 1e-3)))
    words = (
        f"The solid angle of a triangle of edge {sizes[bad]:.1g} by the excess of its angles in f32 is off by "
        f"{naive[bad]:.0%}; Abbe's floors under such lamps are "
        f"right within {max(ours):.1g} down to an edge of {sizes[-1]:.0e}."
    )
    return Plot(
        "L4",
        "A small triangle of light",
        "distance / edge of the lamp",
        "relative error",
        [
            Series("solid angle by\nGirard, f32", 1 / sizes, naive),
            Series("irradiance,\nAbbe, rendered", 1 / sizes, ours, True),
        ],
        words,
        bound=2e-3,
        source="Girard 1626; van Oosterom & Strackee 1983",
    )
