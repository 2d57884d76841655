"""Where a robot's arms are when it drives, found by looking: compact, free of itself, not in front."""

from collections import Counter
from collections.abc import Set
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import Gripper, RobotAnnotation
from sdt_kg.describe import turtle
from sdt_kg.iri import joint_iri, local_name
from sdt_kg.load import load_twin
from services.describing.posture import SEEDS, Postures, below
from services.embodiment.body.demands import Margins, rules
from services.embodiment.body.limb import BASE, Limb, make_limb
from services.embodiment.body.world import Rules, World
from services.physics.model import Scene

CLEARANCES = (0.02, 0.005, 0.001)  # [m] kept where more than two joints part bodies, the first that there is
BESIDE = 0.02  # [m] from the middle of the robot at which an arm counts as its left or right one

FLOOR = b'<robot name="bare_floor"><link name="floor"/></robot>'


@dataclass(frozen=True, slots=True)
class Parked:
    """Where an arm is parked.

    Attributes:
        positions: Joint name → position [rad or m]; none where no posture is free.
        moved: Joints that move the gripper or its fingers.
        clearance: Distance that its bodies keep from the robot and the floor [m].
        meeting: The bodies that met most often where none is free.
    """

    positions: dict[str, float]
    moved: frozenset[str]
    clearance: float = 0.0
    meeting: tuple[str, ...] = ()


def parked(urdf: Path, robot: RobotAnnotation) -> RobotAnnotation:
    """The annotation with parked positions for one arm after the other, and a note of how they were found.

    An arm of which all joints are held has none.
    """
    settled: set[str] = set()
    for gripper in robot.grippers:
        found = _park(World(_scene(urdf, robot)), gripper, settled)
        if found is not None:
            positions, note = robot.parked | found.positions, _note(gripper, found)
            robot = replace(robot, parked=positions, notes=(*robot.notes, note))
            settled |= found.moved
    return robot


def _note(gripper: Gripper, found: Parked) -> str:
    arm = f"check: the arm of gripper '{gripper.name}'"
    if found.positions:
        return (
            f"{arm} is parked (sdt:parkedPosition) in the most compact posture that was found, by looking at "
            f"{SEEDS} random ones and what is near the best: narrow from above, not in front of the base, "
            f"with ways out, {found.clearance * 1000:g} mm clear of the robot and the floor"
        )
    pair = " meets ".join(map(repr, found.meeting))
    return (
        f"{arm} is parked at 0 or the nearest limits: no posture free of contact was found, most often as "
        f"{pair}; if they always do, sdt:mayTouch says so"
    )


def _scene(urdf: Path, robot: RobotAnnotation) -> Scene:
    """The robot alone on a floor."""
    with TemporaryDirectory() as folder:
        floor, annotation = Path(folder) / "bare_floor.urdf", Path(folder) / f"{robot.robot}.ttl"
        floor.write_bytes(FLOOR)
        annotation.write_text(turtle(robot, urdf.name), encoding="utf-8")
        twin = load_twin(floor, [urdf], annotation)
        return Scene(twin, twin.robots[0])


def _park(world: World, gripper: Gripper, settled: set[str]) -> Parked | None:
    """The best posture that is found, with as much clearance as there is one for; None if nothing moves."""
    limb, scene, met = make_limb(world, gripper), world.scene, Counter[tuple[int, int]]()
    names = [local_name(scene.names[k]) for k in limb.variables]
    fixed = np.array([k < BASE.stop or name in settled for k, name in enumerate(names)], np.bool_)
    if fixed.all():
        return None
    moved = frozenset((*_moved(world, limb), *(one.joint for one in gripper.finger_joints)))
    later = scene.annotation.acceleration.keys() - settled - moved
    passing = _without(world, rules(world, limb, Margins()), later)
    for clearance in CLEARANCES:
        demands = _without(world, rules(world, limb, Margins(clearance, clearance)), later)
        postures = Postures(world, limb, (demands, passing), fixed, _side(world, limb, fixed))
        x = postures.best()
        if x is not None:
            q = limb.q(x)
            at = {name: round(float(q[k]), 4) for name, k in _moved(world, limb).items()}
            return Parked(at, moved, clearance)
        met = postures.met
    ((pair, _),) = met.most_common(1)
    return Parked({}, moved, meeting=tuple(local_name(world.body[k]) for k in pair))


def _moved(world: World, limb: Limb) -> dict[str, int]:
    """Joints that the limb moves, mimicking ones left out, and their coordinates."""
    arm = np.array(np.abs(limb.expansion[:, BASE.stop :]).any(axis=1))
    own = world.scene.coupling.source == np.arange(len(arm))
    return {local_name(world.scene.names[k]): k for k in np.flatnonzero(arm & own).tolist()}


def _side(world: World, limb: Limb, fixed: NDArray[np.bool_]) -> int:
    """1 for the left arm of several, -1 for the right one: where its first joint beside the middle is."""
    if len(world.scene.annotation.grippers) < 2:
        return 0
    y = world.frames(limb.q(limb.parked))[1][limb.variables[~fixed] + 1, 1]
    return next((int(np.sign(each)) for each in y.tolist() if abs(each) > BESIDE), 0)


def _without(world: World, demands: Rules, joints: Set[str]) -> Rules:
    """The same distances, but nothing is asked of what these joints move."""
    scene = world.scene
    iris = {joint_iri(scene.robot.mechanism.name, name) for name in joints}
    moved = below(world.tree[0], {k for k, name in enumerate(scene.model.names) if name in iris})
    near = ~np.isin(world.boxes[0][demands.pairs], moved).any(axis=1)
    return Rules(demands.environment, demands.pairs[near], demands.own[near])
