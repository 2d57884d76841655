"""Certification: a finished motion is re-checked from its samples and the twin alone.

Nothing here knows how motions are planned, and phases that a planner names are not believed: the
grasp is the moment in which the container begins to move.
"""

from services.embodiment.certify.check import Certified, Refused, certify
from services.embodiment.certify.tolerances import Tolerances

__all__ = ["Certified", "Refused", "Tolerances", "certify"]
