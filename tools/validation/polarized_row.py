"""Code that rows of polarized light share: pixels of gray light, and the expected S0 to S3."""

import numpy as np

from . import readers
from .row import ROUNDING, Row
from .scenes import view

GROUP = "polarization"
SKY = [{"environment": {"radiance": 1}}]
DOWN = np.array([0.0, 0.0, -1.0])
RIGHT = (1, 0, 0)
AVERAGED = "light that is taken for unpolarized at every surface"
NOT_TURNED = "frames that are not turned from surface to surface"


def components(image):
    """Returns S0 to S3 of every pixel."""
    polarized = [readers.need(image, f"S{number}.G") for number in (1, 2, 3)]
    return np.stack([image.rgb[..., 1], *polarized], -1).reshape(-1, 4)


def row(
    name,
    formula,
    materials,
    objects,
    expected,
    guards,
    mistake,
    words,
    *,
    film=None,
    camera=None,
    lights=SKY,
    **settings,
):
    """Returns a row for pixels of gray light: S0, or with `film` S0 to S3.

    Rounding is that of bright light, of which dark pixels are the remainder. Components that the mistake changes by
    less do not count as affected."""
    scene = view(materials, objects, lights, **{"polarization": "on"} | settings)
    scene["film"] |= film or {}
    scene["camera"] |= camera or {}
    count = 4 if film else 1
    expected, mistake = (np.round(np.broadcast_to(value, 4)[:count], 12) for value in (expected, mistake))
    mistake = np.where(np.abs(mistake - expected) > 8 * ROUNDING, mistake, expected)
    reader = components if film else readers.gray
    return Row(GROUP, name, formula, scene, reader, expected, guards, mistake, words, rounding=ROUNDING)


def untraced(row, averaged):
    """Returns the row without polarization, in which every surface applies the mean of R_s and R_p."""
    scene = row.scene | {"render": row.scene["render"] | {"polarization": "off"}}
    scene["film"] = {key: value for key, value in row.scene["film"].items() if key != "stokes"}
    return row._replace(
        name=f"{row.name}, averaged",
        formula="the same of the mean of R_s and R_p",
        scene=scene,
        read=readers.gray,
        expected=averaged,
        guards_against="polarization that is traced where it is off",
        mistake=row.expected[0],
        words=f"{row.words} Light is taken for unpolarized at every surface.",
    )


def in_plane(degrees):
    """Returns a direction in the image, counterclockwise from its right."""
    return [float(np.cos(np.radians(degrees))), float(np.sin(np.radians(degrees))), 0.0]


def polarizer(degrees, **more):
    return {"polarizer": {"axis": in_plane(degrees), **more}}
