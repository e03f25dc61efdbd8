"""Stability rows W2, W4, W6, A1: trees of paths and sums of samples. Naive methods in numpy, ours on images."""

import numpy as np
from validation.scenes import plane, sphere

from .plot import Plot, Series
from .scenes import green, mean_and_error, slab, view

R = 0.04  # one boundary of glass of index 1.5 at normal incidence


def stack_exact(panes):
    """Returns the transmittance of a stack of panes, all orders summed (Stokes 1862)."""
    return (1 - R) / (1 + (2 * panes - 1) * R)


def stack_cut(panes: int, depth=10**9, weight=0.0) -> float:
    """Returns the transmittance if no path meets more than `depth` boundaries, or paths are dropped below a weight."""
    sides = 2 * panes
    down = {
        0: {0: 1}
    }  # place -> reflections so far -> number of paths; all rays of a step have met equally many boundaries
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
    """Returns transmittance and its standard error from rendered images of the stack in front of a lamp."""
    objects = [("pane", slab(-0.2 * i, -0.2 * i - 0.1)) for i in range(panes)]
    objects.append(("lamp", plane((0, -0.2 * panes - 1, 0), (0, 1, 0))))
    scene = view(
        objects,
        materials={"pane": {"dielectric": {"index": 1.5}}},
        eye=(0, 5, 0),
        up=(0, 0, 1),
        columns=8,
        rows=8,
        samples=8 if quick else 32,
    )
    return mean_and_error(scene)


def stack_plot(row, title, quick, methods, source):
    """Plots the light lost in stacks of panes, by several ways of ending a tree of paths."""
    panes = np.array([1, 4, 10] if quick else [1, 2, 3, 5, 7, 10, 14, 20])
    exact = stack_exact(panes)
    naive = [
        Series(
            label,
            panes,
            [max(0.0, 1 - stack_cut(int(n), **cut) / truth) for n, truth in zip(panes, exact, strict=True)],
        )
        for label, cut in methods
    ]
    found = np.array([stack_rendered(int(n), quick) for n in panes])
    ours = abs(found[:, 0] / exact - 1)
    z = float(np.max(abs(found[:, 0] - exact) / np.maximum(found[:, 1], 1e-7)))
    ten = int(np.argmin(abs(panes - 10)))
    words = (
        f"Before ten panes, {naive[0].label} loses {naive[0].y[ten]:.0%} of the light and {naive[-1].label} still "
        f"{naive[-1].y[ten]:.1%}; Abbe renders "
        f"{found[ten, 0]:.4f} +- {found[ten, 1]:.4f} for {exact[ten]:.4f}, at most {z:.1f} standard errors off at any "
        "number of panes."
    )
    series = [*naive, Series("Abbe, rendered\n(noise)", panes, ours, True)]
    ylabel = "share of the light that is missed"
    return Plot(row, title, "panes", ylabel, series, words, bound=5e-3, least=1e-6, source=source, z=z)


def w2(quick: bool) -> Plot:
    """Depth limits."""
    methods = [(f"a depth limit of {depth}", {"depth": depth}) for depth in (10, 20, 40)]
    return stack_plot("W2", "Panes of glass and a depth limit", quick, methods, "Whitted 1980")


def w4(quick: bool) -> Plot:
    """Weight cuts."""
    methods = [(f"a cut at weight {cut:g}", {"weight": cut}) for cut in (1e-2, 1e-3, 1e-4)]
    return stack_plot("W4", "Panes of glass and a weight cut", quick, methods, "Hall & Greenberg 1983")


def w6(quick: bool) -> Plot:
    """A closed white room around a point light."""
    absorbed = np.array([0.1, 0.01] if quick else [0.3, 0.1, 0.03, 0.01, 0.003, 0.001])
    ours, errors = [], []
    for a in absorbed:
        light = {"point": {"position": [0, 0, 0], "intensity": 1}}
        room = {"paint": {"diffuse": {"reflectance": float(1 - a)}}}
        scene = view(
            [("paint", sphere())],
            [light],
            room,
            eye=(0, 0, 0),
            target=(0, 0, -1),
            fov=90,
            columns=16,
            rows=16,
            samples=8,
        )
        mean, error = mean_and_error(scene)
        exact = (1 - a) / np.pi / a
        ours.append(abs(mean / exact - 1))
        errors.append(error / exact)
    z = float(np.max(np.array(ours) / np.array(errors)))
    naive = [Series(f"depth limit {depth}", 1 / absorbed, (1 - absorbed) ** depth) for depth in (5, 20, 100)]
    words = (
        f"Where a wall keeps {absorbed[-1]:.1%} of the light, a limit of 100 bounces misses {naive[-1].y[-1]:.0%} of "
        "a closed room's; Abbe's roulette on the "
        f"throughput is off by at most {max(ours):.1%}, {z:.1f} standard errors."
    )
    return Plot(
        "W6",
        "Light in a closed white room",
        "1 / share that a wall absorbs",
        "share of the light that is missed",
        [*naive, Series("Abbe, rendered\n(noise)", 1 / absorbed, ours, True)],
        words,
        bound=0.05,
        least=1e-6,
        source="Arvo & Kirk 1990",
        z=z,
    )


def sum_f32(value: np.float32, counts) -> list[float]:
    """Returns the relative error of a running sum of equal samples in f32, after each number of additions."""
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
        f"A pixel summed in f32 is off by {naive[-1]:.1%} after {counts[-1]:,} samples; Abbe's film, summed in f64, "
        "shows a sky of 0.1 "
        f"within {max(ours):.1g} after any number (the 32-bit numbers of the file carry 6e-8)."
    )
    return Plot(
        "A1",
        "Summing samples",
        "samples in a pixel",
        "relative error of the mean",
        [Series("sum in f32", counts, naive), Series("Abbe, rendered", counts, ours, True)],
        words,
        bound=6e-8,
        source="Higham 2002, section 4.2",
    )
