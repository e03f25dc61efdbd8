"""Stability rows D5, D13, G4, G6, M3: materials and spectra. Naive methods in numpy, ours on rendered images."""

from itertools import pairwise

import numpy as np
from validation.scenes import plane, sphere

from .plot import Plot, Series, times
from .scenes import WHITE_SKY, fresnel, green, mean_and_error, slab, view

GLASS, WATER = 1.5168, 1.333


def d5(quick: bool) -> Plot:
    """Diffuse light on glass of an index close to 1: the mean of its reflectance by Fresnel and by Schlick."""
    excess = np.array([1e-4, 1e-2, 0.5] if quick else [1e-4, 1e-3, 1e-2, 0.05, 0.1, 0.333, 0.52, 1.0, 1.42])
    rows = 256
    impact = (np.arange(rows) + 0.5) / rows
    cosine = np.sqrt(1 - impact**2)
    schlick, ours = [], []
    for index in 1 + excess:
        exact = float(np.sum(fresnel(index, cosine) * impact))
        r0 = ((index - 1) / (index + 1)) ** 2
        schlick.append(abs(float(np.sum((r0 + (1 - r0) * (1 - cosine) ** 5) * impact)) / exact - 1))
        black = {"black": {"dielectric": {"index": index, "absorption": 1e6}}}
        scene = view(
            [("black", sphere())], [WHITE_SKY], black, eye=(0, 0.5, 3), target=(0, 0.5, 0), height=1, rows=rows
        )
        shown = green(scene)[::-1, 0]
        ours.append(abs(float(np.sum(shown * impact)) / exact - 1))
    near = int(np.argmin(abs(excess - 1e-2)))
    words = (
        f"Schlick's approximation reflects {times(1 + schlick[near])} times too much diffuse light at an index of "
        f"{1 + excess[near]:.2f}, and {times(schlick[0])} "
        f"times at {1 + excess[0]:g}: it never falls below 1/21. Abbe's balls show the exact Fresnel mean within "
        f"{max(ours):.1g}."
    )
    series = [Series("Schlick 1994", excess, schlick), Series("Abbe, rendered", excess, ours, True)]
    return Plot(
        "D5",
        "Reflection at a small step of index",
        "index - 1",
        "relative error of the mean reflectance",
        series,
        words,
        bound=1e-6,
        source="Schlick 1994; Fresnel",
    )


def d13(quick: bool) -> Plot:
    """A line as bright as the continuum below it, seen through dispersive glass."""
    widths = np.array([10, 0.1] if quick else [30, 10, 3, 1, 0.3, 0.1, 0.03, 0.01])
    plate = [("prism", slab(0, -0.5))]
    glass = {"prism": {"dielectric": {"index": "N-SF11"}}}
    looking = {
        "eye": (0, 3, 0),
        "up": (0, 0, 1),
        "materials": glass,
        "model": "hero",
        "space": "lin_ciexyzd65_scene",
        "samples": 1,
    }

    def luminances(radiance, side):
        scene = view(plate, [{"environment": {"radiance": radiance}}], columns=side, rows=side, fov=1, **looking)
        return green(scene)

    even = luminances({"samples": [[380, 1], [730, 1]]}, 16).mean()
    power = even / luminances({"lines": [[589, 1]]}, 16).mean()
    ours, misses = [], []
    for w in widths:
        h, edge = 1 + power / w, 1e-3 * min(w, 1)
        line = [[589 - w / 2 - edge, 1], [589 - w / 2, h], [589 + w / 2, h], [589 + w / 2 + edge, 1]]
        shown = luminances({"samples": [[380, 1], *line, [730, 1]]}, 64)
        ours.append(shown.std() / shown.mean())
        misses.append(abs(shown.mean() / (2 * even) - 1))
    span = 730 - 380

    def naive(lanes):
        share = widths * lanes / span
        return span / widths / lanes * np.sqrt(share * (1 - share)) / 2

    series = [
        Series("1 wavelength a sample,\nuniform (closed form)", widths[::-1], naive(1)[::-1]),
        Series("4 stratified\n(closed form)", widths[::-1], naive(4)[::-1]),
        Series("Abbe, rendered (hero)", widths[::-1], np.array(ours)[::-1], True),
    ]
    for one in series:
        one.x = 1 / one.x
    words = (
        f"A line {widths[-1]:g} nm wide and as strong as the continuum makes uniformly drawn wavelengths vary by "
        f"{naive(4)[-1]:.0f} times their mean, four "
        f"lanes and all; Abbe's heroes, seen through N-SF11, vary by {ours[-1]:.2f} at that width and at most "
        f"{max(ours):.2f} at any."
    )
    return Plot(
        "D13",
        "Narrow emission lines",
        "1 / width of the line, in 1/nm",
        "deviation / mean of one sample",
        series,
        words,
        bound=1.1,
        source="Wilkie et al. 2014 for the stratified lanes",
    )


