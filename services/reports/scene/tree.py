"""A mechanism as joints with bodies on them, to be put into a posture by numpy here and by WebGL in a page.

Every joint has one coordinate, as in `services.physics`; mimicking joints have theirs, and whoever gives
positions gives them all.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sdt_kg.iri import Iri, body_iri, joint_iri
from sdt_kg.mechanism import JointType
from sdt_kg.twin import Twin
from services.physics.model import Scene
from services.physics.tree import Part, build
from services.reports.scene.meshes import Mesh, mesh_of

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

WORLD = -1
"""Parent of a joint that hangs on nothing."""

BASE_AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
"""x, y, yaw."""


@dataclass(frozen=True, slots=True, eq=False)
class Shown:
    """A body.

    Attributes:
        joint: Index of the tree's joint that moves it, or `WORLD`.
        mesh: In that joint's frame; in the root frame where nothing moves it.
    """

    iri: Iri
    joint: int
    mesh: Mesh


@dataclass(frozen=True, slots=True, eq=False)
class Tree:
    """A kitchen, or a robot with its base.

    Attributes:
        name: Of the model.
        is_robot: Whether it is a robot, whose first three joints are its base.
        joints: IRI of each of the J joints, parents first.
        parents: Index of the joint on which each hangs, or `WORLD`; shape (J,).
        placements: parent_T_joint, shape (J, 4, 4).
        axes: In the joint's frame, shape (J, 3).
        slides: Whether the joint slides, shape (J,).
        rest: Positions as the twin has them, or parked; shape (J,) [rad or m].
        bodies: All that have a shape.
    """

    name: str
    is_robot: bool
    joints: tuple[Iri, ...]
    parents: Indices
    placements: Array
    axes: Array
    slides: NDArray[np.bool_]
    rest: Array
    bodies: tuple[Shown, ...]

    def frames(self, positions: Array) -> Array:
        """world_T_joint of each joint, shape (J, 4, 4), and the identity last, for `WORLD`."""
        frames = np.tile(np.eye(4), (len(self.joints) + 1, 1, 1))
        for i, parent in enumerate(self.parents):
            frames[i] = frames[parent] @ self.placements[i] @ self._motion(i, positions[i])
        return frames

    def _motion(self, joint: int, position: float) -> Array:
        motion, axis = np.eye(4), self.axes[joint]
        if self.slides[joint]:
            motion[:3, 3] = position * axis
            return motion
        x, y, z = axis
        skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        motion[:3, :3] += np.sin(position) * skew + (1 - np.cos(position)) * (skew @ skew)
        return motion


def kitchen_tree(twin: Twin) -> Tree:
    """The kitchen in its present state."""
    model = build(twin.mechanism(twin.environment))
    rest = np.array([twin.state.get(joint, 0.0) for joint in _names(model.part)])
    return _tree(twin.name(twin.environment), model.model, model.part, (), model.coupling.positions(rest))


def robot_tree(scene: Scene) -> Tree:
    """The robot, parked where the kitchen says that robots start."""
    start = scene.twin.kitchen().start
    rest = scene.q((start[0], start[1], start[2]), {})[scene.base[0] :]
    base = tuple(scene.names[k] for k in scene.base)
    return _tree(scene.robot.mechanism.name, scene.model, scene.robot, base, rest)


def _names(part: Part) -> tuple[Iri, ...]:
    return tuple(joint_iri(part.mechanism.name, each.name) for each in part.joints)


def _tree(name: str, model: object, part: Part, base: tuple[Iri, ...], rest: Array) -> Tree:
    """The joints of a part of a Pinocchio model, and before them those of its base."""
    first = part.first - len(base) + 1  # Pinocchio's joint 0 is the world
    indices = range(first, part.first + len(part.joints) + 1)
    axes = [BASE_AXES[i] for i in range(len(base))] + [each.axis for each in part.joints]
    slides = [True, True, False][: len(base)] + [each.type is JointType.PRISMATIC for each in part.joints]
    parents = [max(model.parents[i] - first, WORLD) for i in indices]  # pyright: ignore[reportAttributeAccessIssue]  # pin has no stubs
    placements = [model.jointPlacements[i].homogeneous for i in indices]  # pyright: ignore[reportAttributeAccessIssue]  # pin has no stubs
    return Tree(
        name,
        bool(base),
        base + _names(part),
        np.array(parents, dtype=np.intp),
        np.array(placements).reshape(-1, 4, 4),
        np.array(axes, dtype=np.float64).reshape(-1, 3),
        np.array(slides, dtype=bool),
        rest,
        tuple(_bodies(part, first)),
    )


def _bodies(part: Part, first: int) -> list[Shown]:
    found = list[Shown]()
    for body in part.mechanism.bodies:
        joint, joint_T_body = part.attached[body.name]
        meshes = [mesh_of(geometry).placed(joint_T_body.homogeneous) for geometry in body.collision]
        if meshes:
            iri = body_iri(part.mechanism.name, body.name)
            found.append(Shown(iri, max(joint - first, WORLD), _joined(meshes)))
    return found


def _joined(meshes: list[Mesh]) -> Mesh:
    starts = np.cumsum([0, *(len(each.vertices) for each in meshes)])
    return Mesh(
        np.vstack([each.vertices for each in meshes]),
        np.vstack([each.faces + start for each, start in zip(meshes, starts, strict=False)]),
        np.vstack([each.edges + start for each, start in zip(meshes, starts, strict=False)]),
    )
