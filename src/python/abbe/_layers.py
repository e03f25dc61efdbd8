"""The base class of rendered images and image files: access to layers by name."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _arguments
from ._arguments import Path

BEAUTY = "beauty"


class Layers:
    """Layers of an image, indexed by name, as arrays of shape height x width, or height x width x channels.

    Row 0 is at the top. Where numpy expects an array, the image is converted to its `rgb`.
    """

    _core: Any

    def __getitem__(self, name: str) -> npt.NDArray[Any]:
        """Returns a layer such as `"albedo"` or `"Z"`, or one channel by its name in the file, such as `"albedo.R"`."""
        raise NotImplementedError

    @property
    def layers(self) -> tuple[str, ...]:
        """The names of all layers.

        `"beauty"` is the image itself. A file stores it as the channels R, G and B, without a layer name.
        """
        return tuple(self._core.layers)

    @property
    def width(self) -> int:
        """The width of the arrays in pixels. With overscan or a crop, it is not that of the format."""
        return self._core.size[0]

    @property
    def height(self) -> int:
        """The height of the arrays in pixels. With overscan or a crop, it is not that of the format."""
        return self._core.size[1]

    @property
    def corner(self) -> tuple[int, int]:
        """Column and row of the first pixel, relative to the top left of the format. Negative in the overscan."""
        return self._core.corner

    def to_png(self, path: Path, exposure: float = 0.0) -> None:
        """Writes an 8-bit sRGB PNG for viewing, brightened by 2^`exposure`.

        Colors are converted from the color space of the image. Creates the folder of the file if it is missing.

        Raises `OptionsError` if `path` does not end in `.png` or `exposure` is not finite, and `OSError` if the file
        cannot be written.
        """
        self._core.write_png(_arguments.path("path", path), _arguments.number("exposure", exposure))

    def _repr_png_(self) -> bytes:
        return self._core.png(0.0)

    def __repr__(self) -> str:
        return f"<abbe.{type(self).__name__} of {self.width} x {self.height} pixels: {', '.join(self.layers)}>"

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> npt.NDArray[Any]:
        if copy is False and dtype is not None and dtype != np.float32:
            raise ValueError("other numbers than float32 are a copy")
        return np.array(self.rgb, dtype) if copy else np.asarray(self.rgb, dtype)

    def _ipython_key_completions_(self) -> list[str]:
        return list(self.layers)

    def __contains__(self, name: object) -> bool:
        """Returns whether `image[name]` is a layer or a channel."""
        if not isinstance(name, str):
            return False
        try:
            self._core.plane(name)
        except KeyError:
            return False
        return True

    def __iter__(self) -> Iterator[str]:
        return iter(self.layers)

    def __len__(self) -> int:
        return len(self.layers)

    @property
    def rgb(self) -> npt.NDArray[np.float32]:
        """The image in linear red, green and blue: float32, height x width x 3, in the color space of the film.

        Raises `KeyError` if the image is a file with named layers only, without `"beauty"`.
        """
        return self[BEAUTY]
