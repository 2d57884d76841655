"""What questions about one kitchen, robot and state share, kept between them."""

from sdt_kg.iri import Iri
from sdt_kg.twin import Twin
from services.embodiment.body.demands import Margins
from services.embodiment.body.world import World
from services.embodiment.floor import check_floor
from services.embodiment.hold.kit import Kits
from services.embodiment.ways.roads import Known
from services.physics.model import Scene

Models = tuple[World, Kits, Known]
"""Bodies, each gripper's limb and grasps, and the ways that were found."""

KEPT = 4
"""[1] Of each: kitchen, robot and state."""


class Worlds:
    """Those that were asked about last."""

    def __init__(self, margins: Margins) -> None:
        self._margins = margins
        self._kept: list[tuple[object, tuple[object, ...], Models]] = []

    def of(self, twin: Twin, robot: Iri) -> Models:
        """Those of the twin's kitchen as it is, and of one robot.

        Raises:
            InputError: There is no floor.
        """
        own = (twin.mechanism(twin.environment), twin.mechanism(robot), twin.robot(robot))
        key = (twin.state, twin.kitchen())
        for known, models, kept in self._kept:
            if known == key and all(one is other for one, other in zip(models, own, strict=True)):
                return kept
        world = World(Scene(twin, robot))
        check_floor(world.scene)
        made = world, Kits(world, self._margins), Known()
        self._kept = [(key, own, made), *self._kept[: KEPT - 1]]
        return made
