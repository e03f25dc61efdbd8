"""The book's expectations for polarization, films and dyes equal numbers that were computed independently.

pytest tools/tests/test_validate_waves.py
"""

import functools

import numpy as np
from validation import book, dyes, films, formulas, polarized
from validation.stokes import Boundary

BREWSTER = {1.5: "56.3099", 1.5168: "56.6038"}
METALS = {"Au": ("gold", polarized.GOLD), "Ag": ("silver", polarized.SILVER), "Al": ("aluminum", polarized.ALUMINUM)}


@functools.cache
def rows():
    return {row.name: np.atleast_1d(row.expected) for row in book.rows(True)}


@functools.cache
def mistakes():
    return {row.name: np.atleast_1d(row.mistake) for row in book.rows(True)}


def near(found, expected, digits=6):
    off = np.abs(np.subtract(found, expected)).max()
    assert off <= 0.6 * 10.0**-digits, f"{found} for {expected}: {off}"


def test_one_surface_has_the_known_amplitudes():
    # R, its degree of polarization and c / a, then the same numbers for the transmitted light.
    known = {
        "0": (0.040000, 0, -1, 0.960000, 0, 1),
        "30": (0.041523, 0.391918, -0.920000, 0.958477, -0.016978, 0.999856),
        "45": (0.050240, 0.831479, -0.555556, 0.949760, -0.043983, 0.999032),
        BREWSTER[1.5]: (0.073964, 1, 0, 0.926036, -0.079872, 0.996805),
        "60": (0.089187, 0.979796, 0.200000, 0.910813, -0.095941, 0.995387),
        "75": (0.253061, 0.578105, 0.815963, 0.746939, -0.195860, 0.980632),
    }
    for degrees, (*reflected, t, d_t, c_t) in known.items():
        for which, (a, d, c), times in (
            ("reflected by glass", reflected, 0.5),
            ("reflected inside glass", reflected, 0.5),
            ("into glass", (t, d_t, c_t), 0.5 * 1.5**2),
            ("into air", (t, d_t, c_t), 0.5 / 1.5**2),
        ):
            stokes = rows()[f"light at 45 degrees {which} at {degrees} degrees"]
            # The image's right is in the plane of incidence.
            near(stokes[0] / times, a)
            near(-stokes[1:3] / stokes[0], (d, c))
            near(stokes[3], 0)


def test_total_reflection_has_the_known_phases():
    for where, degrees in {
        "45 degrees in 1.5": 36.869898,
        "51.6712 degrees in 1.5": 45.239730,
        "60 degrees in 1.5": 40.459083,
        "75 degrees in 1.5": 21.946639,
        "54.6 degrees in 1.51": 45.012089,
    }.items():
        _, s1, s2, s3 = rows()[f"light at 45 degrees totally reflected at {where}"]
        near((s1, np.degrees(np.arctan2(s3, -s2))), (0, degrees))
    rhomb = rows()["Fresnel's rhomb of 54.6 degrees"]
    near(rhomb[0] * 2, 0.919134)
    near(abs(rhomb[1:]) / rhomb[0], (0, 0.000422, 1))
    for degrees in ("48.6243", "54.623"):
        near(rows()[f"Fresnel's rhomb of {degrees} degrees"][2], 0, 5)


