"""Energy III: closed rooms, where every bounce counts."""

import numpy as np

from . import formulas, readers
from .row import Row
from .scenes import cube, diffuse, disc, glass, glow, rgb, sphere, view

SPREAD = (1.1, 1.5, 2.5)


def rows(quick):
    """Yields closed rooms, where every bounce counts."""
    size, samples = (12, 512) if quick else (20, 1024)
    for reflectance in (0.65, 0.8, 0.95):
        fraction = 0.05
        # From every point of the wall, a disc across a sphere has the view factor of the cap behind it.
        depth = 1 - 2 * fraction
        port = disc((0, depth, 0), (0, -1, 0), np.sqrt(1 - depth**2))
        materials = {"wall": diffuse(reflectance), "port": glow()}
        scene = view(
            materials,
            [("wall", sphere()), ("port", port)],
            eye=(0, 0, 0),
            target=(0.3, -1, 0.2),
            fov=70,
            size=size,
            samples=samples,
        )
        bounced = reflectance * (1 - fraction)
        expected = reflectance * fraction / (1 - bounced)
        words = (
            f"The inside of a sphere of reflectance {reflectance}; a disc across it that glows by 1 stands for a "
            f"cap of 5 %."
        )
        yield Row(
            "energy",
            f"integrating sphere of reflectance {reflectance}, port of 5 %",
            "rho f / (1 - rho (1 - f))",
            scene,
            readers.gray,
            expected,
            "paths that end after 8 bounces",
            expected * (1 - bounced**8),
            words,
            2,
        )
    for reflectance in ((0.5, 0.7, 0.8), (0.55, 0.75, 0.9)):
        yield from box(np.array(reflectance), quick)
    for name, material, expected, mistake in (
        ("diffuse ball", diffuse(0.5), 0.5, 0.51),
        ("clear ball", glass(rgb(SPREAD)), 1.0, 0.99),
    ):
        materials = {"ball": material, "lamp": glow()}
        objects = [("ball", sphere(radius=0.6)), ("lamp", cube((0.3, 0.2, -0.1), [5.0, 4.0, 6.0]))]
        scene = view(materials, objects, eye=(0.9, 0.4, 1.6), fov=18, size=size, samples=samples // 2)
        words = f"A {name} of radius 0.6 at the origin in a closed box of 5 x 4 x 6 that glows by 1."
        yield Row(
            "energy",
            f"{name} in a glowing box",
            "L = rho" if "diffuse" in name else "L = 1",
            scene,
            readers.colors,
            expected,
            "a lamp counted twice or not at all by 1 % of the paths",
            mistake,
            words,
            2,
        )


def box(reflectance, quick):
    """Yields a diffuse cube around a point light in its middle. All walls are equal, so one is seen, evenly in area."""
    materials, intensity, edge = {"wall": diffuse(rgb(reflectance))}, 1.0, 2.0
    light = {"point": {"position": (0.0, 0.0, 0.0), "intensity": intensity}}
    size, samples = (24, 256) if quick else (32, 1024)
    scene = view(
        materials,
        [("wall", cube(size=edge))],
        [light],
        eye=(0, 0, 0),
        target=(0, 0, -1),
        height=edge,
        size=size,
        samples=samples,
    )
    expected = formulas.irradiance_in_box(4 * np.pi * intensity, 6 * edge**2, reflectance) * reflectance / np.pi
    words = (
        "A closed cube of edge 2, a point light of intensity 1 in its middle; one wall, seen whole by parallel rays."
    )
    yield Row(
        "energy",
        f"closed box of reflectances {'/'.join(map(str, reflectance))}",
        "rho Phi / (pi S (1 - rho))",
        scene,
        readers.colors,
        expected,
        "paths that end after 8 bounces",
        expected * (1 - reflectance**8),
        words,
        2 if quick else 8,  # light paths, used for larger images, are shared by all pixels of one
    )
