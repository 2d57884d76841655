"""What each tool takes; an argument that a tool does not know is refused, never ignored."""

from typing import Annotated, Any, Final

from pydantic import BaseModel, ConfigDict, Field, field_validator

from services.judging.messages import BasePose, Contact, Friction, Seed, TeeName

MOST_BUDGET: Final = 120.0
"""[s] Of search that a call may ask for."""

_SAMPLED: Final = ("robot", "base", "kitchen")
FORMS: Final = {
    "joint": {"joint", "times", "values", "velocities", "timed"},
    "frame": {"frame", "times", "poses", "timed"},
    "robot_positions": {
        *("times", "base", "robot", "gripper", "base_frame", "phase_names", "phase_starts"),
        *("robot_joint_names", "kitchen_joint_names", "robot_positions", "kitchen_positions"),
        *(f"{part}_velocities" for part in _SAMPLED),
    },
}
"""Array that says what kind of motion it is → the arrays of such a motion."""

Kitchen = Annotated[str | None, Field(description="Name of the kitchen; may be left out where there is one.")]
Robot = Annotated[str | None, Field(description="Name of the robot; may be left out where there is one.")]
States = Annotated[
    list[str],
    Field(
        max_length=200,
        description="Where joints or containers are at the start: JOINT=VALUE [rad or m], CONTAINER=open, "
        "all=closed. Without it everything is as it was loaded.",
    ),
]


class Arguments(BaseModel):
    """Of one tool."""

    model_config = ConfigDict(extra="forbid", strict=True)


class Lookup(Arguments):
    """What to look for."""

    name: str = Field(min_length=1, max_length=200, description="Name, label or IRI, or a part of it.")
    kitchen: Kitchen = None


class Schema(Arguments):
    """Which part of the vocabulary."""

    term: str | None = Field(
        None, max_length=200, description="One term, hasHandle say; without it: all names."
    )


class Examples(Arguments):
    """Which examples."""

    tool: str | None = Field(None, description="Only those of this tool.")


class Select(Arguments):
    """A query."""

    query: str = Field(
        min_length=1, max_length=20_000, description="SPARQL SELECT or ASK; usual prefixes are known."
    )
    rows: int = Field(30, ge=1, le=200, description="Rows to show; the number of all is told.")


class ListScopes(Arguments):
    """Which kitchen and robot."""

    kitchen: Kitchen = None
    robot: Robot = None


class Diagnose(Arguments):
    """Which verdict."""

    verdict: str = Field(min_length=1, max_length=300, description="IRI, or the beginning of its hash.")
    section: str | None = Field(None, description="One section of the story, Reasons say; without it: all.")


class Searched(Arguments):
    """What every search takes."""

    task: str = Field(
        min_length=1, max_length=300, description="open:CONTAINER or close:CONTAINER.", examples=["open:NAME"]
    )
    kitchen: Kitchen = None
    robot: Robot = None
    state: States = Field(default_factory=list)
    budget: float = Field(20.0, gt=0, le=MOST_BUDGET, description="Seconds of search before giving up.")
    seed: Seed = Field(0, description="Of the search.")
    friction: Friction | None = Field(
        None, description="Coefficient with which fingers rub on handles: holds that need more are refused."
    )


class Place(Searched):
    """A case without a base: where may that stand?"""


class Judged(Searched):
    """What every judgement takes."""

    drive: str | None = Field(
        None, description="How the base moves: omni, differential or fixed; default: as its hardware does."
    )
    base: BasePose | None = Field(
        None, description="Start of the base: x, y [m], yaw [rad]; default: the kitchen's."
    )
    tee: TeeName = Field(
        "d_artic",
        description="The class that verdicts are relative to: d_artic_dyn has forces that push back.",
    )
    handle_force: float | None = Field(
        None,
        gt=0,
        le=10_000,
        allow_inf_nan=False,
        description="Newtons allowed at the handle, for d_artic_dyn; default: what the force data say.",
    )


class VerifyMotion(Judged):
    """A case with a motion."""

    motion: dict[str, Any] = Field(
        description="Arrays by name, SI units. A container's: joint (text), times (T), values (T), timed "
        "(bool: false lets the robot be slower); or frame, times, poses (T,7: x y z, quaternion xyzw). A "
        "robot's: times (T), base (T,3: x y yaw), robot_joint_names (n), robot_positions (T,n); "
        "robot_velocities, base_velocities, kitchen_joint_names, kitchen_positions, gripper may be there."
    )

    @field_validator("motion")
    @classmethod
    def _knows_each_array(cls, motion: dict[str, Any]) -> dict[str, Any]:
        """A misspelled one would be a verdict about another motion."""
        form = "robot_positions" if "base" in motion else next((each for each in FORMS if each in motion), "")
        known = FORMS.get(form, set().union(*FORMS.values()))
        unknown = sorted(set(motion) - known)
        if unknown:
            raise ValueError(f"no array '{unknown[0][:80]}' in such a motion: {', '.join(sorted(known))}")
        return motion

    any_start: bool = Field(
        False, description="Whether a robot's motion may begin anywhere, in any posture, not only parked."
    )
    contact: Contact | None = Field(
        None, description="How far a finger may be from the handle that it holds [m]; default, most: 0.002."
    )


class WhatIf(Judged):
    """A case and what is otherwise."""

    task: str = Field(
        min_length=1,
        max_length=300,
        description="open:CONTAINER or close:CONTAINER; with grid also open (every container) or open:A,B.",
        examples=["open:NAME"],
    )
    edits: list[str] = Field(
        default_factory=list,
        max_length=20,
        description="As drive:fixed, robot:stretch, handle:CONTAINER=0,0,0.1, move:JOINT=0.3, "
        "set:JOINT.upperLimit=0.2, base:X,Y,YAW, jam:CONTAINER, without:…; a wrong one is told all kinds.",
    )
    turn: bool = Field(
        False,
        description="Whether the smallest share of the edits is searched at which the outcome turns; without "
        "edits: the smallest change of every kind that turns it, looked for.",
    )
    grid: bool = Field(
        False,
        description="Whether each edit is an axis of alternatives, 'drive:omni | robot:stretch', and every "
        "combination is judged; without robot for every robot.",
    )
    within: float | None = Field(
        None, ge=1, le=MOST_BUDGET, description="Seconds of CPU for a turn without edits; default: 30."
    )
