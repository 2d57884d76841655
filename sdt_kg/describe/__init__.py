"""A first annotation for a robot of one's own: grippers guessed, everything to check marked."""

from sdt_kg.describe.write import describe

__all__ = ["describe"]
