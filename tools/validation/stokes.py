"""Polarized light by another method than the renderer's: the electric field in space, along one ray from the light on.

    light = Light.unpolarized((0, 0, -1)).reflected((0, 0, 1), 0.43 - 2.455j)
    light.stokes(right=(1, 0, 0))     # S0 to S3

`field` is the 3 x 3 coherence matrix <E E*> of light that travels along `direction`; no frame is ever rotated. Fields
vary as e^(i omega t), an absorbing index is n - i k, and S3 is positive for light that turns right, seen toward its
source. Born and Wolf, Principles of Optics, 1.5.2, 10.9 and 14.2.
"""

from typing import NamedTuple

import numpy as np


def unit(vector):
    vector = np.asarray(vector, float)
    return vector / np.linalg.norm(vector)


def across(direction, near):
    """Returns the unit vector across `direction` that is nearest to `near`; any one if `near` is parallel to it."""
    near = near - direction * (direction @ near)
    if np.linalg.norm(near) < 1e-9:
        near = np.cross(direction, np.eye(3)[np.argmin(np.abs(direction))])
    return unit(near)


class Boundary(NamedTuple):
    """Amplitudes of s and p at a boundary with a relative index, for one cosine of incidence."""

    reflected: tuple[complex, complex]
    crossing: tuple[complex, complex]
    beyond: complex

    @classmethod
    def of(cls, index, cos):
        beyond = np.sqrt(complex(1 - (1 - cos**2) / index**2))
        # Waves beyond the boundary decay.
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
        """Returns unpolarized light of intensity 1."""
        direction = unit(direction)
        return cls(direction, 0.5 * (np.eye(3) - np.outer(direction, direction)).astype(complex))

    def polarized(self, axis, degree):
        """Returns light of equal intensity, of which a share `degree` is linearly polarized along an axis."""
        axis = across(self.direction, np.asarray(axis, float))
        linear = np.outer(axis, axis) * np.trace(self.field).real
        return Light(self.direction, (1 - degree) * self.depolarized().field + degree * linear)

    def _after(self, direction, matrix):
        return Light(direction, matrix @ self.field @ matrix.conj().T)

    def _met(self, normal):
        """Returns the normal on the light's side, the cosine of incidence, and s."""
        normal = unit(normal)
        normal = -normal if normal @ self.direction > 0 else normal
        return normal, -normal @ self.direction, across(self.direction, np.cross(self.direction, normal))

    def sent(self, onward, s, amplitudes):
        """Returns the light along a new direction, scaled by the amplitudes of s and p."""
        by_s, by_p = amplitudes
        p = [np.cross(direction, s) for direction in (self.direction, onward)]
        return self._after(onward, by_s * np.outer(s, s) + by_p * np.outer(p[1], p[0]))

    def reflected(self, normal, index):
        """Returns the light after reflection by a boundary to `index`, relative to the medium around the light."""
        normal, cos, s = self._met(normal)
        return self.sent(self.direction + 2 * cos * normal, s, Boundary.of(index, cos).reflected)

    def crossing(self, normal, index):
        """Returns the light after crossing a boundary to `index`, as a flux."""
        normal, cos, s = self._met(normal)
        boundary = Boundary.of(index, cos)
        onward = self.direction / index.real + (cos / index.real - boundary.beyond.real) * normal
        return self.sent(onward, s, boundary.crossing)

    def through_polarizer(self, axis, normal, extinction=0.0):
        """Returns the light behind a sheet that absorbs light along the direction in it across its axis."""
        open_to = unit(np.cross(np.cross(normal, axis), self.direction))
        closed_to = np.cross(self.direction, open_to)
        return self._after(
            self.direction, np.outer(open_to, open_to) + np.sqrt(extinction) * np.outer(closed_to, closed_to)
        )

    def through_retarder(self, axis, degrees):
        """Returns the light behind a sheet at right angles to it, whose axis is the fast one."""
        fast = across(self.direction, np.asarray(axis, float))
        slow = np.cross(self.direction, fast)
        ahead = np.exp(1j * np.radians(degrees))
        return self._after(self.direction, ahead * np.outer(fast, fast) + np.outer(slow, slow))

    def depolarized(self):
        """Returns the light as if it were unpolarized: the mistake that rows guard against."""
        return Light(self.direction, Light.unpolarized(self.direction).field * np.trace(self.field).real)

    def stokes(self, right):
        """Returns S0 to S3, with S1 along `right`."""
        x = across(self.direction, np.asarray(right, float))
        y = np.cross(self.direction, x)
        (xx, xy), (yx, yy) = [[a @ self.field @ b for b in (x, y)] for a in (x, y)]
        return np.array([(xx + yy).real, (xx - yy).real, (xy + yx).real, 2 * yx.imag])
