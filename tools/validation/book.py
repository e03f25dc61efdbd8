"""All rows of the book, by group."""

import functools

import numpy as np
import OpenEXR

from . import caustics, color, dyes, energy, films, optics, polarized, transport

GROUPS = {
    "energy": energy,
    "optics": optics,
    "polarization": polarized,
    "films": films,
    "transport": transport,
    "color": color,
    "dyes": dyes,
    "caustics": caustics,
}


@functools.cache
def rows(quick, group=None):
    """Returns the rows of one group, or of all groups."""
    modules = [GROUPS[group]] if group else GROUPS.values()
    return [row for module in modules for row in module.rows(quick)]


def write_assets(folder):
    """Writes the only image that scenes read: two texels, between which a screen rises linearly from 0.1 to 0.9."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "bench.exr"
    if not path.is_file():
        texels = np.array([[0.1, 0.9]], np.float32)
        header = {"compression": OpenEXR.NO_COMPRESSION, "type": OpenEXR.scanlineimage}
        with OpenEXR.File(header, {name: OpenEXR.Channel(texels) for name in "RGB"}) as file:
            file.write(str(path))