def ggx_f32(cosine, alpha):
    """Returns the GGX density of facets as it is usually written, in f32."""
    c2, a2 = np.float32(cosine) ** 2, np.float32(alpha) ** 2
    with np.errstate(divide="ignore"):
        return a2 / (np.float32(np.pi) * (c2 * (a2 - np.float32(1)) + np.float32(1)) ** 2)


def single_scattering(alpha: float, count: int) -> float:
    """Returns the mean albedo of a lossless GGX metal for diffuse light, without light that meets a second facet.

    Facets are sampled by the visible normals of Heitz 2018, with weight G2 / G1 (height-correlated Smith)."""
    random = np.random.default_rng(11)
    cosine = np.sqrt((np.arange(count) + 0.5) / count)
    wo = np.stack([np.sqrt(1 - cosine**2), np.zeros(count), cosine], -1)
    stretched = wo * (alpha, alpha, 1)
    stretched /= np.linalg.norm(stretched, axis=-1, keepdims=True)
    flat = np.hypot(stretched[:, 0], stretched[:, 1])
    t1 = np.stack([-stretched[:, 1], stretched[:, 0], np.zeros(count)], -1) / flat[:, None]
    t2 = np.cross(stretched, t1)
    u, v = random.random((2, count))
    x, y = np.sqrt(u) * np.cos(2 * np.pi * v), np.sqrt(u) * np.sin(2 * np.pi * v)
    s = (1 + stretched[:, 2]) / 2
    y = (1 - s) * np.sqrt(1 - x**2) + s * y
    h = x[:, None] * t1 + y[:, None] * t2 + np.sqrt(np.maximum(0, 1 - x**2 - y**2))[:, None] * stretched
    h *= (alpha, alpha, 1)
    h /= np.linalg.norm(h, axis=-1, keepdims=True)
    wi = 2 * np.sum(wo * h, -1, keepdims=True) * h - wo

    def smith(w):
        return (np.sqrt(1 + alpha**2 * (1 / np.maximum(w[:, 2] ** 2, 1e-300) - 1)) - 1) / 2

    weight = (1 + smith(wo)) / (1 + smith(wo) + smith(wi))
    return float(np.mean(np.where(wi[:, 2] > 0, weight, 0)))


def g6(quick: bool) -> Plot:
    """A lossless rough metal ball under a uniform sky: it should vanish."""
    roughness = np.array([0.3, 1.0] if quick else [0.1, 0.2, 0.3, 0.45, 0.6, 0.8, 1.0])
    alphas = roughness**2
    naive = [1 - single_scattering(alpha, 50_000) for alpha in alphas]
    ours, errors = [], []
    for value in roughness:
        metal = {"metal": {"conductor": {"n": 1e-6, "k": 100, "roughness": float(value)}}}
        scene = view(
            [("metal", sphere(radius=2.0))],
            [WHITE_SKY],
            metal,
            eye=(0, 0, 9),
            height=4 / np.sqrt(2),
            columns=32,
            rows=32,
            samples=64,
        )
        mean, error = mean_and_error(scene)
        ours.append(abs(mean - 1))
        errors.append(error)
    words = (
        f"With single scattering a lossless metal of alpha 1 loses {naive[-1]:.0%} of the light; Abbe's balls give "
        "back all of it but "
        f"{max(ours):.1g} (standard error {max(errors):.0e})."
    )
    series = [Series("single scattering", alphas, naive), Series("Abbe, rendered", alphas, ours, True)]
    return Plot(
        "G6",
        "Energy of rough metals",
        "width of the facets' slopes, alpha",
        "share of light lost or won",
        series,
        words,
        bound=5e-3,
        source="Heitz 2018; Kulla & Conty 2017",
    )


def through(indices) -> float:
    """Returns the transmittance of a stack of boundaries at normal incidence, all orders summed: their R / T add up."""
    r = [((a - b) / (a + b)) ** 2 for a, b in pairwise(indices)]
    return 1 / (1 + sum(one / (1 - one) for one in r))


