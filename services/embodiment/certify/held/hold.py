"""The tool holds the handle from the moment in which the container begins to move to that in which it stops.

What follows is letting go: nothing moves the container any more, so nobody has to hold it. Fingers may
still be at the handle as long as the tool stays in its grasp, and from then on must keep clear of it, until
the tool is in its next grasp, if there is one: a container that rests on the way may be taken hold of anew.
"""

from functools import cached_property
from itertools import product

import numpy as np
from numpy.typing import NDArray

from predicates.case import Evidence, Quantity
from sdt_kg.annotation import Gripper
from sdt_kg.iri import Iri, body_iri, local_name
from sdt_kg.twin import Container
from services.embodiment.certify.findings import Findings, Violation
from services.embodiment.certify.held.grip import NOTHING, Grip, Pinch
from services.embodiment.certify.held.slip import DEEPEST, Attached, Slip
from services.embodiment.certify.held.stints import last, rests
from services.embodiment.certify.held.surface import Posed, Surface, own_shapes
from services.embodiment.certify.sweep.kinematics import Placed, farther
from services.embodiment.certify.sweep.pieces import positions
from services.embodiment.certify.sweep.subject import Subject
from services.physics.model import Scene
from services.physics.tree import se3

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

FINE = 2e-4  # [m or rad] precision of the largest tool error that is reported
FIRST = np.zeros(1, dtype=np.intp)

TURN = "tool turn"
"""Name of the figure that says how far a held tool turns on its handle."""


