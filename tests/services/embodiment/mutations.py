"""Mutations of the gantry's motion that opens the drawer: of the motion, of the robot, of the kitchen."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np

from sdt_kg.annotation import Drive
from sdt_kg.iri import joint_iri
from sdt_kg.load import load_twin
from sdt_kg.motion import Array, BodyMotion
from sdt_kg.twin import Twin
from services.embodiment.certify import Certified, Refused, Tolerances, certify
from services.physics.model import Scene
from tests.services.embodiment.dense import World
from tests.services.embodiment.gantry import FOLDER, JOINTS, RESTS, START, gantry_twin, opening

Random = np.random.Generator
WIDTHS = (0.5, 3.0)  # [s] of a bump
THIN = 0.001  # [m] of a wall


@dataclass(frozen=True)
class Mutation:
    """A motion in a world, and the twin that says the same."""

    name: str
    motion: BodyMotion
    world: World
    twin: Callable[[Path], Twin]


def closed(motion: BodyMotion, half_open: float) -> BodyMotion:
    """The motion, but that fingers close to so far from the middle [m]."""
    column = motion.joints.index("up_joint")
    q, v, part = motion.q.copy(), motion.v.copy(), (0.04 - half_open) / (0.04 - 0.005)
    q[:, column] = 0.04 - (0.04 - q[:, column]) * part
    v[:, column] *= part
    return replace(motion, q=q, v=v)


def resting(motion: BodyMotion, at: int, times: Array) -> BodyMotion:
    """The motion with a sample more so many seconds after one, each as that one is; the others come later."""
    names = ("base", "base_v", "q", "v", "kitchen_q", "kitchen_v")
    parts = {
        name: np.insert(rows := getattr(motion, name), [at + 1] * len(times), rows[at], axis=0)
        for name in names
    }
    later = motion.times[at] + times, motion.times[at + 1 :] + times[-1]
    return replace(motion, times=np.concatenate((motion.times[: at + 1], *later)), **parts)


def before_it_moves(motion: BodyMotion) -> int:
    """The last sample at which the first joint of the kitchen has not moved yet."""
    return int(np.argmax(motion.kitchen_q[:, 0] > 0)) - 1


@cache
def plain(folder: Path) -> Twin:
    return gantry_twin(folder)


def size(random: Random, least: float, most: float) -> float:
    """Log-uniform, of either sign."""
    return float(np.exp(random.uniform(np.log(least), np.log(most))) * random.choice((-1, 1)))


def changed(motion: BodyMotion, column: int, by: np.ndarray, rate: np.ndarray) -> BodyMotion:
    """One coordinate of base (0 to 2), joints (3 to 6) or drawer (7), with its velocity."""
    fields = (("base", "base_v", 0), ("q", "v", 3), ("kitchen_q", "kitchen_v", 7))
    position, velocity, first = next(each for each in reversed(fields) if column >= each[2])
    q, v = getattr(motion, position).copy(), getattr(motion, velocity).copy()
    q[:, column - first] += by
    v[:, column - first] += rate
    return replace(motion, **{position: q, velocity: v})


def waypoint(random: Random, motion: BodyMotion) -> Mutation:
    column = int(random.integers(8))
    by = np.zeros(len(motion.times))
    by[random.integers(len(by))] = size(random, 1e-5, 0.03)
    return Mutation("waypoint", changed(motion, column, by, np.zeros_like(by)), World(), plain)


def bump(random: Random, motion: BodyMotion) -> Mutation:
    """A coordinate leaves its way, slowly, and comes back."""
    column = int(random.integers(8))
    width, most = random.uniform(*WIDTHS), size(random, 1e-4, 0.2)
    phase = (motion.times - random.uniform(0, motion.times[-1] - width)) / width
    inside = (phase > 0) & (phase < 1)
    by = np.where(inside, most * np.sin(np.pi * phase) ** 2, 0)
    rate = np.where(inside, most * np.pi / width * np.sin(2 * np.pi * phase), 0)
    drive = Drive(random.choice([each.value for each in (Drive.OMNI, Drive.OMNI, Drive.DIFFERENTIAL)]))
    return Mutation("bump", changed(motion, column, by, rate), World(drive), plain)


def paced(motion: BodyMotion, scale: float) -> BodyMotion:
    """The same way, in `scale` times as long."""
    return replace(
        motion,
        times=motion.times * scale,
        v=motion.v / scale,
        base_v=motion.base_v / scale,
        kitchen_v=motion.kitchen_v / scale,
    )


def tempo(random: Random, motion: BodyMotion) -> Mutation:
    return Mutation("tempo", paced(motion, random.uniform(0.6, 1.6)), World(), plain)


def fingers(random: Random, motion: BodyMotion) -> Mutation:
    return Mutation("fingers", closed(motion, 0.005 + size(random, 1e-4, 0.02)), World(), plain)


def drawer(random: Random, motion: BodyMotion) -> Mutation:
    """The drawer is pulled a little more or less than the hand moves."""
    part = 1 + size(random, 1e-4, 0.05)
    scaled = replace(motion, kitchen_q=motion.kitchen_q * part, kitchen_v=motion.kitchen_v * part)
    return Mutation("drawer", scaled, World(), plain)


def gripper(random: Random, motion: BodyMotion) -> Mutation:
    del random
    return Mutation("gripper", replace(motion, gripper="other"), World(gripper="other"), plain)


def fixed(random: Random, motion: BodyMotion) -> Mutation:
    del random
    return Mutation("fixed", motion, World(Drive.FIXED), plain)


LIMITS = {"upper": "upperLimit", "velocity": "velocityLimit", "acceleration": "accelerationLimit"}
USED = {
    "upper": (0.2, 0.635, np.inf, 0.04),
    "velocity": (0.06, 0.239, 0, 0.0263),
    "acceleration": (0.048, 0.239, 0, 0.0525),
}


def limit(random: Random, motion: BodyMotion) -> Mutation:
    """A limit of lift, arm or finger shrinks to about what the motion uses of it."""
    kind, joint = str(random.choice(list(LIMITS))), int(random.choice((0, 1, 3)))
    value = max(USED[kind][joint] * (1 + size(random, 1e-3, 0.5)), 1e-3)
    value = max(value, 0.04) if (kind, joint) == ("upper", 3) else value  # it is parked there
    values = list(getattr(World(), kind))
    values[joint] = value
    iri = joint_iri("gantry", JOINTS[joint])
    world = replace(World(), **{kind: tuple(values)})
    return Mutation(
        "limit", motion, world, lambda folder: plain(folder).with_edit(iri, **{LIMITS[kind]: value})
    )


def wall(random: Random, motion: BodyMotion) -> Mutation:
    """A board of 1 mm, across the way or beside it."""
    half = np.array([0.1, 0.1, 0.1])
    half[random.integers(3)] = THIN / 2
    centre = np.array([random.uniform(0.3, 1.15), random.uniform(-0.3, 0.3), random.uniform(0.15, 0.9)])
    xyz, box = " ".join(map(repr, centre.tolist())), " ".join(map(repr, (2 * half).tolist()))
    more = (
        f'<link name="wall"><collision><geometry><box size="{box}"/></geometry></collision></link>'
        '<joint name="wall_joint" type="fixed"><parent link="world"/><child link="wall"/>'
        f'<origin xyz="{xyz}"/></joint>'
    )
    world = World(walls=((tuple(centre.tolist()), tuple(half.tolist())),))
    return Mutation("wall", motion, world, lambda folder: gantry_twin(folder, more))


def handle(random: Random, motion: BodyMotion) -> Mutation:
    """The handle is elsewhere."""
    by = np.zeros(3)
    by[random.integers(3)] = size(random, 1e-4, 0.03)
    x, y, z = by.tolist()

    def twin(folder: Path) -> Twin:
        cell = (
            (FOLDER / "cell.urdf")
            .read_text()
            .replace('xyz="-0.295 0 0"', f'xyz="{-0.295 + x!r} {y!r} {z!r}"')
        )
        (folder / "cell.urdf").write_text(cell)
        return load_twin(folder / "cell.urdf", [FOLDER / "gantry.urdf"])

    return Mutation("handle", motion, World(handle=(x, y, z)), twin)


KINDS = (waypoint, waypoint, bump, bump, bump, tempo, fingers, drawer, limit, wall, handle)
RARE = (gripper, fixed)


def mutations(seed: int, count: int, rests: np.ndarray = RESTS) -> list[Mutation]:
    """So many of the motion from rest to rest, the same for the same seed; a few are always wrong."""
    random, motion = np.random.default_rng(seed), opening(rests=rests)
    return [
        (RARE[k % 2] if k % 50 == 49 else KINDS[random.integers(len(KINDS))])(random, motion)
        for k in range(count)
    ]


class Judge:
    """The certifier; scenes of the plain twin are built once."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.twin = plain(folder)
        self.scene = Scene(self.twin, self.twin.robots[0])

    def __call__(self, mutation: Mutation) -> Certified | Refused:
        twin = mutation.twin(self.folder)
        scene = self.scene if twin is self.twin else None
        container = twin.container("drawer_main")
        robot, drive = twin.robots[0], mutation.world.drive
        return certify(
            twin, robot, mutation.motion, container, Tolerances(), drive=drive, start=START, scene=scene
        )