def test_piles_and_panes_have_the_known_shares():
    # The transmittance of s, of p, and with averaged polarizations.
    known = {
        (1, 1.5, "45"): (0.831479, 0.983209, 0.904327),
        (4, 1.5, "45"): (0.552272, 0.936058, 0.702652),
        (1, 1.5, BREWSTER[1.5]): (0.742268, 1, 0.862259),
        (4, 1.5, BREWSTER[1.5]): (0.418605, 1, 0.610136),
        (10, 1.5, BREWSTER[1.5]): (0.223602, 1, 0.384994),
        (1, 1.5, "60"): (0.699854, 0.996403, 0.836232),
        (1, 1.5168, "45"): (0.824854, 0.981744, 0.900066),
        (4, 1.5168, "45"): (0.540732, 0.930769, 0.692464),
        (10, 1.5168, "45"): (0.320168, 0.843206, 0.473867),
        (1, 1.5168, BREWSTER[1.5168]): (0.731172, 1, 0.855901),
        (4, 1.5168, BREWSTER[1.5168]): (0.404748, 1, 0.597573),
        (10, 1.5168, BREWSTER[1.5168]): (0.213827, 1, 0.372635),
        (1, 1.5168, "75"): (0.421958, 0.808685, 0.592174),
    }
    for (plates, index, degrees), (s, p, averaged) in known.items():
        name = f"S0 and S1 through {plates} plate{'s' if plates > 1 else ''} of {index} at {degrees} degrees"
        s0, s1 = rows()[name]
        near((s0 - s1, s0 + s1), (s, p))
        near(rows()[f"{name}, averaged"], averaged)
    for which, a, d, c in (("reflected by", 0.144024, 0.980834, 0.192978), ("through", 0.757083, -0.185148, 0.969445)):
        stokes = rows()[f"light at 45 degrees {which} a pane at 60 degrees"]
        near(2 * stokes[0], a)
        near(-stokes[1:3] / stokes[0], (d, c))
    near(2 * mistakes()["light at 45 degrees through a pane at 60 degrees"][0], 0.746400)


def test_prisms_and_drops_have_the_known_shares():
    for glass, s, p, both, averaged in (
        ("N-BK7", 0.886614, 0.995630, 0.888681, 0.885710),
        ("N-SF11", 0.699714, 0.998688, 0.743489, 0.721143),
        ("water", 0.953568, 0.995279, 0.949936, 0.949501),
    ):
        stokes = rows()[f"a prism of {glass} at least deviation"]
        near(stokes[0], both)
        near(np.sqrt([stokes[0] - stokes[1], stokes[0] + stokes[1]]), (s, p))
        near(rows()[f"a prism of {glass} at least deviation, averaged"], averaged)
    for which, both in (("two prisms in a plane", 0.617236), ("two crossed prisms", 0.488316)):
        near(rows()[f"{which} of N-SF11 at least deviation"][0], both)
        near(rows()[f"{which} of N-SF11 at least deviation, averaged"], 0.520047)
    for which, both, averaged, degree in (
        ("primary", 0.04561101, 0.05090807, 0.924787),
        ("secondary", 0.01944702, 0.01764553, 0.807796),
    ):
        stokes = rows()[f"a drop at its {which} rainbow"]
        near(stokes[0], both, 8)
        near(-stokes[1] / stokes[0], degree)
        near(rows()[f"a drop at its {which} rainbow, averaged"], averaged, 8)


