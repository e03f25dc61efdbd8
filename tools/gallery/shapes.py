"""The meshes of the gallery: everything in scenes/meshes, and the landscape, which is too large to keep.

Points are numpy arrays n x 3; faces are lists of indices, counterclockwise when seen from outside. +y is up.
"""

import itertools

import numpy as np


def write_ply(path, points, faces, normals=None, uv=None):
    """Writes a binary PLY file of triangles."""
    columns = [("x y z", points), ("nx ny nz", normals), ("s t", uv)]
    columns = [(names.split(), np.asarray(values)) for names, values in columns if values is not None]
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(points)}"]
    header += [f"property float {name}" for names, _ in columns for name in names]
    header += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    corners = np.empty(len(faces), [("count", "u1"), ("corners", "<i4", 3)])
    corners["count"], corners["corners"] = 3, faces
    vertices = np.concatenate([values for _, values in columns], axis=1).astype("<f4")
    path.parent.mkdir(exist_ok=True)
    path.write_bytes("\n".join([*header, ""]).encode() + vertices.tobytes() + corners.tobytes())


def convex(normals, offsets):
    """Returns the convex polyhedron normals . p <= offsets: points and triangles, each face a fan.

    Planes pass through at most a few corners."""
    triples = np.array(list(itertools.combinations(range(len(normals)), 3)))
    determinants = np.linalg.det(normals[triples])
    triples = triples[np.abs(determinants) > 1e-9]
    corners = np.linalg.solve(normals[triples], offsets[triples][..., None])[..., 0]
    corners = corners[np.all(corners @ normals.T <= offsets + 1e-9, axis=1)]
    corners = np.unique(np.round(corners, 8) + 0.0, axis=0)
    faces = []
    for normal, offset in zip(normals, offsets):
        (on,) = np.nonzero(np.abs(corners @ normal - offset) < 1e-6)
        if len(on) < 3:
            continue
        u = np.cross(normal, [0.3, 0.5, 0.8])
        v = np.cross(normal, u)
        around = corners[on] - corners[on].mean(axis=0)
        on = on[np.argsort(np.arctan2(around @ v, around @ u))]
        faces += [(on[0], on[i], on[i + 1]) for i in range(1, len(on) - 1)]
    return corners, faces


def brilliant(table=0.53, crown=34.5, pavilion=40.75, star=0.5, lower=0.77, girdle=0.05, sides=96):
    """Returns a round brilliant of 57 facets with radius 1 and the axis +y; the middle of its girdle is in y = 0.

    Proportions of Marcel Tolkowsky, Diamond Design (1919): table, as a share of the diameter, crown and pavilion angle
    in degrees. Star facets reach `star` of the way to the girdle, lower halves `lower` of the way to the culet."""
    crown, pavilion = np.tan(np.radians([crown, pavilion]))
    between = np.cos(np.pi / 8)
    half = girdle / 2

    def at(radius, y, degrees):
        angle = np.radians(degrees)
        return np.array([radius * np.cos(angle), y, radius * np.sin(angle)])

    top = half + (1 - table) * crown
    tip = table * between + star * (1 - table * between)
    tip = (tip, half + (1 - tip * between) * crown)
    deep = (1 - lower, -half - (1 - (1 - lower) * between) * pavilion)
    planes = [(at(0, top, 0), at(1, top, 0), at(1, top, 90))]
    for k in range(8):
        a, b, c = 45 * k, 45 * k + 22.5, 45 * k + 45
        planes.append((at(1, half, a), at(table, top, a), at(1, half, a) + at(1, 0, a + 90)))
        planes.append((at(table, top, a), at(table, top, c), at(*tip, b)))
        planes.append((at(1, -half, a), at(0, -half - pavilion, a), at(1, -half, a) + at(1, 0, a + 90)))
        for corner in (a, c):
            planes.append((at(*tip, b), at(1, half, corner), at(1, half, b)))
            planes.append((at(*deep, b), at(1, -half, corner), at(1, -half, b)))
    normals = [np.cross(q - p, r - p) for p, q, r in planes] + [at(1, 0, 360 * k / sides) for k in range(sides)]
    through = [p for p, _, _ in planes] + [at(1, 0, 360 * k / sides) for k in range(sides)]
    normals = np.array([normal / np.linalg.norm(normal) for normal in normals])
    offsets = np.einsum("ij,ij->i", normals, through)
    normals[offsets < 0] *= -1
    return convex(normals, np.abs(offsets))


