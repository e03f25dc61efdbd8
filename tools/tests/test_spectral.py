"""Spectral images: other readers find the bands at their wavelengths, and the spectra agree with the RGB image.

    pytest tools/tests/test_spectral.py

colour-science reads the layout, and integrates with its own color matching functions.
"""

import functools
import tempfile
from pathlib import Path

import check_exr
import numpy as np
import OpenEXR
import pytest
import render
from test_check_exr import found, header, plane  # noqa: F401

# A floor of a measured color, a red wall and a gold ball, under an incandescent lamp and a blue sky.
ROOM = """
camera = { position = [0, 1.2, 5], look_at = [0, 0.9, 0], vertical_fov = 40 }
film = { width = 48, height = 32, spectral = true, color_space = "SPACE" }
render = { samples = 32 }
[material]
floor.diffuse.reflectance = "light skin"
wall.diffuse.reflectance = { rgb = [0.7, 0.1, 0.1] }
gold.conductor = { metal = "Au", roughness = 0.2 }
lamp.emissive.radiance = { blackbody = 2856, scale = 30 }
[[object]]
shape.plane = { point = [0, 0, 0], normal = [0, 1, 0] }
material = "floor"
[[object]]
shape.quad = { center = [-1.8, 1, -0.5], u = [0, 0, 1.5], v = [0, 1, 0] }
material = "wall"
[[object]]
shape.sphere = { center = [0.5, 0.7, 0], radius = 0.7 }
material = "gold"
[[object]]
shape.sphere = { center = [0.6, 2.8, 1], radius = 0.3 }
material = "lamp"
[[light]]
environment.radiance = { rgb = [0.1, 0.2, 0.4] }
"""
# A ball of dispersive glass, so lanes part. A wavelength's random place in its band is noise, which takes many samples
# to average out.
PRISM = """
camera = { position = [0, 0, 5], look_at = [0, 0, 0], vertical_fov = 24 }
film = { width = 32, height = 24, spectral = true }
render = { samples = 1024, model = "hero" }
material.glass.dielectric.index = "N-SF11"
object = [{ material = "glass", shape = { sphere = { center = [0, 0, 0], radius = 0.9 } } }]
light = [{ environment = { radiance = { illuminant = "D65", scale = 1 } } }]
"""
# An emitter of radiance 1 at every wavelength.
EVEN = """
camera = { position = [0, 0, 5], look_at = [0, 0, 0], vertical_fov = 24 }
film = { width = 4, height = 3, spectral = true }
render = { samples = 4 }
light = [{ environment.radiance.samples = [[300, 1], [900, 1]] }]
"""
# A ball of glass behind a polarizer and a wave plate whose retardance depends on the wavelength.
POLARIZED = """
camera = { position = [0, 0, 5], look_at = [0, 0, 0], vertical_fov = 24 }
film = { width = 16, height = 12, spectral = true, stokes = true, layers = ["polarization"] }
render = { samples = 16 }
[material]
sheet.polarizer = { axis = [1, 0.4, 0], extinction = 0.01 }
plate.retarder = { axis = [1, 1, 0], retardation_nm = 560 }
glass.dielectric.index = 1.5
[[object]]
shape.sphere = { center = [0, 0, 0], radius = 0.9 }
material = "glass"
[[object]]
shape.quad = { center = [0.6, 0, 1], u = [0.6, 0, 0], v = [0, 2, 0] }
material = "sheet"
[[object]]
shape.quad = { center = [0, 0.5, 1.2], u = [2, 0, 0], v = [0, 0.5, 0] }
material = "plate"
[[light]]
environment.radiance = { illuminant = "D65", scale = 1 }
"""
SCENES = {"room": ROOM.replace("SPACE", "lin_rec709_scene"), "aces": ROOM.replace("SPACE", "lin_ap1_scene"), "prism": PRISM, "even": EVEN}
SCENES["polarized"] = POLARIZED
every_scene = pytest.mark.parametrize("name", SCENES)