def test_sheets_and_filters_let_the_known_shares_through():
    malus = {0: 0.5, 15: 0.466506, 30: 0.375, 45: 0.25, 60: 0.125, 75: 0.033494, 90: 0}
    for degrees, through in malus.items():
        near(rows()[f"two polarizers at {degrees} degrees"], through)
    for degrees, through in {60: 0.125075, 75: 0.033587, 90: 0.000100}.items():
        near(rows()[f"two polarizers at {degrees} degrees, which leak"], through)
    near(rows()["three polarizers at 0, 45 and 90 degrees"], 0.125)
    for degrees, through in {15: 0.000600, 30: 0.010204, 45: 0.055556, 60: 0.180000}.items():
        near(rows()[f"crossed polarizers seen at {degrees} degrees"], through)
    for plate, stokes in {
        "quarter wave at 45": (1, 0, 0, 1),
        "quarter wave at 135": (1, 0, 0, -1),
        "half wave at 22.5": (1, 0, 1, 0),
        "half wave at 45": (1, -1, 0, 0),
        "sixth wave at 45": (1, 0.5, 0, 0.866025),
    }.items():
        near(2 * rows()[f"polarized light through a {plate} degrees"], stokes)
    for retardance, through in {30: 0.033494, 60: 0.125, 90: 0.25, 120: 0.375, 180: 0.5}.items():
        near(rows()[f"a retardance of {retardance} degrees between crossed polarizers"], through)
    for degrees, p, s, both in (
        ("45", 0.004233, 0.046007, 0.050240),
        (BREWSTER[1.5], 0, 0.073964, 0.073964),
        ("65", 0.006482, 0.114031, 0.120513),
    ):
        near(rows()[f"p of glass at {degrees} degrees through a filter"], p)
        near(rows()[f"s of glass at {degrees} degrees through a filter"], s)
        near(rows()[f"glass at {degrees} degrees without a filter"][0], both)
    for degrees, kept in (
        ("45", (0.00426907, 0.00339656, 0.00252405, 0.00165154, 0.00077903)),
        (BREWSTER[1.5], (0.01094149, 0.00820612, 0.00547075, 0.00273537, 0)),
    ):
        for turn, reflected in zip((0, 30, 45, 60, 90), kept, strict=True):
            near(rows()[f"two surfaces of glass at {degrees} degrees, planes {turn} degrees apart"], reflected, 8)
    for degrees, kept in (
        ("30", (0.028139, 0.024810, 0.021480, 0.014820)),
        ("45", (0.045541, 0.036745, 0.027949, 0.010357)),
        ("53.1315", (0.066662, 0.052937, 0.039213, 0.011764)),
        ("70", (0.193998, 0.163791, 0.133584, 0.073169)),
    ):
        for turn, reflected in zip((0, 30, 45, 90), kept, strict=True):
            near(rows()[f"water at {degrees} degrees under a sky polarized {turn} degrees from s"][0], reflected)
    for degrees, degree in {30: 0.016978, 45: 0.043983, 60: 0.095941, 75: 0.195860, 85: 0.308744}.items():
        near(rows()[f"the base of plastic at {degrees} degrees"], degree)


def test_metals_mirror_the_known_components():
    # R_s, R_p and their phase difference; S0 to S3 of two mirrors along the axes of the last; two in a plane, and
    # crossed.
    known = {
        ("Au", 45): (0.849414, 0.721504, 149.731837, (0.616945, 0.050234, 0.043242, -0.025236), 0.621036, 0.612855),
        ("Au", 75): (0.943701, 0.706358, 72.742012, (0.680673, 0.097907, -0.028745, -0.092527), 0.694756, 0.666590),
        ("Ag", 45): (0.988061, 0.976265, 158.106852, (0.964644, 0.005793, 0.005375, -0.002160), 0.964679, 0.964609),
        ("Ag", 75): (0.995683, 0.965111, 91.712086, (0.961178, 0.014986, 0.000448, -0.014978), 0.961412, 0.960945),
        ("Al", 45): (0.939707, 0.883049, 168.152672, (0.830610, 0.025818, 0.025256, -0.005298), 0.831412, 0.829807),
        ("Al", 75): (0.977597, 0.763276, 124.230155, (0.757660, 0.093277, 0.052071, -0.076533), 0.769143, 0.746176),
    }
    for (symbol, degrees), (s, p, phase, twice, in_plane, crossed) in known.items():
        metal, index = METALS[symbol]
        one = rows()[f"a mirror at {degrees} degrees of {metal}"]
        near((one[0] - one[1], one[0] + one[1]), (s, p))
        two = rows()[f"two mirrors at {degrees} degrees of {metal}"]
        # The image's right is in the plane of incidence of the last mirror.
        near(abs(two), np.abs(twice))
        near(two[[0, 1]], (twice[0], -twice[1]))
        assert np.sign(two[2] * two[3]) == -np.sign(twice[2] * twice[3])
        by_s, by_p = Boundary.of(index, np.cos(np.radians(degrees))).reflected
        near(abs(np.degrees(np.angle(by_p / by_s))), phase)
        near(rows()[f"two mirrors at {degrees} degrees in a plane of {metal}"][0], in_plane)
        near(rows()[f"two crossed mirrors at {degrees} degrees of {metal}"][0], crossed)
    near(
        abs(rows()["three mirrors at 75 degrees, each turned by 45 of gold"]), (0.558164, 0.057061, 0.048428, 0.098750)
    )
    near(mistakes()["three mirrors at 75 degrees, each turned by 45 of gold"][0], 0.561575)
    for name, stokes in {
        "a mirror at 45 degrees of gold": (0.785459, -0.063955, 0, 0),
        "a mirror at 45 degrees, its plane turned by 30 of gold": (0.785459, -0.031978, -0.055387, 0),
        "two mirrors at 45 degrees of gold": (0.616945, -0.050234, 0.043242, 0.025236),
        "two mirrors at 75 degrees of gold": (0.680673, -0.097907, -0.028745, 0.092527),
        "three mirrors at 75 degrees of gold": (0.533189, -0.056212, 0.041503, 0.090961),
        "three mirrors at 75 degrees of aluminum": (0.684973, -0.107958, 0.075201, 0.048315),
    }.items():
        near(rows()[name], stokes)


