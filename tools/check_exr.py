"""Checks that EXR files obey every rule of the files that Abbe writes; prints OK or FAIL and each violation.

    python tools/check_exr.py FILE...           # exit code 1 if any file breaks a rule

Images have scan lines and the channels R G B A Z, alone or with layers, in one part or with each layer in a part of its
own. A lossy compression is used for colors only. Numbers are finite, and 32-bit floats unless the file says that colors
have 16 bits. Lights and kinds of light add up to the image, mattes to its coverage. The header states a color space,
the camera, and the provenance under render/.

A spectral image holds R G B and one channel for each band of wavelengths, or four with Stokes vectors (Fichet,
Pacanowski & Wilkie 2021, "An OpenEXR Layout for Spectral Images", JCGT 10(3)).

Attribute meanings: OpenEXR, "Standard Attributes"; color: ASWF Color Interop Forum, recommendations 03 and 04 (2026);
mattes: Cryptomatte specification 1.2.0.
"""

import argparse
import itertools
import json
import math
import re
import sys
from typing import NamedTuple

import numpy as np
import OpenEXR

MISS_DEPTH = 1e10

# Red, green, blue and white xy of each color space that Abbe writes (Color Interop Forum, recommendation 03).
CHROMATICITIES = {
    "lin_rec709_scene": (0.640, 0.330, 0.300, 0.600, 0.150, 0.060, 0.3127, 0.3290),
    "lin_ap1_scene": (0.713, 0.293, 0.165, 0.830, 0.128, 0.044, 0.32168, 0.33767),
    "lin_ap0_scene": (0.7347, 0.2653, 0.0, 1.0, 0.0001, -0.077, 0.32168, 0.33767),
    "lin_rec2020_scene": (0.708, 0.292, 0.170, 0.797, 0.131, 0.046, 0.3127, 0.3290),
    "lin_p3d65_scene": (0.680, 0.320, 0.265, 0.690, 0.150, 0.060, 0.3127, 0.3290),
    "lin_ciexyzd65_scene": (1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1 / 3, 1 / 3),
}

LOSSLESS = {
    OpenEXR.NO_COMPRESSION: "none",
    OpenEXR.RLE_COMPRESSION: "rle",
    OpenEXR.ZIPS_COMPRESSION: "zips",
    OpenEXR.ZIP_COMPRESSION: "zip",
    OpenEXR.PIZ_COMPRESSION: "piz",
}

LOSSY = {
    OpenEXR.PXR24_COMPRESSION: "pxr24",
    OpenEXR.DWAA_COMPRESSION: "dwaa",
    OpenEXR.DWAB_COMPRESSION: "dwab",
}

# The channels of each layer; the image itself is the layer with an empty name.
LAYERS = {
    r"": "RGBAZ",
    r"emission|background|direct|indirect|caustics|dispersed|shadow": "RGB",
    r"(diffuse|glossy|specular|transmission)_(in)?direct": "RGB",
    r"light_[A-Za-z0-9_]+": "RGB",
    r"albedo|variance|residual|half_[ab]|denoised|S[123]": "RGB",
    r"polarization": ("degree", "linear_degree", "angle"),
    r"Nd?|P": "XYZ",
    r"UV": "UV",
    r"samples": "V",
    r"Crypto(Object|Material|Asset)0[0-2]": "rgba",
}
# A Stokes component of a band of wavelengths: its center in nm, with a decimal comma.
BAND = r"S([0-3])\.([0-9]+),([0-9]{6})nm"
# Channels that a lossy compression may change: light meant for viewing. A is rounded, or kept exactly.
LIGHT = r"([RGBA]|(emission|background|direct|indirect|caustics|dispersed|shadow|light_\w+|[a-z]+_(in)?direct)\.[RGB])"
# Colors in the file's color space, where they have parts of their own: no shares, squares or differences.
COLOR = r"(emission|background|direct|indirect|caustics|dispersed|albedo|half_[ab]|denoised|light_\w+|[a-z]+_(in)?direct)\.[RGB]"
# Channels that 16 bits would spoil: depth, positions, statistics and the numbers of mattes.
ALWAYS_32_BITS = r"Z|P\..*|UV\..*|variance\..*|samples\..*|residual\..*|S[123]\..*|polarization\..*|Crypto.*"
# Attributes that are the same in all parts of a file.
SHARED = ("type", "compression", "lineOrder", "dataWindow", "displayWindow", "pixelAspectRatio")
SHARED += ("screenWindowCenter", "screenWindowWidth")
MATTE_LAYERS = ("00", "01", "02")
STOKES = ("S0", "S1", "S2", "S3")
LOBES = ("diffuse", "glossy", "specular", "transmission")