def lathe(profile, segments=96):
    """Returns a surface of revolution about y with smooth normals.

    `profile` is a list of (radius, y), from axis to axis or closed, with the outside on its right."""
    profile = np.array(profile, float)
    closed = np.allclose(profile[0], profile[-1])
    steps = np.diff(profile, axis=0)
    sides = np.stack([steps[:, 1], -steps[:, 0]], axis=1) / np.linalg.norm(steps, axis=1)[:, None]
    before, after = np.vstack([sides[-1:] if closed else [[0, -1]], sides]), np.vstack([sides, sides[:1] if closed else [[0, 1]]])
    slopes = before + after
    if not closed:
        slopes[0], slopes[-1] = [0, np.sign(slopes[0, 1])], [0, np.sign(slopes[-1, 1])]
    slopes /= np.linalg.norm(slopes, axis=1)[:, None]
    angles = np.arange(segments) * 2 * np.pi / segments
    ring = np.stack([np.cos(angles), np.ones(segments), np.sin(angles)], axis=1)
    points, normals, first = [], [], []
    for (radius, y), (out, up) in zip(profile, slopes):
        first.append(len(points))
        copies = ring if radius > 0 else ring[:1]
        points += list(copies * [radius, y, radius])
        normals += list(copies * [out, up, out])
    if closed:
        first[-1] = first[0]
        points, normals = points[:-segments], normals[:-segments]
    faces = []
    for i in range(len(profile) - 1):
        here = [first[i] + (k % segments if profile[i, 0] > 0 else 0) for k in range(segments + 1)]
        there = [first[i + 1] + (k % segments if profile[i + 1, 0] > 0 else 0) for k in range(segments + 1)]
        for k in range(segments):
            if profile[i, 0] > 0:
                faces.append((here[k], there[k], here[k + 1]))
            if profile[i + 1, 0] > 0:
                faces.append((here[k + 1], there[k], there[k + 1]))
    return np.array(points), faces, np.array(normals)


def arc(center, radius, start, end, steps=8):
    """Returns points on a circle, for a profile, from `start` to `end` degrees; counterclockwise if `end` is larger."""
    angles = np.radians(np.linspace(start, end, steps))
    return [(center[0] + radius * np.cos(a), center[1] + radius * np.sin(a)) for a in angles]


def lens(front, back, thickness, radius, steps=24):
    """Returns the profile of a lens about y, with its center at the origin and `thickness` on the axis.

    It lies between spheres of the radii `front` (top, convex if positive) and `back` (bottom). Its edge is a cylinder
    of `radius`."""

    def cap(r, way):
        heights = [*np.linspace(0, radius - 0.004, steps), radius]
        return [(h, way * (thickness / 2 - (np.sign(r) * (abs(r) - np.sqrt(r * r - h * h))))) for h in heights]

    return cap(back, -1) + cap(front, 1)[::-1]


def flint(back, thickness, radius, bottom, top, steps=24):
    """Returns the profile of an achromat's flint, `thickness` on the axis, behind a crown that ends at `bottom`.

    Its back has the radius `back`. Its top is flat and lies inside the crown, at the height `top`."""
    heights = np.array([*np.linspace(0, radius - 0.004, steps), radius])
    return [(h, bottom - thickness + back - np.sqrt(back * back - h * h)) for h in heights] + [(radius, top), (radius - 0.004, top), (0, top)]


def tumbler():
    """Returns a glass's profile: radius 0.38 at the foot, 0.46 at the rim, height 1.25, wall 0.035, thick bottom."""
    outside = [(0, 0), (0.3, 0), *arc((0.34, 0.045), 0.045, -90, -4), *[(0.385 + 0.075 * t, 0.045 + 1.19 * t) for t in (0.3, 0.65, 0.98)]]
    rim = arc((0.4425, 1.23), 0.0185, 0, 180, 9)
    inside = [(0.349 + 0.075 * t, 0.045 + 1.19 * t) for t in (0.98, 0.65, 0.3)]
    return outside + rim + inside + [*arc((0.305, 0.175), 0.05, 0, -90), (0.2, 0.118), (0, 0.115)]


