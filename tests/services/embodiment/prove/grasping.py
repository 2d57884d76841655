"""Fronts of which grasps of a bar are refuted, with the base fixed."""

from pathlib import Path

import numpy as np

from sdt_kg.annotation import Drive
from sdt_kg.twin import Twin
from services.embodiment.body.world import World
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.hold.handle import Mechanics, find_bar
from services.embodiment.proof_check import check
from services.embodiment.proof_check.grasps import Grasps
from services.embodiment.proof_check.proof.claim import Bar
from services.embodiment.proof_check.statement import Statement
from services.embodiment.prove import Prover, claimed
from services.physics.model import Scene
from tests.services.embodiment.prove.standing import HERE, Known, front

NEVER_HELD = 515
"""A front before a PR2 with its bar out of the way of the hand."""


def twin_of(folder: Path, number: int, robot: str = "pr2") -> Twin:
    return front(folder, robot, number)


def bar_of(twin: Twin) -> Bar:
    world = World(Scene(twin, twin.robots[0]))
    bar = find_bar(world, Mechanics(world, twin.container("front_door")), world.scene.q(HERE, {}))
    assert bar is not None
    return claimed(bar)


def prover(twin: Twin, bar: Bar) -> Prover:
    door = twin.container("front_door")
    values = np.array([0.0, door.open_from])
    return Prover(twin, twin.robots[0], door, Drive.FIXED, HERE, values, bar=bar)


def statement(twin: Twin) -> Statement:
    door = twin.container("front_door")
    about = twin, twin.robots[0], door, Drive.FIXED, HERE, Tolerances()
    return Statement(*about, span=(0.0, door.open_from))


def grasps_at(twin: Twin, value: float, gripper: str = "") -> Grasps:
    about = statement(twin)
    one = next(each for each in about.grippers if not gripper or each.name == gripper)
    arm = about.arm(one)
    assert arm is not None
    return Grasps(about, arm, bar_of(twin), value)


def checked(twin: Twin, content: bytes) -> bool:
    return check(twin, twin.robots[0], twin.container("front_door"), content).holds


def refuted_grasps(folder: Path, number: int) -> Known:
    """A front before a PR2 that no grasp opens, and the proof."""
    twin = twin_of(folder, number)
    proved = prover(twin, bar_of(twin)).grasped()
    assert proved is not None
    return twin, proved