# The form of each provenance attribute. A seed is text because an EXR integer has only 32 bits.
PROVENANCE = {
    "render/version": r"\S.*",
    "render/sceneHash": r"[0-9a-f]{64}",
    "render/seed": r"[0-9]{1,20}",
    "render/samples": range(1, 2**31),
    "render/filter": r"box|center|(tent|blackman-harris) radius [0-9.]+(e-[0-9]+)?|gaussian sigma [0-9.]+(e-[0-9]+)?|mitchell b [0-9.]+ c [0-9.]+",
    "render/projection": r"perspective|orthographic|equirectangular",
    "render/model": r"\S.*",
    "render/transport": r"\S.*",
    "render/nonFinite": range(2**31),
}


# The attributes of a stamp: when the image was made, in UTC, how long that took, and on how many threads.
STAMP = ("capDate", "utcOffset", "render/renderTime", "render/threads")
STAMPED = r"[0-9]{4}:(0[1-9]|1[0-2]):(0[1-9]|[12][0-9]|3[01]) ([01][0-9]|2[0-3]):[0-5][0-9]:[0-5][0-9]"


class File(NamedTuple):
    """The contents of a file: header of its first part, all channels by name, header and channels of each part."""

    header: dict
    channels: dict
    parts: list

    def layers(self):
        """Returns the names of its layers, in the order of their channels."""
        return list(dict.fromkeys(name.rpartition(".")[0] for name in self.channels))

    def layer(self, layer):
        """Returns the channels of a layer as one float64 array, channels first; None unless the file has them all."""
        names = [f"{layer}.{channel}" for channel in known_channels(layer)]
        if names and all(name in self.channels for name in names):
            return np.array([self.channels[name] for name in names], np.float64)
        return None

    def bands(self, component=0):
        """Returns the channels of a Stokes component by the centers of their bands in nm, ascending."""
        found = {name: re.fullmatch(BAND, name) for name in self.channels}
        own = {name: match for name, match in found.items() if match and int(match[1]) == component}
        return dict(sorted((float(f"{match[2]}.{match[3]}"), name) for name, match in own.items()))


def read(path):
    """Reads a file with all of its pixels; raises RuntimeError if it is damaged or cut off."""
    with OpenEXR.File(str(path), separate_channels=True) as file:
        if not file.parts:
            raise RuntimeError("the pixels are damaged or cut off")
        # Pixels that are not copied are freed when the file is closed.
        parts = [(dict(part.header), {name: each.pixels.copy() for name, each in part.channels.items()}) for part in file.parts]
        return File(parts[0][0], {name: pixels for _, channels in parts for name, pixels in channels.items()}, parts)


def known_channels(layer):
    """Returns the channels of a layer that Abbe writes; an empty sequence for any other layer."""
    return next((channels for form, channels in LAYERS.items() if re.fullmatch(form, layer)), "")


def layout(file):
    """Checks for scan lines from top to bottom, a known compression, and a display window at the origin.

    The data window may be smaller, as in crops, or larger, as with overscan, except in an environment map."""
    header = file.header
    if header.get("type", OpenEXR.scanlineimage) != OpenEXR.scanlineimage:
        yield f"type is {header['type']}, not a scanline image"
    if header["compression"] not in LOSSLESS | LOSSY:
        yield f"compression is {header['compression']}, not one of {', '.join((LOSSLESS | LOSSY).values())}"
    if header["lineOrder"] != OpenEXR.INCREASING_Y:
        yield f"line order is {header['lineOrder']}, not increasing y"
    data, display = (np.array(header[name]) for name in ("dataWindow", "displayWindow"))
    if "envmap" in header and not np.array_equal(data, display):
        yield f"data window {data.tolist()} of an environment differs from display window {display.tolist()}"
    if display[0].any():
        yield f"display window begins at {display[0].tolist()}, not at the origin"
    if header["pixelAspectRatio"] != 1:
        yield f"pixel aspect ratio is {header['pixelAspectRatio']}, not 1"


