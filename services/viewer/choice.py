"""What one person has chosen, as the question that it is; and the link that opens the page on it."""

from dataclasses import dataclass, field
from itertools import chain, count
from typing import Final
from urllib.parse import quote, unquote

from sdt_kg.load import model_name
from sdt_kg.twin import Twin
from services.viewer.judging.question import Place, Question

OBSTACLE: Final = "obstacle"
"""Name of the box that a person puts into the kitchen, where nothing there is called so."""
NAMES: Final = ("kitchen", "robot", "task", "tee", "drive", "base", "friction", "state")
"""What a link can say."""


@dataclass(frozen=True, slots=True)
class Obstacle:
    """A box.

    Attributes:
        size: Its sides x, y, z [m].
        x, y, yaw: Where it stands [m, m, rad].
        bottom: Above the floor [m].
        name: That nothing in the kitchen has.
    """

    size: tuple[float, float, float]
    x: float
    y: float
    yaw: float = 0.0
    bottom: float = 0.0
    name: str = OBSTACLE

    def edit(self) -> str:
        """As an edit of the twin."""
        sides = ",".join(f"{each:.4g}" for each in self.size)
        middle = self.bottom + self.size[2] / 2
        return f"box:{self.name}={sides}@{self.x:.4f},{self.y:.4f},{middle:.4f},{self.yaw:.4f}"


@dataclass(slots=True)
class Choice:
    """What is chosen.

    Attributes:
        kitchen, robot: Bundled names or paths.
        friction: Coefficient with which fingers rub on handles [1]; None: verdicts say what is needed.
        opened: Container → position of its actuated joint [rad or m], where it is not closed.
        motion: Path of the motion that is given; empty: to be found.
    """

    kitchen: str
    robot: str
    verb: str = "open"
    container: str = ""
    tee: str = "D_artic"
    drive: str | None = None
    base: tuple[float, float, float] | None = None
    budget: float = 20.0
    friction: float | None = None
    opened: dict[str, float] = field(default_factory=dict[str, float])
    obstacle: Obstacle | None = None
    motion: str = ""
    any_start: bool = False

    def place(self, *, edited: bool = True) -> Place:
        """The world, with or without the obstacle."""
        states = tuple(f"{name}={value!r}" for name, value in sorted(self.opened.items()))
        edits = (self.obstacle.edit(),) if edited and self.obstacle is not None else ()
        return Place(self.kitchen, self.robot, states, edits)

    def question(self) -> Question:
        """What *Check* asks."""
        return Question(
            place=self.place(),
            task=f"{self.verb}:{self.container}",
            tee=self.tee,
            drive=self.drive,
            base=self.base,
            budget=self.budget,
            friction=self.friction,
            motion=self.motion,
            any_start=self.any_start and bool(self.motion),
        )

    def link(self) -> str:
        """Path and query that open the page on the same case, but for obstacle and files of one's own."""
        parts = {
            "kitchen": model_name(self.kitchen),
            "robot": model_name(self.robot),
            "task": f"{self.verb}:{self.container}",
            "tee": self.tee,
            "drive": self.drive or "",
            "base": "" if self.base is None else ",".join(repr(float(each)) for each in self.base),
            "friction": "" if self.friction is None else repr(self.friction),
            "state": ",".join(self.place().states),
        }
        query = "&".join(f"{name}={quote(value, safe=':,')}" for name, value in parts.items() if value)
        return f"/case?{query}"


def free_name(twin: Twin) -> str:
    """What a box can be called in the twin's kitchen."""
    mechanism = twin.mechanism(twin.environment)
    taken = {each.name for each in (*mechanism.bodies, *mechanism.joints)}
    names = chain([OBSTACLE], (f"{OBSTACLE}{index}" for index in count(2)))
    return next(name for name in names if not {name, f"{name}_obstacle"} & taken)


def wanted(path: str) -> dict[str, str]:
    """What the path of a connection says of the case, `/case/kitchen=b;robot=pr2`: name → text."""
    found: dict[str, str] = {}
    for part in path.rpartition("/")[2].split(";"):
        name, equals, value = part.partition("=")
        if equals and name in NAMES:
            found[name] = unquote(value)
    return found
