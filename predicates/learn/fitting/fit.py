r"""The likeliest curve through a track, and how much evidence there is for it.

Deviations from the path are two-dimensional Student-t, :math:`p(r) \propto
(1 + |r|^2 / \nu\sigma^2)^{-(\nu + 2)/2}`, so that a slip or a lost grasp counts little; where along
the curve a sample lies is equally likely over the travel L. Fitted by iteratively reweighted
Gauss-Newton steps; the evidence is Laplace's approximation at the maximum.
"""

import math
from dataclasses import dataclass

import numpy as np

from predicates.learn.fitting.cells import Cells
from predicates.learn.fitting.curve import STRAIGHT, Curves, Frame, curves
from predicates.learn.fitting.priors import (
    RADIUS,
    RADIUS_SPREAD,
    SCALE,
    SCALE_WEIGHT,
    Gravity,
    Plumb,
    log_radius_density,
    log_scale_density,
    log_seen_radius_density,
)
from predicates.learn.fitting.student import FREEDOM, log_student
from predicates.learn.fitting.turning import Seen
from predicates.learn.fitting.vectors import cross
from predicates.learn.track import Array

STEPS = 40
"""[1] Gauss-Newton steps at most; ten are usual."""

HALVINGS = 8
"""[1] Halvings of a step that does not descend."""

PROBE = 1e-6
"""[m, rad or 1/m] Step of the difference quotients."""

CONVERGED = 1e-3
"""[1] A step that promises less log posterior than this ends the fit."""

ROOM = 1.0
"""[m] Where a path may pass: the unit of length in which places are equally likely."""

LINE, ARC = 4, 6
"""[1] Parameters of a line and of an arc."""


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """The likeliest line or arc of one class of axes.

    Attributes:
        frame: Where the parameters begin.
        parameters: Shape (6,).
        free: How many of the parameters were free: LINE or ARC.
        scale: Sigma of the deviations [m].
        covariance: Shape (free, free), of the parameters.
        evidence: Log evidence, without what all candidates share.
    """

    frame: Frame
    parameters: Array
    free: int
    scale: float
    covariance: Array
    evidence: float

    @property
    def curve(self) -> Curves:
        """The curve, K = 1."""
        return curves(self.frame, self.parameters[None])


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """A line or an arc through cells, its axis of one class.

    Attributes:
        cells: What was observed.
        gravity: What is known of up.
        plumb: How the axis lies.
        free: LINE or ARC.
        seen: Axis that orientations show, if there are any.
    """

    cells: Cells
    gravity: Gravity
    plumb: Plumb
    free: int
    seen: Seen | None = None

    def prior_residuals(self, family: Curves) -> Array:
        """Deviations from what was expected, in standard deviations, shape (K, P)."""
        if self.free == LINE:
            return self.gravity.residuals(family.tangent, self.plumb)
        parts = [self.gravity.residuals(family.normal, self.plumb)]
        curvature = np.maximum(family.curvature, 1e-12)[:, None]
        if self.seen is None:
            parts.append(-np.log(curvature * RADIUS) / RADIUS_SPREAD)
        else:
            radius = float(np.linalg.norm(self.seen.arm))
            parts.append((1 / curvature - radius) / self.seen.arm_spread)
            parts.append(cross(family.normal, self.seen.axis) / self.seen.spread)
        return np.concatenate(parts, axis=1)

    def cost(self, frame: Frame, parameters: Array, scale: float) -> Array:
        """Negative log posterior up to a constant, shape (K,), for parameters (K, 6)."""
        family = curves(frame, parameters)
        return self.weighed(family.residuals(self.cells.points), self.prior_residuals(family), scale)

    def weighed(self, residuals: Array, priors: Array, scale: float) -> Array:
        """The same for residuals, shape (K, N, 2), and deviations from what was expected, shape (K, P)."""
        squares = np.einsum("knc,knc->kn", residuals, residuals)
        fidelity = (FREEDOM + 2) / 2 * np.log1p(squares / (FREEDOM * scale**2)) @ self.cells.weights
        return fidelity + np.einsum("kp,kp->k", priors, priors) / 2


