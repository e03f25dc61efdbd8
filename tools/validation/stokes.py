"""Polarized light by another method than the renderer's: the electric field in space, along one ray and forward.

    light = Light.unpolarized((0, 0, -1)).reflected((0, 0, 1), 0.43 - 2.455j)
    light.stokes(right=(1, 0, 0))     # S0 to S3

`field` is the 3 x 3 coherence matrix <E E*> of light that goes along `direction`; no frame is ever turned. Fields vary
as e^(i omega t), an absorbing index is n - i k, and S3 is above 0 of light that turns right, seen toward its source.
Born and Wolf, Principles of Optics, 1.5.2, 10.9 and 14.2.
"""

from typing import NamedTuple

import numpy as np


def unit(vector):
    vector = np.asarray(vector, float)
    return vector / np.linalg.norm(vector)


def across(direction, near):
    """The unit vector across a direction that is nearest to another, if that has a part across it."""
    near = near - direction * (direction @ near)
    if np.linalg.norm(near) < 1e-9:
        near = np.cross(direction, np.eye(3)[np.argmin(np.abs(direction))])
    return unit(near)


class Boundary(NamedTuple):
    """Amplitudes of s and p at a boundary of a relative index, met at an angle of a cosine."""

    reflected: tuple[complex, complex]
    crossing: tuple[complex, complex]
    beyond: complex

    @classmethod
    def of(cls, index, cos):
        beyond = np.sqrt(complex(1 - (1 - cos**2) / index**2))
        # Waves beyond fade out.
        beyond = -beyond if (index * beyond).imag > 0 else beyond
        s, p = cos + index * beyond, index * cos + beyond
        flux = np.sqrt(index * beyond / cos)
        reflected = ((cos - index * beyond) / s, (index * cos - beyond) / p)
        return cls(reflected, (2 * cos * flux / s, 2 * cos * flux / p), beyond)


class Light(NamedTuple):
    direction: np.ndarray
    field: np.ndarray

    @classmethod
    def unpolarized(cls, direction):
        """Light of intensity 1."""
        direction = unit(direction)
        return cls(direction, 0.5 * (np.eye(3) - np.outer(direction, direction)).astype(complex))

    def polarized(self, axis, degree):
        """The same intensity, of which a degree is linear along an axis."""
        axis = across(self.direction, np.asarray(axis, float))
        linear = np.outer(axis, axis) * np.trace(self.field).real
        return Light(self.direction, (1 - degree) * self.depolarized().field + degree * linear)

    def _after(self, direction, matrix):
        return Light(direction, matrix @ self.field @ matrix.conj().T)

    def _met(self, normal):
        """The normal against the light, its cosine, and s."""
        normal = unit(normal)
        normal = -normal if normal @ self.direction > 0 else normal
        return normal, -normal @ self.direction, across(self.direction, np.cross(self.direction, normal))

    def sent(self, onward, s, amplitudes):
        """Onward, by the amplitudes of s and p."""
        by_s, by_p = amplitudes
        p = [np.cross(direction, s) for direction in (self.direction, onward)]
        return self._after(onward, by_s * np.outer(s, s) + by_p * np.outer(p[1], p[0]))

    def reflected(self, normal, index):
        """By a boundary to so many times the index around the light."""
        normal, cos, s = self._met(normal)
        return self.sent(self.direction + 2 * cos * normal, s, Boundary.of(index, cos).reflected)

    def crossing(self, normal, index):
        """Through that boundary, as a flux."""
        normal, cos, s = self._met(normal)
        boundary = Boundary.of(index, cos)
        onward = self.direction / index.real + (cos / index.real - boundary.beyond.real) * normal
        return self.sent(onward, s, boundary.crossing)

    def through_polarizer(self, axis, normal, extinction=0.0):
        """A sheet absorbs light along what lies in it, across its axis."""
        open_to = unit(np.cross(np.cross(normal, axis), self.direction))
        closed_to = np.cross(self.direction, open_to)
        return self._after(
            self.direction, np.outer(open_to, open_to) + np.sqrt(extinction) * np.outer(closed_to, closed_to)
        )

    def through_retarder(self, axis, degrees):
        """Of a sheet at right angles to the light, whose axis is the fast one."""
        fast = across(self.direction, np.asarray(axis, float))
        slow = np.cross(self.direction, fast)
        ahead = np.exp(1j * np.radians(degrees))
        return self._after(self.direction, ahead * np.outer(fast, fast) + np.outer(slow, slow))

    def depolarized(self):
        """Taken for unpolarized: the mistake that rows guard against."""
        return Light(self.direction, Light.unpolarized(self.direction).field * np.trace(self.field).real)

    def stokes(self, right):
        """S0 to S3, S1 along `right`."""
        x = across(self.direction, np.asarray(right, float))
        y = np.cross(self.direction, x)
        (xx, xy), (yx, yy) = [[a @ self.field @ b for b in (x, y)] for a in (x, y)]
        return np.array([(xx + yy).real, (xx - yy).real, (xy + yx).real, 2 * yx.imag])
