"""OpenEXR files, and comparing two images."""

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
    """An OpenEXR file, written by any program and read as a whole."""

    _core: _abbe.Exr

    def __init__(self, core: _abbe.Exr) -> None:
        self._core = core

    def __getitem__(self, name: str) -> npt.NDArray[Any]:
        """Returns a layer such as `"albedo"`, or one channel by its full name, such as `"albedo.R"`.

        The array is float32, or uint32 if the file stores integers. Its shape is height x width for one channel, and
        height x width x channels for several. Layers do not include alpha, which is the channel `"A"` or `"NAME.A"`.
        Only mattes do: they have four channels.

        Raises `KeyError` if there is no such layer or channel. The message lists the layers.
        """
        return np.asarray(self._core.plane(_arguments.text("the name of a layer", name)))

    @property
    def format(self) -> tuple[int, int]:
        """Width and height of the format in pixels. The file may hold only a part of it, or overscan around it."""
        return self._core.format

    @property
    def attributes(self) -> dict[str, str]:
        """The attributes in the header of the file, as strings. If the parts of a file differ, the first one counts."""
        return dict(reversed(self._core.attributes))


@dataclass(frozen=True)
class Difference:
    """The result of `diff`. In its formulas, a is a value of the first image, and b the same value of the second one.

    Pixels with an infinite or NaN value in one of the images are left out of the statistics.
    """

    agrees: bool
    """Whether the images agree. With a tolerance, `relative_mse` must be within it, and so must that of alpha. Without
    one, the images must either be equal, with no `layers_apart`, or differ by no more than the noise that both state in
    their `variance` layers. If `torn` is not 0, they never agree."""
    is_equal: bool
    """Whether all values are equal, alpha included. NaN counts as equal to NaN."""
    layers_apart: list[str]
    """If the images are equal and `layer` was not given: the names of the other common layers that differ."""
    is_part: bool
    """Whether one image has pixels that the other, such as a crop, lacks. Only common pixels are compared."""
    channels: list[str]
    """The names of the compared channels."""
    relative_mse: float
    """The mean of (a - b)^2 / (b^2 + 0.01) over all values."""
    brightness: float
    """The sum of all a, divided by the sum of all b."""
    mean_de2000: float | None
    """The mean CIEDE2000 difference over all pixels, of the colors as a screen shows them. None for other data."""
    worst_de2000: float | None
    """The largest CIEDE2000 difference. None for other data."""
    worst_pixel: tuple[int, int] | None
    """Column and row of the pixel that differs most, in the full image. None if none differs."""
    left_out: int
    """The number of pixels that are left out."""
    torn: int
    """The number of left-out pixels whose values differ."""
    worst_z: float | None
    """The z = (a - b) / sqrt(variance of a + variance of b) that is farthest from 0, with its sign. None unless the
    images themselves are compared, and both state their noise in a `variance` layer."""
    z_threshold: float | None
    """The bound that |z| exceeds by chance in one of a hundred pairs of images. None if `worst_z` is None."""
    z_of_means: list[float] | None
    """The z of the mean of each channel. None if `worst_z` is None."""
    absolute: npt.NDArray[np.float64] = field(repr=False, compare=False)
    """The largest |a - b| in each compared pixel, height x width. Infinite where `torn` counts a pixel."""


Picture = Union[Path, ExrImage, Image]


def read_exr(path: Path) -> ExrImage:
    """Reads an OpenEXR file written by any program.

    Raises `FileNotFoundError` if there is no such file, `RenderError` if it is not a complete OpenEXR image, and
    `OSError` if reading fails.
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
    """Compares two images, or files of images, like the command `render diff`.

    - `a`, `b`: rendered images, images returned by `read_exr`, or paths of OpenEXR files.
    - `layer`: the name of a layer to compare, such as `"albedo"`, instead of the image itself.
    - `tolerance`: the largest `relative_mse` at which the images agree, 0 or more.

    Without `tolerance`, images with a `variance` layer agree if noise explains the difference of every pixel and of
    each channel's mean. Two renders of a scene with different seeds fail this test in about one of a hundred cases, at
    most. If one image is a crop of the other, only the pixels that both have are compared.

    Raises `OptionsError` if the images cannot be compared, for example because their sizes differ, and the errors of
    `read_exr` if a file cannot be read.
    """
    name = None if layer is None else _arguments.text("layer", layer)
    most = None if tolerance is None else _arguments.number("tolerance", tolerance)
    found = _abbe.diff(_file(a), _file(b), name, most)
    return Difference(**{**found, "absolute": np.asarray(found["absolute"])})
