"""The EXR checker passes good files of layers, in one part and in several, and names what is wrong with bad ones.

pytest tools/tests/test_check_exr_layers.py
"""

import json
import re

import check_exr
import numpy as np
import OpenEXR
import pytest
from test_check_exr import HEIGHT, SHIFTED, SMALLER, WIDTH, WINDOW, found, header, plane  # noqa: F401


def layered(half=False, **changes):
    """Returns a good image with every layer: two objects and a bit of sky, lit by two lights."""
    numbers = np.random.default_rng(7)
    kinds = {name: numbers.random((3, HEIGHT, WIDTH)) for name in ("emission", "background", "direct", "indirect")}
    image, share = sum(kinds.values()), numbers.random((3, HEIGHT, WIDTH))
    ball, floor = np.zeros((HEIGHT, WIDTH)), np.ones((HEIGHT, WIDTH))
    ball[2:5, 3:8], floor[2:5, 3:8], ball[2, 2:9], floor[2, 2:9], floor[:2] = 1, 0, 0.75, 0.25, 0
    alpha = ball + floor
    normal = np.stack([np.zeros_like(alpha), alpha, np.zeros_like(alpha)])
    layers = {
        **kinds,
        **{f"{lobe}_{kind}": 0.25 * kinds[kind] for lobe in check_exr.LOBES for kind in ("direct", "indirect")},
        "caustics": 0.5 * kinds["indirect"],
        "dispersed": 0.1 * image,
        "light_key": share * image,
        "light_rim_1": (1 - share) * image,
        "half_a": image + share,
        "half_b": image - share,
        "albedo": share,
        "variance": share**2,
        "N": normal,
        "Nd": normal,
        "P": numbers.normal(size=(3, HEIGHT, WIDTH)) * alpha,
        "UV": numbers.random((2, HEIGHT, WIDTH)) * alpha,
        "samples": np.full((1, HEIGHT, WIDTH), 4),
        "residual": 1e-7 * (share - 0.5),
        "shadow": np.zeros_like(image),
        **{name: share_of * image for name, share_of in {"S1": 0.3, "S2": -0.2, "S3": 0.1}.items()},
    }
    numbers_of = (np.sqrt(0.14), np.sqrt(0.13), np.rad2deg(np.arctan2(-0.2, 0.3) / 2))
    layers["polarization"] = np.stack([np.full_like(alpha, number) for number in numbers_of])
    for matte, names in MATTES.items():
        for suffix in check_exr.MATTE_LAYERS:
            layers[matte + suffix] = np.zeros((4, HEIGHT, WIDTH))
        first, second = (np.float32(np.uint32(check_exr.matte_number(name)).view(np.float32)) for name in names)
        more, less = np.maximum(ball, floor), np.minimum(ball, floor)
        number = np.where(ball > floor, first, second)
        other = np.where(ball > floor, second, first)
        layers[matte + "00"] = np.stack([np.where(more > 0, number, 0), more, np.where(less > 0, other, 0), less])
    good = {"R": image[0], "G": image[1], "B": image[2], "A": alpha, "Z": np.where(alpha > 0, 2.5, 1e10)}
    for layer, values in layers.items():
        known = check_exr.known_channels(layer)
        good |= {f"{layer}.{channel}": each for channel, each in zip(known, values, strict=True)}
    wide = {name for name in good if not half or re.fullmatch(check_exr.ALWAYS_32_BITS, name)}
    good = {name: each.astype(np.float32 if name in wide else np.float16) for name, each in good.items()}
    return {name: value for name, value in {**good, **changes}.items() if value is not None}


MATTES = {"CryptoObject": ("ball", "равнина"), "CryptoMaterial": ('a "red" one', "grass"), "CryptoAsset": ("ball", "torus")}


