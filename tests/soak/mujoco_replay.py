"""A motion replayed in MuJoCo: its own reading of URDF, its own kinematics, its own collision detection."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from xml.etree import ElementTree

import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from tests.soak.audit import Way
from tests.soak.audit_holds import MOVES

Array = NDArray[np.float64]

PREFIX = "robot/"
BASE = ("base/x", "base/y", "base/yaw")
KITCHEN, ROBOT = (2, 0), (1, 3)
"""contype and conaffinity: the kitchen is not looked at against itself."""


def read(file: Path) -> mujoco.MjSpec:
    """A URDF file as MuJoCo reads it, every link a body; masses, which nothing needs, are made up."""
    root = ElementTree.parse(file).getroot()  # noqa: S314 - our own file
    for link in root.iter("link"):
        for inertial in link.findall("inertial"):
            link.remove(inertial)
    for joint in root.iterfind("joint/limit/.."):
        limit = joint.find("limit")
        stands = limit is not None and limit.get("lower", "0") == limit.get("upper", "0")
        if (
            stands and joint.get("type") != "continuous"
        ):  # MuJoCo would ignore its limits, and say so in a file
            joint.set("type", "fixed")
    settings = {"fusestatic": "false", "discardvisual": "true", "boundmass": "1", "boundinertia": "1"}
    ElementTree.SubElement(ElementTree.SubElement(root, "mujoco"), "compiler", settings)
    return mujoco.MjSpec.from_string(ElementTree.tostring(root, encoding="unicode"))


class Scene:
    """A kitchen with a robot whose base moves in the plane.

    Args:
        kitchen: URDF file.
        robot: Likewise.
        base: Link of the robot that its base pose is about.
        height: Of that link above the floor [m].
    """

    def __init__(self, kitchen: Path, robot: Path, base: str, height: float) -> None:
        world, other = read(kitchen), read(robot)
        for spec, (contype, conaffinity) in ((world, KITCHEN), (other, ROBOT)):
            for geom in spec.geoms:
                geom.contype, geom.conaffinity = contype, conaffinity
        carrier = world.worldbody.add_body(name="base", pos=(0, 0, height))
        slide, hinge = mujoco.mjtJoint.mjJNT_SLIDE, mujoco.mjtJoint.mjJNT_HINGE
        for name, kind, axis in zip(BASE, (slide, slide, hinge), np.eye(3), strict=True):
            carrier.add_joint(name=name, type=kind, axis=axis)
        base_T_root = np.linalg.inv(_resting(read(robot), base))
        x, y, z, w = Rotation.from_matrix(base_T_root[:3, :3]).as_quat()
        at = carrier.add_frame(pos=base_T_root[:3, 3], quat=(w, x, y, z))
        world.attach(other, frame=at, prefix=PREFIX)
        self.model = world.compile()
        self.data = mujoco.MjData(self.model)
        bodies = range(self.model.nbody)
        self.names = [mujoco.mj_id2name(self.model, mujoco.mjtObj.mjOBJ_BODY, body) for body in bodies]

    def put(self, positions: Mapping[str, float]) -> None:
        """Joint → position, by MuJoCo's names and as the files count; placements and contacts follow."""
        for name, value in positions.items():
            self.data.joint(name).qpos = value
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_collision(self.model, self.data)

    def touching(self) -> Iterator[tuple[str, str]]:
        """Names of bodies that overlap."""
        for pair in np.asarray(self.data.contact.geom).reshape(-1, 2):
            one, other = sorted(self.names[body] for body in self.model.geom_bodyid[pair])
            yield one, other

    def pose(self, body: str) -> Array:
        """world_T_body."""
        return _pose(self.data, body)


def _resting(spec: mujoco.MjSpec, body: str) -> Array:
    """root_T_body of a robot by itself."""
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return _pose(data, body)


def _pose(data: mujoco.MjData, body: str) -> Array:
    frame, found = np.eye(4), data.body(body)
    frame[:3, :3], frame[:3, 3] = found.xmat.reshape(3, 3), found.xpos
    return frame


def positions_of(way: Way) -> dict[str, Array]:
    """MuJoCo's joint names → positions at all times of the way, as the files count them."""
    stage, at = way.stage, way.spline(way.times)
    columns = {name: at[:, k] for k, name in enumerate(way.names)}
    found = dict(zip(BASE, at[:, :3].T, strict=True))
    resting = ({**stage.robot.rests(), **stage.note.parked}, {**stage.kitchen.rests(), **stage.state})
    for machine, rest, prefix in zip((stage.robot, stage.kitchen), resting, (PREFIX, ""), strict=True):
        values = {name: columns.get(name, np.full(len(at), rest[name])) for name in machine.movable}
        for name, (source, ratio, offset) in machine.mimicked().items():
            values[name] = ratio * values[source] + offset
        found |= {prefix + name: machine.sign[name] * value for name, value in values.items()}
    return found


def replayed(scene: Scene, way: Way) -> tuple[dict[tuple[str, str], float], float, float]:
    """What a simulator sees of a motion.

    Returns:
        Bodies that overlap and must not, and when first [s]; and by how much at most the tool moves
        against the handle while the container moves [m, rad].
    """
    found, held = dict[tuple[str, str], float](), list[Array]()
    positions, container = positions_of(way), way.container()
    moving = np.abs(container - container[0]) > MOVES
    for k, time in enumerate(way.times):
        scene.put({name: value[k] for name, value in positions.items()})
        for pair in set(scene.touching()):
            if pair not in found and not _may(way, pair):
                found[pair] = float(time)
        if moving[k]:
            tool, tool_T, _ = way.hand
            held.append(np.linalg.inv(scene.pose(way.stage.handle)) @ scene.pose(PREFIX + tool) @ tool_T)
    first = held[0]
    slip = max(float(np.linalg.norm(each[:3, 3] - first[:3, 3])) for each in held)
    turn = max(float(Rotation.from_matrix(first[:3, :3].T @ each[:3, :3]).magnitude()) for each in held)
    return found, slip, turn


def _may(way: Way, pair: tuple[str, str]) -> bool:
    """Whether two bodies may touch: neighbours, those the annotation names, fingers and their handle."""
    stage = way.stage
    ours = [body.removeprefix(PREFIX) for body in pair if body.startswith(PREFIX)]
    if len(ours) == 2:
        return frozenset(ours) in stage.note.touching or stage.robot.joined(*ours)
    others = [body for body in pair if not body.startswith(PREFIX)]
    return ours[0] in way.hand[2] and others == [stage.handle]
