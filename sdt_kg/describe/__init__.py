"""A first annotation for a robot of one's own: what its structure tells, everything to check marked."""

from sdt_kg.describe.guess import guessed
from sdt_kg.describe.write import turtle

__all__ = ["guessed", "turtle"]