def matte_attributes(**changes):
    """Returns the attributes of all mattes; `changes` are to those of CryptoObject."""
    attributes = {}
    for matte, names in MATTES.items():
        manifest = {name: f"{check_exr.matte_number(name):08x}" for name in names}
        said = {"name": matte, "hash": "MurmurHash3_32", "conversion": "uint32_to_float32"}
        said |= {"manifest": json.dumps(manifest, ensure_ascii=False)} | (changes if matte == "CryptoObject" else {})
        attributes |= {f"cryptomatte/{check_exr.matte_key(matte)}/{key}": value for key, value in said.items()}
    return attributes


def test_numbers_of_names_are_those_of_the_specification():
    assert check_exr.murmur3(b"torus") == 4053562365
    assert check_exr.matte_number("torus") == 0xF19C73FD
    assert check_exr.murmur3("равнина".encode()) == 2518896926
    assert check_exr.matte_key("CryptoObject") == "3ae39a5"


def test_numbers_of_names_are_finite_floats():
    numbers = np.array([check_exr.matte_number(f"object {i}") for i in range(20000)], np.uint32).view(np.float32)
    assert (np.isfinite(numbers) & (np.abs(numbers) >= np.finfo(np.float32).tiny)).all()


@pytest.mark.parametrize("half", [False, True])
@pytest.mark.parametrize("compression", check_exr.LOSSLESS, ids=check_exr.LOSSLESS.values())
def test_a_good_file_of_all_layers_breaks_no_rule(found, half, compression):
    attributes = {**matte_attributes(), "compression": compression, "render/clamped": 0 if half else None}
    assert found(header(**attributes), layered(half)) == []


def test_layers_by_themselves_break_no_rule(found):
    for layer in ("emission", "light_key", "half_a", "P", "samples"):
        own = {name: value for name, value in layered().items() if name in "RGBAZ" or name.startswith(f"{layer}.")}
        own |= {"R": own[f"{layer}.R"], "G": own[f"{layer}.G"], "B": own[f"{layer}.B"]} if layer == "light_key" else {}
        assert found(header(), own) == [], layer


def changed(name, value, where=(5, 5)):
    """Returns a channel of the good image with another number at one place."""
    values = layered()[name].copy()
    values[where] = value
    return {name: values}


def swapped(first, second):
    """Returns two channels of the good image, swapped."""
    good = layered()
    return {first: good[second], second: good[first]}


