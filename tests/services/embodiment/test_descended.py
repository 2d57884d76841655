"""A door that only holds found by descent open, from where the base stands."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from predicates.case import Outcome, Verdict
from sdt_kg.annotation import Drive
from sdt_kg.motion import BodyMotion
from sdt_kg.task import UNKNOWN
from services.app import Policy, Service, load
from services.embodiment.oracle import WholeBody
from services.motions import arrays_of, motion_of
from tests.soak.annotated import Note
from tests.soak.audit import Stage, audited
from tests.soak.doors import draw, write
from tests.soak.test_audit import COARSE, NO_LESS, bundled, machine

pytestmark = pytest.mark.oracle

HERE = (0.0, 0.0, 0.0)
NO_HAND_FITS = 40
"""A door that tips over, 0.74 m away: about its bar no listed or bred grasp has room at the end."""
BUDGET = 60.0  # [s]


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write(draw(np.random.default_rng(NO_HAND_FITS)), tmp_path_factory.mktemp("front"), "front")


@pytest.fixture(scope="module")
def service(path: Path) -> Service:
    return load(path, ["tiago_dual"], policy=Policy(Drive.FIXED, HERE, BUDGET))


@pytest.fixture(scope="module")
def found(service: Service) -> Verdict:
    (verdict,) = service.achieve("open:front_door")
    return verdict


def body_of(verdict: Verdict) -> BodyMotion:
    assert verdict.outcome is Outcome.CERTIFIED, verdict.diagnoses
    assert verdict.can_perform is not None
    body = verdict.can_perform.case.body_motion
    assert isinstance(body, BodyMotion)
    return body


def test_it_is_certified_in_holds_that_a_descent_found(found: Verdict) -> None:
    assert body_of(found).phases[-1][0].startswith("follow")
    assert found.can_perform is not None
    assert found.can_perform.figures["holds"][0] >= 2
    assert any("by descent; let go at" in note for note in found.can_perform.notes)


def test_who_shares_no_code_with_it_finds_no_rule_broken(found: Verdict, path: Path) -> None:
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
    slack = audited(stage, arrays_of(body_of(found)), COARSE).slack
    assert {rule: one for rule, one in slack.items() if one < NO_LESS} == {}


def test_it_is_certified_again_when_somebody_gives_it(service: Service, found: Verdict) -> None:
    given = motion_of(arrays_of(body_of(found)), service.twin)
    (verdict,) = service.achieve("open:front_door", motion=given)
    assert verdict.outcome is Outcome.CERTIFIED, verdict.diagnoses


def test_the_same_seed_gives_the_same_motion(found: Verdict, path: Path) -> None:
    again = load(path, ["tiago_dual"], policy=Policy(Drive.FIXED, HERE, 2 * BUDGET))
    (verdict,) = again.achieve("open:front_door")
    one, other = arrays_of(body_of(found)), arrays_of(body_of(verdict))
    assert one.keys() == other.keys()
    for name in one:
        np.testing.assert_array_equal(one[name], other[name])


def test_where_one_hold_is_asked_for_there_is_no_descent(found: Verdict) -> None:
    assert found.can_perform is not None
    case = replace(found.can_perform.case, body_motion=UNKNOWN)
    answer = WholeBody(Drive.FIXED, HERE, BUDGET, regrasps=False).perform(case)
    assert not answer.holds
    assert "descent" not in answer.seconds
    assert not any("by descent" in each.reason for each in answer.diagnoses)
