"""What is the same for all containers of a scene: a limb, its hand, and the distances demanded of both."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from sdt_kg.annotation import Gripper
from sdt_kg.iri import Iri, joint_iri
from services.embodiment.body.demands import Margins, eased, rules
from services.embodiment.body.limb import Limb, make_limb, rate_limits
from services.embodiment.body.parked import Parked
from services.embodiment.body.world import Rules, World
from services.embodiment.hold.grasp import Hand
from services.physics.model import Scene


@dataclass(frozen=True, slots=True, eq=False)
class Kit:
    """One gripper's limb, ready to search.

    Attributes:
        demands: Distances demanded while it holds, but for fingers and handle.
        opened: Distances demanded of the open hand; parked, the robot keeps them.
    """

    limb: Limb
    hand: Hand
    demands: Rules
    opened: Rules


@dataclass(slots=True, eq=False)
class Kits:
    """The kits of one scene, made when they are first asked for.

    Attributes:
        beside: Joints that every limb has besides its own, and where they are aside [rad or m].
    """

    world: World
    margins: Margins
    beside: Mapping[Iri, float] = field(default_factory=dict[Iri, float])
    _made: dict[str, Kit] = field(init=False, default_factory=dict[str, Kit])
    _outside: Rules | None = field(init=False, default=None)
    _parked: Parked | None = field(init=False, default=None)

    def of(self, gripper: Gripper) -> Kit:
        """The kit of a gripper."""
        if gripper.name not in self._made:
            limb = make_limb(self.world, gripper, self.beside)
            demands = rules(self.world, limb, self.margins)
            least = self.margins.close + self.world.scene.annotation.overhang
            opened = eased(self.world, demands, limb.q(limb.parked), least)
            self._made[gripper.name] = Kit(limb, Hand(self.world, limb), demands, opened)
        return self._made[gripper.name]

    def outside(self) -> Rules:
        """Distances certification demands between the robot, wherever it stands parked, and the kitchen."""
        if self._outside is None:
            gripper = self.world.scene.annotation.grippers[0]
            demands = rules(self.world, self.of(gripper).limb, Margins(0.0, 0.0, 0.0))
            self._outside = Rules(demands.environment, demands.pairs[:0], np.zeros(0))
        return self._outside

    def parked(self) -> Parked:
        """The robot, parked, wherever it stands: it keeps what `outside` says."""
        if self._parked is None:
            self._parked = Parked(self.world, self.world.scene.q((0.0, 0.0, 0.0), {}), self.outside())
        return self._parked


def stuck(scene: Scene, gripper: Gripper) -> list[str]:
    """Finger joints that planning may not move, as they are held or have no speed: it never closes."""
    units, name = np.eye(scene.model.nq), scene.robot.mechanism.name
    found: list[str] = []
    for joint in (one.joint for one in gripper.finger_joints):
        column = scene.coupling.rates(units[scene.coordinate[joint_iri(name, joint)]])
        velocity, acceleration, _ = rate_limits(scene, column[:, None])
        if joint in scene.annotation.held or min(velocity[0], acceleration[0]) == 0:
            found.append(joint)
    return found
