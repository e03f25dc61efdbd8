"""Stability rows S1, S6, T1: intersections of rays with surfaces. Naive methods in numpy, ours on rendered images."""

import numpy as np
from validation.scenes import plane, quad, sphere

from .plot import Plot, Series
from .scenes import WHITE_SKY, fresnel, photograph, view

INDEX = 1.5


def ball_reflectance(cosine):
    """Returns what a ball of black glass reflects of a sky of 1, at an angle of incidence."""
    return fresnel(INDEX, cosine)


def ball_rays(distance: float, count: int, precision):
    """Returns origin and unit directions from `distance` along z, across 0.999 of a unit ball, in a precision."""
    slope = 0.999 / distance * (2 * np.arange(count) + 1 - count) / count
    length = np.hypot(1, slope)
    zero = np.zeros(count)
    return np.array([0, 0, distance], precision), np.stack([zero, slope / length, -1 / length], -1).astype(precision)


def expanded(origin, directions):
    """Returns distances to a unit ball by R^2 - (|o|^2 - (o.n)^2), as in textbooks and smallpt; NaN on a miss."""
    b = -(directions @ origin)
    with np.errstate(invalid="ignore"):
        return b - np.sqrt(origin.dtype.type(1) - (origin @ origin - b * b))


def by_cross_product(origin, directions):
    """Returns distances to a unit ball by R^2 - |o x n|^2: no cancellation (Haines, Gunther, Akenine-Moller 2019)."""
    across = np.cross(np.broadcast_to(origin, directions.shape), directions).astype(origin.dtype)
    with np.errstate(invalid="ignore"):
        return -(directions @ origin) - np.sqrt(origin.dtype.type(1) - np.sum(across * across, -1))


def shown(method, distance, count, precision):
    """Returns the RMS relative error of the reflectance that a method shows, and the share of rays that it loses.

    The truth is the closed form for the same rounded rays. A lost ray shows the sky."""
    origin, directions = ball_rays(distance, count, precision)
    t = method(origin, directions)
    hit = origin + t[:, None] * directions
    cosine = -np.sum(directions * hit, -1).astype(np.float64)
    seen = np.where(np.isnan(t), 1.0, ball_reflectance(np.nan_to_num(cosine)))
    wide = directions.astype(np.float64)
    sine = distance * np.hypot(wide[:, 0], wide[:, 1]) / np.linalg.norm(wide, axis=-1)
    truth = ball_reflectance(np.sqrt(np.maximum(0, 1 - sine**2)))
    return rms(seen / truth - 1), np.isnan(t).mean()


def rms(errors):
    return float(np.sqrt(np.mean(np.square(errors))))


def s1(quick: bool) -> Plot:
    """A ball seen from afar, judged by the reflectance it shows."""
    count = 64
    distances = 10.0 ** np.arange(1, 9, 1 if quick else 0.5)
    methods = [
        ("expanded, f32", expanded, np.float32),
        ("cross product, f32", by_cross_product, np.float32),
        ("expanded, f64", expanded, np.float64),
    ]
    found = {label: np.array([shown(f, d, count, kind) for d in distances]) for label, f, kind in methods}
    ours = []
    for distance in distances:
        fov = 2 * np.degrees(np.arctan(0.999 / distance))
        scene = view([("black_glass", sphere())], [WHITE_SKY], eye=(0, 0, distance), fov=fov, rows=count)
        slope = np.tan(np.radians(fov) / 2) * (2 * np.arange(count) + 1 - count) / count
        truth = ball_reflectance(np.sqrt(1 - (distance * slope / np.hypot(1, slope)) ** 2))
        ours.append(rms(photograph(scene).channels["G"][:, 0].astype(float) / truth - 1))
    series = [Series(label, distances, values[:, 0]) for label, values in found.items()]
    wrong = found["expanded, f32"][np.argmin(abs(distances - 1e3)), 0]
    words = (
        f"From 1000 radii away the textbook discriminant in f32 shows a ball wrong by {wrong:.0%}, and in f64 from "
        "1e8 radii away by "
        f"{found['expanded, f64'][-1, 0]:.0%}; Abbe's images, cross product in f64, are right within {max(ours):.1g} "
        "at every distance "
        "(the 32-bit numbers of the file carry 6e-8)."
    )
    return Plot(
        "S1",
        "A ball seen from afar",
        "distance / radius",
        "RMS relative error of its reflectance",
        [*series, Series("Abbe, rendered", distances, ours, True)],
        words,
        bound=3e-6,
        source="Haines, Gunther & Akenine-Moller 2019; pbrt-v4 6.8",
    )


