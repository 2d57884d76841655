"""What a track says of the joint that moves the observed point."""

import math
from dataclasses import dataclass

import numpy as np

from predicates.learn.fitting.curve import Curves
from predicates.learn.fitting.priors import Plumb
from predicates.learn.fitting.vectors import cross
from predicates.learn.track import Array, Track
from sdt_kg.mechanism import JointType

SURE = 0.95
"""[1] Below this probability a track does not tell its joint: the best one is only the likeliest."""

SCATTER, SHARE_OFF = 0.01, 0.25
"""[m], [1] Where more lies off the path, or farther, few samples tell the joint, whatever its probability."""


@dataclass(frozen=True, slots=True, eq=False)
class Articulation:
    """One joint that would explain a track. Vectors are in the track's frame.

    Attributes:
        joint_type: FIXED, PRISMATIC or REVOLUTE.
        axis: Unit vector, shape (3,): positive motion leads away from the first samples; zeros if fixed.
        origin: Revolute: centre of the point's circle; prismatic and fixed: where the point is at 0 [m].
        radius: Of the circle [m]; 0 unless revolute.
        positions: Shape (T,): joint position of each sample [rad or m], 0 at the first samples.
        limits: Smallest and largest position observed, outliers left out [rad or m].
        distances: Shape (T,): distance of each sample from the path [m].
        scale: Sigma of the deviations, robust [m].
        outliers: How many samples are farther than five scales from the path.
        deviations: Name → standard deviation: axis [rad], origin [m], radius [m], limits [rad or m].
        evidence: Log evidence, comparable among the candidates of one track.
        plumb: How the axis was taken to lie.
        swung: By what that turned the axis from where the track alone shows it, and the standard deviation
            of that [rad]; zeros where it was not.
        curve: The path; None if fixed.
        extent: Diagonal of the box that holds all samples but spikes [m]: the point moved by less. Of one
            that stands still no less than it may deviate: samples that are all the same may be rounded.
    """

    joint_type: JointType
    axis: Array
    origin: Array
    radius: float
    positions: Array
    limits: tuple[float, float]
    distances: Array
    scale: float
    outliers: int
    deviations: dict[str, float]
    evidence: float
    plumb: Plumb
    swung: tuple[float, float]
    curve: Curves | None
    extent: float

    @property
    def residual_rms(self) -> float:
        """Root mean square distance of all samples from the path [m], outliers included."""
        return float(np.sqrt(np.mean(self.distances**2)))

    def distance(self, points: Array) -> Array:
        """Distance of points (N, 3) from the path, shape (N,) [m]."""
        if self.curve is None:
            return np.linalg.norm(points - self.origin, axis=1)
        return np.linalg.norm(self.curve.residuals(points)[0], axis=1)

    def point(self, positions: Array) -> Array:
        """Where the observed point is at joint positions (N,), shape (N, 3) [m]."""
        if self.joint_type is not JointType.REVOLUTE:
            return self.origin + positions[:, None] * self.axis
        assert self.curve is not None
        begin = self._start() - self.origin
        across = cross(self.axis, begin)
        return self.origin + np.cos(positions)[:, None] * begin + np.sin(positions)[:, None] * across

    def _start(self) -> Array:
        """The point of the circle at position 0."""
        assert self.curve is not None
        zero = float(self.deviations["zero"])
        inward, tangent = self.curve.inward[0], self.curve.tangent[0]
        return self.origin + self.radius * (math.sin(zero) * tangent - math.cos(zero) * inward)


@dataclass(frozen=True, slots=True, eq=False)
class Learned:
    """Candidates for one track, best first.

    Attributes:
        track: What was observed.
        candidates: One of each joint type.
    """

    track: Track
    candidates: tuple[Articulation, ...]

    @property
    def best(self) -> Articulation:
        """The candidate with the most evidence."""
        return self.candidates[0]

    @property
    def probabilities(self) -> tuple[float, ...]:
        """Posterior probability of each candidate, all three being equally likely before."""
        evidence = np.array([each.evidence for each in self.candidates])
        weights = np.exp(evidence - evidence.max())
        return tuple(float(each) for each in weights / weights.sum())

    @property
    def poor(self) -> bool:
        """Whether too few samples lie on the path to show what moves."""
        return self.best.scale > SCATTER or self.best.outliers > SHARE_OFF * len(self.track.positions)

    @property
    def sure(self) -> bool:
        """Whether the track tells its joint."""
        return self.probabilities[0] >= SURE and not self.poor