def object_number(name):
    return np.uint32(check_exr.matte_number(name)).view(np.float32)


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"albedo.G": None}, "channel 'albedo.G': missing"),
        ({"albedo.A": plane(1)}, "channel 'albedo.A': none of its layer"),
        ({"diffuse.R": plane(1)}, "layer 'diffuse': not one that Abbe writes"),
        ({"P.X": plane(0, np.float16)}, "'P.X': float16, not 32-bit float"),
        ({"N.X": plane(0, np.float16)}, "'N.X': float16, not 32-bit float"),
        ({"samples.V": plane(4, np.uint32)}, "'samples.V': uint32, not 32-bit float"),
        (changed("direct.R", np.nan), "'direct.R': 1 values not finite"),
        (changed("albedo.R", 1.001), "layer 'albedo': from"),
        (changed("albedo.R", -0.001), "layer 'albedo': from"),
        (changed("variance.B", -1e-9), "layer 'variance': 1 values negative"),
        (changed("N.X", 0.01), "layer 'N': a length of"),
        (changed("Nd.Y", -1.001), "layer 'Nd': a length of"),
        (changed("P.Z", 1e-9, (0, 0)), "layer 'P': not 0 in 1 pixels"),
        (changed("UV.U", 0.5, (0, 0)), "layer 'UV': not 0 in 1 pixels"),
        (changed("samples.V", 3.5), "layer 'samples': not whole numbers"),
        (changed("samples.V", 3), "layer 'samples': down to 3 of 4, and none was lost"),
        (changed("samples.V", 5), "layer 'samples': up to 5, more than 4"),
        (changed("glossy_direct.R", 3), "transmission_indirect: not R, G, B in 1 values"),
        (changed("indirect.G", 3), "emission + background + direct + indirect: not R, G, B in 1 values"),
        (changed("light_rim_1.B", 3), "light_key + light_rim_1: not R, G, B in 1 values"),
        (changed("half_b.R", 30), "half_a + half_b: not twice R, G, B in 1 values"),
        ({"S1.R": None}, "channel 'S1.R': missing"),
        (changed("S2.G", -30), "layers S1, S2 and S3: more than the image in 1 pixels"),
        (changed("polarization.degree", 1.1), "layer 'polarization': degrees that are not"),
        (changed("polarization.linear_degree", 0.5), "layer 'polarization': degrees that are not"),
        (changed("polarization.angle", -90), "layer 'polarization': angles from -90"),
        (changed("polarization.degree", 0.4), "layer 'polarization': not that of the Stokes vectors in 1 pixels"),
        (changed("polarization.angle", 16.9), "layer 'polarization': not that of the Stokes vectors in 1 pixels"),
        ({"light_rim_1.R": None, "light_rim_1.G": None, "light_rim_1.B": None}, "light_key: not R, G, B"),
        ({f"CryptoObject02.{channel}": None for channel in "rgba"}, "layer 'CryptoObject02': missing"),
        (changed("CryptoObject00.r", object_number("cube")), "1 numbers are not in its manifest"),
        (changed("CryptoObject00.r", -0.0, (0, 0)), "1 numbers are not in its manifest, such as 80000000"),
        (changed("CryptoObject00.r", object_number("ball"), (0, 0)), "numbers without coverage"),
        (changed("CryptoObject00.g", 0.5), "coverage adds up to another number than A, by 0.5"),
        (changed("CryptoObject00.g", 1.1), "coverage adds up to 1.1, more than 1"),
        (changed("CryptoObject00.g", -0.1), "coverage down to -0.1"),
        (changed("CryptoObject00.b", object_number("ball"), (2, 3)), "a number has several ranks"),
        (swapped("CryptoObject00.g", "CryptoObject00.a"), "coverage grows from rank to rank"),
    ],
)
def test_a_bad_layer_fails_for_its_own_reason(found, changes, reason):
    violations = found(header(**matte_attributes()), layered(**changes))
    assert any(reason in violation for violation in violations), violations
    assert len(violations) <= 4, violations


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        (matte_attributes(hash="MurmurHash3_128"), "cryptomatte/3ae39a5/hash is 'MurmurHash3_128'"),
        (matte_attributes(conversion=None), "cryptomatte/3ae39a5/conversion is None"),
        (matte_attributes(name="CryptoAsset"), "cryptomatte/3ae39a5/name is 'CryptoAsset'"),
        (matte_attributes(manifest=None), "manifest is no object"),
        (matte_attributes(manifest='{"ball":'), "manifest is no object"),
        (matte_attributes(manifest='["ball"]'), "manifest is no object"),
        (matte_attributes(manifest='{"ball":"torus"}'), "manifest is no object"),
        (matte_attributes(manifest='{"ball":"f19c73fd"}'), "manifest: 'ball' is f19c73fd, not"),
        (matte_attributes(manifest="{}"), "2 numbers are not in its manifest"),
        ({**matte_attributes(), "cryptomatte/0000000/name": "CryptoLight"}, "cryptomatte/0000000: no matte"),
        ({**matte_attributes(), "render/clamped": 0}, "'R': float32, not 16-bit float"),
        ({**matte_attributes(), "render/clamped": -1}, "render/clamped is -1"),
    ],
)
def test_bad_attributes_of_layers_fail_for_their_own_reason(found, changes, reason):
    violations = found(header(**changes), layered())
    assert any(reason in violation for violation in violations), violations


def test_sums_are_as_exact_as_their_numbers_are_stored(found):
    attributes = {**matte_attributes(), "render/clamped": 0}
    image = layered(half=True)
    term = image["direct.R"]
    # One unit in the last place of one term may come from the rounding of all terms. A hundred may not.
    term[4, 4] = np.nextafter(term[4, 4], np.float16(9))
    assert found(header(**attributes), {**image}) == []
    for _ in range(99):
        term[4, 4] = np.nextafter(term[4, 4], np.float16(9))
    (violation,) = found(header(**attributes), {**image})
    assert "emission + background + direct + indirect: not R, G, B in 1 values" in violation