class Hold:
    """One gripper, the handle of one container, and the motion that is to be checked for them.

    Attributes:
        begin: First piece on which the container moves; its start is the moment of the grasp.
        last: Last piece on which it moves, before it is let go; until its end it is held.
        onward: First piece on which it moves after that, by another hold; None if it does not.
        time: The moment of the grasp [s].
        until: The end of holding [s].
        room: By how much the handle may be elsewhere and is still held [m]; known once `contact` holds.
        slant: How far the faces that hold look away from the way in which fingers close, at most [rad]; known
            then too, and pi / 2 where nothing is shown.
        most: How far the tool may slip [m] and turn [rad] on it: less where another container goes farther.
    """

    def __init__(
        self, checked: Subject, container: Container, gripper: Gripper, begin: int, since: int | None = None
    ) -> None:
        self.checked, self.scene = checked, checked.scene
        scene = checked.scene
        self.tolerances, self.timeline = checked.tolerances, checked.timeline
        self.kinematics, self.shapes = checked.kinematics, checked.shapes
        self.pieces, self.begin = checked.timeline.pieces, begin
        self.room, self.slant, self._since = 0.0, np.pi / 2, since
        self.gripper, self.container = gripper, container
        ratio = farther(scene, scene.coordinate[container.joint])
        self.most = self.tolerances.tool_position / ratio, self.tolerances.tool_angle / ratio
        joint, joint_T_body = scene.robot.attached[gripper.tool_body]
        self.tool = self._attached(joint, (joint_T_body * se3(gripper.tool)).homogeneous)
        joint, joint_T_body = scene.kitchen.attached[local_name(container.handle)]
        self.handle = self._attached(joint, joint_T_body.homogeneous)
        robot = scene.robot.mechanism.name
        self.fingers = _shapes_of(scene, [body_iri(robot, name) for name in gripper.fingers])
        self.bar = _shapes_of(scene, [container.handle])
        self.slip = Slip(checked, self.tool, self.handle, begin)
        self.last, self.onward = self._ends()
        self.time = float(self.pieces.start[begin])
        self.until = float(self.pieces.start[self.last] + self.pieces.duration[self.last])

    def _ends(self) -> tuple[int, int | None]:
        """Last piece before the hand leaves its grasp while the container rests, and first one after that."""
        k = self.scene.coordinate[self.container.joint]
        for rest in rests(self.checked.pieces, k, self.begin):
            if len(self.slip.off(rest.start + 1, rest.stop + 1)) or self._is_anew(rest):
                return rest.start - 1, rest.stop
        return last(self.checked.pieces, k), None

    def _is_anew(self, rest: slice) -> bool:
        """Whether the fingers open in place, and may close again: at a sample all are off the handle."""
        samples = np.arange(rest.start + 1, rest.stop + 1)
        shift = np.abs(self.pieces.c[0, samples] - self.pieces.c[0, self.begin])
        moved = np.array([self._moved(finger, shift) for finger in self.fingers]).max(axis=0, initial=0.0)
        opened = samples[moved > self.tolerances.contact]
        return bool(len(opened)) and not self._near(opened).all()

    def _attached(self, joint: int, joint_T_frame: Array) -> Attached:
        return Attached(int(self.kinematics.carrier[joint]), self.kinematics.fixed[joint] @ joint_T_frame)

    @cached_property
    def arrived(self) -> float:
        """Time of the sample from which on the tool is in its grasp: the fingers may close.

        The first of all if it was nowhere else; if another hold came before, the first after that was left.
        """
        since = min(self._since or 0, self.begin)
        off = self.slip.off(since, self.begin)
        first = int(off[-1]) + 1 if len(off) else since
        leaving = self.slip.leaving(first, self.begin)
        return float(self.pieces.start[int(leaving[-1]) + 1 if len(leaving) else first])

    @cached_property
    def left(self) -> int:
        """First piece on which fingers have to be clear of the handle; as many as there are if on none.

        It begins with the last sample up to which the tool, after the container has stopped, is in its grasp.
        """
        count = len(self.pieces.start)
        stop = count if self.onward is None else self.onward
        off = self.slip.off(self.last + 2, stop + 1)
        end = int(off[0]) - 1 if len(off) else stop
        leaving = self.slip.leaving(self.last + 1, end)
        return int(leaving[0]) if len(leaving) else end

    def clear_from(self) -> float:
        """When that piece begins [s]; infinite if there is none."""
        return float(self.pieces.start[self.left]) if self.left < len(self.pieces.start) else np.inf

    @cached_property
    def contact(self) -> Findings:
        """At the grasp two fingers have the handle between them: they reach over it and touch it."""
        grip = self._grip()
        pinch = grip.pinch()
        if pinch is None or pinch.over < self.tolerances.engaged:
            return self._not_held(grip, pinch)
        self.room, self.slant = grip.room(pinch), grip.slant(pinch)
        return Findings(figures={"finger to handle": (pinch.gap, "m")})

    def _grip(self) -> Grip:
        placed = self.slip.at_grasp
        tool_R, _ = self.tool.world(placed)
        robot = self.scene.robot.mechanism.name
        bodies = [body_iri(robot, name) for name in self.gripper.fingers]
        fingers = {body: _shapes_of(self.scene, [body]) for body in bodies}
        surfaces = self._surfaces(placed)
        return Grip(self.shapes, placed, tool_R[0], fingers, self.bar, surfaces, self.tolerances)

    def _surfaces(self, placed: Placed) -> dict[Iri, Surface]:
        """Fingers with meshes, as these are, at the first configuration."""
        part, shapes = self.scene.robot, np.array(self.bar, dtype=np.intp)
        frames = zip(*self.shapes.frames(placed, np.zeros_like(shapes), shapes), strict=True)
        bar = [(self.scene.solids[k].shape, *at) for k, at in zip(self.bar, frames, strict=True)]
        found: dict[Iri, Surface] = {}
        for name in self.gripper.fingers:
            joint, joint_T_body = part.attached[name]
            finger: list[Posed] = []
            for shape, body_T_shape in own_shapes(part.mechanism, name):
                rotation, origin = self._attached(joint, joint_T_body.homogeneous @ body_T_shape).world(
                    placed
                )
                finger.append((shape, rotation[0], origin[0]))
            if finger:
                found[body_iri(part.mechanism.name, name)] = Surface(finger, bar)
        return found

    def later(self) -> "Hold | None":
        """The first sample after the container began to move at which it is held, if there is one."""
        pieces = np.arange(self.begin, self.last + 1)
        for begin in pieces[self._near(pieces)]:
            late = Hold(self.checked, self.container, self.gripper, int(begin))
            if not late.contact.violations:
                return late
        return None

    def _near(self, pieces: Indices) -> NDArray[np.bool_]:
        """Whether any finger is as near to the handle as a contact allows, where these pieces begin."""
        q, v, _ = self.pieces.at(pieces, np.zeros(len(pieces)))
        placed, near = self.kinematics.place(q, v), np.zeros(len(pieces), dtype=bool)
        for finger, bar in product(self.fingers, self.bar):
            pair = np.tile((finger, bar), (len(pieces), 1))
            gaps = self.shapes.distances(placed, np.arange(len(pieces)), pair)
            near |= gaps <= self.tolerances.contact
        return near

    def _not_held(self, grip: Grip, pinch: Pinch | None) -> Findings:
        handle, tolerances = local_name(self.container.handle), self.tolerances
        if pinch is not None:
            finger, value, bound = pinch.finger, pinch.over, tolerances.engaged
            what = f"{local_name(finger)} reaches {value * 1000:.1f} mm over {handle}"
            excess = bound - value
        else:
            finger = grip.lacking()
            value, bound = grip.gaps[finger], tolerances.contact
            what = f"{local_name(finger)} is {value * 1000:.1f} mm away from {handle}"
            excess = value
            if not np.isfinite(value):
                what = f"no finger of {self.gripper.name}, or not {handle}, has a shape to touch with"
                value, bound = NOTHING, tolerances.engaged
            elif value <= bound:
                what = f"{handle} is not between the fingers of {self.gripper.name}"
                value, bound = NOTHING, tolerances.engaged
        moves = "moves before it is held" if self._since is None else "moves on before it is held anew"
        reason = f"{self.container.name} {moves}: {what}"
        links = (finger, self.container.handle)
        evidence = Evidence(Quantity.DISTANCE, value, bound, "m", links=links, time=self.time)
        return Findings([Violation("held", reason, evidence, excess)])

    def follows(self) -> Findings:
        """While it is held the tool neither slips nor turns on the handle, between samples too."""
        findings, seen, safe = Findings(), np.zeros(2), np.zeros(2)
        most = np.array([self.most[0], 2 * np.sin(self.most[1] / 2)])
        level, intervals = self.timeline.depth, np.arange(self.begin, self.last + 1)
        for halving in range(DEEPEST + 1):
            spans, error, upper = self.slip.on(level + halving, intervals)
            if halving == DEEPEST:  # what is not shown by now is refused
                error = upper
            seen = np.maximum(seen, error.max(axis=1))
            for row in (0, 1):
                self._slips(
                    findings, row, np.where(error[row] > most[row], error[row], 0), spans.middle, most
                )
            may_be_worse = upper > seen[:, None] + FINE
            may_break = (upper > most[:, None]) & (seen <= most)[:, None]
            keep = (may_be_worse | may_break).any(axis=0)
            safe = np.maximum(safe, upper[:, ~keep].max(axis=1, initial=0))
            intervals = intervals[keep]
            if not len(intervals):
                break
            intervals = np.concatenate((2 * intervals, 2 * intervals + 1))
        if not findings.violations:
            findings.figures["tool slip"] = (float(safe[0]), "m")
            findings.figures[TURN] = (float(2 * np.arcsin(safe[1] / 2)), "rad")
        return findings

    def _slips(self, findings: Findings, row: int, error: Array, time: Array, most: Array) -> None:
        if not error.any():
            return
        verb, quantity, unit = (
            ("slips", Quantity.TOOL_ERROR, "m"),
            ("turns", Quantity.ORIENTATION_ERROR, "rad"),
        )[row]
        for n in (int(np.argmax(error > 0)), int(np.argmax(error))):
            value, bound = float(error[n]), float(most[row])
            entity = body_iri(self.scene.robot.mechanism.name, self.gripper.tool_body)
            evidence = Evidence(quantity, value, bound, unit, entity, time=float(time[n]))
            reason = f"the tool {verb} by {value:.4g} {unit} on {local_name(self.container.handle)}"
            findings.violations.append(Violation(f"tool {verb}", reason, evidence, value))

    def keeps_fingers(self) -> Findings:
        """While they hold, the fingers do not move against the tool by more than a contact allows."""
        findings, (values, _) = Findings(), positions(self.pieces)
        later = values[:, self.begin : self.last + 1]
        shift = np.abs(later - self.pieces.c[0, self.begin]).max(axis=(0, 1))
        for finger in self.fingers:
            moved = float(self._moved(finger, shift))
            if moved > self.tolerances.contact:
                body = self.scene.solids[finger].body
                reason = f"{local_name(body)} moves by up to {moved * 1000:.1f} mm while it holds the handle"
                evidence = Evidence(
                    Quantity.TOOL_ERROR, moved, self.tolerances.contact, "m", body, time=self.time
                )
                findings.violations.append(Violation("fingers", reason, evidence, moved))
        return findings

    def _moved(self, finger: int, shift: Array) -> Array:
        """How far a finger's shape moves against the tool at most [m], by how much coordinates are off."""
        placed = self.slip.at_grasp
        between = self.kinematics.path[self.shapes.carrier[finger]] ^ self.kinematics.path[self.tool.carrier]
        centre = self.shapes.centres(placed, FIRST, np.array([finger]))[0]
        lever = self.kinematics.levers(placed, centre) + self.shapes.radius[finger]
        return (between[1:] * np.where(self.kinematics.revolute[1:], lever[1:], 1) * shift).sum(axis=-1)


def _shapes_of(scene: Scene, bodies: list[Iri]) -> list[int]:
    return [i for i, one in enumerate(scene.solids) if one.body in bodies]
