"""What rendered images and images in files have in common: layers by name."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

BEAUTY = "beauty"


class Layers:
    """The layers of an image by their names, as arrays: rows from the top, columns, and channels if it has several."""

    def __getitem__(self, name: str) -> npt.NDArray[Any]:
        """A layer such as `"albedo"` or `"Z"`, or one channel by its name in the file, such as `"albedo.R"`."""
        raise NotImplementedError

    @property
    def layers(self) -> tuple[str, ...]:
        """The names of all layers; `"beauty"` is the image itself."""
        raise NotImplementedError

    def __contains__(self, name: object) -> bool:
        return name in self.layers

    def __iter__(self) -> Iterator[str]:
        return iter(self.layers)

    def __len__(self) -> int:
        return len(self.layers)

    @property
    def rgb(self) -> npt.NDArray[np.float32]:
        """Linear red, green and blue, float32, height x width x 3: the radiance in the film's color space."""
        return self[BEAUTY]
