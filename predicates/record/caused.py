"""An answer of Causes as a JSON object: what the shell prints, and what services answer with."""

from typing import Any

from predicates.case import Answer, Kind
from predicates.meant import moved_by, unit_of
from predicates.record.report import diagnosis_json
from sdt_kg.iri import local_name
from sdt_kg.motion import Motion
from sdt_kg.task import Task

Json = dict[str, Any]  # JSON object


def task_json(task: Task) -> Json:
    """A request by names."""
    container = task.container if isinstance(task.container, str) else ""
    return {"task": task.verb.value, "container": local_name(container)}


def caused_json(answer: Answer, tee: str) -> Json:
    """The answer, relative to the class of that name: outcome, the container's way, figures and reasons."""
    case = answer.case
    row: Json = task_json(case.task) if isinstance(case.task, Task) else {}
    diagnoses = [diagnosis_json(each) for each in answer.diagnoses]
    row["outcome"] = _outcome(answer)
    if isinstance(case.motion, Motion) and not case.motion.is_poses:
        values, times = case.motion.values[:, 0], case.motion.times
        row |= {"start": float(values[0]), "end": float(values[-1]), "duration": float(times[-1] - times[0])}
        moved = moved_by(case.twin, case.motion.of)
        row["unit"] = unit_of(case.twin, moved[0]) if moved else ""
    row |= {"figures": dict(answer.figures), "notes": list(answer.notes)}
    return row | {"diagnoses": diagnoses, "tee_class": tee}


def _outcome(answer: Answer) -> str:
    if answer.holds:
        return "causes"
    kinds = {each.kind for each in answer.diagnoses}
    return "out_of_scope" if Kind.OUT_OF_SCOPE in kinds else "does_not_cause"
