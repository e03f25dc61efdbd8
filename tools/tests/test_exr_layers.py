"""Files of layers hold the same numbers in every form.

    pytest tools/tests/test_exr_layers.py

The forms are whole, cropped or with overscan, in one part or several, in 16 or 32 bits, compressed or not. Two readers
show what the files hold, OpenEXR and OpenImageIO. Points, plates and holdouts show whether a compositor can use them.
"""

import itertools
import re

import check_exr
import numpy as np
import OpenEXR
import pytest
import render
from layered_scene import COMPRESSIONS, CROP, HEIGHT, LAYERS, OVERSCAN, WIDTH, Form, read, rendered

# Each precision with each compression in one part and in several, whole; crops, overscan and plain files of each
# precision.
FORMS = [
    *(Form(True, *each) for each in itertools.product(("float", "half"), COMPRESSIONS, (False, True))),
    Form(precision="float", compression="zips", crop=True),
    Form(precision="float", compression="piz", multipart=True, crop=True),
    Form(precision="half", compression="zip", crop=True),
    Form(precision="half", compression="none", multipart=True, crop=True),
    Form(overscan=True),
    Form(precision="half", compression="piz", multipart=True, overscan=True),
    Form(precision="float", multipart=True, crop=True, overscan=True),
    *(Form(False, precision, crop=crop) for precision in ("float", "half") for crop in (False, True)),
]
# DWA stores colors in 16 bits.
LOSSY = [("pxr24", "float"), *((compression, "half") for compression in check_exr.LOSSY.values())]
every_form = pytest.mark.parametrize("form", FORMS, ids=str)


def window(form):
    """Returns the first and the last column and row of the pixels in a form."""
    if form.crop:
        left, top, width, height = CROP
        return (left, top), (left + width - 1, top + height - 1)
    left, top, right, bottom = OVERSCAN if form.overscan else (0, 0, 0, 0)
    return (-left, -top), (WIDTH + right - 1, HEIGHT + bottom - 1)


def expected(form, name):
    """Returns a channel of a form inside the format: that of the plainest file, cropped and rounded."""
    (left, top), (right, bottom) = window(form)
    values = read(Form())[1][name][max(top, 0) : bottom + 1, max(left, 0) : right + 1]
    return values.astype(np.float16 if form.bits()[name] == 16 else np.float32)


@every_form
def test_a_file_of_every_form_keeps_every_rule(form):
    assert check_exr.violations(rendered(form)) == []


@every_form
def test_every_form_holds_the_same_pixels_to_the_bit(form):
    file = read(form)
    assert set(file.channels) == set(form.bits())
    (left, top), (right, bottom) = window(form)
    for name, every in file.channels.items():
        assert every.shape == (bottom - top + 1, right - left + 1)
        pixels = every[max(-top, 0) : HEIGHT - top, max(-left, 0) : WIDTH - left]
        wanted = expected(form, name)
        assert (pixels.dtype, pixels.shape) == (wanted.dtype, wanted.shape), name
        assert pixels.tobytes() == wanted.tobytes(), name


@every_form
def test_openexr_reads_windows_parts_and_compression(form):
    parts = read(form).parts
    compression = numbered(form.compression)
    for header, _ in parts:
        assert np.array_equal(header["dataWindow"], window(form))
        assert np.array_equal(header["displayWindow"], ((0, 0), (WIDTH - 1, HEIGHT - 1)))
        assert header["compression"] == compression
    names = [header.get("name") for header, _ in parts]
    assert set(names) - {"depth"} == ({"image", *LAYERS} if form.multipart else {None})
    assert parts[0][0]["owner"] == "Émilie" and parts[0][0]["comments"] == "shot 12"
    assert ("chromaticities" in parts[0][0]) == (not form.multipart)


@pytest.mark.parametrize("form", [*FORMS, *(Form(True, bits, packed, True) for packed, bits in LOSSY)], ids=str)
def test_openimageio_reads_the_same_names_types_windows_and_pixels(form):
    oiio = pytest.importorskip("OpenImageIO", reason="OpenImageIO has no package for this system")
    file = oiio.ImageInput.open(str(rendered(form)))
    bits, seen = {"half": 16, "float": 32}, {}
    for part in range(len(read(form).parts)):
        assert file.seek_subimage(part, 0)
        spec = file.spec()
        (left, top), (right, bottom) = window(form)
        assert (spec.x, spec.y, spec.width, spec.height) == (left, top, right - left + 1, bottom - top + 1)
        assert (spec.full_x, spec.full_y, spec.full_width, spec.full_height) == (0, 0, WIDTH, HEIGHT)
        pixels = file.read_image(part, 0, 0, spec.nchannels, "float")
        for i, name in enumerate(spec.channelnames):
            seen[name] = bits[str(spec.channelformat(i))]
            assert np.array_equal(pixels[..., i], read(form).channels[name]), name
    assert not file.seek_subimage(len(read(form).parts), 0)
    file.close()
    assert seen == form.bits()


