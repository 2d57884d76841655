"""Modes agree in every TEE class: what generation makes, verification certifies and explanation names.

A fixed sample: both classes, several types of mechanism, both verbs, half-open starts. What a real
robot does is in tests/soak/test_modes.py.
"""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from predicates.case import Case, Outcome
from predicates.law import law
from predicates.oracle import Embodiment, Physics
from predicates.record import to_json
from sdt_kg.task import UNKNOWN, Task, Verb
from sdt_kg.twin import Twin
from services.dynamics.oracle import Dynamics
from services.dynamics.robot.bearing import Bearing
from services.physics.oracle import Kinematics
from tests.services.dynamics.forced import forced_twin, light_folding_twin
from tests.small import small_twin
from tests.small.lift import Lift

PER_MECHANISM = 4
"""[1] Starts and verbs that are drawn for each mechanism."""


@dataclass(frozen=True)
class Class:
    """A TEE class with oracles, and the containers that lie in it."""

    twin: Twin
    physics: Physics
    embodiment: Embodiment
    containers: tuple[str, ...]


CLASSES = {
    "D_artic": Class(
        small_twin("a", ("pr2",)), Kinematics(), Lift(), ("low_drawer", "side_door", "folding_door")
    ),
    "D_artic, kitchen b": Class(small_twin("b", ("pr2",)), Kinematics(), Lift(), ("top_drawer", "oven_door")),
    "D_artic_dyn": Class(forced_twin(("pr2",)), Dynamics(), Bearing(Lift()), ("top_drawer", "oven_door")),
}
CLASSES["D_artic_dyn, a folding door"] = Class(
    light_folding_twin(("pr2",)), Dynamics(), Bearing(Lift()), ("folding_door",)
)
SAMPLE = [(name, container) for name, each in CLASSES.items() for container in each.containers]


@pytest.mark.parametrize(("name", "container"), SAMPLE)
def test_modes_agree_on_small_models(name: str, container: str) -> None:
    in_class = CLASSES[name]
    rng, one = np.random.default_rng(len(name) + len(container)), in_class.twin.container(container)
    certified = 0
    for share in (0.0, 1.0, *rng.uniform(0, 1, PER_MECHANISM - 2)):
        twin = in_class.twin.at({one.joint: float(share) * one.upper})
        for verb in Verb:
            certified += agreed(twin, Task(verb, one.iri), in_class.physics, in_class.embodiment)
    assert certified >= 2, "a sample that certifies nothing compares nothing"


def agreed(twin: Twin, task: Task, physics: Physics, embodiment: Embodiment) -> bool:
    """Whether generation certified it; then verification and explanation must say so, too."""
    (robot,) = twin.robots
    (made,) = law(Case(twin, robot=robot, task=task), physics, embodiment)
    if made.outcome is not Outcome.CERTIFIED:
        assert made.diagnoses
        return False
    with_motion = Case(twin, robot=robot, task=task, motion=made.case.motion)
    with_body = Case(twin, robot=robot, task=task, body_motion=made.case.body_motion)
    for case in (with_motion, with_body):
        (verified,) = law(case, physics, embodiment)
        assert verified.outcome is Outcome.CERTIFIED, to_json(verified)
        (explained,) = law(replace(case, task=UNKNOWN), physics, embodiment)
        assert explained.case.task == task
        assert explained.iri == verified.iri
    return True
