"""Absolute light: colors times whiteLuminance give the lamp's luminance by colour-science, and files state their units.

pytest tools/tests/test_radiometry.py
"""

import re
import subprocess
from datetime import UTC, datetime

import check_exr
import numpy as np
import pytest
import render

colour = pytest.importorskip("colour", reason="colour-science is not installed")

EFFICACY = 683.002  # lm/W, CIE 018:2019
SCENE = """
camera = {{ position = [0, 0, 4], look_at = [0, 0, 0], vertical_fov = 40{camera} }}
film = {{ width = 16, height = 8{film} }}
render = {{ samples = 64, model = {model}, meters_per_unit = 0.01 }}
[[light]]
environment.radiance = {lamp}
"""
ABSOLUTE = ', radiometry = "absolute"'


def rendered(path, lamp="1", film="", camera="", model='"auto"', **flags):
    render.write(SCENE.format(lamp=lamp, film=film, camera=camera, model=model), path, **flags)
    assert check_exr.violations(path) == []
    return check_exr.read(path)


def luminance_of(lamp):
    """Returns the luminance in cd/m^2 of wavelengths and radiances in W / (m^2 sr nm), by colour-science."""
    shape = colour.SpectralShape(360, 830, 1)
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(shape)
    spectrum = np.interp(shape.wavelengths, *np.transpose(lamp), left=0, right=0)
    return EFFICACY * (spectrum * observer.values[:, 1]).sum()


# A warm lamp, and a narrow blue one.
LAMPS = [
    [[380, 0.001], [560, 0.02], [780, 0.05]],
    [[440, 0], [450, 0.3], [460, 0]],
]


@pytest.mark.parametrize("lamp", LAMPS, ids=("warm", "blue"))
@pytest.mark.parametrize("space", check_exr.CHROMATICITIES)
@pytest.mark.parametrize(("white", "precision"), [(None, "float"), (100, "half")])
def test_colors_times_white_luminance_are_luminance(tmp_path, lamp, space, white, precision):
    film = f'{ABSOLUTE}, color_space = "{space}", precision = "{precision}"'
    film += f", white_luminance = {white}" if white else ""
    file = rendered(tmp_path / "image.exr", f"{{ samples = {lamp} }}", film)
    assert file.header["whiteLuminance"] == (white or 1)
    # The luminance of each primary, from the file's chromaticities.
    weights = [0, 1, 0]
    if space != "lin_ciexyzd65_scene":
        x, y = np.reshape(file.header["chromaticities"], (4, 2)).astype(np.float64).T
        primaries = np.array([x / y, np.ones(4), (1 - x - y) / y])
        weights = np.linalg.solve(primaries[:, :3], primaries[:, 3])
    rgb = np.array([file.channels[name].astype(np.float64).mean() for name in "RGB"])
    assert file.header["whiteLuminance"] * (weights @ rgb) == pytest.approx(luminance_of(lamp), rel=0.005)


def test_rec709_weights_the_colors_of_a_lamp_of_known_luminance(tmp_path):
    for lamp in ("{ blackbody = 2856, luminance = 250 }", '{ illuminant = "FL11", luminance = 250 }', "250"):
        file = rendered(tmp_path / "image.exr", lamp, f"{ABSOLUTE}, white_luminance = 80")
        red, green, blue = (file.channels[name].astype(np.float64).mean() for name in "RGB")
        assert 80 * (0.2126 * red + 0.7152 * green + 0.0722 * blue) == pytest.approx(250, rel=0.005)


def test_relative_light_says_no_luminance(tmp_path):
    assert "whiteLuminance" not in rendered(tmp_path / "image.exr").header


def test_openimageio_tells_luminance_lens_and_date(tmp_path):
    oiio = pytest.importorskip("OpenImageIO", reason="OpenImageIO has no package for this system")
    camera = ", sensor_width = 36, near = 0.5, lens = { radius = 0.5, focus_distance = 400 }"
    path = tmp_path / "image.exr"
    before = datetime.now(UTC).replace(microsecond=0)
    render.write(SCENE.format(lamp="1", film=ABSOLUTE, camera=camera, model='"auto"'), path, threads=2)
    assert "capDate" not in check_exr.read(path).header
    command = [str(render.binary()), str(path.with_suffix(".toml")), "--exr", str(path), "--threads", "2", "--stamp"]
    subprocess.run(command, check=True, capture_output=True)
    assert check_exr.violations(path) == []
    spec = oiio.ImageInput.open(str(path)).spec()
    behind = 36 / (4 * np.tan(np.radians(20)))
    focal_length = 1 / (1 / behind + 1 / 4000)
    for name, value in {
        "whiteLuminance": 1,
        "pinholeFocalLength": behind,
        "effectiveFocalLength": focal_length,
        "FNumber": focal_length / 10,  # `aperture` in the EXR
        "focus": 4,
        "near": 0.5,
        "utcOffset": 0,
        "render/threads": 2,
    }.items():
        assert spec.getattribute(name) == pytest.approx(value, rel=1e-6), name
    assert spec.getattribute("sensorOverallDimensions") == pytest.approx((36, 18))
    made = datetime.strptime(check_exr.read(path).header["capDate"], "%Y:%m:%d %H:%M:%S").replace(tzinfo=UTC)
    assert before <= made <= datetime.now(UTC)
    assert re.fullmatch(check_exr.STAMPED, spec.get_string_attribute("DateTime"))
