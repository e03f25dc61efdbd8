"""Image files, and the difference between two images."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from . import _abbe, _arguments
from ._arguments import Path
from ._image import Image
from ._layers import Layers


class ExrImage(Layers):
    """An OpenEXR file written by any program, read as a whole."""

    _core: _abbe.Exr

    def __init__(self, core: _abbe.Exr) -> None:
        self._core = core

    def __getitem__(self, name: str) -> npt.NDArray[Any]:
        """Returns a layer by its name, or one channel by its full name.

        The array is float32, or uint32 if the file has that; height x width, and x channels if there are several. Alpha
        is not part of a color: it is `"A"`, or `"NAME.A"`. Mattes have four channels.

        Raises `KeyError` with the nearest name if there is none.
        """
        return np.asarray(self._core.plane(_arguments.text("the name of a layer", name)))

    @property
    def format(self) -> tuple[int, int]:
        """Columns and rows of the full image. The file may hold a part of it, or more than it."""
        return self._core.format

    @property
    def attributes(self) -> dict[str, str]:
        """The attributes of the file's header, as text. Where its parts differ, the value is that of the first part."""
        return dict(reversed(self._core.attributes))


@dataclass(frozen=True)
class Difference:
    """The difference between two images. Pixels with a value that is not finite are left out, except from `torn`."""

    agrees: bool
    """Whether all values are equal, those of other layers as well; or whether `relative_mse` is within the tolerance;
    or, without one, whether both images differ by no more than their `variance` layers explain."""
    is_equal: bool
    """Whether every value is the same."""
    layers_apart: list[str]
    """If it is: the other layers of both images that differ."""
    is_part: bool
    """Whether one image has pixels that the other has not, as beside a crop of it: those that both have are compared."""
    channels: list[str]
    """The channels that were compared."""
    relative_mse: float
    """The mean of (a - b)^2 / (b^2 + 0.01)."""
    brightness: float
    """The sum of the first image's values over that of the second one's."""
    mean_de2000: float | None
    """CIEDE2000 of colors as a screen shows them, over all pixels; None if they are no colors."""
    worst_de2000: float | None
    """The largest."""
    worst_pixel: tuple[int, int] | None
    """Column and row of the pixel that differs most, if any does."""
    left_out: int
    """Pixels that are left out."""
    torn: int
    """Those of them whose values differ."""
    worst_z: float | None
    """The largest |a - b| / sqrt(variance of a + variance of b); None if not both images say how noisy they are."""
    z_threshold: float | None
    """What chance exceeds in one of a hundred pairs of images."""
    z_of_means: list[float] | None
    """The same of each channel's mean."""
    absolute: npt.NDArray[np.float64] = field(repr=False, compare=False)
    """The largest |a - b| of each pixel's values, height x width."""


Picture = Union[Path, ExrImage, Image]


def read_exr(path: Path) -> ExrImage:
    """Reads an OpenEXR file written by any program.

    Raises `FileNotFoundError` if there is no such file, and `RenderError` if it is not a complete image.
    """
    return ExrImage(_abbe.Exr.read(_arguments.path("path", path)))


def _file(picture: Picture) -> _abbe.Exr:
    if isinstance(picture, ExrImage):
        return picture._core
    if isinstance(picture, Image):
        return _abbe.Exr.of(picture._core)
    wanted = "an abbe.Image, an abbe.ExrImage or the path of a file"
    return _abbe.Exr.read(_arguments.path("an image", picture, wanted))


def diff(a: Picture, b: Picture, *, layer: str | None = None, tolerance: float | None = None) -> Difference:
    """Compares two images, or files of images, as the command `render diff` does.

    Images with a `variance` layer agree if chance explains the difference of every pixel and of each channel's mean.
    Two renders of a scene with different seeds fail this test in at most about one of a hundred cases. `tolerance`
    judges by `relative_mse` instead. `layer` compares a layer such as `"albedo"` instead of the image itself. If one
    image is a crop of the other, the pixels that both have are compared.

    Raises `OptionsError` if they cannot be compared, for example because their sizes differ.
    """
    name = None if layer is None else _arguments.text("layer", layer)
    most = None if tolerance is None else _arguments.number("tolerance", tolerance)
    found = _abbe.diff(_file(a), _file(b), name, most)
    return Difference(**{**found, "absolute": np.asarray(found["absolute"])})