def scaled_scene(size: float) -> str:
    """Returns a scene with glass ball, metal ball, lamp and floor, every length times `size`."""
    materials = {
        "glass": {"dielectric": {"index": 1.5}},
        "metal": {"conductor": {"metal": "Au", "roughness": 0.3}},
        "gray": {"diffuse": {"reflectance": 0.6}},
        "bright": {"emissive": {"radiance": 5}},
    }
    objects = [
        ("glass", sphere((0, size, 0), size)),
        ("metal", sphere((2 * size, size, -size), size)),
        ("gray", plane((0, 0, 0), (0, 1, 0))),
        ("bright", quad((0, 4 * size, 0), (size, 0, 0), (0, 0, size))),
    ]
    lights = [{"environment": {"radiance": 0.2}}]
    return view(
        objects,
        lights,
        materials,
        eye=(0, 1.25 * size, 6 * size),
        target=(0, size, 0),
        fov=50,
        columns=32,
        rows=24,
        samples=4,
        caustics="off",
    )


def lost_chords(size: float, precision, count: int, epsilon=1e-4) -> float:
    """Returns the share of rays from a point on a sphere into it that do not end on its far side.

    The hit is the first root above a fixed epsilon, as in smallpt."""
    random = np.random.default_rng(7)
    point = random.standard_normal((count, 3))
    point = (size * point / np.linalg.norm(point, axis=-1, keepdims=True)).astype(precision)
    inward = random.standard_normal((count, 3))
    inward /= np.linalg.norm(inward, axis=-1, keepdims=True)
    inward = (inward * -np.sign(np.sum(inward * point, -1, keepdims=True))).astype(precision)
    b = -np.sum(point * inward, -1)
    with np.errstate(invalid="ignore", over="ignore"):
        root = np.sqrt(precision(size) ** 2 - (np.sum(point * point, -1) - b * b))
        near, far = b - root, b + root
        t = np.where(near > epsilon, near, np.where(far > epsilon, far, np.nan))
    return float(np.mean(~(abs(t - 2 * b) < 0.01 * abs(b))))


def s6(quick: bool) -> Plot:
    """The same scene in other units."""
    powers = np.arange(-40, 41, 20 if quick else 8)
    sizes = 2.0**powers
    naive = [
        Series(f"t > 1e-4, {name}", sizes, [lost_chords(s, kind, 20000) for s in sizes])
        for name, kind in (("f32", np.float32), ("f64", np.float64))
    ]
    base = photograph(scaled_scene(1.0)).rgb
    ours = [float(np.mean(np.any(photograph(scaled_scene(float(s))).rgb != base, axis=-1))) for s in sizes]
    words = (
        f"With a fixed epsilon of 1e-4, {naive[1].y[0]:.0%} of the rays inside a ball of size 2^-40 are lost; Abbe's "
        "image of a scene times 2^k "
        f"differs from the unscaled one in {sum(ours) * base.shape[0] * base.shape[1]:.0f} pixels of "
        f"{base.shape[0] * base.shape[1] * len(sizes)}, to the last bit."
    )
    return Plot(
        "S6",
        "The same scene in other units",
        "size of the scene",
        "share of wrong rays; of pixels that differ",
        [*naive, Series("Abbe, rendered:\npixels that differ", sizes, ours, True)],
        words,
        linear=True,
        source="smallpt",
    )