def fit(problem: Problem, frame: Frame, start: Array) -> Fit:
    """The maximum near a start, shape (6,), and the evidence for it."""
    parameters, scale = start.copy(), 2 * SCALE
    steps = np.concatenate([np.zeros((1, 6)), PROBE * np.eye(6)[: problem.free]])
    information = np.eye(problem.free)
    for _ in range(STEPS):
        family = curves(frame, parameters + steps)
        residuals, priors = family.residuals(problem.cells.points), problem.prior_residuals(family)
        squares = (residuals[0] ** 2).sum(axis=1)
        pull = problem.cells.weights * (FREEDOM + 2) / (FREEDOM + squares / scale**2)
        scale = _scale(pull, squares, problem.cells.observations)
        slope = (residuals[1:] - residuals[0]) / PROBE
        lean = (priors[1:] - priors[0]) / PROBE
        weighted = slope * (pull / scale**2)[None, :, None]
        information = np.einsum("anc,bnc->ab", weighted, slope) + lean @ lean.T
        gradient = np.einsum("anc,nc->a", weighted, residuals[0]) + lean @ priors[0]
        step = np.zeros(6)
        step[: problem.free] = -np.linalg.solve(_regular(information), gradient)
        now = float(problem.weighed(residuals[:1], priors[:1], scale)[0])
        parameters = _descend(problem, frame, parameters, step, (scale, now))
        if -gradient @ step[: problem.free] < CONVERGED:
            break
    known = information + np.diag(1 / _room(parameters)[: problem.free] ** 2)
    covariance: Array = np.asarray(np.linalg.inv(known), dtype=np.float64)
    found = Fit(frame, parameters, problem.free, scale, covariance, 0.0)
    return Fit(frame, parameters, problem.free, scale, covariance, _evidence(problem, found))


def _room(parameters: Array) -> Array:
    """How far each parameter may be from anything, whatever was seen, shape (6,).

    A track that hardly moves leaves a direction open: by a radian, not by Laplace's millions.
    """
    curvature = max(float(np.hypot(parameters[4], parameters[5])), STRAIGHT)
    return np.array([ROOM, ROOM, 1.0, 1.0, curvature, curvature])


def _scale(pull: Array, squares: Array, observations: float) -> float:
    """Sigma that explains the deviations and stays near what is expected."""
    seen = float((pull * squares).sum()) / 2
    return math.sqrt((seen + SCALE_WEIGHT * SCALE**2) / (observations + SCALE_WEIGHT))


def _regular(information: Array) -> Array:
    return information + 1e-9 * np.diag(np.diag(information)) + 1e-12 * np.eye(len(information))


def _descend(
    problem: Problem, frame: Frame, parameters: Array, step: Array, begun: tuple[float, float]
) -> Array:
    """Where the whole step leads, or the longest of its halvings that descends; nowhere if none does.

    `begun` is the scale, and what the parameters cost with it.
    """
    scale, now = begun
    whole = parameters + step
    if float(problem.cost(frame, whole[None], scale)[0]) <= now:
        return whole
    tried = parameters + 0.5 ** np.arange(1, HALVINGS)[:, None] * step
    better = np.flatnonzero(problem.cost(frame, tried, scale) <= now)
    return tried[int(better[0])] if better.size else parameters


def _evidence(problem: Problem, found: Fit) -> float:
    """Laplace's approximation: likelihood and priors at the maximum times the volume of the maximum."""
    curve = found.curve
    squares = (curve.residuals(problem.cells.points)[0] ** 2).sum(axis=1)
    evidence = log_student(squares, found.scale, 2) @ problem.cells.weights
    evidence -= problem.cells.observations * math.log(problem.cells.extent)
    evidence += log_scale_density(found.scale, SCALE)
    evidence += found.free / 2 * math.log(2 * math.pi) + float(np.linalg.slogdet(found.covariance)[1]) / 2
    axis = curve.tangent[0] if found.free == LINE else curve.normal[0]
    evidence += problem.gravity.log_density(axis, problem.plumb)
    if found.free == ARC:
        k = float(curve.curvature[0])
        # density over the plane of curvature vectors: d²k = k dk dψ, and dk = k d(log k)
        density = log_radius_density if problem.seen is None else log_seen_radius_density
        evidence += density(1 / k) - 2 * math.log(k) - math.log(2 * math.pi)
    return float(evidence)
