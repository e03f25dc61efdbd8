"""Optical data of glasses, metals, illuminants and reflectances, by the names that scenes use.

Wavelengths `nm` are in nanometers: a number, or an array of any shape. Results have the same shape. If the array
is masked, they have the same mask.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _abbe, _arguments

__all__ = [
    "Glass",
    "Illuminant",
    "Metal",
    "Reflectance",
    "glass",
    "glasses",
    "illuminant",
    "illuminants",
    "metal",
    "metals",
    "reflectance",
    "reflectances",
]


def __dir__() -> list[str]:
    return __all__


def _at(nm: npt.ArrayLike, values: Callable[[bytes], _abbe.Plane]) -> Any:
    wavelengths = np.asarray(nm, dtype=np.float64)
    found = np.asarray(values(wavelengths.tobytes())).reshape(wavelengths.shape)
    if np.ma.isMaskedArray(nm):
        found = np.ma.masked_array(found, mask=np.ma.getmaskarray(nm))
    return found if wavelengths.ndim else found[()]


class _Entry:
    _core: Any

    @property
    def name(self) -> str:
        """The full name, such as `"schott/N-BK7"`."""
        return self._core.entry.name

    @property
    def source(self) -> str:
        """Who published the data."""
        return self._core.entry.source

    @property
    def range_nm(self) -> tuple[float, float]:
        """The first and the last wavelength of the data, in nm."""
        return self._core.entry.range_nm

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Entry) and (type(self), self.name) == (type(other), other.name)

    def __hash__(self) -> int:
        return hash((type(self), self.name))

    def __reduce__(self) -> tuple[type[_Entry], tuple[str]]:
        return type(self), (self.name,)

    def __repr__(self) -> str:
        return f"<abbe.catalog.{type(self).__name__} {self.name}>"


class Glass(_Entry):
    """A clear material: a glass, crystal, liquid, plastic or gas."""

    _core: _abbe.Glass

    def __init__(self, name: str) -> None:
        self._core = _abbe.Glass(_arguments.text("the name of a glass", name))

    @property
    def n_d(self) -> float:
        """The refractive index at 587.56 nm."""
        return self._core.n_d

    @property
    def v_d(self) -> float:
        """The Abbe number (n_d - 1) / (n_F - n_C). NaN if the index is not known at these lines."""
        return self._core.v_d

    def index(self, nm: npt.ArrayLike) -> Any:
        """Returns the refractive index. Beyond `range_nm`, it is constant."""
        return _at(nm, self._core.index)

    def extinction(self, nm: npt.ArrayLike) -> Any:
        """Returns the extinction coefficient k: linear between samples, constant beyond the ends. NaN if not known."""
        return _at(nm, self._core.extinction)


class Metal(_Entry):
    """A metal."""

    _core: _abbe.Metal

    def __init__(self, name: str) -> None:
        self._core = _abbe.Metal(_arguments.text("the name of a metal", name))

    def index(self, nm: npt.ArrayLike) -> Any:
        """Returns the complex index n + ik: linear between the measured wavelengths, constant beyond `range_nm`."""
        return _at(nm, self._core.n) + 1j * _at(nm, self._core.k)


class Illuminant(_Entry):
    """The spectrum of a light source."""

    _core: _abbe.Tabulated

    def __init__(self, name: str) -> None:
        self._core = _abbe.Tabulated("illuminant", _arguments.text("the name of an illuminant", name))

    def power(self, nm: npt.ArrayLike) -> Any:
        """Returns the relative power per nm, on an arbitrary scale: linear between tabulated wavelengths, 0 beyond."""
        return _at(nm, self._core.at)


class Reflectance(_Entry):
    """The reflectance of a colored surface."""

    _core: _abbe.Tabulated

    def __init__(self, name: str) -> None:
        self._core = _abbe.Tabulated("reflectance", _arguments.text("the name of a reflectance", name))

    def reflectance(self, nm: npt.ArrayLike) -> Any:
        """Returns the reflectance, 0 to 1: linear between the tabulated wavelengths, constant beyond."""
        return _at(nm, self._core.at)


def glass(name: str) -> Glass:
    """Returns the glass with a name such as `"N-BK7"` or `"schott/N-BK7"`, ignoring case.

    Raises `KeyError` if there is none. The message suggests a similar name, if there is one.
    """
    return Glass(name)


def metal(name: str) -> Metal:
    """Returns the metal with a name such as `"Au"` or `"gold"`, ignoring case.

    Raises `KeyError` if there is none. The message suggests a similar name, if there is one.
    """
    return Metal(name)


def illuminant(name: str) -> Illuminant:
    """Returns the illuminant with a name such as `"D65"`, ignoring case.

    Raises `KeyError` if there is none. The message suggests a similar name, if there is one.
    """
    return Illuminant(name)


def reflectance(name: str) -> Reflectance:
    """Returns the reflectance with a name such as `"dark skin"`, ignoring case.

    Raises `KeyError` if there is none. The message suggests a similar name, if there is one.
    """
    return Reflectance(name)


def glasses() -> list[str]:
    """Returns the full names of all glasses."""
    return _abbe.names("glass")


def metals() -> list[str]:
    """Returns the names of all metals."""
    return _abbe.names("metal")


def illuminants() -> list[str]:
    """Returns the names of all illuminants."""
    return _abbe.names("illuminant")


def reflectances() -> list[str]:
    """Returns the full names of all reflectances."""
    return _abbe.names("reflectance")