def at(nm, name):
    """Returns S0 to S3 at one of the lines."""
    return rows()[name].reshape(4, -1)[:, films.LINES.index(nm)]


def assert_reflects(name, s, p, phase=None):
    """Asserts the reflectance of s and p, and the phase between them in degrees, for light at 45 degrees."""
    stokes = 2 * at(550.0, f"{name}, S0 to S3")
    near((stokes[0] - stokes[1], stokes[0] + stokes[1]), (s, p))
    if phase is not None:
        near(abs(np.degrees(np.arctan2(stokes[3], -stokes[2]))), phase, 4)


def test_films_have_the_known_shares():
    absorbing = "a layer that absorbs at 30 degrees"
    assert_reflects(absorbing, 0.170494, 0.099452)
    stokes = 2 * at(550.0, f"through {absorbing}, S0 to S3") / 1.5**2
    near((stokes[0] - stokes[1], stokes[0] + stokes[1]), (0.654205, 0.711481))
    dark = {400: 0.021983, 450: 0.015953, 500: 0.013261, 550: 0.012709, 600: 0.013386, 650: 0.014704, 700: 0.016312}
    for nm, share in dark.items():
        near(rows()[f"a darkened lens at {nm} nm"], share)
    near(rows()["a bare lens at 550 nm"], 0.042388)
    near(formulas.index("N-BK7", 550), 1.518522)
    quarter = "a quarter wave of magnesium fluoride on N-BK7 at"
    for degrees, s, p, phase in (
        (30, 0.020783, 0.007085, 178.5563),
        (45, 0.040246, 0.001373, 165.1251),
        (60, 0.101084, 0.006016, 17.7510),
        (75, 0.304050, 0.114505, 5.9963),
    ):
        assert_reflects(f"{quarter} {degrees} degrees", s, p, phase)
    for layers, at_550, at_450 in (
        (3, 0.683313, 0.535443),
        (7, 0.955855, 0.589673),
        (11, 0.994646, 0.123001),
        (19, 0.999924, 0.620067),
    ):
        near(rows()[f"a mirror of {layers} layers at 0 degrees"][[1, 0]], (at_550, at_450))
    assert_reflects("a mirror of 11 layers at 45 degrees", 0.997526, 0.951827)
    assert_reflects("glass on aluminum at 60 degrees", 0.791828, 0.867711, 160.8335)
    for gap, s, p in (
        (50, 0.196161, 0.335224),
        (100, 0.547909, 0.714642),
        (200, 0.914268, 0.956591),
        (500, 0.999695, 0.999853),
    ):
        assert_reflects(f"R of {gap} nm of air in glass at 60 degrees", s, p)
    near(rows()["the mean of soap over one fringe"], 0.039329698, 9)