@functools.cache
def folder():
    return tempfile.TemporaryDirectory()


@functools.cache
def rendered(name):
    """Returns the image of a scene, and its spectral image."""
    path = Path(folder().name) / f"{name}.exr"
    render.write(SCENES[name], path)
    return path, path.with_suffix(".spectral.exr")


@pytest.fixture(scope="module")
def colour():
    colour = pytest.importorskip("colour")
    pytest.importorskip("OpenImageIO", reason="OpenImageIO has no package for this system")
    return colour


def spectra(path):
    """Returns the centers of the bands in nm, and radiance by row, column and band."""
    file = check_exr.read(path)
    return np.array(list(file.bands())), np.stack([file.channels[name] for name in file.bands().values()], -1).astype(np.float64)


@every_scene
def test_both_files_keep_every_rule(name):
    image, spectral = rendered(name)
    assert check_exr.violations(image) == []
    assert check_exr.violations(spectral) == []


@every_scene
def test_both_files_hold_the_same_colors(name):
    image, spectral = (check_exr.read(path).channels for path in rendered(name))
    assert "A" in image and "A" not in spectral
    for channel in "RGB":
        assert image[channel].tobytes() == spectral[channel].tobytes()


def test_an_even_emitter_is_one_in_every_band():
    bands, values = spectra(rendered("even")[1])
    assert np.array_equal(bands, np.arange(380, 781, 5))
    assert (values == 1).all()


@every_scene
def test_colour_science_reads_the_bands_and_their_unit(colour, name):
    path = str(rendered(name)[1])
    components = colour.io.read_spectral_image_Fichet2021(path)
    read_nm, read = components["S0"]
    bands, values = spectra(path)
    order = np.argsort(read_nm)
    assert np.allclose(np.asarray(read_nm)[order], bands, atol=1e-6)
    assert np.array_equal(np.asarray(read, np.float64)[..., order], values)
    header = check_exr.read(path).header
    assert header["emissiveUnits"] == "W.m^-2.sr^-1" and header["spectralLayoutVersion"] == "1.0"


def test_colour_science_reads_the_components_of_stokes_vectors(colour):
    path = rendered("polarized")[1]
    components, file = colour.io.read_spectral_image_Fichet2021(str(path)), check_exr.read(path)
    for number, name in enumerate(check_exr.STOKES):
        read_nm, read = components[name]
        bands = file.bands(number)
        order = np.argsort(read_nm)
        assert np.allclose(np.asarray(read_nm)[order], list(bands), atol=1e-6)
        expected = np.stack([file.channels[channel] for channel in bands.values()], -1)
        assert np.array_equal(np.asarray(read, np.float32)[..., order], expected)
        assert np.abs(expected).max() > 0
    assert file.header["polarisationHandedness"] == "right"


@pytest.mark.parametrize("name", ["room", "aces", "prism"])
def test_spectra_seen_by_the_standard_observer_are_the_colors(colour, name):
    """Allows 0.5 % of the brightest channel, or of 1 % of the image's mean, and 0.3 dE2000, by the image's white."""
    image, spectral = rendered(name)
    bands, values = spectra(spectral)
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(colour.SpectralShape(360, 830, 1))
    # The mean of the functions over each band, because each number is the mean of the light over its band.
    around = np.arange(-2, 3)
    at = (bands[:, None] - 360).astype(int) + around
    functions = observer.values[at].mean(axis=1)
    xyz = values @ functions * (bands[1] - bands[0]) / observer.values[:, 1].sum()
    file = check_exr.read(image)
    rgb = np.stack([file.channels[channel] for channel in "RGB"], -1).astype(np.float64)
    space = {"lin_rec709_scene": "ITU-R BT.709", "lin_ap1_scene": "ACEScg"}[file.header["colorInteropID"]]
    to_xyz = colour.RGB_COLOURSPACES[space].matrix_RGB_to_XYZ
    expected = rgb @ to_xyz.T
    strongest = np.abs(rgb).max(axis=-1)
    off = np.abs(xyz @ np.linalg.inv(to_xyz).T - rgb).max(axis=-1) / np.maximum(strongest, 0.01 * strongest.mean())
    assert off.max() <= 5e-3, off.max()
    white = colour.RGB_COLOURSPACES[space].whitepoint
    lab = [colour.XYZ_to_Lab(np.maximum(each, 0) / np.percentile(expected[..., 1], 99), white) for each in (xyz, expected)]
    apart = colour.delta_E(*lab, method="CIE 2000")
    assert apart.max() <= 0.3, apart.max()


