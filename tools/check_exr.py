"""Checks that EXR files keep every rule of the files Abbe writes; says OK or FAIL and names each violation.

    python tools/check_exr.py FILE...           # exit code 1 if any file breaks a rule

One scanline part under lossless ZIP, channels R G B A Z (and samples.V) as 32-bit floats, finite, a stated color space, the camera,
and the provenance under render/. Attribute meanings: OpenEXR, "Standard Attributes"; color: ASWF Color Interop Forum,
recommendations 03 and 04 (2026).
"""

import re
import sys

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

# What each provenance attribute must look like; a seed is text because an EXR integer has 32 bits only.
PROVENANCE = {
    "render/version": r"\S.*",
    "render/sceneHash": r"[0-9a-f]{64}",
    "render/seed": r"[0-9]{1,20}",
    "render/samples": range(1, 2**31),
    "render/filter": r"box|center|(tent|blackman-harris) radius [0-9.]+(e-[0-9]+)?|gaussian sigma [0-9.]+(e-[0-9]+)?",
    "render/projection": r"perspective|orthographic|equirectangular",
    "render/model": r"\S.*",
    "render/transport": r"\S.*",
    "render/nonFinite": range(2**31),
}


def layout(header, channels):
    """One scanline image, lossless, top to bottom; the display window at the origin, the data window all or a part of it."""
    if header.get("type", OpenEXR.scanlineimage) != OpenEXR.scanlineimage:
        yield f"type is {header['type']}, not a scanline image"
    if header["compression"] != OpenEXR.ZIP_COMPRESSION:
        yield f"compression is {header['compression']}, not ZIP"
    if header["lineOrder"] != OpenEXR.INCREASING_Y:
        yield f"line order is {header['lineOrder']}, not increasing y"
    data, display = (np.array(header[name]) for name in ("dataWindow", "displayWindow"))
    if (data[0] < display[0]).any() or (data[1] > display[1]).any() or (data[0] > data[1]).any():
        yield f"data window {data.tolist()} is no part of display window {display.tolist()}"
    if "envmap" in header and not np.array_equal(data, display):
        yield f"data window {data.tolist()} of an environment differs from display window {display.tolist()}"
    if display[0].any():
        yield f"display window begins at {display[0].tolist()}, not at the origin"
    if header["pixelAspectRatio"] != 1:
        yield f"pixel aspect ratio is {header['pixelAspectRatio']}, not 1"


def names(header, channels):
    """Names that every reader keeps: Nuke drops other characters, old readers cut at 31 bytes."""
    for name in channels:
        if not re.fullmatch(r"[\x21-\x7e]{1,31}", name):
            yield f"channel {name!r}: not 1 to 31 printable ASCII characters"
        if not re.fullmatch(r"([A-Za-z][A-Za-z0-9_]*\.)?[A-Za-z][A-Za-z0-9_]*", name):
            yield f"channel {name!r}: not LAYER.CHANNEL"
    for channel in header["channels"]:
        if channel.pLinear:
            yield f"channel {channel.name!r}: marked as perceptually linear"
        if (channel.xSampling, channel.ySampling) != (1, 1):
            yield f"channel {channel.name!r}: subsampled"
    for name in "RGBAZ":
        if name not in channels:
            yield f"channel {name!r}: missing"


def values(header, channels):
    """32-bit floats, finite; coverage in 0..1; a positive depth, the miss depth where nothing is covered."""
    for name, pixels in channels.items():
        if pixels.dtype != np.float32:
            yield f"channel {name!r}: {pixels.dtype}, not 32-bit float"
        if wrong := np.count_nonzero(~np.isfinite(pixels.astype(np.float64))):
            yield f"channel {name!r}: {wrong} values not finite"
    alpha, depth = (channels.get(name) for name in "AZ")
    if alpha is not None and not ((alpha >= 0) & (alpha <= 1)).all():
        yield f"channel 'A': from {alpha.min()} to {alpha.max()}, not within 0..1"
    if depth is not None and not (depth > 0).all():
        yield f"channel 'Z': {np.count_nonzero(~(depth > 0))} depths not positive"
    if alpha is not None and depth is not None and (alpha[depth != np.float32(MISS_DEPTH)] == 0).any():
        yield f"channel 'Z': pixels without coverage are not at the miss depth {MISS_DEPTH:g}"


def color(header, channels):
    """A color space by name, and the same by its chromaticities for readers that know no names."""
    space, stored = header.get("colorInteropID"), header.get("chromaticities")
    if space not in CHROMATICITIES:
        yield f"colorInteropID is {space!r}, not one of {', '.join(CHROMATICITIES)}"
    elif stored is None:
        yield "chromaticities are missing"
    elif tuple(stored) != tuple(float(np.float32(value)) for value in CHROMATICITIES[space]):
        yield f"chromaticities {stored} are not those of {space}"
    if warnings := int(OpenEXR.checkColorMetadata(header)):
        yield f"OpenEXR warns of the color metadata: bits {warnings:#x}"


def camera(header, channels):
    """worldToCamera acts on row vectors, from a right-handed world to a left-handed camera that looks along +z."""
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


def provenance(header, channels):
    """Where the image comes from, and no clock: two runs of one scene are the same to the byte."""
    for name, form in PROVENANCE.items():
        value = header.get(name)
        if value is None:
            yield f"{name} is missing"
        elif isinstance(form, range) and (type(value) is not int or value not in form):
            yield f"{name} is {value!r}, not an integer from {form.start}"
        elif isinstance(form, str) and not (isinstance(value, str) and re.fullmatch(form, value)):
            yield f"{name} is {value!r}, not text like {form}"
    if not str(header.get("software", "")).strip():
        yield "software is missing"
    if "capDate" in header:
        yield "capDate is present"


RULES = (layout, names, values, color, camera, provenance)


def violations(path):
    """Every broken rule of the file, in words."""
    try:
        with OpenEXR.File(str(path), separate_channels=True) as file:
            if not file.parts:
                return ["unreadable: the pixels are damaged or cut off"]
            if len(file.parts) != 1:
                return [f"{len(file.parts)} parts, not one"]
            header = file.parts[0].header
            channels = {name: channel.pixels for name, channel in file.parts[0].channels.items()}
            return [violation for rule in RULES for violation in rule(header, channels)]
    except RuntimeError as error:
        return [f"unreadable: {error}"]


def main(paths):
    if not paths:
        sys.exit("usage: check_exr.py FILE...")
    bad = 0
    for path in paths:
        found = violations(path)
        bad += bool(found)
        print("FAIL" if found else "OK  ", path)
        for violation in found:
            print("     ", violation)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
