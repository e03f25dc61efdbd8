"""Rendered images."""

from __future__ import annotations

import json
import warnings
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from . import _abbe, _arguments
from ._arguments import Path
from ._layers import Layers


class Spectrum(NamedTuple):
    """The spectrum of a pixel."""

    wavelengths_nm: npt.NDArray[np.float64]
    """The middle of each band in nm."""
    radiance: npt.NDArray[np.float32]
    """The mean over each band, per nm: an even spectrum of 1 is 1 in all of them, and has luminance 1 in the image."""


class Image(Layers):
    """A rendered image, and what the render reports about it.

    Its arrays are read-only: they are the renderer's own memory, not copies. `image.rgb.copy()` can be written to.
    """

    _core: _abbe.Image

    def __init__(self, core: _abbe.Image) -> None:
        self._core = core

    def __getitem__(self, name: str) -> npt.NDArray[np.float32]:
        """Returns a layer by its name, or one channel by its name in the file.

        `"beauty"` is the image, height x width x 3. `"A"`, the share of camera rays that hit something, 0 to 1, and
        `"Z"`, the nearest depth in scene units, 1e10 where nothing is hit, are height x width. Of the layers asked for,
        colors and vectors have 3 channels, `"UV"` has 2, `"samples"` 1 and mattes 4. `"albedo.R"` is one channel.

        Raises `KeyError` if the image has no such layer, and says what to do.
        """
        return np.asarray(self._core.plane(_arguments.text("the name of a layer", name)))

    @cached_property
    def stats(self) -> dict[str, Any]:
        """What the render reports, with the keys of the command's `--json`.

        Among them are `samples` (camera samples of all pixels together), `seconds`, `error` (the estimated error of the
        image if an error or a time was asked for, else None), `plan` (a dict) and `warnings` (a list).
        """
        return json.loads(self._core.account)

    @cached_property
    def _spectra(self) -> Spectrum | None:
        spectra = self._core.spectra()
        if spectra is None:
            return None
        # All spectra of the image share this array.
        wavelengths = np.array(spectra[0])
        wavelengths.setflags(write=False)
        return Spectrum(wavelengths, np.asarray(spectra[1]))

    @property
    def spectra(self) -> Spectrum | None:
        """The spectra of all pixels, radiance height x width x bands; None without `spectral=True`."""
        return self._spectra

    @property
    def stokes_spectra(self) -> npt.NDArray[np.float32] | None:
        """S1, S2 and S3 of all pixels in the bands of `spectra`, height x width x 3 x bands, per nm.

        S0 is the radiance of `spectra`. None unless both spectra and Stokes vectors were asked for: spectra by
        `spectral=True`, Stokes vectors by `film.stokes = true` in the scene or by layers such as `"S1"`. S1 is light
        polarized along the image's rows minus light polarized along its columns. S2 is light polarized along the
        diagonal that rises to the right minus light polarized across it. S3 is right-circular minus left-circular
        light, as seen looking toward the scene.
        """
        stokes = self._core.stokes_spectra()
        return None if stokes is None else np.asarray(stokes)

    def spectrum(self, x: int, y: int) -> Spectrum:
        """Returns the spectrum of the pixel in column `x`, row `y`, from 0 at the top left of the rendered part.

        Raises `ValueError` if spectra were not asked for, and `IndexError` if there is no such pixel.
        """
        if self._spectra is None:
            raise ValueError("the image has no spectra: ask for them with spectral=True")
        x, y = _arguments.whole("x", x), _arguments.whole("y", y)
        if not (0 <= x < self.width and 0 <= y < self.height):
            raise IndexError(f"there is no pixel ({x}, {y}) in {self.width} x {self.height}")
        return Spectrum(self._spectra.wavelengths_nm, self._spectra.radiance[y, x])

    def write_exr(self, path: Path) -> None:
        """Writes a linear OpenEXR file with all layers. The command writes the same bytes for the same scene file.

        Warns if the scene asks for 16 bits and values were too large for them and became 65504. Creates the file's
        folder if it is missing. Raises `OSError` if the file cannot be written; an older file of that name is then left
        untouched.
        """
        if too_large := self._core.write_exr(_arguments.path("path", path)):
            warnings.warn(f"{too_large} values were too large for 16 bits and became 65504", stacklevel=2)

    def write_spectral_exr(self, path: Path) -> None:
        """Writes the spectra of all pixels as an OpenEXR file.

        Raises `ValueError` if spectra were not asked for, and `OSError` if it cannot be written.
        """
        if self._spectra is None:
            raise ValueError("the image has no spectra: ask for them with spectral=True")
        self._core.write_spectral_exr(_arguments.path("path", path))
