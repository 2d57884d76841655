"""Modes agree in every TEE class, on a real robot: what generation makes, verification certifies.

Where forces leave it open or refuse, so does verification of the motion that is certified without them.
"""

from dataclasses import replace

import pytest

from predicates.case import Case, Outcome
from predicates.law import law
from predicates.record import to_json
from services import load
from services.app import Policy, Service

REAL = {
    "b": ("sink_area_left_middle_drawer_main", "iai_fridge_door", "oven_area_oven_door"),
    "a": ("cabinet9_drawer_middle",),
}
"""Drawers, doors about upright hinges, doors that open downwards."""


@pytest.mark.oracle
@pytest.mark.slow
@pytest.mark.parametrize("tee", ["d_artic", "d_artic_dyn"])
@pytest.mark.parametrize(("kitchen", "container"), [(k, each) for k, names in REAL.items() for each in names])
def test_modes_agree_on_a_real_robot(kitchen: str, container: str, tee: str) -> None:
    service = load(kitchen, ["pr2"], policy=Policy(budget=20.0))
    service = service.with_forces() if tee == "d_artic_dyn" else service
    task = f"open:{container}"
    (made,) = service.achieve(task)
    if made.outcome is Outcome.CERTIFIED:
        (verified,) = service.achieve(task, motion=made.case.body_motion)
        assert verified.outcome is Outcome.CERTIFIED, to_json(verified)
        case = Case(service.twin, body_motion=made.case.body_motion)
        (explained,) = law(case, service.physics, service.embodiment)
        assert (explained.outcome, explained.case.task.container) == (made.outcome, made.case.task.container)
        return
    assert made.diagnoses
    assert tee == "d_artic_dyn", "each of them opens where forces do not count"
    assert refused_with_its_motion(service, task) is made.outcome


def refused_with_its_motion(service: Service, task: str) -> Outcome:
    """What verification says of the body motion that is certified where forces do not count."""
    (free,) = replace(service, oracles=None).achieve(task)
    assert free.outcome is Outcome.CERTIFIED
    (verified,) = service.achieve(task, motion=free.case.body_motion)
    return verified.outcome
