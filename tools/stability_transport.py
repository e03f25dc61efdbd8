"""Stability rows W2, W4, W6, A1, A6, L1, L3, L4: trees, sums and lights. Naive methods in numpy, ours on rendered images."""

import numpy as np
from stability_plot import Plot, Series
from stability_scenes import green, mean_and_error, photograph, plane, slab, sphere, timed, view

R = 0.04  # one boundary of glass of index 1.5 at normal incidence


def stack_exact(panes):
    """Transmittance of a stack of panes, all orders summed (Stokes 1862)."""
    return (1 - R) / (1 + (2 * panes - 1) * R)


def stack_cut(panes: int, depth=10**9, weight=0.0) -> float:
    """Transmittance when no path is longer than `depth` boundaries, or when paths are dropped below a weight."""
    sides = 2 * panes
    down = {0: {0: 1}}  # place -> reflections so far -> number of paths; all rays of one step have met as many boundaries
    up: dict = {}
    out = 0.0
    for step in range(min(depth, 4000)):
        next_down: dict = {}
        next_up: dict = {}
        alive = False
        for rays, forward in ((down, True), (up, False)):
            for place, paths in rays.items():
                for reflections, count in paths.items():
                    for bounced in (False, True):
                        k = reflections + bounced
                        w = R**k * (1 - R) ** (step + 1 - k)
                        if w < weight or w * count < 1e-18:
                            continue
                        onward = forward != bounced
                        # Place p is the gap before boundary p when going down, and after boundary p - 1 when going up.
                        target = place + 1 if forward and onward else place if forward != onward else place - 1
                        if onward and target == sides:
                            out += w * count
                        elif not onward and target == 0:
                            continue
                        else:
                            book = (next_down if onward else next_up).setdefault(target, {})
                            book[k] = book.get(k, 0) + count
                            alive = True
        down, up = next_down, next_up
        if not alive:
            break
    return out


def stack_rendered(panes: int, quick: bool) -> tuple[float, float]:
    """Transmittance and its standard error from the renderer's own image of the stack before a lamp."""
    objects = [("pane", slab(-0.2 * i, -0.2 * i - 0.1)) for i in range(panes)]
    objects.append(("lamp", plane((0, -0.2 * panes - 1, 0), (0, 1, 0))))
    scene = view(objects, materials={"pane": {"dielectric": {"index": 1.5}}}, eye=(0, 5, 0), up=(0, 0, 1), columns=8, rows=8,
                 samples=8 if quick else 32)
    return mean_and_error(scene)


def stack_plot(row, title, quick, methods, source):
    """Light lost in stacks of panes, by several ways of ending a tree of paths."""
    panes = np.array([1, 4, 10] if quick else [1, 2, 3, 5, 7, 10, 14, 20])
    exact = stack_exact(panes)
    naive = [Series(label, panes, [max(0.0, 1 - stack_cut(int(n), **cut) / truth) for n, truth in zip(panes, exact, strict=True)])
             for label, cut in methods]
    found = np.array([stack_rendered(int(n), quick) for n in panes])
    ours = abs(found[:, 0] / exact - 1)
    z = float(np.max(abs(found[:, 0] - exact) / np.maximum(found[:, 1], 1e-7)))
    ten = int(np.argmin(abs(panes - 10)))
    words = (
        f"Before ten panes, {naive[0].label} loses {naive[0].y[ten]:.0%} of the light and {naive[-1].label} {naive[-1].y[ten]:.1%}; Abbe renders "
        f"{found[ten, 0]:.4f} +- {found[ten, 1]:.4f} for {exact[ten]:.4f}, at most {z:.1f} standard errors off at any number of panes."
    )
    series = [*naive, Series("Abbe, rendered", panes, ours, True)]
    plot = Plot(row, title, "panes", "share of the light that is missed", series, words, bound=5e-3, least=1e-6, source=source)
    plot.notes.append(f"z {z:.3f}")
    return plot


def w2(quick: bool) -> Plot:
    """Depth limits."""
    methods = [(f"a depth limit of {depth}", {"depth": depth}) for depth in (10, 20, 40)]
    return stack_plot("W2", "Panes of glass and a depth limit", quick, methods, "closed form: every path counted")


def w4(quick: bool) -> Plot:
    """Weight cuts."""
    methods = [(f"a cut at weight {cut:g}", {"weight": cut}) for cut in (1e-2, 1e-3, 1e-4)]
    return stack_plot("W4", "Panes of glass and a weight cut", quick, methods, "closed form: every path counted")