def test_sums_say_nothing_of_what_did_not_fit(found):
    image = layered(half=True)
    for name in ("R", "emission.R", "light_key.R", "half_a.R"):
        image[name][4, 4] = np.finfo(np.float16).max
    assert found(header(**matte_attributes(), **{"render/clamped": 4}), image) == []


def several_parts(half=False, *, changes=None, **attributes):
    """Returns the good image with each layer in a part of its own; `changes` are attributes by the name of the part."""
    image = layered(half)
    attributes = {"chromaticities": None, "render/clamped": 0 if half else None, **matte_attributes(), **attributes}
    first = header(**attributes)
    shared = ("type", "compression", "dataWindow", "displayWindow", "screenWindowWidth")
    own = {name: first[name] for name in shared if name in first}
    parts = {"image": ({**first, "name": "image"}, {})}
    for name, values in image.items():
        layer = name.rpartition(".")[0] or "image"
        space = first["colorInteropID"] if re.fullmatch(check_exr.COLOR, name) else "data"
        parts.setdefault(layer, ({**own, "colorInteropID": space, "name": layer}, {}))[1][name] = values
    for layer, change in (changes or {}).items():
        own = {name: value for name, value in {**parts[layer][0], **change}.items() if value is not None}
        parts[layer] = own, parts[layer][1]
    return parts


@pytest.fixture
def found_in_parts(tmp_path):
    """Returns the violations of a file of several parts."""

    def write_and_check(parts):
        path = tmp_path / "parts.exr"
        OpenEXR.File([OpenEXR.Part(header, channels, header["name"]) for header, channels in parts.values()]).write(str(path))
        return check_exr.violations(path)

    return write_and_check


@pytest.mark.parametrize("taken", [2, 4, 8, 16])
def test_adaptive_sampling_takes_half_or_four_times_as_many(found, taken):
    assert found(header(**matte_attributes()), {**layered(), **changed("samples.V", taken)}) == []


@pytest.mark.parametrize("half", [False, True])
def test_a_good_file_of_several_parts_breaks_no_rule(found_in_parts, half):
    assert found_in_parts(several_parts(half)) == []


def lossy_parts(compression, half):
    """Returns the good file of several parts with lossy compression of its colors, and depth in a part of its own."""
    parts = several_parts(half)
    parts["depth"] = {**parts["N"][0], "name": "depth"}, {"Z": parts["image"][1].pop("Z")}
    for header, channels in parts.values():
        light = all(re.fullmatch(check_exr.LIGHT, name) for name in channels)
        header["compression"] = compression if light else OpenEXR.ZIP_COMPRESSION
    return parts


@pytest.mark.parametrize("half", [False, True])
@pytest.mark.parametrize("compression", check_exr.LOSSY, ids=check_exr.LOSSY.values())
def test_colors_alone_may_be_under_a_compression_that_loses(found_in_parts, half, compression):
    found = found_in_parts(lossy_parts(compression, half))
    if half or compression == OpenEXR.PXR24_COMPRESSION:
        assert found == []
    else:
        assert "channel 'R': float32, of which dwa" in "\n".join(found)


@pytest.mark.parametrize("name", ["N", "albedo", "variance", "half_a", "CryptoObject00"])
@pytest.mark.parametrize("compression", check_exr.LOSSY, ids=check_exr.LOSSY.values())
def test_data_under_a_compression_that_loses_fail(found_in_parts, compression, name):
    parts = lossy_parts(compression, half=True)
    parts[name][0]["compression"] = compression
    violations = found_in_parts(parts)
    assert f"part {name!r}: compression differs from that of the first part" in violations
    for channel in parts[name][1]:
        assert f"channel {channel!r}: no color, and {check_exr.LOSSY[compression]} changes it" in violations


