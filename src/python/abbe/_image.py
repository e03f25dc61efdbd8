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
    """The spectrum of one pixel, or of all pixels."""

    wavelengths_nm: npt.NDArray[np.float64]
    """The center of each band in nm."""
    radiance: npt.NDArray[np.float32]
    """The mean radiance in each band, per nm. A constant spectrum of 1 is 1 in every band, and has luminance 1."""


class Image(Layers):
    """A rendered image, with the report of its render.

    Its arrays share the renderer's memory and are read-only. Use `image.rgb.copy()` to get an array to modify.
    """

    _core: _abbe.Image

    def __init__(self, core: _abbe.Image) -> None:
        self._core = core

    def __getitem__(self, name: str) -> npt.NDArray[np.float32]:
        """Returns a layer such as `"albedo"`, or one channel by its name in the file, such as `"albedo.R"`.

        Every image has these layers:

        - `"beauty"`: the image itself, height x width x 3.
        - `"A"`: the fraction of camera rays that hit something, 0 to 1, height x width.
        - `"Z"`: the smallest depth in scene units, or 1e10 where nothing is hit, height x width.

        Requested layers have 3 channels, but `"UV"` has 2, mattes have 4, and `"samples"` is height x width.

        Raises `KeyError` if there is no such layer or channel. The message lists the layers.
        """
        return np.asarray(self._core.plane(_arguments.text("the name of a layer", name)))

    @cached_property
    def stats(self) -> dict[str, Any]:
        """The report of the render, with the keys of the command's `--json`.

        - `samples`: the number of camera samples, of all pixels together.
        - `seconds`: how long the render took.
        - `error`: a dict about the estimated error of the image, or None if neither an error nor a time was requested.
        - `plan`: the plan as a dict.
        - `warnings`: a list of strings.

        There are more, such as `rays` and `photons`.
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
        """The spectra of all pixels; `radiance` is height x width x bands. None if spectra were not requested."""
        return self._spectra

    @property
    def stokes_spectra(self) -> npt.NDArray[np.float32] | None:
        """The Stokes components S1, S2 and S3 of all pixels, per nm: height x width x 3 x bands.

        The bands are those of `spectra`, whose radiance is S0. None unless both spectra and Stokes vectors were
        requested: spectra by `spectral=True`, Stokes vectors by `film.stokes = true` in the scene or by a layer such as
        `"S1"`.

        - S1: light polarized along the rows of the image, minus light polarized along its columns.
        - S2: light polarized along the diagonal that rises to the right, minus light polarized along the other one.
        - S3: right-circular minus left-circular light, as seen looking toward the scene.
        """
        stokes = self._core.stokes_spectra()
        return None if stokes is None else np.asarray(stokes)

    def spectrum(self, x: int, y: int) -> Spectrum:
        """Returns the spectrum of the pixel in column `x` and row `y`. (0, 0) is the top left of the rendered part.

        Raises `ValueError` if spectra were not requested, and `IndexError` if there is no such pixel.
        """
        if self._spectra is None:
            raise ValueError("the image has no spectra: ask for them with spectral=True")
        x, y = _arguments.whole("x", x), _arguments.whole("y", y)
        if not (0 <= x < self.width and 0 <= y < self.height):
            raise IndexError(f"there is no pixel ({x}, {y}) in {self.width} x {self.height}")
        return Spectrum(self._spectra.wavelengths_nm, self._spectra.radiance[y, x])

    def write_exr(self, path: Path) -> None:
        """Writes a linear OpenEXR file with all layers.

        The command writes the same bytes for the same scene file. Creates the folder of the file if it is missing.
        Issues a `UserWarning` if the scene requests 16 bits and some values were too large for that. They are written
        as 65504.

        Raises `OptionsError` if `path` does not end in `.exr`, and `OSError` if the file cannot be written. An existing
        file is then left unchanged.
        """
        if too_large := self._core.write_exr(_arguments.path("path", path)):
            warnings.warn(f"{too_large} values were too large for 16 bits and became 65504", stacklevel=2)

    def write_spectral_exr(self, path: Path) -> None:
        """Writes the spectra of all pixels as an OpenEXR file. Creates the folder of the file if it is missing.

        Raises `ValueError` if spectra were not requested, `OptionsError` if `path` does not end in `.exr`, and
        `OSError` if the file cannot be written.
        """
        if self._spectra is None:
            raise ValueError("the image has no spectra: ask for them with spectral=True")
        self._core.write_spectral_exr(_arguments.path("path", path))