def parts(file):
    """Checks files of several parts: the first is the image and has all metadata; the others are layers, or depth."""
    if len(file.parts) == 1:
        return
    if file.header.get("name") != "image":
        yield f"the first part is {file.header.get('name')!r}, not 'image'"
    if layers := {name.rpartition(".")[0] for name in file.parts[0][1]} - {""}:
        yield f"part 'image': holds {', '.join(sorted(layers))} as well"
    if len(file.channels) < sum(len(channels) for _, channels in file.parts):
        yield "a channel is in several parts"
    for header, channels in file.parts[1:]:
        part = f"part {header.get('name')!r}"
        layers = {name.rpartition(".")[0] for name in channels}
        if layers != {header.get("name")} and (header.get("name"), *channels) != ("depth", "Z"):
            yield f"{part}: holds {', '.join(map(repr, sorted(layers)))}, not the layer of its name"
        for name in SHARED:
            wanted = file.header.get(name)
            if name == "compression" and wanted in LOSSY and not all(re.fullmatch(LIGHT, each) for each in channels):
                wanted = OpenEXR.ZIP_COMPRESSION
            if not np.array_equal(header.get(name), wanted):
                yield f"{part}: {name} differs from that of the first part"
        is_color = all(re.fullmatch(COLOR, each) for each in channels)
        wanted = file.header.get("colorInteropID") if is_color else "data"
        if header.get("colorInteropID") != wanted:
            yield f"{part}: colorInteropID is {header.get('colorInteropID')!r}, not {wanted!r}"
        if said := sorted(name for name in header if re.match("render/|cryptomatte/|chromaticities|capDate", name)):
            yield f"{part}: {', '.join(said)} would stand in the first part, if anywhere"
        if warnings := int(OpenEXR.checkColorMetadata(header, file.header)):
            yield f"{part}: OpenEXR warns of the color metadata: bits {warnings:#x}"


def losses(file):
    """Checks that a lossy compression changes only colors. DWA stores them in 16 bits, and packs depth without loss."""
    for header, channels in file.parts:
        name = LOSSY.get(header["compression"])
        for channel, pixels in channels.items() if name else ():
            if not re.fullmatch(LIGHT if name == "pxr24" else f"Z|{LIGHT}", channel):
                yield f"channel {channel!r}: no color, and {name} changes it"
            elif name != "pxr24" and channel != "Z" and pixels.dtype != np.float16:
                yield f"channel {channel!r}: {pixels.dtype}, of which {name} keeps 16 bits"


def unit(file, name):
    """Returns the relative spacing of a channel's numbers. PXR24 keeps 15 bits of a mantissa of 23."""
    packed = next(header["compression"] for header, channels in file.parts if name in channels)
    exact = float(np.finfo(file.channels[name].dtype).eps)
    return max(exact, 2.0**-15) if packed == OpenEXR.PXR24_COMPRESSION else exact


def names(file):
    """Checks that all readers keep the names: Nuke drops other characters, old readers cut at 31 bytes.

    Also checks that layers are complete, and that no channel is subsampled or marked as perceptually linear."""
    for name in file.channels:
        if not re.fullmatch(r"[\x21-\x7e]{1,31}", name):
            yield f"channel {name!r}: not 1 to 31 printable ASCII characters"
        if not re.fullmatch(rf"([A-Za-z][A-Za-z0-9_]*\.)?[A-Za-z][A-Za-z0-9_]*|{BAND}", name):
            yield f"channel {name!r}: not LAYER.CHANNEL"
    for channel in itertools.chain.from_iterable(header["channels"] for header, _ in file.parts):
        if channel.pLinear:
            yield f"channel {channel.name!r}: marked as perceptually linear"
        if (channel.xSampling, channel.ySampling) != (1, 1):
            yield f"channel {channel.name!r}: subsampled"
    spectral = bool(file.bands())
    for layer in dict.fromkeys(["", *file.layers()]):
        if spectral and layer in STOKES:
            continue
        known, prefix = "RGB" if spectral and not layer else known_channels(layer), f"{layer}." if layer else ""
        held = {name[len(prefix) :] for name in file.channels if name.rpartition(".")[0] == layer}
        if not known and re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", layer):
            yield f"layer {layer!r}: not one that Abbe writes"
        for channel in sorted(set(known) ^ held if known else ()):
            yield f"channel {prefix + channel!r}: {'missing' if channel in known else 'none of its layer'}"


def types(file):
    """Checks for 32-bit floats; 16 bits for colors, coverage and normals of files that count clamped values."""
    half = "render/clamped" in file.header
    for name, pixels in file.channels.items():
        bits = 16 if half and not re.fullmatch(ALWAYS_32_BITS, name) else 32
        if pixels.dtype != np.dtype(f"f{bits // 8}"):
            yield f"channel {name!r}: {pixels.dtype}, not {bits}-bit float"
    clamped = file.header.get("render/clamped", 0)
    if type(clamped) is not int or clamped < 0:
        yield f"render/clamped is {clamped!r}, not an integer from 0"


def subtracts(file):
    """Whether the filter has negative values.

    Coverage is then filtered as light is, so the layers of surfaces need not be empty where it is 0."""
    return str(file.header.get("render/filter", "")).startswith("mitchell")


