"""A random front that a TIAGo++ opens from where its base stands, and who judges its motion."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from predicates.case import Outcome, Verdict
from sdt_kg.annotation import Drive
from sdt_kg.motion import BodyMotion
from services.app import Policy, Service, load
from services.motions import arrays_of, motion_of
from tests.soak.annotated import Note
from tests.soak.audit import Stage, audited
from tests.soak.doors import draw, write
from tests.soak.test_audit import COARSE, NO_LESS, bundled, machine

HERE = (0.0, 0.0, 0.0)
BUDGET = 60.0  # [s]


def fixtures(number: int) -> tuple[Any, Any, Any]:
    """Where the front of that number lies, the Law over it, and what it finds: `path`, `service`, `found`."""

    @pytest.fixture(scope="module")
    def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
        return write(draw(np.random.default_rng(number)), tmp_path_factory.mktemp("front"), "front")

    @pytest.fixture(scope="module")
    def service(path: Path) -> Service:
        return asked(path)

    @pytest.fixture(scope="module")
    def found(service: Service) -> Verdict:
        (verdict,) = service.achieve("open:front_door")
        return verdict

    return path, service, found


def asked(path: Path, budget: float = BUDGET) -> Service:
    """The Law over the front, the base standing."""
    return load(path, ["tiago_dual"], policy=Policy(Drive.FIXED, HERE, budget))


def body_of(verdict: Verdict) -> BodyMotion:
    """The motion that is certified."""
    assert verdict.outcome is Outcome.CERTIFIED, verdict.diagnoses
    assert verdict.can_perform is not None
    body = verdict.can_perform.case.body_motion
    assert isinstance(body, BodyMotion)
    return body


def check_by_other_code(body: BodyMotion, path: Path) -> None:
    """Who shares no code with planner and certifier finds no rule broken."""
    robot = (bundled("robots", "tiago_dual", suffix) for suffix in (".urdf", ".ttl"))
    stage = Stage(
        machine(path, True),
        machine(next(robot), False),
        Note(next(robot)),
        {},
        {},
        "front_door_joint",
        "front_handle",
        "open",
        "fixed",
        HERE,
    )
    slack = audited(stage, arrays_of(body), COARSE).slack
    assert {rule: one for rule, one in slack.items() if one < NO_LESS} == {}


def check_found_again(body: BodyMotion, path: Path) -> None:
    """The same seed gives the same motion, with more time too."""
    (verdict,) = asked(path, 2 * BUDGET).achieve("open:front_door")
    one, other = arrays_of(body), arrays_of(body_of(verdict))
    assert one.keys() == other.keys()
    for name in one:
        np.testing.assert_array_equal(one[name], other[name])


def check_given_again(body: BodyMotion, service: Service) -> None:
    """Certification accepts it again when somebody gives it."""
    (verdict,) = service.achieve("open:front_door", motion=motion_of(arrays_of(body), service.twin))
    assert verdict.outcome is Outcome.CERTIFIED, verdict.diagnoses
