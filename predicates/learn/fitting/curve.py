r"""Lines and arcs as one family of curves with six parameters, of which a line uses four.

About a frame (o, t, u, v): anchor :math:`a = o + \theta_0 u + \theta_1 v`, tangent
:math:`T \propto t + \theta_2 u + \theta_3 v`, curvature vector
:math:`k = \theta_4 U + \theta_5 V`, where U, V complete T to a frame. A line is the arc with
k = 0, so that nothing degenerates when a drawer is fitted as an arc.
"""

from dataclasses import dataclass

import numpy as np

from predicates.learn.fitting.vectors import cross, unit
from predicates.learn.track import Array

STRAIGHT = 1e-9
"""[1/m] Below this curvature an arc's plane is any plane."""


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """Where the parameters of curves begin: all 0 is the line through o along t.

    Attributes:
        o: Shape (3,) [m].
        axes: Rows t, u, v, orthonormal, shape (3, 3).
    """

    o: Array
    axes: Array

    @staticmethod
    def about(o: Array, tangent: Array, towards: Array | None = None) -> "Frame":
        """A frame whose u points towards a vector, or anywhere."""
        t = tangent / np.linalg.norm(tangent)
        u = np.eye(3)[int(np.argmin(np.abs(t)))] if towards is None else towards
        u = u - t * (u @ t)
        u = u / np.linalg.norm(u)
        return Frame(o, np.stack([t, u, np.cross(t, u)]))


@dataclass(frozen=True, slots=True, eq=False)
class Curves:
    """K curves of the family, their vectors of shape (K, 3).

    Attributes:
        anchor: A point of each curve [m].
        tangent: Unit tangent there.
        inward: Unit vector towards the centre.
        curvature: Shape (K,) [1/m].
    """

    anchor: Array
    tangent: Array
    inward: Array
    curvature: Array

    @property
    def normal(self) -> Array:
        """Axis of each arc, shape (K, 3): positive turning leads along the tangent."""
        return cross(self.tangent, self.inward)

    def residuals(self, points: Array) -> Array:
        """How far points (N, 3) lie from the curve: in its plane, out of it; shape (K, N, 2) [m]."""
        x, y, z = self._coordinates(points)
        k = self.curvature[:, None]
        across = (k * (x * x + y * y) - 2 * y) / (np.hypot(k * x, k * y - 1) + 1)
        both = np.empty((*z.shape, 2))
        both[..., 0], both[..., 1] = across, z
        return both

    def progress(self, points: Array) -> Array:
        """Arc length from the anchor to the nearest point of the curve, shape (K, N) [m]."""
        x, y, _ = self._coordinates(points)
        k = self.curvature[:, None]
        bent = np.abs(k) > STRAIGHT
        safe = np.where(bent, k, 1.0)
        return np.where(bent, np.arctan2(safe * x, 1 - safe * y) / safe, x)

    def _coordinates(self, points: Array) -> tuple[Array, Array, Array]:
        offset = points[None] - self.anchor[:, None]
        axes = np.empty((len(self.tangent), 3, 3))
        axes[:, :, 0], axes[:, :, 1], axes[:, :, 2] = self.tangent, self.inward, self.normal
        local = offset @ axes
        return local[..., 0], local[..., 1], local[..., 2]


def curves(frame: Frame, parameters: Array) -> Curves:
    """Curves of parameters, shape (K, 6), about a frame."""
    t, u = frame.axes[:2]
    anchor = frame.o + parameters[:, 0:2] @ frame.axes[1:]
    tangent = unit(t + parameters[:, 2:4] @ frame.axes[1:])
    side = unit(u - tangent * (tangent @ u)[:, None])
    other = cross(tangent, side)
    curvature = np.hypot(parameters[:, 4], parameters[:, 5])
    bent = curvature > STRAIGHT
    whole = np.where(bent, curvature, 1.0)
    cosine = np.where(bent, parameters[:, 4] / whole, 1.0)
    sine = np.where(bent, parameters[:, 5] / whole, 0.0)
    inward = cosine[:, None] * side + sine[:, None] * other
    return Curves(anchor, tangent, inward, curvature)