def values(file):
    """Checks for finite numbers, coverage in 0..1, and positive depth: the miss depth where nothing is covered."""
    for name, pixels in file.channels.items():
        if wrong := np.count_nonzero(~np.isfinite(pixels.astype(np.float64))):
            yield f"channel {name!r}: {wrong} values not finite"
    alpha, depth = (file.channels.get(name) for name in "AZ")
    if alpha is not None and not ((alpha >= 0) & (alpha <= 1)).all():
        yield f"channel 'A': from {alpha.min()} to {alpha.max()}, not within 0..1"
    if depth is not None and not (depth > 0).all():
        yield f"channel 'Z': {np.count_nonzero(~(depth > 0))} depths not positive"
    if alpha is not None and depth is not None and not subtracts(file) and (alpha[depth != np.float32(MISS_DEPTH)] == 0).any():
        yield f"channel 'Z': pixels without coverage are not at the miss depth {MISS_DEPTH:g}"


def surfaces(file):
    """Checks the layers of first surfaces: albedo in 0..1, normals no longer than 1, 0 where there is no surface."""
    albedo = file.layer("albedo")
    if albedo is not None and not ((albedo >= 0) & (albedo <= 1)).all():
        yield f"layer 'albedo': from {albedo.min()} to {albedo.max()}, not within 0..1"
    for layer in ("N", "Nd"):
        normal = file.layer(layer)
        if normal is not None:
            length = np.sqrt((normal**2).sum(axis=0)).max()
            # The weight of a sample behind mirrors and glass is a product of 32-bit shares.
            if length > 1 + np.finfo(file.channels[f"{layer}.X"].dtype).eps + 32 * np.finfo(np.float32).eps:
                yield f"layer {layer!r}: a length of {length}, more than 1"
    alpha = file.channels.get("A")
    for layer in ("N", "Nd", "P", "UV"):
        numbers = file.layer(layer)
        if alpha is None or numbers is None or subtracts(file):
            continue
        if (wrong := np.count_nonzero(numbers[:, alpha == 0].any(axis=0))):
            yield f"layer {layer!r}: not 0 in {wrong} pixels where nothing is met"


def statistics(file):
    """Checks that variance is not negative, and that the numbers of samples are those asked for.

    Adaptive sampling takes half, twice or four times as many samples of a pixel. Samples that were not finite are
    missing.
    """
    variance, samples = file.layer("variance"), file.layer("samples")
    if variance is not None and not (variance >= 0).all():
        yield f"layer 'variance': {np.count_nonzero(~(variance >= 0))} values negative"
    if samples is None:
        return
    if ((samples < 0) | (samples != np.floor(samples))).any():
        yield "layer 'samples': not whole numbers"
    asked, lost = file.header.get("render/samples"), file.header.get("render/nonFinite")
    if type(asked) is not int:
        return
    rates = (math.ceil(asked / 2), asked, 2 * asked, 4 * asked)
    odd = samples[~np.isin(samples, rates)] if lost == 0 else samples[samples > rates[-1]]
    if (odd > asked).any():
        yield f"layer 'samples': up to {odd.max():g}, more than {asked}"
    elif odd.size:
        yield f"layer 'samples': down to {odd.min():g} of {asked}, and none was lost"


def luminance(file, channels):
    """Returns Y of three channels in the color space of the file; None if that is not known."""
    primaries = CHROMATICITIES.get(file.header.get("colorInteropID"))
    if primaries is None or any(channel not in file.channels for channel in channels):
        return None
    xyz = np.array([(x / y, 1, (1 - x - y) / y) if y else (1, 0, 0) if x else (0, 0, 1) for x, y in np.reshape(primaries, (4, 2))])
    # Red, green and blue of 1 make white.
    weights = np.linalg.solve(xyz[:3].T, xyz[3]) * xyz[:3, 1]
    return np.tensordot(weights, np.array([file.channels[channel] for channel in channels], np.float64), 1)


