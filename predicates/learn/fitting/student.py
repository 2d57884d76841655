"""Student-t deviations: a slip or a lost grasp counts little."""

import math

import numpy as np

from predicates.learn.track import Array

FREEDOM = 4.0
"""[1] nu: a deviation of five scales is 3,000 times likelier than a Gaussian's."""


def log_student(squares: Array, scale: float, dimension: int) -> Array:
    """Log density of isotropic Student-t deviations, of their squared lengths."""
    constant = math.lgamma((FREEDOM + dimension) / 2) - math.lgamma(FREEDOM / 2)
    constant -= dimension / 2 * math.log(FREEDOM * math.pi * scale**2)
    return constant - (FREEDOM + dimension) / 2 * np.log1p(squares / (FREEDOM * scale**2))
