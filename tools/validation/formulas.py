"""Closed-form optics and transport, from first principles: the references for the rendered numbers.

from validation.formulas import fresnel, slab
fresnel(1.5, 45)                 # 0.0502..., unpolarized
slab(1.5, 0, optical_depth=1)    # (R, T) of a plate with all its reflections
"""

import numpy as np


def refracted_cosine(index, degrees):
    """Returns the cosine of refraction by Snell's law, from air into a medium of `index`."""
    return np.sqrt(1 - (np.sin(np.radians(degrees)) / index) ** 2)


def fresnel(index, degrees):
    """Returns unpolarized reflectance from air to `index`, which is complex for a metal (n + ik).

    Born and Wolf, Principles of Optics, 1.5.2 (20), 1.5.3 (30) and 14.2.
    """
    return sum(both_polarizations(index, degrees)) / 2


def both_polarizations(index, degrees):
    """Returns the reflectances of s and p."""
    cosine, cosine_t = np.cos(np.radians(degrees)), refracted_cosine(index, degrees)
    s = (cosine - index * cosine_t) / (cosine + index * cosine_t)
    p = (index * cosine - cosine_t) / (index * cosine + cosine_t)
    return np.abs(s) ** 2, np.abs(p) ** 2


def inner_diffuse_reflectance(index):
    """Returns the share of diffuse light inside `index` that its boundary to air reflects.

    It is 1 - T / index^2, where T is the share of diffuse light outside that gets in. The cosines of the sum are v^3,
    dense near grazing angles. Duntley 1942, The Optical Properties of Diffusing Materials.
    """
    v = (np.arange(20000) + 0.5) / 20000
    cosine = v**3
    cosine_t = np.sqrt(1 - (1 - cosine**2) / index**2)
    s = (cosine - index * cosine_t) / (cosine + index * cosine_t)
    p = (index * cosine - cosine_t) / (index * cosine + cosine_t)
    entering = np.mean(6 * v**5 * (1 - (s**2 + p**2) / 2))
    return 1 - entering / index**2


def slab(index, degrees, optical_depth=0):
    """Returns R and T of a plate in air, all orders summed: the geometric series of Stokes (1862).

    Unpolarized light has the mean of both polarizations, each with a series of its own. `optical_depth` is absorption
    times thickness.
    """
    a = np.exp(-optical_depth / refracted_cosine(index, degrees))
    through = [(1 - r) ** 2 * a / (1 - (r * a) ** 2) for r in both_polarizations(index, degrees)]
    back = [r + r * a * t for r, t in zip(both_polarizations(index, degrees), through, strict=True)]
    return sum(back) / 2, sum(through) / 2


def slab_of_averages(index, degrees, optical_depth=0):
    """Returns the values of `slab` for light that is unpolarized at each surface: the mistake that rows detect."""
    r = fresnel(index, degrees)
    a = np.exp(-optical_depth / refracted_cosine(index, degrees))
    transmittance = (1 - r) ** 2 * a / (1 - (r * a) ** 2)
    return r + r * a * transmittance, transmittance


def irradiance_under_disc(radius, height):
    """Returns the irradiance on the axis of a parallel disc of radiance 1 (B-12 in Howell, Menguc, Daun, Siegel)."""
    return np.pi * radius**2 / (radius**2 + height**2)


def irradiance_under_square(half_side, height):
    """Returns the irradiance under the center of a parallel square of radiance 1: four corners of B-3 (Howell)."""
    x = half_side / np.hypot(half_side, height)
    return 4 * x * np.arctan(x)


def irradiance_under_sphere(radius, distance):
    """Returns the irradiance of a plane facing the center of a sphere of radiance 1 that is all above the horizon."""
    return np.pi * (radius / distance) ** 2


def irradiance_in_box(power, area, reflectance):
    """Returns the mean over the walls of a closed Lambertian box, from the balance E S = power + reflectance E S."""
    return power / (area * (1 - reflectance))