def w6(quick: bool) -> Plot:
    """A closed white room around a point light."""
    absorbed = np.array([0.1, 0.01] if quick else [0.3, 0.1, 0.03, 0.01, 0.003, 0.001])
    ours, errors = [], []
    for a in absorbed:
        light = {"point": {"position": [0, 0, 0], "intensity": 1}}
        room = {"paint": {"diffuse": {"reflectance": float(1 - a)}}}
        scene = view([("paint", sphere())], [light], room, eye=(0, 0, 0), target=(0, 0, -1), fov=90, columns=16, rows=16, samples=8)
        mean, error = mean_and_error(scene)
        exact = (1 - a) / np.pi / a
        ours.append(abs(mean / exact - 1))
        errors.append(error / exact)
    z = float(np.max(np.array(ours) / np.array(errors)))
    naive = [Series(f"depth limit {depth}", 1 / absorbed, (1 - absorbed) ** depth) for depth in (5, 20, 100)]
    words = (
        f"Where a wall keeps {absorbed[-1]:.1%} of the light, a limit of 100 bounces misses {naive[-1].y[-1]:.0%} of a closed room's; Abbe's roulette on the "
        f"throughput is off by at most {max(ours):.1%}, {z:.1f} standard errors."
    )
    plot = Plot("W6", "Light in a closed white room", "1 / share that a wall absorbs", "share of the light that is missed",
                [*naive, Series("Abbe, rendered", 1 / absorbed, ours, True)], words, bound=0.05, least=1e-6,
                source="geometric series")
    plot.notes.append(f"z {z:.3f}")
    return plot


def sum_f32(value: np.float32, counts) -> list[float]:
    """Relative error of a running sum of equal samples in f32, by as many additions."""
    total, done, result, block = np.float32(0), 0, [], 2**20
    for count in counts:
        while done < count:
            step = min(block, count - done)
            terms = np.full(step + 1, value, np.float32)
            terms[0] = total
            total = np.add.accumulate(terms)[-1]
            done += step
        result.append(abs(float(total) / (count * float(value)) - 1))
    return result


def a1(quick: bool) -> Plot:
    """Many samples in one pixel."""
    counts = 2 ** np.arange(6, 19 if quick else 26, 4 if quick else 3)
    value = np.float32(0.1)
    naive = sum_f32(value, counts.tolist())
    scene = view([], [{"environment": {"radiance": 0.1}}], eye=(0, 0, 3), samples=1)
    ours = [abs(float(green(scene, samples=int(n))[0, 0]) / 0.1 - 1) for n in counts]
    words = (
        f"A pixel summed in f32 is off by {naive[-1]:.1%} after {counts[-1]:,} samples; Abbe's film, summed in f64, shows a sky of 0.1 "
        f"within {max(ours):.1g} after any number (the 32-bit numbers of the file carry 6e-8)."
    )
    return Plot("A1", "Summing samples", "samples in a pixel", "relative error of the mean",
                [Series("sum in f32", counts, naive), Series("Abbe, rendered", counts, ours, True)], words, bound=6e-8, source="Higham 2002, section 4.2")


def caustic_scene(radius: float, samples: int, caustics: str, **settings) -> str:
    """A floor below a glass ball below a lamp of one power, seen without the ball."""
    materials = {"glass": {"dielectric": {"index": 1.5}}, "tiny": {"emissive": {"radiance": 1 / radius**2}}, "floor": {"diffuse": {"reflectance": 0.7}}}
    objects = [("glass", sphere((0, 1, 0), 0.5)), ("tiny", sphere((0, 5, 0), radius)), ("floor", plane((0, 0, 0), (0, 1, 0)))]
    return view(objects, materials=materials, eye=(0, 0.4, 3), target=(0, 0, 0), fov=22, columns=24, rows=16, samples=samples,
                caustics=caustics, **settings)


def a6(quick: bool) -> Plot:
    """A caustic, met by chance or by photons: error times processor time.

    By chance a path brings reflectance x radiance x transmittance or nothing, so its variance is that product times what it
    brings on average, which the converged picture tells; rare paths make what a single picture shows of it far too small."""
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
        f"Paths that must meet the lamp by chance need {ratio[0]:.1g} times Abbe's processor time for the same error at a lamp of radius {radii[0]:g} and "
        f"{ratio[-1]:.1g} times at {radii[-1]:g}; with photons from the lamp 1 % takes {costs['auto'][0]:.2g} s and {costs['auto'][-1]:.2g} s. A single "
        "picture by chance looks better than it is, since it shows few of the rare paths."
    )
    series = [Series("by chance, expected\n(variance computed,\ntime measured)", 1 / radii, costs["expected"]),
              Series("by chance, one picture\n(caustics = \"off\")", 1 / radii, costs["off"]), Series("Abbe, rendered", 1 / radii, costs["auto"], True)]
    return Plot("A6", "A caustic of a small lamp", "1 / radius of the lamp", "processor seconds to 1 % error", series, words, source="Kajiya 1986 for paths by chance")