def stokes(file):
    """Checks that the polarized part is at most all light, and that degrees and angles match the Stokes vectors."""
    degrees = file.layer("polarization")
    if degrees is not None:
        degree, linear, angle = degrees
        if not ((linear >= 0) & (linear <= degree * (1 + np.finfo(np.float32).eps)) & (degree <= 1)).all():
            yield "layer 'polarization': degrees that are not 0 <= linear_degree <= degree <= 1"
        if not ((angle > -90) & (angle <= 90)).all():
            yield f"layer 'polarization': angles from {angle.min()} to {angle.max()}, not above -90 to 90"
    s0, *others = (luminance(file, [prefix + channel for channel in "RGB"]) for prefix in ("", "S1.", "S2.", "S3."))
    if s0 is None or any(each is None for each in others) or subtracts(file):
        return
    s1, s2, s3 = others
    linear, whole = np.hypot(s1, s2), np.sqrt(s1**2 + s2**2 + s3**2)
    # Lanes are interpolated, which may make the polarized part a little larger than the whole.
    if wrong := np.count_nonzero(whole > 1.01 * s0 + 1e-6 * np.abs(s0).max()):
        yield f"layers S1, S2 and S3: more than the image in {wrong} pixels"
    if degrees is None or file.channels["R"].dtype != np.float32:
        return
    # The rounding of 32-bit channels in a sum in which they may cancel.
    size = np.abs([file.channels[channel] for channel in "RGB"]).sum(axis=0)
    rounding = 32 * unit(file, "R") * size
    turned = np.deg2rad(2 * degrees[2])
    off = [degrees[0] * s0 - np.minimum(whole, s0), degrees[1] * (s0 * np.cos(turned)) - s1, degrees[1] * (s0 * np.sin(turned)) - s2]
    lit = (s0 > 1e-3 * np.abs(s0).max()) & (whole <= s0)
    if wrong := np.count_nonzero((np.abs(off) > rounding)[:, lit].any(axis=0)):
        yield f"layer 'polarization': not that of the Stokes vectors in {wrong} pixels"


def sums(file):
    """Checks that kinds of light, lights, and halves of the samples add up to the image within rounding."""
    lights = [layer for layer in file.layers() if layer.startswith("light_")]
    lobes = [f"{lobe}_{kind}" for lobe in LOBES for kind in ("direct", "indirect")]
    wholes = [(("emission", "background", "direct", "indirect"), 1), (("emission", "background", *lobes), 1), (lights, 1)]
    if file.header["compression"] in (OpenEXR.DWAA_COMPRESSION, OpenEXR.DWAB_COMPRESSION):
        return  # DWA keeps only the look of colors
    samples = file.header.get("render/samples")
    # Halves of an odd number of samples, or with samples missing, have unequal weights.
    if type(samples) is int and samples % 2 == 0 and file.header.get("render/nonFinite") == 0:
        wholes.append((("half_a", "half_b"), 0.5))
    image = [file.channels.get(name) for name in "RGB"]
    for layers, share in wholes:
        terms = [file.layer(layer) for layer in layers]
        if not terms or any(each is None for each in [*terms, *image]):
            continue
        kind = np.finfo(image[0].dtype)
        numbers = np.array([*(share * term for term in terms), -np.array(image, np.float64)])
        # Each number is off by up to half a unit in its last place. Values that did not fit into its type are skipped.
        rounding = unit(file, "R") * np.abs(numbers).sum(axis=0) + len(numbers) * float(kind.smallest_subnormal)
        fits = (np.abs([*terms, numbers[-1]]) < float(kind.max)).all(axis=0)
        off = np.where(fits, np.abs(numbers.sum(axis=0)) - rounding, 0)
        if wrong := np.count_nonzero(off > 0):
            yield f"{' + '.join(layers)}: not {'R, G, B' if share == 1 else 'twice R, G, B'} in {wrong} values, by {off.max():g}"


# The attributes of a spectral image. Readers of the layout warn about any unit other than this one.
SPECTRAL = {"spectralLayoutVersion": "1.0", "emissiveUnits": "W.m^-2.sr^-1", "render/spectralUnits": "W.m^-2.sr^-1.nm^-1"}


def spectrum(file):
    """Checks that bands are evenly spaced, beside R, G and B alone, with attributes that no other file has."""
    attributes = (*SPECTRAL, "render/spectralStep", "polarisationHandedness")
    bands, said = np.array(list(file.bands())), {name: file.header.get(name) for name in attributes}
    if not len(bands):
        yield from (f"{name} in a file without spectra" for name, value in said.items() if value is not None)
        return
    yield from (f"{name} is {said[name]!r}, not {value!r}" for name, value in SPECTRAL.items() if said[name] != value)
    step = said["render/spectralStep"]
    if not isinstance(step, float) or not step > 0:
        yield f"render/spectralStep is {step!r}, not a width in nm"
    # Centers have six decimals, and the step the digits of a 32-bit float.
    elif (np.abs(np.diff(bands) - step) > 1e-6 + 4 * step * np.finfo(np.float32).eps).any():
        yield f"bands are not {step:g} nm apart throughout"
    if "render/clamped" in file.header:
        yield "a spectral image of 16 bits"
    if len(file.parts) > 1:
        yield "a spectral image of several parts"
    if others := sorted(set(file.layers()) - {"", *STOKES}):
        yield f"a spectral image with the layers {', '.join(others)}"
    components = [list(file.bands(component)) for component in (1, 2, 3)]
    if any(components) and any(each != bands.tolist() for each in components):
        yield "S1, S2 and S3 are not there in the bands of S0"
    handedness = "right" if any(components) else None
    if said["polarisationHandedness"] != handedness:
        yield f"polarisationHandedness is {said['polarisationHandedness']!r}, not {handedness!r}"


