"""One question in one or several worlds: a kitchen, a robot, a policy, and edits of them."""

from dataclasses import dataclass, replace

from predicates.case import Outcome, Verdict
from predicates.record import StoredVerdict
from sdt_kg.errors import InputError
from sdt_kg.iri import Iri
from sdt_kg.motion import BodyMotion, Motion
from services.app import DEFAULT_BUDGET, load
from services.physics.model import Scene
from services.reports.studies.judged import policy_of
from services.requests import listed_states, parse_base
from services.store.files import SavedVerdicts
from services.whatif import Change, World, parse_change


@dataclass(frozen=True, slots=True)
class Question:
    """What is asked in every world.

    Attributes:
        task: One container, `open:NAME` or `close:NAME`.
        ground: The world as it is: verdicts about it are kept.
        saved: Where verdicts are recalled from and kept.
        edited: The same for edited worlds, whose models have the names of those as they are: kept among
            the others, such a verdict would be read as one about the kitchen itself.
    """

    task: str
    ground: World
    saved: SavedVerdicts
    edited: SavedVerdicts

    def judged(self, world: World, motion: Motion | BodyMotion | None = None) -> Verdict:
        """The verdict in a world, of a motion if one is given; recalled if it was judged before.

        Raises:
            InputError: The task is about no container, or about several.
        """
        service = replace(world.service, recall=self._recalled)
        verdicts = list(service.achieve(self.task, world.robot_iri, motion))
        if len(verdicts) != 1:
            raise InputError(
                f"'{self.task}' is {len(verdicts)} questions",
                allowed="one container: open:NAME or close:NAME",
            )
        if not verdicts[0].stored and world is self.ground:
            self.saved.add_twin(service.twin)
            self.saved.add(verdicts[0])
        elif not verdicts[0].stored:
            self.edited.add(verdicts[0])
        return verdicts[0]

    def _recalled(self, verdict: Iri) -> StoredVerdict | None:
        stored = self.saved.stored(verdict)
        return self.edited.stored(verdict) if stored is None else stored


def world_of(  # noqa: PLR0913 - the options of sdt whatif
    kitchen: str,
    robot: str,
    *,
    state: str = "",
    base: str = "",
    drive: str = "",
    friction: str = "",
    budget: float = DEFAULT_BUDGET,
) -> World:
    """The world as it is.

    Raises:
        InputError: A name, state, base, drive or friction that does not exist.
    """
    policy = policy_of(drive, parse_base(base or None), budget, friction)
    states = listed_states(state)
    return World(load(kitchen, [robot], state=states, policy=policy), robot)


def changes_of(edits: str) -> tuple[Change, ...]:
    """The changes of a text, separated by semicolons.

    Raises:
        InputError: One of them is no edit.
    """
    return tuple(parse_change(each.strip()) for each in edits.split(";") if each.strip())


def scene_of(world: World) -> Scene:
    """Kitchen and robot of a world as one scene."""
    return Scene(world.service.twin, world.robot_iri)


def certified_motion(verdict: Verdict) -> BodyMotion | None:
    """The body motion of a verdict that certifies one."""
    motion = verdict.case.body_motion
    return motion if verdict.outcome is Outcome.CERTIFIED and isinstance(motion, BodyMotion) else None
