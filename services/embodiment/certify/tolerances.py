"""What certification allows; part of every verdict's inputs."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace

from sdt_kg.errors import InputError
from services.physics.replay import BEYOND_STOPS
from services.policy import USUAL_CONTACT, check_contact, friction_of


@dataclass(frozen=True, slots=True)
class Tolerances:
    """How exactly a motion must keep what it promises.

    Attributes:
        margin: Distance to be kept from everything, beyond the robot's overhang [m].
        resolution: A pair that keeps less than this beyond the margin may be refused [m].
        contact: How far a finger may be from the handle that it holds [m].
        depth: How deep it may be in it [m]; less where both are thin (`held/through.py`).
        engaged: How far each finger has to reach over the handle that it holds, up, down, forth
            and back [m]. Ours: more than `depth`, so that no fingertip that stands in front of a
            bar, or is as deep in its front as it may be, counts; and more than `tool_position`,
            so that what is held stays so while the tool slips.
        facing: Between the closing direction and the faces with which fingers and handle meet, along each
            side [rad].
        cone: The same in all, as friction holds [rad]: of a coefficient µ its arc tangent; pi / 2 if none was
            asked for.
        tool_position: How far the tool may slip on the handle [m]; where a container goes n times as far as
            the one that is held, an n-th of it.
        tool_angle: How far it may turn on the handle [rad]; so, too.
        position: Beyond position limits [rad or m]: rounding, no more.
        rate: Beyond limits of velocity and acceleration, as a fraction of them.
        lag: Behind the motion, of a joint that its safety controller slows near a limit [rad or m]:
            a tenth of what it may be off at the start.
        start_position: Of the base and of prismatic joints at the start [m].
        start_angle: Of the base and of other joints at the start [rad].
        rest: Speed at the first and the last sample [rad/s or m/s].
        coupling: Between joints that must move together, and between a joint that must stand
            still and its place [rad or m].
        sideways: Sideways velocity of a differential drive [m/s].
        drift: Sideways path of a differential drive in all [m].
    """

    margin: float = 0.0
    resolution: float = 1e-4
    contact: float = USUAL_CONTACT
    depth: float = 0.002
    engaged: float = 0.003
    facing: float = math.radians(30.0)
    cone: float = math.pi / 2
    tool_position: float = 0.002
    tool_angle: float = math.radians(1.0)
    position: float = BEYOND_STOPS
    rate: float = 1e-3
    lag: float = 1e-4
    start_position: float = 1e-3
    start_angle: float = 1e-3
    rest: float = 1e-3
    coupling: float = 1e-3
    sideways: float = 0.002
    drift: float = 0.01

    def __post_init__(self) -> None:
        """Each is a number: what is none would allow everything.

        Raises:
            InputError: One is not.
        """
        for field in fields(self):
            if math.isnan(getattr(self, field.name)):
                raise InputError(f"the tolerance '{field.name}' is not a number", allowed="0 or above")

    @classmethod
    def within(cls, contact: float | None, friction: float | None = None) -> "Tolerances":
        """The usual ones, but for a finger's distance from the handle [m], or its friction, that is said.

        Raises:
            InputError: Nothing would have to hold the handle.
        """
        check_contact(contact)
        usual = cls() if contact is None else cls(contact=contact)
        if friction is None:
            return usual
        cone = math.atan(friction)
        return replace(usual, cone=cone, facing=min(usual.facing, cone))

    @classmethod
    def told(cls, given: Mapping[str, float]) -> "Tolerances":
        """Those of an artefact; `lag` and `cone`, which some do not have yet, are as ever.

        Raises:
            ValueError: Others are missing, or unknown.
        """
        if wrong := {field.name for field in fields(cls)} ^ {*given, "lag", "cone"}:
            raise ValueError(f"tolerances {sorted(wrong)}, which are missing or unknown")
        return cls(**given)

    @property
    def notes(self) -> tuple[str, ...]:
        """What a verdict has to say of them: in what fingers may, or may not, hold otherwise than usual."""
        notes = list[str]()
        if self.contact != USUAL_CONTACT:
            much, usual = 1e3 * self.contact, 1e3 * USUAL_CONTACT
            notes.append(
                f"a finger may be {much:g} mm from the handle that it holds, not {usual:g} mm: as asked"
            )
        if (friction := self.friction) is not None:
            notes.append(f"holds that need friction of more than {friction:g} are refused: as asked")
        return tuple(notes)

    @property
    def friction(self) -> float | None:
        """The coefficient of friction that was asked for [1], if one was."""
        return friction_of(self.cone)