def murmur3(data):
    """Returns MurmurHash3_x86_32 of bytes, with seed 0."""
    mask = 0xFFFFFFFF

    def turned(number, bits):
        return (number << bits | number >> 32 - bits) & mask

    def mixed(block):
        return turned(block * 0xCC9E2D51 & mask, 15) * 0x1B873593 & mask

    number, whole = 0, len(data) // 4 * 4
    for at in range(0, whole, 4):
        number = turned(number ^ mixed(int.from_bytes(data[at : at + 4], "little")), 13) * 5 + 0xE6546B64 & mask
    number ^= mixed(int.from_bytes(data[whole:], "little")) ^ len(data)
    number = (number ^ number >> 16) * 0x85EBCA6B & mask
    number = (number ^ number >> 13) * 0xC2B2AE35 & mask
    return number ^ number >> 16


def matte_number(name):
    """Returns the number of a name in a matte: its hash, with the exponent of a finite float that is not 0."""
    number = murmur3(name.encode())
    return number ^ 1 << 23 if number >> 23 & 0xFF in (0, 0xFF) else number


def matte_key(name):
    """Returns the key that stands for a matte in the names of its attributes."""
    return f"{murmur3(name.encode()):08x}"[:7]


def matte(file, name):
    """Returns a matte's numbers, as integers, and coverage, rank by rank; None without all layers in 32 bits."""
    channels = [file.channels.get(f"{name}{layer}.{channel}") for layer in MATTE_LAYERS for channel in "rgba"]
    if any(each is None or each.dtype != np.float32 for each in channels):
        return None
    return np.array([each.view(np.uint32) for each in channels[::2]]), np.array(channels[1::2], np.float64)


def mattes(file):
    """Checks the attributes of each matte and its numbers: all in its manifest, ranked by coverage, adding up to A."""
    found = dict.fromkeys(layer[:-2] for layer in file.layers() if re.fullmatch(r"Crypto[A-Za-z]+[0-9]{2}", layer))
    keys = {match[1] for attribute in file.header if (match := re.match(r"cryptomatte/([^/]*)/", attribute))}
    for key in sorted(keys - {matte_key(name) for name in found}):
        yield f"cryptomatte/{key}: no matte of this file"
    for name in found:
        key = matte_key(name)
        said = {field: file.header.get(f"cryptomatte/{key}/{field}") for field in ("name", "hash", "conversion", "manifest")}
        for field, value in {"name": name, "hash": "MurmurHash3_32", "conversion": "uint32_to_float32"}.items():
            if said[field] != value:
                yield f"cryptomatte/{key}/{field} is {said[field]!r}, not {value!r}"
        try:
            manifest = {each: int(number, 16) for each, number in json.loads(said["manifest"]).items()}
        except (TypeError, ValueError, AttributeError):
            yield f"cryptomatte/{key}/manifest is no object of names and hexadecimal numbers"
            continue
        for each, number in manifest.items():
            if number != matte_number(each):
                yield f"cryptomatte/{key}/manifest: {each!r} is {number:08x}, not {matte_number(each):08x}"
        for suffix in MATTE_LAYERS:
            if name + suffix not in file.layers():
                yield f"layer {name + suffix!r}: missing"
        if (ranks := matte(file, name)) is not None:
            yield from (f"matte {name!r}: {violation}" for violation in coverage(file, *ranks, manifest))


def coverage(file, numbers, shares, manifest):
    """Checks the ranks of a matte."""
    if unknown := set(np.unique(numbers).tolist()) - {0, *manifest.values()}:
        yield f"{len(unknown)} numbers are not in its manifest, such as {min(unknown):08x}"
    if ((numbers == 0) != (shares == 0)).any():
        yield "numbers without coverage, or coverage without a number"
    if any(((a == b) & (a != 0)).any() for a, b in itertools.combinations(numbers, 2)):
        yield "a number has several ranks of a pixel"
    if (shares < 0).any():
        yield f"coverage down to {shares.min():g}"
    if (np.diff(shares, axis=0) > 0).any():
        yield "coverage grows from rank to rank"
    whole = shares.sum(axis=0)
    rounding = len(shares) * np.finfo(np.float32).eps
    if (whole > 1 + rounding).any():
        yield f"coverage adds up to {whole.max():g}, more than 1"
    alpha = file.channels.get("A")
    if alpha is None or subtracts(file):
        return
    # If the last rank is used there may be more objects than ranks. Shadows cover a plate, but are not objects.
    shadow = [file.channels.get(f"shadow.{channel}") for channel in "RGB"]
    clear = np.zeros_like(whole, bool) if any(part is None for part in shadow) else (np.stack(shadow) == 0).all(axis=0)
    off = np.where((shares[-1] == 0) & clear, np.abs(whole - alpha), whole - alpha).max()
    if off > rounding + unit(file, "A"):
        yield f"coverage adds up to another number than A, by {off:g}"