def l1(quick: bool) -> Plot:
    """A floor under a far, small ball of light of the same irradiance."""
    sizes = 10.0 ** np.arange(-1, -6.1, -2 if quick else -0.5)
    ours = []
    for size in sizes:
        objects = [("white", plane((0, 0, 0), (0, 1, 0))), ("far", sphere((0, 1, 0), float(size)))]
        scene = view(objects, materials={"far": {"emissive": {"radiance": float(1 / size**2)}}}, eye=(3, 1, 0), columns=8, rows=8, samples=64,
                     diffuse_bounces=0)
        ours.append(abs(float(green(scene).mean()) - 1))
    s = sizes.astype(np.float32)
    with np.errstate(divide="ignore"):
        cone = np.float32(1) - np.sqrt(np.float32(1) - s * s)
    truth = sizes**2 / (1 + np.sqrt(1 - sizes**2))
    naive = abs(cone.astype(float) / truth - 1)
    bad = int(np.argmin(abs(sizes - 1e-3)))
    words = (
        f"1 - cos of the cone in f32 is off by {naive[bad]:.0%} at a radius of {sizes[bad]:g} of the distance and 0 at {sizes[naive >= 1][0]:.0e}, a density of infinity; "
        f"Abbe's floors get the right irradiance within {max(ours):.1g} down to {sizes[-1]:.0e}."
    )
    return Plot("L1", "A ball of light, far away", "distance / radius of the lamp", "relative error",
                [Series("solid angle by\n1 - cos, f32", 1 / sizes, naive), Series("irradiance,\nAbbe, rendered", 1 / sizes, ours, True)], words,
                bound=2e-3, source="Shirley, Wang & Zimmerman 1996")


def wall_share(h):
    """Form factor from a point of the floor to a square of side 2 that stands on it at distance h (Howell, B-5)."""
    far = np.hypot(h, 2)
    return (np.arctan(1 / h) - h / far * np.arctan(1 / far)) / np.pi


def area_deviation(h):
    """Standard deviation over the mean of one point drawn evenly on that lamp, by the trapezoid rule over the logarithms."""
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
        lamp = {"quad": {"center": [0, 1, 0], "u": [0, 0, -1], "v": [0, 1, 0]}}
        scene = view([("white", plane((0, 0, 0), (0, 1, 0))), ("lamp", lamp)], eye=(float(h), 3, 0), target=(float(h), 0, 0), up=(0, 0, 1), fov=1e-6,
                     columns=64, rows=64, samples=1, diffuse_bounces=0)
        shown = green(scene)
        ours.append(shown.std() / exact)
        misses.append(abs(shown.mean() / exact - 1) / (shown.std() / exact / 64))
    words = (
        f"At {heights[-1]:g} of a standing lamp's half side, points drawn evenly on it vary by {naive[-1]:.0f} times their mean and find {biases[-1]:.0%} of the light in {count} samples; Abbe's samples "
        f"deviate by at most {max(ours):.2f} of the mean at any distance, and the mean is within {max(misses):.1f} standard errors."
    )
    plot = Plot("L3", "A lamp that touches the floor", "half side of the lamp / distance", "standard deviation / mean of one sample",
                [Series("points drawn\non the lamp (exact)", 1 / heights, naive), Series("Abbe, rendered", 1 / heights, ours, True)], words, bound=1.1,
                source="Shirley, Wang & Zimmerman 1996; Veach 1997")
    plot.notes.append(f"z {max(misses):.3f}")
    return plot


def girard_f32(size: float) -> float:
    """Solid angle by the excess of the angles (Girard), in f32, of a triangle of edge `size` at distance 1."""
    p = triangle_points(size).astype(np.float32)
    a, b, c = (v / np.sqrt(v @ v, dtype=np.float32) for v in p)

    def angle(at, one, two):
        u, v = np.cross(at, one), np.cross(at, two)
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.arccos(np.clip((u @ v) / np.sqrt((u @ u) * (v @ v)), -1, 1), dtype=np.float32)

    return float(angle(a, b, c) + angle(b, c, a) + angle(c, a, b) - np.float32(np.pi))


def triangle_points(size: float):
    """Corners around (0, 1, 0), in a plane that faces down."""
    turns = np.radians([10, 130, 250])
    return np.stack([size / np.sqrt(3) * np.cos(turns), np.ones(3), size / np.sqrt(3) * np.sin(turns)], -1)


def triangle_integral(size: float, power: float) -> float:
    """Integral of cos^power / r^2 over the triangle seen from the origin, 8 x 8 Gauss points: power 1 for the solid angle."""
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
        lamp = {"triangle": {"points": triangle_points(size)}}
        scene = view([("white", plane((0, 0, 0), (0, 1, 0))), ("small", lamp)], materials={"small": {"emissive": {"radiance": radiance}}}, eye=(3, 0.8, 0),
                     columns=16, rows=16, samples=64, diffuse_bounces=0)
        ours.append(abs(float(green(scene).mean()) - 1))
    bad = int(np.argmin(abs(sizes - 1e-3)))
    words = (
        f"The solid angle of a triangle of edge {sizes[bad]:.1g} by the excess of its angles in f32 is off by {naive[bad]:.0%}; Abbe's floors under such lamps are "
        f"right within {max(ours):.1g} down to an edge of {sizes[-1]:.0e}."
    )
    return Plot("L4", "A small triangle of light", "distance / edge of the lamp", "relative error",
                [Series("solid angle by\nGirard, f32", 1 / sizes, naive), Series("irradiance,\nAbbe, rendered", 1 / sizes, ours, True)], words,
                bound=2e-3, source="Girard 1626; van Oosterom & Strackee 1983")