def water(level=0.86, overlap=0.012):
    """Returns the profile of the water in the tumbler, with a meniscus. It reaches into the wall by `overlap`."""
    wall = lambda y: 0.349 + 0.075 * (y - 0.045) / 1.19 + overlap
    bottom = [(0, 0.115 - overlap), (0.2, 0.118 - overlap), *arc((0.305, 0.175), 0.05 + overlap, -90, 0)]
    rise = [(wall(level) - 0.06 * t, level + 0.022 * (1 - t) ** 3) for t in np.linspace(0.1, 1, 8)]
    return bottom + [(wall(y), y) for y in (0.35, 0.6, level)] + rise + [(0, level)]


def tube(radius=0.04, wall=0.006, length=1.5):
    """Returns a drinking straw along +y, with texture coordinates around it and along it."""
    outline = [(radius, 0), (radius, length), (radius - wall, length), (radius - wall, 0), (radius, 0)]
    points, faces, uv, segments = [], [], [], 48
    for (r0, y0), (r1, y1) in itertools.pairwise(outline):
        for k in range(segments + 1):
            a = 2 * np.pi * k / segments
            for r, y in ((r0, y0), (r1, y1)):
                points.append((r * np.cos(a), y, r * np.sin(a)))
                uv.append((k / segments, y))
            if k < segments:
                n = len(points) - 2
                faces += [(n, n + 1, n + 2), (n + 2, n + 1, n + 3)]
    return np.array(points), faces, np.array(uv)


def vase():
    """Returns the profile of a clay vase with a narrow neck, 0.4 high, open at the top."""
    t = np.linspace(0, 1, 16)
    outside = 0.055 + 0.075 * np.sin(np.pi * t**0.8) ** 1.4 + 0.02 * t**8
    wall = [(radius, 0.4 * y) for radius, y in zip(outside, t)]
    inside = [(radius - 0.008, 0.4 * y) for radius, y in zip(outside[::-1], t[::-1]) if y > 0.05]
    return [(0, 0), *wall, *inside, (0, 0.03)]


def bowl():
    """Returns the profile of a shallow bowl, 0.36 wide, with a foot."""
    t = np.linspace(0.15, 1, 10)
    outside = [(0.18 * x, 0.012 + 0.09 * x**2.2) for x in t]
    inside = [(0.18 * x - 0.004, 0.02 + 0.084 * x**2.2) for x in t[::-1]]
    return [(0, 0), (0.06, 0), (0.06, 0.008), *outside, *inside, (0, 0.021)]


def grid(rows, columns):
    """Returns the triangles between points in rows and columns."""
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).reshape(-1)
    upper = np.stack([corner, corner + columns, corner + 1], 1)
    return np.concatenate([upper, np.stack([corner + 1, corner + columns, corner + columns + 1], 1)])


def curtain(width=0.55, height=2.15, folds=5, columns=61, rows=15):
    """Returns a cloth hanging from the origin, gathered toward the top, with smooth normals; it folds in z along +x."""
    s, t = np.meshgrid(np.linspace(0, 1, columns), np.linspace(0, 1, rows))
    swing = 0.035 * (0.6 + 0.5 * t) * np.sin(2 * np.pi * folds * s + 0.8 * np.sin(3 * t)) + 0.012 * np.sin(17 * s + 4 * t)
    points = np.stack([(s - 0.5) * width * (0.9 + 0.12 * t), -height * t, swing], axis=-1)
    normals = np.cross(np.gradient(points, axis=0), np.gradient(points, axis=1))
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    return points.reshape(-1, 3), grid(rows, columns), normals.reshape(-1, 3)


def noise(size, cells, seed):
    """Returns smooth noise of a few cells on a square of size x size, within -1 and 1."""
    values = np.random.default_rng(seed).uniform(-1, 1, (cells + 2, cells + 2))
    place = np.linspace(0, cells, size, endpoint=False)
    i = place.astype(int)
    f = place - i
    f = f * f * f * (f * (6 * f - 15) + 10)
    rows = values[i] * (1 - f)[:, None] + values[i + 1] * f[:, None]
    return rows[:, i] * (1 - f) + rows[:, i + 1] * f