def numbered(name):
    """Returns the number of a compression in OpenEXR."""
    return next(number for number, known in (check_exr.LOSSLESS | check_exr.LOSSY).items() if known == name)


@pytest.mark.parametrize(("compression", "precision"), LOSSY)
def test_a_compression_that_loses_changes_colors_alone(compression, precision):
    form = Form(True, precision, compression, multipart=True)
    assert check_exr.violations(rendered(form)) == []
    assert {name: header["compression"] for header, channels in read(form).parts for name in channels} == {
        name: numbered(compression if re.fullmatch(check_exr.LIGHT, name) else "zip") for name in form.bits()
    }
    for name, pixels in read(form).channels.items():
        exact = expected(form, name)
        assert pixels.dtype == exact.dtype, name
        if not re.fullmatch(check_exr.LIGHT, name) or pixels.dtype == np.float16 and compression == "pxr24":
            assert pixels.tobytes() == exact.tobytes(), name
        elif compression == "pxr24":
            # PXR24 keeps 15 bits of the mantissa, rounded.
            assert (np.abs(pixels - exact) <= 2**-16 * np.abs(exact)).all(), name
        elif name == "A":
            assert pixels.tobytes() == exact.tobytes()
    is_kept = (compression, precision) == ("pxr24", "half")
    assert np.array_equal(read(form).channels["R"], expected(form, "R")) == is_kept