def m3(quick: bool) -> Plot:
    """Water on glass: with an air gap, overlapping without a rule, and overlapping by priority."""
    depths = np.array([1e-1, 1e-3, 1e-6] if quick else [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6])
    exact = through([1, GLASS, WATER, 1])
    gap, ours = [], []
    for depth in depths:
        for shift, found in ((-depth, gap), (depth, ours)):
            materials = {
                "glass": {"dielectric": {"index": GLASS, "priority": 1}},
                "water": {"dielectric": {"index": WATER}},
            }
            objects = [
                ("glass", slab(1, 0)),
                ("water", slab(float(shift), -1, side=39.0)),
                ("lamp", plane((0, -3, 0), (0, 1, 0))),
            ]
            scene = view(objects, materials=materials, eye=(0, 5, 0), up=(0, 0, 1))
            found.append(abs(float(green(scene)[0, 0]) / exact - 1))
    alone = abs(through([1, GLASS, 1, WATER, 1]) / exact - 1)
    words = (
        f"Water drawn a hair below its glass loses {gap[-1]:.1%} of the light however thin the gap of air, and bodies "
        "that overlap without a rule as "
        f"much; Abbe's priorities let them overlap and keep the transmittance within {max(ours):.1g}, whatever the "
        "overlap."
    )
    series = [
        Series("gap of air (rendered)", 1 / depths, gap),
        Series("overlap, each boundary\nby itself (closed form)", 1 / depths, [alone] * len(depths)),
        Series("Abbe, rendered:\noverlap by priority", 1 / depths, ours, True),
    ]
    return Plot(
        "M3",
        "Water in glass",
        "thickness of the glass / gap or overlap",
        "relative error of the transmittance",
        series,
        words,
        bound=1e-6,
        source="Schmidt & Budge 2002",
    )


def g4(quick: bool) -> Plot:
    """The highlight of a point light on metal that is polished more and more."""
    alphas = np.array([1e-2, 1e-3, 2e-4] if quick else [1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 3e-4, 2e-4, 1.1e-4])
    tilts = np.array([0.0, 0.5, 1.0, 2.0])
    naive, ours = [], []
    for alpha in alphas:
        metal = {"metal": {"conductor": {"n": 1e-6, "k": 100, "roughness": float(np.sqrt(alpha))}}}
        worst, missed = 0.0, 0.0
        for tilt in tilts:
            slope = tilt * alpha
            cosine = 1 / np.hypot(1, slope)
            exact = 1 / (np.pi * alpha**2 * cosine**4 * (1 + tilt**2) ** 2)
            worst = max(worst, abs(float(ggx_f32(cosine, alpha)) / exact - 1))
            turn = 2 * np.arctan(slope)
            light = {"point": {"position": [float(3 * np.sin(turn)), float(3 * np.cos(turn)), 0], "intensity": 9}}
            scene = view([("metal", plane((0, 0, 0), (0, 1, 0)))], [light], metal, eye=(0, 2, 0), up=(0, 0, 1))
            shown = float(green(scene)[0, 0])
            lambda_ = (np.sqrt(1 + (alpha * np.tan(turn)) ** 2) - 1) / 2
            missed = max(missed, abs(shown / (exact / (1 + lambda_) / 4) - 1))
        naive.append(worst)
        ours.append(missed)
    near = int(np.argmin(abs(alphas - 1e-3)))
    words = (
        f"Written as c^2 (alpha^2 - 1) + 1 in f32, the density of facets is off by {naive[near]:.1%} at alpha "
        f"{alphas[near]:g}, and "
        f"{'infinite' if np.isinf(naive[-1]) else f'off by {naive[-1]:.0%}'} at {alphas[-1]:g}; Abbe's highlights of "
        f"a point light are right within {max(ours):.1g}, and below 1e-4 metal counts as smooth."
    )
    last = " (last: infinite)" if np.isinf(naive[-1]) else ""
    series = [
        Series(f"c^2 (alpha^2 - 1) + 1,\nf32{last}", 1 / alphas, np.minimum(naive, 1e3)),
        Series("Abbe, rendered", 1 / alphas, ours, True),
    ]
    return Plot(
        "G4",
        "Highlights on polished metal",
        "1 / alpha",
        "worst relative error of the radiance",
        series,
        words,
        bound=1e-5,
        source="Walter et al. 2007 for the distribution",
    )
