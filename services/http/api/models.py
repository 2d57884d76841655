"""What the verbs take: checked before anything is done; an unknown field is an error."""

from datetime import datetime
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from services.judging.messages import BasePose, Contact, DriveName, Edit, Finite, Friction, Seed, TeeName

Name = Annotated[str, Field(min_length=1, max_length=500)]
StateText = Annotated[str, Field(min_length=3, max_length=500, examples=["iai_fridge_door=open"])]
STATE = ["iai_fridge_door=open"]
EDIT = {"entity": "https://example.org/id/b/joint/iai_fridge_door_joint", "changes": {"upperLimit": 1.2}}


def _told(time: object) -> object:
    """The time is a text: a number alone would be seconds since 1970."""
    if isinstance(time, str) and ":" in time:
        return time
    raise ValueError("a text as 2026-01-31T12:00:00Z is expected")


Moment = Annotated[datetime, Field(strict=False), BeforeValidator(_told)]


class Body(BaseModel):
    """What all bodies share.

    Attributes:
        kitchen: Name; may be left out where one kitchen is served.
    """

    model_config = ConfigDict(extra="forbid", strict=True)

    kitchen: Name | None = None


class Stated(Body):
    """What every question about the kitchen in a state shares.

    Attributes:
        state: Texts as for `sdt --state`, on top of the present state.
        seconds: After which nobody waits any more.
    """

    state: list[StateText] = Field(default_factory=list, max_length=1000, examples=[STATE])
    seconds: float = Field(default=60.0, gt=0, le=600)


class Asked(Stated):
    """What every question relative to a class shares.

    Attributes:
        tee: The class that is asked about: kinematics alone, or with forces that push back.
        handle_force: Newtons allowed at the handle, for d_artic_dyn; without it, what the force data say.
    """

    tee: TeeName = "d_artic"
    handle_force: float | None = Field(default=None, gt=0, le=10_000, allow_inf_nan=False)


class Searched(Stated):
    """What every question shares about a robot, for whose answer is searched.

    Attributes:
        robot: Name; may be left out where one is served.
        friction: Coefficient with which fingers rub on handles: holds that need more are refused; without it,
            verdicts say what their holds need.
        budget: Seconds of search for each container, step or world.
    """

    robot: Name | None = None
    friction: Friction | None = None
    budget: float = Field(default=20.0, gt=0, le=600)
    seed: Seed = 0


class Performed(Asked, Searched):
    """What every question about a robot shares that is under a policy.

    Attributes:
        drive: How the base moves; without it, as the robot's hardware does.
        base: Start pose x, y [m], yaw [rad]; without it the kitchen's.
    """

    drive: DriveName | None = None
    base: BasePose | None = Field(default=None, examples=[[0.0, 0.0, 1.57]])


class CausesBody(Asked):
    """Which motions would cause the task, or does this one? No robot.

    Attributes:
        motion: Arrays by name, as in a motion file; without it, motions are made.
    """

    task: Name = Field(examples=["open:iai_fridge_door"])
    motion: dict[str, Any] | None = None


class TaskBody(Performed):
    """What becomes of a task with steps, and of the rules that hold along the way? The result is kept.

    Attributes:
        task: Name of a ready task, or one written in Turtle.
    """

    task: Annotated[str, Field(min_length=1, max_length=200_000, examples=["close_all"])]
    seconds: float = Field(default=120.0, gt=0, le=600)


class AchieveBody(Performed, CausesBody):
    """Can the robot achieve the task? Makes a motion, or verifies the one given; the verdict is kept.

    Attributes:
        robot: Name; without it, every robot that is served.
        motions: Whether the answer has the certified body motions.
        any_start: Whether a robot's motion that is given may begin anywhere, in any posture.
        contact: How far a finger may be from the handle that it holds [m]; without it, and at most, 0.002.
    """

    motions: bool = False
    any_start: bool = False
    contact: Contact | None = None


class PlaceBody(Searched):
    """Where may the base stand, so that the task is certified without moving it? Nothing is written."""

    task: Name = Field(examples=["open:iai_fridge_door"])


class WhatIfBody(Performed):
    """Would the robot achieve the task if things were otherwise? Verdicts as things are are kept.

    Attributes:
        task: Of one container; of a grid also `open`, of every container, or `open:CONTAINER,CONTAINER`.
        robot: Name; may be left out where one is served; a grid without it is about every robot.
        edits: As `sdt whatif --edit` takes them; none may name a file.
        turn: Whether the smallest share of them is searched at which the outcome turns; without edits, the
            smallest change of every kind that is looked at.
        grid: Whether each edit is an axis of alternatives (`A | B`), and every combination is judged.
        within: Seconds of CPU for a turn without edits; without it 30.
    """

    task: Name = Field(examples=["open:iai_fridge_door"])
    edits: list[Edit] = Field(default_factory=list, max_length=20, examples=[["robot:stretch"]])
    turn: bool = False
    grid: bool = False
    within: float | None = Field(default=None, ge=1, le=600)
    seconds: float = Field(default=120.0, gt=0, le=600)


class QueryBody(BaseModel):
    """A query, and how much may be judged before it is evaluated.

    Attributes:
        drive, friction: As of an achieve, for what is judged.
        budget: Seconds in all.
        limit: Cases.
    """

    model_config = ConfigDict(extra="forbid", strict=True)

    query: str = Field(min_length=1, max_length=200_000)
    drive: DriveName | None = None
    friction: Friction | None = None
    budget: float = Field(default=60.0, gt=0, le=600)
    limit: int = Field(default=20, ge=1, le=1000)


class StateBody(Body):
    """The kitchen is now in another state.

    Attributes:
        state: Texts as for `sdt --state`, on top of the present state.
    """

    state: list[StateText] = Field(min_length=1, max_length=1000, examples=[STATE])


class ObservationBody(Body):
    """Somebody has observed where joints are; it changes no state.

    Attributes:
        positions: Joint name → position [rad or m].
        time: When, with its zone.
        by: Who or what observed.
    """

    positions: dict[Name, Finite] = Field(
        min_length=1, max_length=1000, examples=[{"iai_fridge_door_joint": 0.3}]
    )
    time: Moment
    by: Name


class EditBody(BaseModel):
    """Properties of one individual become others.

    Attributes:
        entity: IRI of the individual, a joint say.
        changes: Local name of a property of `sdt.ttl` → value; null removes.
    """

    model_config = ConfigDict(extra="forbid", strict=True)

    entity: Name
    changes: dict[Name, str | bool | int | Finite | None] = Field(min_length=1, max_length=100)


class BranchBody(Body):
    """What if: a branch with other joint positions or another property; the present stays.

    Attributes:
        parent: IRI of the branch to start from; without it, the present.
        state: Texts as for `sdt --state`.
        edit: Instead of a state.
    """

    parent: Name | None = None
    state: list[StateText] = Field(default_factory=list, max_length=1000, examples=[STATE])
    edit: EditBody | None = Field(default=None, examples=[EDIT])
