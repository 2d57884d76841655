"""Results of task specifications, kept where verdicts are."""

from predicates.specification.results.record import task_record
from predicates.specification.results.result import TaskResult
from services.store.files import SavedVerdicts


def keep(saved: SavedVerdicts, result: TaskResult) -> bool:
    """The result, its twin and the verdicts of its steps are kept; whether the result is new.

    A result that is there already stays, unless it gives way to this one.
    """
    saved.add_twin(result.case.twin)
    for step in result.steps:
        saved.add(step.verdict)
    return saved.add_record(task_record(result))