# B and C (square micrometers) of n^2 = 1 + sum of B l^2 / (l^2 - C): SCHOTT's data sheets of 2017; Malitson 1965 (fused
# silica); Dodge 1986 (sapphire, ordinary ray); Peter 1923 (diamond); Daimon and Masumura 2007, 20 degrees (water).
SELLMEIER = {
    "N-BK7": ((1.03961212, 0.231792344, 1.01046945), (0.00600069867, 0.0200179144, 103.560653)),
    "N-SF11": ((1.73759695, 0.313747346, 1.89878101), (0.013188707, 0.0623068142, 155.23629)),
    "N-SF10": ((1.62153902, 0.256287842, 1.64447552), (0.0122241457, 0.0595736775, 147.468793)),
    "N-BAK4": ((1.28834642, 0.132817724, 0.945395373), (0.00779980626, 0.0315631177, 105.965875)),
    "N-LASF9": ((2.00029547, 0.298926886, 1.80691843), (0.0121426017, 0.0538736236, 156.530829)),
    "N-FK51A": ((0.971247817, 0.216901417, 0.904651666), (0.00472301995, 0.0153575612, 168.68133)),
    "N-K5": ((1.08511833, 0.199562005, 0.930511663), (0.00661099503, 0.024110866, 111.982777)),
    "schott/F2": ((1.34533359, 0.209073176, 0.937357162), (0.00997743871, 0.0470450767, 111.886764)),
    "fused silica": ((0.6961663, 0.4079426, 0.8974794), (0.0684043**2, 0.1162414**2, 9.896161**2)),
    "sapphire": ((1.4313493, 0.65054713, 5.3414021), (0.0726631**2, 0.1193242**2, 18.028251**2)),
    "diamond": ((0.3306, 4.3356), (0.175**2, 0.106**2)),
    "water": (
        (0.5684027565, 0.1726177391, 0.02086189578, 0.1130748688),
        (0.005101829712, 0.01821153936, 0.02620722293, 10.69792721),
    ),
}
# Wavelength in nm, n and k of titanium: Johnson and Christy 1974, Phys. Rev. B 9, 5056.
TITANIUM = np.transpose(
    [
        (354, 1.82, 2.87),
        (368, 1.90, 2.90),
        (381, 1.99, 2.93),
        (397, 2.08, 2.95),
        (413, 2.14, 2.98),
        (431, 2.21, 3.01),
        (451, 2.27, 3.04),
        (471, 2.32, 3.10),
        (496, 2.36, 3.19),
        (521, 2.44, 3.30),
        (549, 2.54, 3.43),
        (582, 2.60, 3.58),
        (617, 2.67, 3.72),
        (659, 2.76, 3.84),
        (704, 2.86, 3.96),
        (756, 3.00, 4.01),
        (821, 3.21, 4.01),
        (892, 3.29, 3.96),
    ]
)
F_LINE, D_LINE, C_LINE = 486.13, 587.56, 656.27  # nm
# The wavelengths of red, green and blue in rows that measure an index in three lanes: C, e and F.
RED_GREEN_BLUE = (656.27, 546.07, 486.13)


def index(name, nm):
    """Returns the refractive index at a wavelength in nm."""
    strengths, places = SELLMEIER[name]
    squared = (np.asarray(nm, float) / 1000) ** 2
    return np.sqrt(1 + sum(b * squared / (squared - c) for b, c in zip(strengths, places, strict=True)))


def titanium(nm):
    """Returns n - i k, linear between the measured wavelengths."""
    wavelengths, n, k = TITANIUM
    return np.interp(nm, wavelengths, n) - 1j * np.interp(nm, wavelengths, k)


def inside_fresnel(index, degrees):
    """Returns the unpolarized reflectance from inside `index` to air; 1 beyond the critical angle."""
    sine = index * np.sin(np.radians(degrees))
    return fresnel(index, np.degrees(np.arcsin(sine))) if sine < 1 else 1.0


def schlick(index, degrees):
    """Returns the reflectance by Schlick's approximation (1994): the mistake that many rows guard against."""
    normal = np.abs((index - 1) / (index + 1)) ** 2
    return normal + (1 - normal) * (1 - np.cos(np.radians(degrees))) ** 5


def pile(index, degrees, plates):
    """Returns transmittance of m plates (Stokes 1862): the mean of (1 - r) / (1 + (2 m - 1) r) over s and p."""
    return sum((1 - r) / (1 + (2 * plates - 1) * r) for r in both_polarizations(index, degrees)) / 2


def least_incidence(index, apex):
    """Returns the incidence of minimum deviation, in degrees: the ray runs through the prism symmetrically."""
    return np.degrees(np.arcsin(index * np.sin(np.radians(apex) / 2)))


def prism_deviation(index, apex, incidence):
    """Returns the deviation by Snell's law at both faces (Born and Wolf 4.7.2), all in degrees."""
    inside = np.arcsin(np.sin(np.radians(incidence)) / index)
    leaving = np.arcsin(index * np.sin(np.radians(apex) - inside))
    return incidence + np.degrees(leaving) - apex


def bow_incidence(index, reflections):
    """Returns the incidence of the rainbow after k reflections: cos^2 i = (n^2 - 1) / (k (k + 2)) (Descartes 1637)."""
    return np.degrees(np.arccos(np.sqrt((index**2 - 1) / (reflections * (reflections + 2)))))