def ball_mesh(rings=12, around=24):
    """Returns a closed ball of 528 triangles, rotated at random; corners rounded to 32 bits."""
    polar = np.pi * np.arange(1, rings) / rings
    angle = 2 * np.pi * np.arange(around) / around
    band = [(np.sin(p) * np.cos(a), np.sin(p) * np.sin(a), np.cos(p)) for p in polar for a in angle]
    points = np.array([(0, 0, 1), *band, (0, 0, -1)])

    def at(ring, k):
        return 1 + ring * around + k % around

    faces = [(0, at(0, k), at(0, k + 1)) for k in range(around)]
    for ring in range(rings - 2):
        for k in range(around):
            a, b, c, d = at(ring, k), at(ring + 1, k), at(ring + 1, k + 1), at(ring, k + 1)
            faces += [(a, b, c), (a, c, d)]
    faces += [(at(rings - 2, k + 1), at(rings - 2, k), len(points) - 1) for k in range(around)]
    turn, _ = np.linalg.qr(np.random.default_rng(5).standard_normal((3, 3)))
    if np.linalg.det(turn) < 0:
        turn[0] *= -1
    return (points @ turn.T).astype(np.float32).astype(np.float64), np.array(faces)


def moller_trumbore_leaks(origins, direction, points, faces, precision) -> int:
    """Returns the number of rays that hit no triangle at all (Moller & Trumbore 1997)."""
    o, d, p = origins.astype(precision), direction.astype(precision), points.astype(precision)
    a, e1, e2 = p[faces[:, 0]], p[faces[:, 1]] - p[faces[:, 0]], p[faces[:, 2]] - p[faces[:, 0]]
    q = np.cross(d, e2)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        inverse = precision(1) / np.sum(e1 * q, -1)
        s = o[:, None] - a
        r = np.cross(s, e1)
        u, v = np.sum(s * q, -1) * inverse, (r @ d) * inverse
        t = np.sum(e2 * r, -1) * inverse
        inside = (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0)
    return int(np.sum(~np.any(inside, axis=1)))


def t1(quick: bool) -> Plot:
    """Rays from inside a closed mesh at its edges, and close to them."""
    points, faces = ball_mesh()
    edges = sorted({tuple(sorted((int(f[i]), int(f[i - 1])))) for f in faces for i in range(3)})
    chosen = np.random.default_rng(3).permutation(len(edges))[: 16 if quick else 64]
    aims = np.array(
        [1e-1, 1e-8, 1e-16] if quick else [1e-1, 1e-3, 1e-5, 1e-6, 1e-7, 1e-8, 1e-10, 1e-12, 1e-14, 1e-15, 1e-16, 1e-17]
    )
    rows = 64
    mesh = {"mesh": {"points": points.tolist(), "faces": faces.tolist()}}
    leaks = np.zeros((len(aims), 3))
    for index in chosen:
        a, b = (points[i] for i in edges[index])
        middle, along = (a + b) / 2, (b - a) / np.linalg.norm(b - a)
        forward = middle / np.linalg.norm(middle)
        right = np.cross(forward, along)
        height = 0.9 * float(np.linalg.norm(b - a))
        for i, aim in enumerate(aims):
            eye = 0.5 * middle + aim * np.linalg.norm(b - a) * right
            offsets = height * ((np.arange(rows) + 0.5) / rows - 0.5)
            origins = eye + offsets[:, None] * along
            for j, kind in enumerate((np.float32, np.float64)):
                leaks[i, j] += moller_trumbore_leaks(origins, forward, points, faces, kind)
            scene = view([("lamp", mesh)], eye=eye, target=eye + forward, up=along, height=height, rows=rows)
            leaks[i, 2] += np.sum(photograph(scene).channels["A"] < 1)
    share = leaks / (rows * len(chosen))
    words = (
        f"Aimed at the edges of a closed mesh within rounding, Moller-Trumbore lets {share[-1, 0]:.1%} of the rays "
        "out in f32 and still "
        f"{share[-1, 1]:.1%} in f64; Abbe's rendered ball leaks {int(leaks[:, 2].sum())} of "
        f"{rows * len(chosen) * len(aims)} rays (Woop's test with exact ties)."
    )
    labels = ("Moller-Trumbore, f32", "Moller-Trumbore, f64", "Abbe, rendered")
    series = [Series(label, 1 / aims, share[:, j], j == 2) for j, label in enumerate(labels)]
    return Plot(
        "T1",
        "Leaks through a closed mesh",
        "edge length / distance of the aim from the edge",
        "share of rays that leak",
        series,
        words,
        linear=True,
        source="Moller & Trumbore 1997; Woop, Benthin & Wald 2013",
    )
