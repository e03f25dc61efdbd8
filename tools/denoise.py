"""Denoises an image by Intel Open Image Denoise, into a layer beside it: denoised.R, denoised.G, denoised.B.

    python -m pip install pyoidn OpenEXR numpy          # once; pyoidn has 90 MB
    render scene.toml --exr image.exr --layers albedo,N
    python tools/denoise.py image.exr                   # into the same file
    python tools/denoise.py image.exr out.exr           # into another one

The layers `albedo` and `N` tell the denoiser where surfaces end and textures change. With film.first = "visible" in the
scene they also do so in mirrors and through smooth glass. All other channels and all attributes are kept to the bit,
so a file with a lossy compression is refused. A file of several parts gets one more. A layer `denoised` that is already
there is replaced.

A denoised image looks clean but is biased: measure and compare the noisy one, which stays in the file.
"""

import argparse
import os
import shutil
import sys
from pathlib import Path

import check_exr
import numpy as np
import OpenEXR

LAYER = "denoised"
NEEDED = {"image": "RGB", "albedo": ("albedo.R", "albedo.G", "albedo.B"), "N": ("N.X", "N.Y", "N.Z")}


def opened(path):
    """Opens an EXR file with its pixels."""
    if not path.is_file():
        sys.exit(f"{path}: no such file")
    with path.open("rb") as file:
        if file.read(4) != b"v/1\x01":
            sys.exit(f"{path}: not an EXR file")
    try:
        file = OpenEXR.File(str(path), separate_channels=True)
    except RuntimeError as error:
        sys.exit(f"{path}: damaged: {error}")
    return file if file.parts else sys.exit(f"{path}: the pixels are damaged or cut off")


def inputs(path, file):
    """Returns the image, its albedo and its normals, height x width x 3 of 32-bit floats."""
    channels = {name: channel.pixels for part in file.parts for name, channel in part.channels.items()}
    missing = [layer for layer, names in NEEDED.items() if not all(name in channels for name in names)]
    if "image" in missing:
        sys.exit(f"{path}: no image of R, G and B")
    if missing:
        again = f"render SCENE.toml --exr {path.name} --layers albedo,N"
        advice = 'best with film.first = "visible" in the scene'
        sys.exit(f"{path}: no layer {' and no layer '.join(missing)}: make them by `{again}`, {advice}")
    if len({channels[name].shape for names in NEEDED.values() for name in names}) > 1:
        sys.exit(f"{path}: its layers are of several sizes")
    return [np.stack([channels[name] for name in names], axis=-1).astype(np.float32) for names in NEEDED.values()]


def denoised(denoise, color, albedo, normal):
    """Returns the denoised image; `denoise` is the function of pyoidn.

    Colors outside the color space have negative components. The denoiser would take these for 0, and turn noise around
    0 into light. So the negative part is denoised separately, as a color of its own."""
    above, below = np.maximum(color, 0), np.maximum(-color, 0)
    result = denoise(above, albedo, normal, hdr=True)
    return result - denoise(below, albedo, normal, hdr=True) if below.any() else result


def parts_with(file, result):
    """Returns the parts of a file with the result in as many bits as the image: in the only part, or in its own."""
    first = file.parts[0]
    kind = next(part.channels["R"].pixels.dtype for part in file.parts if "R" in part.channels)
    fitting = result.clip(-np.finfo(kind).max, np.finfo(kind).max).astype(kind)
    planes = {f"{LAYER}.{name}": np.ascontiguousarray(fitting[..., i]) for i, name in enumerate("RGB")}
    if len(file.parts) == 1:
        for name, plane in planes.items():
            first.channels[name] = OpenEXR.Channel(name, plane)
        return file.parts
    # All colors of a file share one color space.
    header = {name: first.header[name] for name in check_exr.SHARED if name in first.header}
    header |= {"name": LAYER, "colorInteropID": first.header["colorInteropID"]}
    own = OpenEXR.Part(header, planes, LAYER)
    return [*(part for part in file.parts if part.header.get("name") != LAYER), own]


def changed(before, after):
    """Yields what differs between the parts of two files, apart from the layer of the result."""
    before = [part for part in before if part.header.get("name") != LAYER]
    for old, new in zip(before, after, strict=False):
        for name in (old.header.keys() | new.header.keys()) - {"channels", "chunkCount"}:
            if not np.array_equal(old.header.get(name), new.header.get(name)):
                yield f"attribute {name}"
        for name, channel in old.channels.items():
            kept = new.channels.get(name)
            if not name.startswith(f"{LAYER}.") and (kept is None or kept.pixels.tobytes() != channel.pixels.tobytes()):
                yield f"channel {name}"


def write(parts, before, out):
    """Writes to a temporary name first, so that there is never half a file."""
    # A symbolic link stays a link.
    out = out.resolve()
    partial = out.with_name(f"{out.name}.partial")
    try:
        OpenEXR.File(parts).write(str(partial))
        with OpenEXR.File(str(partial), separate_channels=True) as written:
            if lost := sorted(changed(before, written.parts)):
                sys.exit(f"{out}: not written, for this would not stay as it is: {', '.join(lost)}")
        if out.exists():
            shutil.copymode(out, partial)
        os.replace(partial, out)
    except (OSError, RuntimeError) as error:
        sys.exit(f"{out}: cannot be written: {error}")
    finally:
        partial.unlink(missing_ok=True)


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("image", type=Path, help="an EXR file with the layers albedo and N")
    parser.add_argument("out", type=Path, nargs="?", help="the file to write; the image itself if absent")
    options = parser.parse_args(arguments)
    out = options.out or options.image
    with opened(options.image) as file:
        if lossy := {check_exr.LOSSY[each] for part in file.parts if (each := part.header["compression"]) in check_exr.LOSSY}:
            sys.exit(f"{options.image}: colors under {lossy.pop()} would lose once more: render it with compression = \"zip\"")
        images = inputs(options.image, file)
        try:
            import pyoidn
        except ModuleNotFoundError:
            print("the denoiser is not installed: python -m pip install pyoidn", file=sys.stderr)
            return 2
        try:
            result = denoised(pyoidn.denoise, *images)
        except RuntimeError as error:
            sys.exit(f"the denoiser failed: {error}")
        write(parts_with(file, result), file.parts, out)
    print(f"wrote {out}: its layer {LAYER} is by Open Image Denoise {pyoidn.version.oidn_version}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