def ridges(size=1025):
    """Returns heights of mountains by ridged noise (Musgrave, Texturing and Modeling, 1994), roughest on the crests."""
    heights, weight, amplitude = np.zeros((size, size)), np.ones((size, size)), 1.0
    for octave in range(9):
        crest = (1 - np.abs(noise(size, 4 * 2**octave, 41 + octave))) ** 2
        heights += amplitude * weight * crest
        weight = np.clip(2.0 * crest * weight, 0, 1)
        amplitude *= 0.5
    return heights


def sheet(heights, width, depth):
    """Returns a grid of heights as a mesh around the origin, with texture coordinates 0 to 1."""
    rows, columns = heights.shape
    s, t = np.meshgrid(np.linspace(0, 1, columns), np.linspace(0, 1, rows))
    points = np.stack([(s - 0.5) * width, heights, (t - 0.5) * depth], axis=-1).reshape(-1, 3)
    return points, grid(rows, columns), np.stack([s, 1 - t], axis=-1).reshape(-1, 2)


def waves(size=65, width=5.2):
    """Returns heights of water, `width` x `width`: twelve crossing waves, equally steep, 1.1 to 0.4 long."""
    x, z = np.meshgrid(np.linspace(0, width, size), np.linspace(0, width, size))
    random, heights = np.random.default_rng(5), np.zeros((size, size))
    for length in np.geomspace(1.1, 0.4, 12):
        turn, phase = random.uniform(0, 2 * np.pi, 2)
        heights += 0.007 * length * np.sin(2 * np.pi * (x * np.cos(turn) + z * np.sin(turn)) / length + phase)
    return heights


def block(heights, width, depth, bottom):
    """Returns a body with upright sides, a flat bottom and a sheet of heights as its top, with smooth normals."""
    points, faces, _ = sheet(heights, width, depth)
    down, along = np.gradient(heights, depth / (heights.shape[0] - 1), width / (heights.shape[1] - 1))
    normals = np.stack([-along, np.ones_like(heights), -down], axis=-1).reshape(-1, 3)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    place = np.arange(heights.size).reshape(heights.shape)
    sides = [(place[-1], (0, 0, 1)), (place[::-1, -1], (1, 0, 0)), (place[0, ::-1], (0, 0, -1)), (place[:, 0], (-1, 0, 0))]
    points, faces, normals = list(points), [tuple(face) for face in faces], list(normals)
    middle = len(points)
    points.append(np.array([0, bottom, 0]))
    normals.append((0, -1, 0))
    for edge, outward in sides:
        first, count = len(points), len(edge)
        upper = [points[k] for k in edge]
        lower = [np.array([x, bottom, z]) for x, _, z in upper]
        points += upper + lower + lower
        normals += [outward] * (2 * count) + [(0, -1, 0)] * count
        for k in range(first, first + count - 1):
            faces += [(k, k + count, k + 1), (k + 1, k + count, k + count + 1), (k + 2 * count, middle, k + 2 * count + 1)]
    return np.array(points), faces, np.array(normals)


def sweep(width=30, front=14, back=-4, radius=3, height=14):
    """Returns the paper backdrop of a studio: a floor that bends up into a wall behind."""
    bend = [(back - radius * np.sin(a), radius - radius * np.cos(a), a) for a in np.linspace(0, np.pi / 2, 25)]
    outline = [(front, 0.0, 0.0), *bend, (back - radius, height, np.pi / 2)]
    points = np.array([(x, y, z) for z, y, _ in outline for x in (-width / 2, width / 2)])
    normals = np.array([(0, np.cos(a), np.sin(a)) for _, _, a in outline for _ in range(2)])
    faces = [face for n in range(0, len(points) - 2, 2) for face in ((n, n + 1, n + 2), (n + 2, n + 1, n + 3))]
    return points, faces, normals


def landscape():
    """Returns heights of a lake, 1025 x 1025, with mountains that rise to the north (-z) behind it."""
    heights = ridges()
    size = heights.shape[0]
    x, z = np.meshgrid(np.linspace(-1, 1, size), np.linspace(-1, 1, size))
    z = z + 0.12 * np.sin(3 * x + 1)
    rise = np.clip((0.42 - z) / 1.1, 0, 1)
    sides = np.clip(np.abs(x + 0.1) - 0.32, 0, 1) * 1.1
    return heights * (0.35 + 2.8 * rise**1.3 + sides) + 0.55 * rise