def spectral_file(found, changes=(), header_changes=None):
    """Returns the violations of a good spectral image with changes."""
    channels = {"R": plane(0.5), "G": plane(0.5), "B": plane(0.5)}
    channels |= {f"S0.{nm},000000nm": plane(0.01) for nm in (500, 510, 520)}
    channels = {name: value for name, value in {**channels, **dict(changes)}.items() if value is not None}
    said = {**check_exr.SPECTRAL, "render/spectralStep": 10.0}
    return found(header(**{**said, **(header_changes or {})}), channels)


def test_a_good_spectral_file_breaks_no_rule(found):  # noqa: F811
    assert spectral_file(found) == []


def test_stokes_vectors_of_bands_say_their_handedness(found):  # noqa: F811
    components = {f"S{i}.{nm},000000nm": plane(0.001) for i in (1, 2, 3) for nm in (500, 510, 520)}
    assert spectral_file(found, components, {"polarisationHandedness": "right"}) == []
    assert spectral_file(found, components) == ["polarisationHandedness is None, not 'right'"]


@pytest.mark.parametrize(
    "changes, header_changes, said",
    [
        ({"S0.520,000000nm": None, "S0.525,000000nm": plane(1)}, {}, "not 10 nm apart"),
        ({"S0.510,000000nm": None}, {}, "not 10 nm apart"),
        ({"S0.530.000000nm": plane(1)}, {}, "not LAYER.CHANNEL"),
        ({"S0.530,000000nm": plane(1, np.float16)}, {}, "not 32-bit"),
        ({"S0.530,000000nm": plane(np.nan)}, {}, "not finite"),
        ({"A": plane(1)}, {}, "'A': none of its layer"),
        ({"N.X": plane(0), "N.Y": plane(0), "N.Z": plane(0)}, {}, "with the layers N"),
        ({"G": None}, {}, "'G': missing"),
        ({"S1.500,000000nm": plane(0)}, {"polarisationHandedness": "right"}, "not there in the bands of S0"),
        ({}, {"polarisationHandedness": "right"}, "polarisationHandedness is 'right', not None"),
        ({}, {"spectralLayoutVersion": "2"}, "spectralLayoutVersion is '2'"),
        ({}, {"emissiveUnits": None}, "emissiveUnits is None"),
        ({}, {"render/spectralUnits": "W"}, "render/spectralUnits is 'W'"),
        ({}, {"render/spectralStep": -1.0}, "not a width in nm"),
    ],
)
def test_a_bad_spectral_file_is_named(found, changes, header_changes, said):  # noqa: F811
    assert any(said in violation for violation in spectral_file(found, changes, header_changes))


def test_attributes_of_spectra_stand_in_no_other_file(found):  # noqa: F811
    channels = {"R": plane(0.5), "G": plane(0.5), "B": plane(0), "A": plane(1), "Z": plane(2.5)}
    assert found(header(spectralLayoutVersion="1.0"), channels) == ["spectralLayoutVersion in a file without spectra"]


def test_openexr_finds_no_fault_with_the_colors():
    for name in SCENES:
        with OpenEXR.File(str(rendered(name)[1]), separate_channels=True) as file:
            assert int(OpenEXR.checkColorMetadata(file.parts[0].header)) == 0
