"""A kitchen and a robot as one scene: Pinocchio model, limits, collision shapes and their pairs."""

from collections.abc import Mapping, Sequence
from functools import cached_property

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  # found through a .pth file

from sdt_kg.annotation import RobotAnnotation
from sdt_kg.errors import UnknownEntityError
from sdt_kg.iri import Iri, body_iri
from sdt_kg.mechanism import Geometry, JointType, ShapeType
from sdt_kg.motion import BASE_JOINTS
from sdt_kg.twin import Twin
from services.physics.geometry.floor import BELOW, floor_box, floor_iri, standing
from services.physics.geometry.hulls import COARSE, FINE
from services.physics.geometry.shapes import solids, surface
from services.physics.placements import Placements
from services.physics.solids import Solid, outlines_of, solid_at, solids_of
from services.physics.tree import (
    UNIVERSE,
    Array,
    Bounds,
    Indices,
    add,
    base_T_root,
    coupling,
    exempt_pairs,
    se3,
)

NEAR = 1e-6
"""[m] Spheres about shapes that are farther apart than that are apart, however they are rounded."""


class Scene:
    """A kitchen and one robot as one Pinocchio model with collision shapes.

    Coordinates: the kitchen's movable joints, base x, y, yaw, the robot's movable joints. `placement`
    moves the scene's own `placements`; everything else is read only.

    Attributes:
        model: Pinocchio's. Frames are named by body IRI, tool frames `ROBOT/gripper/NAME`.
        placements: Where its joints are.
        kitchen, robot: Which part of the model is which.
        annotation: The robot's; the twin's, if no other is given.
        names: IRI of the joint of each coordinate; `ROBOT/base_x` and so on for the base.
        coordinate: The inverse of `names`.
        base: Coordinates of the base, shape (3,).
        coupling: How mimic joints follow.
        bounds: Limits of each coordinate.
        solids: All collision shapes: the kitchen's, the floor, the robot's.
        outlines: The same as arrays.
        self_pairs: Pairs of robot shapes that must not touch, shape (P, 2), indices of `solids`.
        floor: Index of the floor among `solids`, after the kitchen's own.
        ground: Indices of the floor and of what rests no higher: a kitchen may model its own floor.
        standing: Bodies that may stand on them.
        environment_pairs: Every robot shape with every kitchen shape and the floor, but for those that
            stand with the ground, shape (P, 2), robot first.
    """

    def __init__(self, twin: Twin, robot: Iri, annotation: RobotAnnotation | None = None) -> None:
        kitchen, machine = twin.mechanism(twin.environment), twin.mechanism(robot)
        self.twin, self.robot_iri, self.annotation = twin, robot, annotation or twin.robot(robot)
        self.model = pin.Model()
        self.kitchen = add(self.model, kitchen, UNIVERSE, pin.SE3.Identity())
        self.base = np.arange(self.model.nq, self.model.nq + 3)
        carrier = self._add_base(self.model)
        self.robot = add(self.model, machine, carrier, base_T_root(machine, self.annotation))
        self._add_tools()
        self.placements = Placements(self.model)
        self.coupling = coupling(self.model.nq, (self.kitchen, self.robot))
        self.names = self._names()
        self.coordinate = {name: k for k, name in enumerate(self.names)}
        self.bounds = self._bounds()
        self.standing = standing(machine, self.annotation)
        self._set_solids(fine=frozenset())
        if fine := self._meshes_touching_when_parked():
            self._set_solids(fine)

    def _set_solids(self, fine: frozenset[Iri]) -> None:
        def pieces(body: Iri, geometry: Geometry) -> tuple[coal.CollisionGeometry, ...]:
            return solids(geometry, FINE if body in fine else COARSE)

        kitchen = solids_of(self.kitchen, lambda _, geometry: surface(geometry))
        self.floor = len(kitchen)
        floor = solid_at(floor_iri(self.twin.environment), BELOW, UNIVERSE, pin.SE3.Identity(), floor_box())
        self.solids = (*kitchen, floor, *solids_of(self.robot, pieces))
        self.ground = np.flatnonzero([one.is_ground for one in self.solids[: self.floor + 1]])
        self.self_pairs, self.environment_pairs = self._pairs()
        self.outlines = outlines_of(self.solids)

    def _meshes_touching_when_parked(self) -> frozenset[Iri]:
        """Bodies with meshes whose coarse pieces fill a gap between links that do not touch."""
        part = self.robot
        meshed = {
            body_iri(part.mechanism.name, body.name)
            for body in part.mechanism.bodies
            if any(geometry.shape is ShapeType.MESH for geometry in body.collision)
        }
        if not meshed:
            return frozenset()
        at = self.placements.move(self.q((0.0, 0.0, 0.0), {}))
        frames = [at[one.joint] * one.joint_T_shape for one in self.solids]
        placed = [coal.Transform3s(frame.rotation, frame.translation) for frame in frames]
        middle = np.array([at[one.joint].act(one.centre) for one in self.solids])
        radius = np.array([one.radius for one in self.solids])
        i, j = self.self_pairs.T
        near = np.linalg.norm(middle[i] - middle[j], axis=1) <= radius[i] + radius[j] + NEAR
        touching: set[Iri] = set()
        for i, j in self.self_pairs[near].tolist():
            one, other = self.solids[i], self.solids[j]
            request, result = coal.CollisionRequest(), coal.CollisionResult()
            if coal.collide(one.shape, placed[i], other.shape, placed[j], request, result):
                touching |= {one.body, other.body}
        return frozenset(touching & meshed)

    def _add_base(self, model: pin.Model) -> int:
        up = pin.SE3(np.eye(3), np.array([0.0, 0.0, self.annotation.base_height]))
        joints = (pin.JointModelPX(), pin.JointModelPY(), pin.JointModelRZ())
        carrier, placement = UNIVERSE, up
        for joint, name in zip(joints, BASE_JOINTS, strict=True):
            carrier = model.addJoint(carrier, joint, placement, f"{self.robot_iri}/{name}")
            placement = pin.SE3.Identity()
        return carrier

    def _add_tools(self) -> None:
        for gripper in self.annotation.grippers:
            joint, joint_T_body = self.robot.attached[gripper.tool_body]
            name = self.tool_frame(gripper.name)
            self.model.addFrame(pin.Frame(name, joint, joint_T_body * se3(gripper.tool), pin.OP_FRAME))

    def _names(self) -> tuple[Iri, ...]:
        return tuple(self.model.names)[1:]

    def _bounds(self) -> Bounds:
        nq, base = self.model.nq, self.annotation.base_limits
        bounds = Bounds(np.full(nq, -np.inf), *(np.full(nq, np.inf) for _ in range(4)))
        annotated = (
            (self.kitchen, self.twin.kitchen().acceleration),
            (self.robot, self.annotation.acceleration),
        )
        for part, acceleration in annotated:
            for k, joint in enumerate(part.joints, part.first):
                if joint.type is not JointType.CONTINUOUS:
                    bounds.lower[k], bounds.upper[k] = joint.limits.lower, joint.limits.upper
                bounds.velocity[k], bounds.gain[k] = joint.limits.velocity, joint.limits.gain or np.inf
                bounds.acceleration[k] = min(joint.limits.acceleration, acceleration.get(joint.name, np.inf))
        bounds.velocity[self.base] = base.linear_velocity, base.linear_velocity, base.angular_velocity
        bounds.acceleration[self.base] = (
            base.linear_acceleration,
            base.linear_acceleration,
            base.angular_acceleration,
        )
        return bounds

    def _pairs(self) -> tuple[Indices, Indices]:
        first = next((i for i, one in enumerate(self.solids) if self.is_robot(one)), len(self.solids))
        kitchen, robot = np.arange(first), np.arange(first, len(self.solids))
        environment = np.stack(np.meshgrid(robot, kitchen, indexing="ij"), axis=-1).reshape(-1, 2)
        exempt = exempt_pairs(self.robot.mechanism, self.annotation)
        own = [
            (i, j)
            for i in robot
            for j in range(i + 1, len(self.solids))
            if frozenset((self.solids[i].body, self.solids[j].body)) not in exempt
        ]
        on_floor = [i for i in robot if self.solids[i].body in self.standing]
        stands = np.isin(environment[:, 0], on_floor) & np.isin(environment[:, 1], self.ground)
        return np.array(own, dtype=np.intp).reshape(-1, 2), environment[~stands]

    def is_robot(self, one: Solid) -> bool:
        """Whether a shape is the robot's."""
        return one.joint > self.base[-1]

    def q(
        self,
        base: Sequence[float] | Array,
        robot: Mapping[str, float],
        kitchen: Mapping[Iri, float] | None = None,
    ) -> Array:
        """Coordinates, shape (nq,).

        Args:
            base: x, y [m], yaw [rad].
            robot: Joint name → position; joints that are not listed are parked.
            kitchen: Joint IRI → position; joints that are not listed are as the twin's state says.

        Raises:
            UnknownEntityError: The robot or the kitchen has no such movable joint.
        """
        q = self._still.copy()
        for given, known in ((kitchen or {}, self.coordinate), (robot, self._robot_coordinate)):
            for joint, value in given.items():
                if joint not in known:
                    raise UnknownEntityError("joint", joint, known)
                q[known[joint]] = value
        q[self.base] = base
        return self.coupling.positions(q)

    @cached_property
    def _robot_coordinate(self) -> dict[str, int]:
        return {joint.name: k for k, joint in enumerate(self.robot.joints, self.robot.first)}

    @cached_property
    def _still(self) -> Array:
        """The kitchen as the twin's state says; the robot parked: as annotated, else at or nearest to 0."""
        q = np.zeros(self.model.nq)
        for iri, value in self.twin.state.positions:
            if iri not in self.coordinate:
                raise UnknownEntityError("joint", iri, self.names)
            q[self.coordinate[iri]] = value
        for k, joint in enumerate(self.robot.joints, self.robot.first):
            rest = min(max(0.0, joint.limits.lower), joint.limits.upper)
            q[k] = self.annotation.parked.get(joint.name, rest)
        return q

    def tool_frame(self, gripper: str) -> str:
        """Name of a gripper's tool frame in the model."""
        return f"{self.robot_iri}/gripper/{gripper}"

    def placement(self, q: Array, frame: str) -> pin.SE3:
        """world_T_frame of a body (its IRI) or tool frame at q."""
        of = self.model.frames[self.model.getFrameId(frame)]
        return self.placements.move(q)[of.parentJoint] * of.placement