def color(file):
    """Checks for a color space by name, and in single parts its chromaticities, for readers that know no names."""
    space, stored = file.header.get("colorInteropID"), file.header.get("chromaticities")
    if space not in CHROMATICITIES:
        yield f"colorInteropID is {space!r}, not one of {', '.join(CHROMATICITIES)}"
    elif len(file.parts) > 1:
        if stored is not None:
            yield "chromaticities would be those of all parts"
    elif stored is None:
        yield "chromaticities are missing"
    elif tuple(stored) != tuple(float(np.float32(value)) for value in CHROMATICITIES[space]):
        yield f"chromaticities {stored} are not those of {space}"
    if not file.header.get("whiteLuminance", 1) > 0:
        yield f"whiteLuminance is {file.header['whiteLuminance']}, not positive"
    if warnings := int(OpenEXR.checkColorMetadata(file.header)):
        yield f"OpenEXR warns of the color metadata: bits {warnings:#x}"


def optics(file):
    """Checks that sensor, focal lengths and f-number agree with the screen window and with each other."""
    header, near = file.header, 4 * np.finfo(np.float32).eps
    for name in ("near", "focus", "aperture", "pinholeFocalLength", "effectiveFocalLength"):
        if not header.get(name, 1) > 0:
            yield f"{name} is {header[name]}, not positive"
    sensor, pinhole, effective = (header.get(name) for name in ("sensorOverallDimensions", "pinholeFocalLength", "effectiveFocalLength"))
    if (sensor is None) != (pinhole is None):
        yield "sensorOverallDimensions and pinholeFocalLength: one is there without the other"
    elif sensor is not None:
        columns, rows = np.asarray(header["displayWindow"][1], np.float64) + 1
        if abs(sensor[0] - pinhole * header["screenWindowWidth"]) > near * sensor[0]:
            yield f"pinholeFocalLength is {pinhole}, not that of a sensor of {sensor[0]} mm and the screen window"
        if abs(sensor[1] * columns - sensor[0] * rows) > near * sensor[0] * rows:
            yield f"sensorOverallDimensions are {list(sensor)}, not as the image"
    if effective is not None:
        # 1 / f = 1 / image distance + 1 / distance in focus.
        expected = 1 / (1 / (pinhole or np.nan) + 1 / (1e3 * header.get("focus", np.nan)))
        if not abs(effective - expected) <= near * expected:
            yield f"effectiveFocalLength is {effective}, not that of pinholeFocalLength and focus"
    if (effective is None) != ("aperture" not in header or "focus" not in header):
        yield "effectiveFocalLength, aperture and focus: some are there without the others"


def camera(file):
    """Checks that worldToCamera takes row vectors from a right-handed world to a left-handed camera along +z."""
    header = file.header
    if not header.get("screenWindowWidth", 0) > 0:
        yield "screenWindowWidth is not positive"
    center = np.asarray(header.get("screenWindowCenter", (np.nan, np.nan)), np.float64)
    equirectangular = header.get("render/projection") == "equirectangular"
    if not np.isfinite(center).all():
        yield f"screenWindowCenter is {center.tolist()}, not finite"
    elif equirectangular and (center.any() or header.get("screenWindowWidth") != 1):
        yield "screenWindowCenter and screenWindowWidth are not (0, 0) and 1, as where nothing is projected in perspective"
    if "envmap" in header and (not equirectangular or header["envmap"] != OpenEXR.ENVMAP_LATLONG):
        yield f"envmap is {header['envmap']} in a view of projection {header.get('render/projection')!r}"
    matrix = header.get("worldToCamera")
    if matrix is None:
        yield "worldToCamera is missing"
        return
    matrix = np.asarray(matrix, np.float64)
    turn = matrix[:3, :3]
    if not np.isfinite(matrix).all() or np.any(matrix[:, 3] != (0, 0, 0, 1)):
        yield "worldToCamera is not affine"
    elif not np.abs(turn @ turn.T - np.eye(3)).max() <= 1e-6:
        yield "worldToCamera is not orthonormal"
    elif np.linalg.det(turn) > 0:
        yield "worldToCamera does not end in a left-handed camera"
    else:
        yield from projection(header, matrix, center)


