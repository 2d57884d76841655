"""What decides CanPerform beyond twin, robot and task."""

import math
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from sdt_kg.iri import Iri

if TYPE_CHECKING:
    from sdt_kg.twin import Twin

DEFAULT_BUDGET: Final = 20.0
"""[s] How long CanPerform searches for one container before it gives up."""
DEFAULT_WITHIN: Final = 30.0
"""[s] Of CPU for each process that looks for changes which nobody names."""

SEEDS: Final = 2**63
"""How many seeds there are: they are kept as integers of 64 bits."""


USUAL_CONTACT: Final = 0.002
"""[m] How far a finger may be from the handle that it holds, unless somebody asks for something else."""

MOST_CONTACT: Final = USUAL_CONTACT
"""[m] The most that may be asked for: as far as the tool may slip. Less can be asked for, and is stricter."""
NOT_HELD: Final = "fingers that are farther from a handle do not hold it: let them close on it"
"""Why no more may be asked for, and what to do."""

LEAST_FRICTION: Final = 0.01
MOST_FRICTION: Final = 10.0
"""[1] Coefficients of friction that may be asked for: how faces look is told to some thousandths."""


def check_contact(contact: float | None) -> None:
    """Fingers that may be so far from the handle [m] hold it; None is as far as usual.

    Raises:
        InputError: Nothing would have to hold it, or it is no distance.
    """
    if contact is not None and not 0 <= contact <= MOST_CONTACT:
        what = f"a finger may be {contact:g} m from what it holds"
        raise InputError(what, allowed=f"0 to {MOST_CONTACT:g} m", remedy=NOT_HELD)


def friction_of(cone: float) -> float | None:
    """The coefficient [1] whose cone of friction is that wide from its axis [rad]; None of a half space."""
    return None if cone == math.pi / 2 else float(f"{math.tan(cone):.12g}")


def told_friction(tolerances: str) -> float | None:
    """The same of the text of tolerances that a verdict has among its inputs; None where it says none."""
    cone = _told(tolerances, "cone")
    return None if cone is None else friction_of(cone)


def told_contact(tolerances: str) -> float | None:
    """How far a finger may be from what it holds [m], of the same text; None where it says none."""
    return _told(tolerances, "contact")


def _told(tolerances: str, name: str) -> float | None:
    """A number in the text of tolerances; None where it has none of that name."""
    found = re.search(rf"\b{name}=(\d+(?:\.\d+)?(?:e-?\d+)?)[,)]", tolerances)
    return float(found[1]) if found else None


@dataclass(frozen=True)
class Policy:
    """How the robot moves, where it starts, and how long is searched.

    Attributes:
        drive: How the base moves; None takes the robot's own.
        base: Start pose x, y [m], yaw [rad]; None takes the kitchen's, turned towards the handle.
        budget: Seconds of CPU for the search of each container.
        seed: Of the search.
        any_start: Whether a body motion that is given may begin anywhere, in any posture.
        contact: How far a finger may be from the handle that it holds [m]; None takes the certifier's.
        friction: The coefficient with which fingers rub on handles [1]: holds that need more are refused.
            None: a certificate says what its holds need.

    Raises:
        InputError: A drive, seed, budget or tolerance that is none, or a start where none is demanded.
    """

    drive: Drive | None = None
    base: tuple[float, float, float] | None = None
    budget: float = DEFAULT_BUDGET
    seed: int = 0
    any_start: bool = False
    contact: float | None = None
    friction: float | None = None

    def __post_init__(self) -> None:
        if not 0 <= self.seed < SEEDS:
            raise InputError(f"a seed of {self.seed}", allowed="a whole number, 0 or more, below 2^63")
        if not self.budget >= 0:
            raise InputError(f"a budget of {self.budget:g} s", allowed="0 s or more")
        if self.drive is not None and not isinstance(self.drive, Drive):
            raise InputError(f"'{self.drive}' is no Drive", allowed=", ".join(map(str, Drive)))
        check_contact(self.contact)
        if self.friction is not None and not LEAST_FRICTION <= self.friction <= MOST_FRICTION:
            what = f"fingers that rub with a coefficient of friction of {self.friction:g}"
            raise InputError(what, allowed=f"{LEAST_FRICTION:g} to {MOST_FRICTION:g}")
        if self.any_start and self.base is not None:
            what = "a start of the base, for a motion that may begin anywhere"
            raise InputError(what, allowed="one of base and any_start")
        if self.base is not None:
            from services.motions.units import check_start  # noqa: PLC0415 - seldom given

            check_start(self.base)

    def drive_of(self, twin: "Twin", robot: Iri) -> Drive:
        """How the base of a robot moves: as is said here, or as its own does."""
        return self.drive or twin.robot(robot).drive
