"""Other readers understand the files: OpenColorIO knows each color space by name, ffmpeg reads every pixel.

    python -m pip install imageio-ffmpeg                     # or a system's own ffmpeg; nothing else here needs it
    pytest tools/tests/test_exr_readers.py

If one of them is not installed, its tests are skipped.
"""

import itertools
import shutil
import subprocess

import check_exr
import numpy as np
import pytest
import render
from layered_scene import CROP, HEIGHT, WIDTH, Form, read, rendered

SPACES = tuple(check_exr.CHROMATICITIES)
# A sky of a color inside all of these gamuts: red, green and blue of Rec.709, under the film's own white.
LAMP = """
camera = {{ position = [0, 0, 4], look_at = [0, 0, 0], vertical_fov = 40 }}
film = {{ width = 8, height = 4, color_space = "{space}" }}
render = {{ samples = 1, model = "rgb" }}
[[light]]
environment.radiance = {{ rgb = [0.2, 0.5, 0.8] }}
"""


def ffmpeg():
    """Returns the program, from the system or from the package imageio-ffmpeg."""
    if found := shutil.which("ffmpeg"):
        return found
    return pytest.importorskip("imageio_ffmpeg", reason="ffmpeg is not installed").get_ffmpeg_exe()


@pytest.fixture(scope="module")
def config():
    ocio = pytest.importorskip("PyOpenColorIO", reason="OpenColorIO is not installed")
    return ocio.Config.CreateFromBuiltinConfig("studio-config-latest")


@pytest.fixture(scope="module")
def lamps(tmp_path_factory):
    """Returns the name in the file of every color space, and red, green and blue of the lamp in it."""
    folder = tmp_path_factory.mktemp("lamps")
    found = {}
    for space in SPACES:
        render.write(LAMP.format(space=space), folder / f"{space}.exr")
        image = render.read(folder / f"{space}.exr")
        found[space] = image.header["colorInteropID"], image.rgb[0, 0]
    return found


@pytest.mark.parametrize(("space", "other"), list(itertools.permutations(SPACES, 2)))
def test_opencolorio_takes_the_colors_of_a_space_to_those_of_another(config, lamps, space, other):
    (name, rgb), (other_name, expected) = lamps[space], lamps[other]
    spaces = [config.findColorSpaceForID(each) for each in (name, other_name)]
    assert all(spaces)
    convert = config.getProcessor(*(each.getName() for each in spaces)).getDefaultCPUProcessor()
    # The matrices of a configuration are rounded to some six digits.
    assert convert.applyRGB(rgb.tolist()) == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize("form", [Form(False), Form(False, "half"), Form(False, crop=True), Form(), Form(compression="piz")], ids=str)
def test_ffmpeg_reads_the_pixels_of_openexr(form):
    half = form.precision == "half"
    pixels = ["-f", "rawvideo", "-pix_fmt", "gbrapf16le" if half else "gbrapf32le"]
    run = subprocess.run([ffmpeg(), "-v", "error", "-i", str(rendered(form)), *pixels, "-"], capture_output=True, check=True)
    planes = np.frombuffer(run.stdout, "<f2" if half else "<f4").reshape(4, HEIGHT, WIDTH)
    left, top, width, height = CROP if form.crop else (0, 0, WIDTH, HEIGHT)
    for plane, name in zip(planes, "GBRA", strict=True):
        # ffmpeg fills the display window: pixels outside a crop are 0.
        whole = np.zeros_like(plane)
        whole[top : top + height, left : left + width] = read(form).channels[name]
        assert np.array_equal(plane, whole), name
    assert run.stderr == b""