def drop_deviation(index, incidence, reflections):
    """Returns 2 (i - r) + k (180 - 2 r), in degrees."""
    inside = np.degrees(np.arcsin(np.sin(np.radians(incidence)) / index))
    return 2 * (incidence - inside) + reflections * (180 - 2 * inside)


def slab_shift(index, degrees, thickness):
    """Returns d sin t (1 - cos t / sqrt(n^2 - sin^2 t))."""
    angle = np.radians(degrees)
    return thickness * np.sin(angle) * (1 - np.cos(angle) / np.sqrt(index**2 - np.sin(angle) ** 2))


def ball_focus(index, height):
    """Returns where a ray parallel to the axis of a ball of radius 1 crosses it, from the center.

    By symmetry the ray leaves as far from the center as it arrived, deviated by 2 (i - r). Near the axis it is n / (2
    (n - 1))."""
    turned = np.radians(drop_deviation(index, np.degrees(np.arcsin(height)), 0))
    return height / np.sin(turned)


def parallel_squares(side, distance):
    """Returns the view factor of two opposite squares: C-11 of Howell's catalog, as written by Hottel (1931)."""
    x = side / distance
    root = np.sqrt(1 + x * x)
    return (
        2
        / (np.pi * x * x)
        * (np.log((1 + x * x) / np.sqrt(1 + 2 * x * x)) + 2 * x * root * np.arctan(x / root) - 2 * x * np.arctan(x))
    )


def perpendicular_rectangles(width, length, height):
    """Returns the view factor from width x length to width x height across a common edge: C-14 of Howell."""
    h, w = height / width, length / width
    a, b, c = 1 + w * w, 1 + h * h, 1 + w * w + h * h
    s = h * h + w * w
    angles = w * np.arctan(1 / w) + h * np.arctan(1 / h) - np.sqrt(s) * np.arctan(1 / np.sqrt(s))
    logs = np.log(a * b / c) + w * w * np.log(w * w * c / (a * s)) + h * h * np.log(h * h * c / (b * s))
    return (angles + logs / 4) / (np.pi * w)


def coaxial_discs(first, second, distance):
    """Returns the view factor from the first of two parallel discs to the second: C-41 of Howell's catalog."""
    a, b = first / distance, second / distance
    x = 1 + (1 + b * b) / (a * a)
    return (x - np.sqrt(x * x - 4 * (b / a) ** 2)) / 2


def point_beside_rectangle(width, distance, height):
    """Returns the view factor from a point to a rectangle on its plane, opposite its middle: twice B-4 of Howell."""
    half, far = width / 2, np.hypot(height, distance)
    return (np.arctan(half / distance) - distance / far * np.arctan(half / far)) / np.pi


def through_ball(index, center, light, half_side, count=400_000, averaged=False):
    """Returns the mean irradiance of a square of the floor under a clear ball of radius 1, which shades it.

    The center of the ball is `center` above the floor, and a point light of intensity 1 is at height `light` on its
    axis. Sums over the directions of the light within the cone of the ball: Snell and Fresnel, up to 8 reflections
    inside. A ring on the floor counts by the part of it inside the square. `averaged` takes light for unpolarized at
    every surface, as the literature does."""
    sine = (np.arange(count) + 0.5) / count / (light - center)  # of the angle to the axis, evenly spaced
    step = 1 / count / (light - center)
    incidence = np.arcsin(sine * (light - center))
    inside = np.arcsin(np.sin(incidence) / index)
    each = both_polarizations(index, np.degrees(incidence))
    each = [sum(each) / 2] * 2 if averaged else each
    angle, total = np.arcsin(sine), 0.0
    for reflections in range(9):
        # Rays turn toward the axis: from an outward direction `angle` to angle - turned.
        turned = 2 * (incidence - inside) + reflections * (np.pi - 2 * inside)
        leaving = angle - turned
        # The point where light leaves the ball: the first point, and one chord further for each passage.
        at = np.pi / 2 - (incidence - angle) - (reflections + 1) * (np.pi - 2 * inside)
        x, y = np.cos(at), np.sin(at)
        down = np.cos(leaving) > 1e-9
        place = np.abs(x + (center + y) * np.tan(leaving))
        share = np.clip(1 - 4 / np.pi * np.arccos(np.clip(half_side / np.maximum(place, 1e-12), 0, 1)), 0, 1)
        weight = sum((1 - r) ** 2 * r**reflections for r in each) / 2
        total += np.sum(np.where(down, weight * share * 2 * np.pi * sine / np.cos(angle), 0)) * step
    return total / (2 * half_side) ** 2
