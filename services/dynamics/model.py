r"""What pushes back at a container's handle: parameters as intervals, and the rigid body that moves.

With q the container's own joint, 0 closed, r the distance of the handle from the axis (1 for a slide):

.. math::
    r F = M \ddot q + m w \gamma(q) + k (q - q_0) + L(q) + S(q) + (b + d(q, \dot q)) \dot q + \lambda

Joints that move together (two leaves of a door, one of which follows the other) have q_i = ρ q + o each, and
by virtual work the handle gives the sum of ρ times what each of them needs. Where one carries another (panels
of a folding door), inertia and weight of what is carried depend on q: see `Fold`.

M = m u κ with κ and γ from the twin's shapes (Pinocchio), u and w factors that say how far mass may be
from uniform; L a latch that pulls shut and lets go over its width; S and d a soft closer, which pulls
within its range and damps closing there; λ friction: within ± break-away at rest, ± Coulomb while sliding.
"""

import math
from dataclasses import astuple, dataclass, fields
from itertools import product

import numpy as np
from numpy.typing import NDArray

from sdt_kg.iri import Iri

Array = NDArray[np.float64]

LOAD_ERROR = 1e-9
"""[1] Share by which inertia and weight from the twin's shapes are widened: more than Pinocchio errs."""


@dataclass(frozen=True, slots=True)
class Values:
    """One value of each parameter, in SI units of the joint: N and m for a slide, N m and rad for a hinge.

    Attributes:
        mass: Of all that moves, contents included [kg].
        inertia: u, share of the inertia that uniform mass would have.
        weight: w, share of the moment of weight that uniform mass would have.
        coulomb: Friction while sliding.
        break_away: Friction that rest can bear; not below `coulomb`.
        viscous: b, per speed.
        stiffness: k of the spring.
        latch: Force with which the latch holds at the lower stop.
        closer: Pull of the soft closer towards the lower stop.
        closer_damping: d, per speed, while closing.
    """

    mass: float
    inertia: float
    weight: float
    coulomb: float
    break_away: float
    viscous: float
    stiffness: float
    latch: float
    closer: float
    closer_damping: float

    def array(self) -> Array:
        """In the order of the attributes."""
        return np.array(astuple(self))


NAMES = tuple(each.name for each in fields(Values))


@dataclass(frozen=True, slots=True)
class ForceModel:
    """I_Φ of one mechanism: every value between two.

    Attributes:
        lower, upper: Least and largest value of each parameter.
        rest: Position at which the spring is at rest [rad or m].
        latch_width: Way over which the latch lets go [rad or m].
        closer_range: Way from the lower stop within which the soft closer works [rad or m].
        allowed: Force at the handle that is allowed [N].
        iri: Individual that says so.
    """

    lower: Values
    upper: Values
    rest: float
    latch_width: float
    closer_range: float
    allowed: float
    iri: Iri = ""

    def corners(self) -> list[Values]:
        """Every combination of ends, for refuting: never a proof of anything about what lies between."""
        ends = [
            (low, high) if low < high else (low,)
            for low, high in zip(astuple(self.lower), astuple(self.upper), strict=True)
        ]
        found = (Values(*each) for each in product(*ends))
        return [each for each in found if each.coulomb <= each.break_away]

    def middle(self) -> Values:
        """The middle of every interval."""
        return Values(*((self.lower.array() + self.upper.array()) / 2).tolist())

    def __contains__(self, values: Values) -> bool:
        low, high = self.lower.array(), self.upper.array()
        inside = bool(((low <= values.array()) & (values.array() <= high)).all())
        return inside and values.coulomb <= values.break_away


