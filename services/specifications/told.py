"""What became of a task, as JSON: what the shell prints, and what services answer with."""

from typing import Any

from predicates.case import Outcome
from predicates.margins import is_bound
from predicates.record import diagnosis_json, to_json
from predicates.specification.model import Quality
from predicates.specification.quality import UNITS, unweighed
from predicates.specification.results.result import StepResult, TaskResult
from predicates.specification.rules import RuleAnswer
from sdt_kg.iri import local_name

Json = dict[str, Any]  # a JSON object

BETWEEN = (
    "each step is certified by itself: the robot begins it at its start pose, parked; its way back there "
    "from the step before is not part of any certificate"
)
ORDER = (
    "a step for every container asks them one by one, in the order of their names: that they could not be "
    "opened or closed in another order is not shown, whatever is proved of one of them"
)
NOMINAL = (
    "rules hold of the motion as certified: the container may be elsewhere by what the tool may slip (2 mm)"
)


def result_json(result: TaskResult) -> Json:
    """The result as a JSON object, in it the verdict of each step as `predicates.record.to_json` has it."""
    quality = result.specification.quality
    notes = [BETWEEN] if result.of > 1 else []
    every = any(each.container is None for each in result.specification.steps)
    if every and result.of > 1 and result.outcome is Outcome.NOT_CERTIFIED:
        notes.append(ORDER)
    notes += _unweighed(result)
    return {
        "task": result.specification.label,
        "iri": result.specification.iri,
        "result": result.iri,
        "outcome": result.outcome.value,
        "steps": [_step_json(step, quality) for step in result.steps],
        "steps_of": result.of,
        "rules": [_rule_json(each) for each in result.rules],
        "rules_not_judged": len(result.specification.rules) - len(result.rules),
        "first_broken": None if result.broken is None else _rule_json(result.broken),
        "quality": None
        if quality is None
        else {
            "name": quality.value,
            "value": result.value,
            "unit": UNITS[quality],
            "at_least": _is_bound(quality, result.value),
        },
        "diagnoses": [diagnosis_json(each) for each in result.diagnoses],
        "notes": [*notes, *([NOMINAL] if result.rules else [])],
        "seconds": round(result.seconds, 3),
    }


def _unweighed(result: TaskResult) -> list[str]:
    """That J, where it is work, knows nothing of what some bodies weigh."""
    robot = result.case.robot
    if result.specification.quality is not Quality.WORK or not isinstance(robot, str):
        return []
    names = unweighed(result.case.twin.mechanism(robot))
    if not names:
        return []
    so = "it has no value" if result.value is None else "they count as weightless in it"
    return [f"mechanical work: the robot's model gives no mass of {', '.join(names)}: {so}"]


def _is_bound(quality: Quality | None, value: float | None) -> bool:
    """Whether a value of J is a clearance up to which was looked, so that nothing nearer was found."""
    return quality is Quality.CLEARANCE and value is not None and is_bound(value)


def _step_json(step: StepResult, quality: Quality | None) -> Json:
    return {
        "step": str(step.request),
        "outcome": step.verdict.outcome.value,
        "seed": step.seed,
        "searches": step.tried,
        "compared": step.compared,
        "value": step.value,
        "at_least": _is_bound(quality, step.value),
        "verdict": to_json(step.verdict),
    }


def _rule_json(answer: RuleAnswer) -> Json:
    start = dict(answer.state.positions) if answer.state is not None else {}
    return {
        "rule": answer.rule,
        "standing": answer.standing.value,
        "how": answer.how,
        "step": answer.step,
        "time": answer.time,
        "state": {local_name(joint): at for joint, at in start.items() if at} if start else None,
        "diagnosis": None if answer.diagnosis is None else diagnosis_json(answer.diagnosis),
    }
