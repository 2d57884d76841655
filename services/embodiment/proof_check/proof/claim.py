"""What a proof claims: of which models and state, of which holds, and of which bodies."""

import math
from dataclasses import dataclass

from sdt_kg.annotation import Drive
from sdt_kg.iri import Iri
from sdt_kg.twin import Container, Twin
from services.embodiment.certify.tolerances import Tolerances

Start = tuple[float, float, float]

PITCH, TILT, DEPTH = math.radians(80.0), math.radians(50.0), 0.016
"""[rad, rad, m] Of grasps of a bar at most: those of the listed ones."""
GRASPS = (
    "grasps that close across a bar of the handle, the hand coming from the front: pitched about the bar by "
    f"at most {math.degrees(PITCH):.0f}°, tilted along it by at most {math.degrees(TILT):.0f}°, the bar amid "
    f"the fingers at most {1000 * DEPTH:g} mm before or behind the tool's origin, anywhere along it that "
    "leaves the fingers on it; a hold that is aslant, or of another part of the handle, is not refuted"
)


@dataclass(frozen=True, slots=True)
class Timing:
    """A motion of the container that has to keep its times: increasing times [s], values [rad or m]."""

    times: tuple[float, ...]
    values: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Bar:
    """A bar of a handle, in the frame of the joint that carries it.

    Of its grasps see `grasps.py`, and of what is looked at anew in it `bars.py`.

    Attributes:
        centre: Its middle [m].
        along, outward: Unit vectors along it, and away from the front.
        reach: How far from there along it the tool has it at most [m].
    """

    centre: tuple[float, float, float]
    along: tuple[float, float, float]
    outward: tuple[float, float, float]
    reach: float

    def __str__(self) -> str:
        middle, along, outward = (
            "({:.4f}, {:.4f}, {:.4f})".format(*(round(x, 4) + 0.0 for x in each))  # no -0.0000
            for each in (self.centre, self.along, self.outward)
        )
        return (
            f"the bar has its middle at {middle} m in the frame of the joint that carries it, and lies along "
            f"{along}; it is grasped up to {1000 * self.reach:.0f} mm from there, from the side of {outward}"
        )


@dataclass(frozen=True, slots=True)
class Claim:
    """That no motion which certification accepts takes the container past the refuted values.

    With a timing: that none moves it so in these times.

    Attributes:
        models: Environment, then robot: IRI and content hash.
        state: Joint IRI → position [rad or m] in which the motion begins.
        span: Values [rad or m] all of which the container has to pass.
        start: Base pose x, y [m], yaw [rad] of a fixed base; any pose is meant otherwise.
        within: How far the tool's origin is at most from a box about the handle when it is grasped, of the
            holds that are meant [m]; None: every hold that certification accepts is.
        declared: Whether the robot's bodies are its collision shapes, which may be more than the bodies.
        handle: By which of its handles, where it is not the container's own.
        one_hold: Whether motions alone are meant that hold it once, from when it begins to move to when it
            stops for good; else it may be let go and held anew.
        bar: Of which a set of grasps is meant, and no other hold; None: see `within`.
    """

    models: tuple[tuple[Iri, str], tuple[Iri, str]]
    state: dict[Iri, float]
    container: Iri
    span: tuple[float, float]
    drive: Drive
    start: Start
    tolerances: Tolerances
    timing: Timing | None = None
    within: float | None = None
    declared: bool = False
    handle: Iri | None = None
    one_hold: bool = False
    bar: Bar | None = None

    @property
    def partial(self) -> bool:
        """Whether it says less than that nothing can be certified, of this robot however it is modelled."""
        return self.within is not None or self.declared or self.one_hold or self.bar is not None

    @property
    def bodies(self) -> str:
        """What of the robot is solid, in words."""
        if not self.declared:
            return "the robot's bodies (sdt:hasCore)"
        return (
            "the robot's collision shapes, which certification takes for its bodies (they may be larger: "
            "with closer ones what is refuted might be certified)"
        )

    @property
    def about(self) -> str:
        """Whose collision geometry tells what holds are, in words."""
        if self.bar is not None:
            return "of the handle, which has the bar"
        return "of the fingers and the handle, which a hold is about"

    @property
    def holds(self) -> str:
        """Those that are meant, in words."""
        if self.bar is not None:
            return f"{GRASPS}; {self.bar}"
        if self.within is None:
            return (
                "every hold that certification accepts, two fingers on both sides of the handle anywhere "
                "along it, at any angle"
            )
        return (
            f"holds with the handle, or a box about it, at most {1000 * self.within:g} mm from the tool's "
            "origin when it is grasped, at any angle; a hold farther out on the fingers, or deeper between "
            "them, is not refuted"
        )


def claim_about(  # noqa: PLR0913, PLR0917  # the parts of a claim
    twin: Twin,
    robot: Iri,
    container: Container,
    span: tuple[float, float],
    drive: Drive,
    start: Start,
    timing: Timing | None = None,
    within: float | None = None,
    declared: bool = False,
    one_hold: bool = False,
    bar: Bar | None = None,
) -> Claim:
    """The claim about a robot and a container of a twin, by its handle, with this version's tolerances."""
    models = ((twin.environment, twin.content_hash(twin.environment)), (robot, twin.content_hash(robot)))
    about = models, dict(twin.state), container.iri, span, drive, start, Tolerances()
    return Claim(*about, timing, within, declared, other_handle(twin, container), one_hold, bar)


def other_handle(twin: Twin, container: Container) -> Iri | None:
    """By which of its handles the container is meant, where it is not its own."""
    return None if container.handle == twin.container(container.iri).handle else container.handle