def test_soap_and_titanium_have_the_known_colors():
    # Y, x and y along the normal; CIELAB along the normal; Y, x and y at 45 degrees.
    for thickness, straight, lab, slanting in (
        (100, (0.075937, 0.31403, 0.33860), (33.122, -1.724, 1.664), (0.092297, 0.29998, 0.32220)),
        (150, (0.046665, 0.43156, 0.43955), (25.763, 1.958, 25.506), (0.088802, 0.35556, 0.38060)),
        (200, (0.005199, 0.28978, 0.12426), (4.696, 27.618, -20.792), (0.035929, 0.50543, 0.45417)),
        (250, (0.029318, 0.18054, 0.22159), (19.769, -7.719, -21.782), (0.006627, 0.19018, 0.08590)),
        (300, (0.067491, 0.32086, 0.41972), (31.229, -14.254, 14.005), (0.045355, 0.19260, 0.24536)),
        (400, (0.017113, 0.30929, 0.15192), (13.893, 37.243, -24.859), (0.079038, 0.44956, 0.48150)),
        (500, (0.055238, 0.30164, 0.52967), (28.178, -29.888, 25.608), (0.020518, 0.21435, 0.13816)),
        (600, (0.028965, 0.33944, 0.20190), (19.625, 32.150, -17.063), (0.076023, 0.33294, 0.51978)),
        (1000, (0.039067, 0.36622, 0.32763), (23.361, 9.422, 3.373), (0.043342, 0.33752, 0.34450)),
    ):
        for degrees, (y, *chromaticity) in ((0, straight), (45, slanting)):
            xyz, white, _ = films.under_d65([(1.33, thickness)], films.air, degrees)
            near(xyz[1], y)
            near(xyz[:2] / xyz.sum(), chromaticity, 5)
            if degrees == 0:
                near(films.lab(xyz, white), lab, 3)
    near((formulas.titanium(550).real, -formulas.titanium(550).imag), (2.5418, 3.4345), 4)
    for thickness, lab in {
        0: (81.02, 1.04, 3.62),
        20: (65.57, 2.81, 22.48),
        30: (47.49, 11.33, 39.93),
        40: (29.87, 26.61, -22.37),
        50: (44.40, 1.21, -36.24),
        60: (62.96, -7.42, -23.22),
        80: (79.88, -4.95, -4.20),
        100: (83.09, -5.06, 14.61),
        120: (77.64, -4.05, 60.84),
        140: (59.85, 41.65, 4.53),
        160: (47.91, 34.35, -52.53),
    }.items():
        xyz, white, _ = films.under_d65([(2.4, thickness)], formulas.titanium, 0)
        near(films.lab(xyz, white), lab, 2)


def test_dyes_have_the_known_colors():
    light = dyes.illuminant("D65")
    near(light[dyes.NM < 380].sum() / light.sum(), 0.070, 3)
    # X, Y and Z; then Y of the paper alone.
    for dye, name, xyz, paper in (
        ("yellow dye", "D65", (0.803904, 1.168084, 0.346924), 0.880930),
        ("yellow dye", "A", (0.991020, 0.995397, 0.129157), 0.903727),
        ("yellow dye", "FL11", (0.879344, 1.062595, 0.186003), 0.900997),
        ("red dye", "D65", (1.050030, 0.719865, 0.962303), 0.469808),
        ("red dye", "A", (1.127219, 0.743343, 0.305291), 0.536646),
        ("red dye", "FL11", (1.081292, 0.662621, 0.572306), 0.408412),
        ("brightener", "D65", (0.908949, 0.925202, 1.184591), 0.919968),
        ("brightener", "A", (1.015749, 0.920782, 0.354706), 0.919993),
        ("brightener", "FL11", (0.929920, 0.920280, 0.600078), 0.919988),
    ):
        near(rows()[f"{dye} under {name}"], xyz)
        near(rows()[f"the paper of the {dye} under {name}"][1], paper)
    near(rows()["the paper of the brightener under D65"][2], 0.996882)
    for least, y, z in ((360, 0.923592, 1.126836), (380, 0.921612, 1.055832)):
        near(rows()[f"brightener that absorbs from {least} nm on"][1:], (y, z))
    for dye, xyz, paper in (
        ("yellow dye", (11.40577, 17.96621, 2.75734), (9.83503, 11.10363, 1.90099)),
        ("red dye", (14.12639, 7.85577, 11.69062), (7.13051, 3.81315, 11.68596)),
        ("brightener", (12.69201, 12.63309, 17.95153), (11.79494, 12.49711, 13.19680)),
    ):
        near(rows()[f"closed room of {dye}"], xyz, 5)
        near(rows()[f"closed room of the paper of the {dye}"], paper, 5)
