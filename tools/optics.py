"""Closed-form optics and transport, from first principles: what the rendered numbers are held against.

    from optics import fresnel, slab
    fresnel(1.5, 45)                 # 0.0502..., unpolarized
    slab(1.5, 0, optical_depth=1)    # (R, T) of a plate with all its reflections
"""

import numpy as np


def refracted_cosine(index, degrees):
    """Snell's law, from air into a medium of `index`."""
    return np.sqrt(1 - (np.sin(np.radians(degrees)) / index) ** 2)


def fresnel(index, degrees):
    """Unpolarized reflectance of the boundary between air and `index`, which is complex for a metal (n + ik).

    Born and Wolf, Principles of Optics, 1.5.2 (20), 1.5.3 (30) and 14.2.
    """
    cosine, cosine_t = np.cos(np.radians(degrees)), refracted_cosine(index, degrees)
    s = (cosine - index * cosine_t) / (cosine + index * cosine_t)
    p = (index * cosine - cosine_t) / (index * cosine + cosine_t)
    return (np.abs(s) ** 2 + np.abs(p) ** 2) / 2


def inner_diffuse_reflectance(index):
    """Share of diffuse light inside `index` that its boundary to air reflects: 1 - T / index^2, where T of the diffuse
    light outside gets in. Places of the sum are cosines v^3, dense near grazing angles.

    Duntley 1942, The Optical Properties of Diffusing Materials.
    """
    v = (np.arange(20000) + 0.5) / 20000
    cosine = v**3
    cosine_t = np.sqrt(1 - (1 - cosine**2) / index**2)
    s = (cosine - index * cosine_t) / (cosine + index * cosine_t)
    p = (index * cosine - cosine_t) / (index * cosine + cosine_t)
    entering = np.mean(6 * v**5 * (1 - (s**2 + p**2) / 2))
    return 1 - entering / index**2


def slab(index, degrees, optical_depth=0):
    """Reflectance and transmittance of a plate in air, all orders summed: the geometric series of Stokes (1862).

    Polarization is averaged at every boundary. `optical_depth` is absorption times thickness.
    """
    r = fresnel(index, degrees)
    a = np.exp(-optical_depth / refracted_cosine(index, degrees))
    transmittance = (1 - r) ** 2 * a / (1 - (r * a) ** 2)
    return r + r * a * transmittance, transmittance


def irradiance_under_disc(radius, height):
    """Of a point on the axis of a parallel disc of radiance 1. Howell, Menguc, Daun, Siegel, configuration B-12."""
    return np.pi * radius**2 / (radius**2 + height**2)


def irradiance_under_square(half_side, height):
    """Of a point under the center of a parallel square of radiance 1: four corners of configuration B-3 (Howell)."""
    x = half_side / np.hypot(half_side, height)
    return 4 * x * np.arctan(x)


def irradiance_under_sphere(radius, distance):
    """Of a plane that faces the center of a sphere of radiance 1, whole above the horizon."""
    return np.pi * (radius / distance) ** 2


def irradiance_in_box(power, area, reflectance):
    """Mean over the walls of a closed Lambertian box, from the balance E S = power + reflectance E S."""
    return power / (area * (1 - reflectance))
