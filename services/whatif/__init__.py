"""What people type as a counterfactual edit, turned into another world: twin, robot or policy."""

from services.whatif.change import GRADUAL, KINDS, Change, changed, depends_on_robot, parse_change
from services.whatif.world import World

__all__ = ["GRADUAL", "KINDS", "Change", "World", "changed", "depends_on_robot", "parse_change"]