@dataclass(frozen=True, slots=True)
class Load:
    """The rigid body that a container's joint moves, for one kilogram of it.

    Attributes:
        prismatic: Whether the joint slides.
        inertia: κ [m² for a hinge, 1 for a slide].
        cosine, sine, constant: γ(q) = cosine · cos q + sine · sin q + constant: the joint force that
            holds one kilogram against gravity [N m/kg or N/kg].
        lever: Least and largest distance of the handle's surface from the axis [m]; 1 for a slide.
    """

    prismatic: bool
    inertia: float
    cosine: float
    sine: float
    constant: float
    lever: tuple[float, float]

    def weight(self, q: Array) -> Array:
        """γ(q), shape of q."""
        return self.cosine * np.cos(q) + self.sine * np.sin(q) + self.constant


@dataclass(frozen=True, slots=True, eq=False)
class Wave:
    """A sum of size · cos(rate · q + phase); the three have the shape (K,)."""

    size: Array
    rate: Array
    phase: Array

    def at(self, q: Array) -> Array:
        """Values, shape of q."""
        angles = np.multiply.outer(np.asarray(q), self.rate) + self.phase
        return (self.size * np.cos(angles)).sum(axis=-1)

    def slope(self) -> "Wave":
        """The derivative by q."""
        return Wave(self.size * self.rate, self.rate, self.phase + math.pi / 2)


@dataclass(frozen=True, slots=True, eq=False)
class Fold:
    r"""The panel of a folding door that hangs on panels which move with it, for one kilogram of it.

    All hinges are parallel. With o(q) the panel's own hinge, c its centre and Ω how fast it turns for each
    rad of the container's joint q, all in the plane across the hinges, the inertia that q feels is

    .. math:: |o'|^2 + w \, 2 o' \cdot (\Omega \times c) + u \, \Omega^2 \kappa

    and of the weight likewise: w scales the moment of mass about the panel's own hinge, as everywhere else.

    Attributes:
        carried, mixed, turned: The three terms of the inertia; the last is the same all along.
        weight_carried, weight_own: What holds it: of the way of its hinge, and about it (for w = 1).
    """

    carried: Wave
    mixed: Wave
    turned: float
    weight_carried: Wave
    weight_own: Wave


@dataclass(frozen=True, slots=True, eq=False)
class Reach:
    """Where a folding door's handle goes, in the kitchen's root frame.

    Attributes:
        axis: Unit vector of all hinges, shape (3,).
        origin: A point of the first hinge, shape (3,) [m].
        arms: From each hinge to the next when every joint is at 0, across the axis, shape (N - 1, 3) [m].
        rates, phases: Panel k is turned about the axis by rates[k] · q + phases[k]; shape (N,).
        lever: Square of the way of the handle's middle for each rad or m of q [m²].
        spread: How far the way of other points of the handle may differ from that [m].
    """

    axis: Array
    origin: Array
    arms: Array
    rates: Array
    phases: Array
    lever: Wave
    spread: float


@dataclass(frozen=True, slots=True)
class Mechanics:
    """All that forces at a container's handle depend on.

    Attributes:
        joint: IRI of the container's own joint.
        lower, upper: Its stops [rad or m]; of all that move together the first that is reached.
        others: Joints that move with it.
        fold: Where another that moves with it carries it.
        reach: Of the container's own joint, where another carries it.
    """

    joint: Iri
    forces: ForceModel
    load: Load
    lower: float
    upper: float
    others: "tuple[Other, ...]" = ()
    fold: Fold | None = None
    reach: Reach | None = None

    @property
    def moving(self) -> "tuple[Other, ...]":
        """All joints that move together, this one first."""
        return (Other(1.0, 0.0, self), *self.others)

    @property
    def unit(self) -> str:
        """Unit of a force of the joint."""
        return "N" if self.load.prismatic else "N m"


@dataclass(frozen=True, slots=True)
class Other:
    """A joint that moves with the container's own, q: at ratio · q + offset, counted from closed to open.

    Attributes:
        ratio: Above 0.
        mechanics: Its stops are where it is at the container's.
    """

    ratio: float
    offset: float
    mechanics: Mechanics