@pytest.mark.parametrize("compression", ["dwaa", "dwab"])
def test_dwa_loses_what_the_encoder_of_openexr_loses(compression, tmp_path):
    form = Form(True, "half", compression, multipart=True)
    exact = {name: np.ascontiguousarray(expected(form, name)) for name in "RGB"}
    header = {"compression": numbered(compression), "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, dict(exact)).write(str(tmp_path / "its.exr"))
    its = check_exr.read(tmp_path / "its.exr").channels
    for name in "RGB":
        true, own, other = (each[name].astype(np.float64) for each in (exact, read(form).channels, its))
        error = np.sqrt(((own - true) ** 2).mean())
        # Both round equal cosines, but a few that lie midway between two steps go different ways.
        assert 0 < error < 0.02 * np.sqrt((true**2).mean())
        assert np.sqrt(((own - other) ** 2).mean()) < 0.1 * error


def test_dwa_keeps_the_depth_of_a_file_of_one_part():
    form = Form(False, "half", "dwaa")
    assert check_exr.violations(rendered(form)) == []
    for name in "AZ":
        assert read(form).channels[name].tobytes() == expected(form, name).tobytes()
    assert (read(form).channels["R"] != expected(form, "R")).any()


def test_colors_come_first_and_the_owner_is_told_by_openimageio():
    oiio = pytest.importorskip("OpenImageIO", reason="OpenImageIO has no package for this system")
    spec = oiio.ImageInput.open(str(rendered(Form()))).spec()
    assert spec.channelnames[:5] == ("R", "G", "B", "A", "Z")
    assert (spec.alpha_channel, spec.z_channel) == (3, 4)
    assert spec.get_string_attribute("Copyright") == "Émilie"
    assert spec.get_string_attribute("ImageDescription") == "shot 12"


@pytest.mark.parametrize("form", [Form(sharp=True), Form(precision="half", multipart=True, sharp=True)], ids=str)
def test_a_filter_that_subtracts_keeps_every_rule(form):
    assert check_exr.violations(rendered(form)) == []
    header, channels = read(form)[:2]
    third = 1 / 3
    assert header["render/filter"] == f"mitchell b {third!r} c {third!r}"
    assert (channels["direct.R"] < 0).any() and (channels["A"] >= 0).all()


def test_every_layer_holds_something():
    for layer in LAYERS:
        # Four samples of a pixel hit at most four objects, here two. Light through one surface alone finds nothing
        # behind it.
        if not layer.endswith(("01", "02")) and layer != "transmission_direct":
            assert read(Form()).layer(layer).any(), layer


def test_half_precision_counts_what_it_clamps():
    bright = Form(precision="half").scene().replace("lamp.emissive.radiance = 40", "lamp.emissive.radiance = 1e6")
    image = render.render(bright)
    clamped = sum(int((np.abs(pixels) == 65504).sum()) for pixels in image.channels.values() if pixels.dtype == np.float16)
    assert image.header["render/clamped"] == clamped > 0


def test_two_runs_write_the_same_bytes(tmp_path):
    form = Form(precision="half", compression="piz", multipart=True)
    render.write(form.scene(), tmp_path / "again.exr", threads=1)
    assert (tmp_path / "again.exr").read_bytes() == rendered(form).read_bytes()


def test_layers_of_the_command_line_are_those_of_the_scene(tmp_path):
    render.write(Form(layers=False).scene(), tmp_path / "asked.exr", layers="N,lights")
    asked = check_exr.read(tmp_path / "asked.exr")
    assert check_exr.violations(tmp_path / "asked.exr") == []
    assert set(asked.layers()) == {"", "N", "light_key_lamp", "light_environment", "light_rim"}
    for name, pixels in asked.channels.items():
        assert pixels.tobytes() == read(Form()).channels[name].tobytes(), name


# Three small light-emitting balls, red, green and blue, and nothing else.
BALLS = {"R": (-0.8, 0.5, 0.3), "G": (0.9, 0.65, -1.2), "B": (0.4, -0.6, 0.8)}
SPARKS = """
camera = {{ position = [0.4, 0.7, 5], look_at = [0.1, 0.1, 0], up = [0.1, 1, 0], {camera} }}
film = {{ width = 96, height = 64{film} }}
render = {{ samples = 256, seed = 3 }}
[material]
R.emissive.radiance = {{ rgb = [1, 0, 0] }}
G.emissive.radiance = {{ rgb = [0, 1, 0] }}
B.emissive.radiance = {{ rgb = [0, 0, 1] }}
"""
SPARK = '[[object]]\nshape.sphere = {{ center = {}, radius = 0.06 }}\nmaterial = "{}"\n'


@pytest.mark.parametrize(
    "camera",
    [
        "vertical_fov = 36",
        "vertical_fov = 36, shift = [0.13, -0.08]",
        'projection = "orthographic", height = 2.4',
        'projection = "orthographic", height = 2.4, shift = [-0.1, 0.07]',
    ],
)
@pytest.mark.parametrize("film", ["", ", crop = [10, 5, 80, 55]", ", overscan = [9, 4, 0, 21]"])
def test_world_to_ndc_points_at_what_shines(camera, film):
    text = SPARKS.format(camera=camera, film=film) + "".join(SPARK.format(list(at), name) for name, at in BALLS.items())
    header, channels = render.render(text)
    first, last = np.asarray(header["displayWindow"], np.float64)
    corner = np.asarray(header["dataWindow"][0], np.float64)
    for name, at in BALLS.items():
        x, y, _, w = np.array([*at, 1]) @ np.asarray(header["worldToNDC"], np.float64)
        projected = np.array([x, y]) / w * (last - first + 1)
        light = channels[name].astype(np.float64)
        rows, columns = np.indices(light.shape) + 0.5
        centroid = corner + [(light * columns).sum() / light.sum(), (light * rows).sum() / light.sum()]
        assert (light > 0).any(), name
        assert np.abs(projected - centroid).max() < 0.05, (name, projected, centroid)


@pytest.mark.parametrize("camera", ["vertical_fov = 36, shift = [0.1, -0.2]", 'projection = "orthographic", height = 3'])
def test_world_to_ndc_takes_what_is_met_to_its_pixel(camera):
    scene = Form(layers=False).scene().replace("vertical_fov = 38", camera)
    header, channels = render.render(scene, layers="P", samples=1)
    met = channels["Z"] < 1e9  # shadows on the board have no depth
    points = np.stack([channels[f"P.{axis}"][met] for axis in "XYZ"] + [np.ones(met.sum())], axis=-1)
    seen = points @ np.asarray(header["worldToNDC"], np.float64)
    rows, columns = np.nonzero(met)
    places = seen[:, :2] / seen[:, 3:] * (WIDTH, HEIGHT) - np.stack([columns, rows], axis=-1)
    assert met.sum() > 1000
    assert (places > -1e-3).all() and (places < 1 + 1e-3).all()
    # The matrix can be inverted, and Z is the depth along the view.
    back = seen @ np.linalg.inv(np.asarray(header["worldToNDC"], np.float64))
    assert np.abs(back[:, :3] / back[:, 3:] - points[:, :3]).max() < 1e-4
    depth = points @ np.asarray(header["worldToCamera"], np.float64)[:, 2]
    assert depth == pytest.approx(channels["Z"][met], rel=1e-5)


def test_a_view_all_around_has_no_world_to_ndc():
    scene = Form(layers=False).scene().replace("vertical_fov = 38", 'projection = "equirectangular"')
    header, _ = render.render(scene.replace(f"width = {WIDTH}", f"width = {2 * HEIGHT}"), samples=1)
    assert "worldToNDC" not in header and "worldToCamera" in header


# A ball lit by the sky, and a cube in front of it.
PLATE = 0.3
OBJECTS = f"""
camera = {{ position = [0, 0, 4], look_at = [0, 0, 0], vertical_fov = 40 }}
film = {{ width = 40, height = 40 }}
render = {{ samples = 16, seed = 2 }}
material.clay.diffuse.reflectance = {{ rgb = [0.2, 0.5, 0.8] }}
[[light]]
environment.radiance = {PLATE}
[[object]]
name = "ball"
shape.sphere = {{ center = [0, 0, 0], radius = 1 }}
material = "clay"
[[object]]
name = "cube"
shape.cube = {{ center = [0.6, 0.5, 1.1], size = 0.6 }}
material = "clay"
"""


def image(text):
    """Returns red, green, blue and coverage of a scene, in 64 bits."""
    channels = render.render(text).channels
    return np.stack([channels[name] for name in "RGBA"], axis=-1).astype(np.float64)


def without(text, key, of):
    """Returns the scene with a key added to the object or light that begins with the line `of`."""
    return text.replace(of, f"{key}\n{of}")


@pytest.fixture(scope="module")
def cut_out():
    """Renders the objects in front of a sky that only lights them."""
    return image(without(OBJECTS, "visible_to_camera = false", "environment.radiance"))


def over(a, b):
    """Composites premultiplied colors (Porter & Duff 1984)."""
    return a + (1 - a[..., 3:]) * b


def test_there_is_no_light_where_there_is_no_coverage(cut_out):
    alpha = cut_out[..., 3]
    assert (alpha == 0).any() and (alpha == 1).any() and ((alpha > 0) & (alpha < 1)).any()
    assert (cut_out[alpha == 0] == 0).all()


def test_objects_over_a_plate_of_the_sky_are_the_image_of_both(cut_out):
    both = image(OBJECTS)
    plate = np.broadcast_to([PLATE, PLATE, PLATE, 1.0], both.shape)
    assert over(cut_out, plate)[..., :3] == pytest.approx(both[..., :3], rel=1e-6, abs=1e-7)
    # Over nothing, objects are unchanged; opaque objects over themselves change nothing.
    assert np.array_equal(over(cut_out, np.zeros_like(both)), cut_out)
    opaque = cut_out[..., 3] == 1
    assert np.array_equal(over(cut_out, plate)[opaque], cut_out[opaque])


def test_holdouts_of_each_other_add_up(cut_out):
    hidden = without(OBJECTS, "visible_to_camera = false", "environment.radiance")
    ball = image(without(hidden, "holdout = true", "shape.cube"))
    cube = image(without(hidden, "holdout = true", "shape.sphere"))
    assert ball[..., 3].any() and cube[..., 3].any()
    assert ball + cube == pytest.approx(cut_out, rel=1e-6, abs=1e-7)


def test_mattes_cut_out_each_object():
    ranks = check_exr.matte(read(Form()), "CryptoObject")
    alpha = read(Form()).channels["A"]
    whole = np.zeros((HEIGHT, WIDTH))
    for name in ("floor", "ball", "стекло", "cubes [1]", "cubes [2]", "key lamp"):
        share = np.where(ranks[0] == check_exr.matte_number(name), ranks[1], 0).sum(axis=0)
        assert share.max() == 1 if name != "key lamp" else share.max() > 0, name
        whole += share
    clear = sum(np.abs(read(Form()).channels[f"shadow.{channel}"]) for channel in "RGB") == 0
    assert np.abs(whole - alpha)[clear].max() <= 1e-6 and (whole - alpha).max() <= 1e-6
    assets, shares = check_exr.matte(read(Form()), "CryptoAsset")
    of_both = np.where(assets == check_exr.matte_number("cubes"), shares, 0).sum(axis=0)
    of_each = [np.where(ranks[0] == check_exr.matte_number(f"cubes [{i}]"), ranks[1], 0).sum(axis=0) for i in (1, 2)]
    assert np.abs(of_both - sum(of_each)).max() <= 1e-6


def test_openexr_finds_the_color_metadata_in_order():
    for form in FORMS:
        parts = read(form).parts
        assert int(OpenEXR.checkColorMetadata(parts[0][0])) == 0
        assert all(int(OpenEXR.checkColorMetadata(header, parts[0][0])) == 0 for header, _ in parts[1:])
