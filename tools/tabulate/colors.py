"""Writes lines of tables with color data of CIE and others, from the package colour-science."""

import warnings

from .pages import number

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # colour warns about optional packages
    import colour

OBSERVER = "CIE 1931 2 Degree Standard Observer"
OHTA = "Ohta, The Basis of Color Reproduction Engineering (1997)"
CIE_15_2004 = "CIE 15:2004, Colorimetry"
CIE_15_2018 = "CIE 015:2018, Colorimetry"

ILLUMINANTS = {
    **dict.fromkeys(["A", "C", "D50", "D55", "D65", "D75"], CIE_15_2004),
    "D60": "CIE 15:2004, Colorimetry, computed by colour-science",
    "E": "CIE 15:2004, Colorimetry, equal energy",
    **{f"FL{i}": CIE_15_2004 for i in range(1, 13)},
    **{f"FL3.{i}": CIE_15_2004 for i in range(1, 16)},
    **{f"HP{i}": CIE_15_2004 for i in range(1, 6)},
    **{f"LED-{name}": CIE_15_2018 for name in ["B1", "B2", "B3", "B4", "B5", "BH1", "RGB1", "V1", "V2"]},
}


def line(key, source, first, step, values):
    return "|".join([key, source, number(first), number(step), " ".join(number(f"{value:.10g}") for value in values)])


def curve(key, source, table):
    return line(key, source, table.shape.start, table.shape.interval, table.values)


def color_lines():
    observer = colour.MSDS_CMFS[OBSERVER]
    if (observer.shape.start, observer.shape.end, observer.shape.interval) != (360, 830, 1):
        raise ValueError(f"{OBSERVER} is not tabulated from 360 to 830 nm")
    sensitivities = zip("xyz", observer.values.T, strict=True)
    charts = colour.SDS_COLOURCHECKERS["ColorChecker N Ohta"]
    return [
        *(line(f"observer/{axis}", "CIE 018:2019, " + OBSERVER, 360, 1, values) for axis, values in sensitivities),
        *(curve(f"illuminant/{name}", src, colour.SDS_ILLUMINANTS[name]) for name, src in ILLUMINANTS.items()),
        *(curve(f"colorchecker/{name}", OHTA, table) for name, table in charts.items()),
    ]
