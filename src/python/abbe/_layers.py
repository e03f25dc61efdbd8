"""What rendered images and image files have in common: layers, found by name."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _arguments
from ._arguments import Path

BEAUTY = "beauty"


class Layers:
    """The layers of an image by their names, as arrays: rows from the top, columns, and channels if there are several.

    Where numpy expects an array, the image stands for its `rgb`.
    """

    _core: Any

    def __getitem__(self, name: str) -> npt.NDArray[Any]:
        """Returns a layer such as `"albedo"` or `"Z"`, or one channel by its name in the file, such as `"albedo.R"`."""
        raise NotImplementedError

    @property
    def layers(self) -> tuple[str, ...]:
        """The names of all layers; `"beauty"` is the image itself: in files, red, green and blue without a name."""
        return tuple(self._core.layers)

    @property
    def width(self) -> int:
        """Pixels in each row of the arrays: of the format and its overscan, or of a part of it."""
        return self._core.size[0]

    @property
    def height(self) -> int:
        """Rows of the arrays."""
        return self._core.size[1]

    @property
    def corner(self) -> tuple[int, int]:
        """Column and row of the first pixel, counted from the top left of the format: negative in the overscan."""
        return self._core.corner

    def to_png(self, path: Path, exposure: float = 0.0) -> None:
        """Writes an 8-bit sRGB picture for viewing, brightened by 2^`exposure`, whatever color space the image has."""
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
        """Whether `image[name]` finds a layer, or a channel of this name in the file."""
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
        """Linear red, green and blue, float32, height x width x 3: the radiance in the film's color space.

        Raises `KeyError` if a file has no `"beauty"`, only named layers.
        """
        return self[BEAUTY]