def projection(header, world_to_camera, center):
    """Checks that worldToNDC agrees with worldToCamera and the screen window, and gives farther points a larger z."""
    kind, stored = header.get("render/projection"), header.get("worldToNDC")
    if kind == "equirectangular":
        if stored is not None:
            yield "worldToNDC is present in a view all around"
        return
    if stored is None:
        yield "worldToNDC is missing"
        return
    if kind not in ("perspective", "orthographic") or not header.get("screenWindowWidth", 0) > 0:
        return
    columns, rows = np.asarray(header["displayWindow"][1], np.float64) + 1
    size = header["screenWindowWidth"] * np.array([1, rows / columns])
    # Points at two depths, on the screen from the top left to the bottom right, and their positions in the world.
    ndc = np.array([(0, 0), (1, 0), (0.25, 0.75), (0.5, 0.5), (1, 1)] * 2, np.float64)
    depth = np.repeat([1.0, 3.0], 5)[:, None] * max(1, np.abs(world_to_camera[3]).max())
    across = (center + (ndc - 0.5) * (1, -1) * size) * (depth if kind == "perspective" else 1)
    seen = np.hstack([across, depth, np.ones_like(depth)])
    world = seen @ np.linalg.inv(world_to_camera)
    stored = np.asarray(stored, np.float64)
    clip, eps = world @ stored, np.finfo(np.float32).eps
    # The effect of rounding each of the 16 numbers on a point, in units of the image.
    from_camera = np.abs(world) @ np.abs(world_to_camera)[:, :3] * eps
    off_axis = from_camera[:, :2] + np.abs(across) / depth * from_camera[:, 2:]
    to_screen = off_axis / (depth if kind == "perspective" else 1) / size + eps * (1 + np.abs(center) / size)
    off_clip = np.abs(world) @ np.abs(stored) * eps
    with np.errstate(divide="ignore", invalid="ignore"):
        found = clip[:, :3] / clip[:, 3:]
        rounding = to_screen + (off_clip[:, :2] + np.abs(found[:, :2]) * off_clip[:, 3:]) / clip[:, 3:]
    if not (clip[:, 3] > 0).all():
        yield "worldToNDC puts points before the camera behind it"
    elif not (np.abs(found[:, :2] - ndc) <= rounding).all():
        off = np.abs(found[:, :2] - ndc).max()
        yield f"worldToNDC is off by {off:.3g} of the image from worldToCamera and the screen window"
    elif not (found[5:, 2] > found[:5, 2]).all():
        yield "worldToNDC does not put farther points at a larger z"


def provenance(file):
    """Checks the provenance: two runs of a scene give the same bytes, so it has no time unless a stamp is asked for."""
    for name, form in PROVENANCE.items():
        value = file.header.get(name)
        if value is None:
            yield f"{name} is missing"
        elif isinstance(form, range) and (type(value) is not int or value not in form):
            yield f"{name} is {value!r}, not an integer from {form.start}"
        elif isinstance(form, str) and not (isinstance(value, str) and re.fullmatch(form, value)):
            yield f"{name} is {value!r}, not text like {form}"
    if not str(file.header.get("software", "")).strip():
        yield "software is missing"
    stamped = [name in file.header for name in STAMP]
    if any(stamped) and not all(stamped):
        yield f"{', '.join(STAMP)}: some are there, and not all"
    elif all(stamped) and (not re.fullmatch(STAMPED, file.header["capDate"]) or file.header["utcOffset"] != 0):
        yield f"capDate is {file.header['capDate']!r} with utcOffset {file.header['utcOffset']}, not a time in UTC"
    elif all(stamped) and not (file.header["render/renderTime"] >= 0 and file.header["render/threads"] >= 1):
        yield "render/renderTime or render/threads is no time and no number of threads"


RULES = (layout, parts, losses, names, types, spectrum, color, optics, camera, provenance)
RULES_OF_PIXELS = (values, surfaces, statistics, sums, stokes, mattes)


def violations(path):
    """Returns every broken rule of the file, in words."""
    try:
        file = read(path)
    except RuntimeError as error:
        return [f"unreadable: {error}"]
    # Pixels of several sizes, or that are not floats, break one of `RULES` and cannot be compared.
    sizes, kinds = ({getattr(pixels, what) for pixels in file.channels.values()} for what in ("shape", "dtype"))
    comparable = len(sizes) == 1 and all(kind.kind == "f" for kind in kinds)
    rules = (*RULES, *RULES_OF_PIXELS) if comparable else RULES
    return [violation for rule in rules for violation in rule(file)]


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", metavar="FILE", nargs="+")
    bad = 0
    for path in parser.parse_args(arguments).files:
        found = violations(path)
        bad += bool(found)
        print("FAIL" if found else "OK  ", path)
        for violation in found:
            print("     ", violation)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