def test_a_depth_under_pxr24_fails(found):
    image = {name: plane(0.5, np.float32 if name == "Z" else np.float16) for name in "RGBAZ"}
    attributes = {"render/clamped": 0, "compression": OpenEXR.PXR24_COMPRESSION}
    assert found(header(**attributes), image) == ["channel 'Z': no color, and pxr24 changes it"]
    assert found(header(**attributes | {"compression": OpenEXR.DWAA_COMPRESSION}), image) == []


def test_depth_may_be_a_part_of_its_own(found_in_parts):
    parts = several_parts()
    parts["depth"] = {**parts["N"][0], "name": "depth"}, {"Z": parts["image"][1].pop("Z")}
    assert found_in_parts(parts) == []


@pytest.mark.parametrize(
    ("parts", "reason"),
    [
        (several_parts(changes={"image": {"name": "beauty"}}), "the first part is 'beauty', not 'image'"),
        (several_parts(changes={"N": {"name": "normal"}}), "part 'normal': holds 'N', not the layer of its name"),
        (several_parts(changes={"N": {"colorInteropID": None}}), "part 'N': colorInteropID is None, not 'data'"),
        (several_parts(changes={"emission": {"colorInteropID": "data"}}), "part 'emission': colorInteropID is 'data', not 'lin_"),
        (several_parts(changes={"N": {"compression": OpenEXR.RLE_COMPRESSION}}), "part 'N': compression differs"),
        (several_parts(changes={"N": {"dataWindow": SHIFTED}}), "part 'N': dataWindow differs"),
        (several_parts(changes={"N": {"screenWindowWidth": 2.0}}), "part 'N': screenWindowWidth differs"),
        (several_parts(changes={"N": {"render/samples": 4}}), "part 'N': render/samples would stand in the first part"),
        (several_parts(changes={"image": {"render/samples": None}}), "render/samples is missing"),
        (several_parts(changes={"image": {"worldToNDC": None}}), "worldToNDC is missing"),
    ],
)
def test_a_bad_part_fails_for_its_own_reason(found_in_parts, parts, reason):
    violations = found_in_parts(parts)
    assert any(reason in violation for violation in violations), violations
    assert len(violations) <= 2, violations


def test_chromaticities_in_a_file_of_several_parts_fail(found_in_parts):
    space = check_exr.CHROMATICITIES["lin_rec709_scene"]
    parts = several_parts(chromaticities=space)
    for own, _ in parts.values():
        own["chromaticities"] = space
    assert "chromaticities would be those of all parts" in found_in_parts(parts)


def test_several_layers_in_one_part_fail(found_in_parts):
    parts = several_parts()
    parts["N"][1].update(parts.pop("Nd")[1])
    assert "part 'N': holds 'N', 'Nd', not the layer of its name" in found_in_parts(parts)
    parts = several_parts()
    parts["image"][1].update(parts.pop("samples")[1])
    assert found_in_parts(parts) == ["part 'image': holds samples as well"]


def test_parts_of_several_sizes_fail(found_in_parts):
    parts = several_parts(dataWindow=WINDOW, displayWindow=WINDOW)
    smaller = {name: values[:-1] for name, values in parts["N"][1].items()}
    parts["N"] = {**parts["N"][0], "dataWindow": SMALLER}, smaller
    assert found_in_parts(parts) == ["part 'N': dataWindow differs from that of the first part"]


def test_integers_fail(found):
    whole = {name: plane(1, np.uint32) for name in "RGBAZ"}
    violations = found(header(**matte_attributes()), layered(**whole))
    assert violations == [f"channel {name!r}: uint32, not 32-bit float" for name in "ABGRZ"]


def test_a_channel_in_two_parts_fails(found_in_parts):
    parts = several_parts()
    parts["N"][1]["P.X"] = parts["P"][1]["P.X"]
    violations = found_in_parts(parts)
    assert "a channel is in several parts" in violations
