"""Mode 3: which known task an observed motion satisfies, and whether Φ replays it."""

from dataclasses import dataclass

from predicates.case import Case, Verdict
from predicates.law import law
from predicates.oracle import Physics
from sdt_kg.motion import Motion
from sdt_kg.task import Task
from sdt_kg.twin import Twin


@dataclass(frozen=True, slots=True, eq=False)
class Explanation:
    """What the Law says of an observed motion.

    Attributes:
        verdicts: One for each request that is met afterwards and was not before, or one refusal.
        tasks: The tasks whose request is met and which Φ confirms that the motion causes.
        replayed: Whether Φ replays the motion, whatever it is good for.
    """

    verdicts: tuple[Verdict, ...]
    tasks: tuple[Task, ...]
    replayed: bool


def explain(twin: Twin, motion: Motion, physics: Physics) -> Explanation:
    """The Law with the task unknown; no robot is asked."""
    verdicts = tuple(law(Case(twin, motion=motion), physics))
    tasks = tuple(
        each.case.task
        for each in verdicts
        if isinstance(each.case.task, Task)
        and each.satisfies_request is not None
        and each.satisfies_request.holds
        and each.causes is not None
        and each.causes.holds
    )
    replayed = any(each.causes is not None and each.causes.holds for each in verdicts)
    return Explanation(verdicts, tasks, replayed)
