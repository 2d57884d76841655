"""What people type as a counterfactual edit, turned into another world: twin, robot or policy."""

from services.whatif.answers import answered
from services.whatif.change import GRADUAL, KINDS, Change, changed, depends_on_robot, parse_change
from services.whatif.named import HERE, named_change
from services.whatif.world import World

__all__ = [
    "GRADUAL",
    "HERE",
    "KINDS",
    "Change",
    "World",
    "answered",
    "changed",
    "depends_on_robot",
    "named_change",
    "parse_change",
]
