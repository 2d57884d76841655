"""A door that no one hold opens, from where the base stands: in several, judged by other code too."""

from pathlib import Path

import numpy as np
import pytest

from predicates.case import Verdict
from sdt_kg.annotation import Drive
from sdt_kg.motion import Motion
from services.app import Service
from services.embodiment.oracle import WholeBody
from services.embodiment.search import plan
from tests.services.embodiment.standing_front import (
    HERE,
    body_of,
    check_by_other_code,
    check_given_again,
    fixtures,
)

pytestmark = pytest.mark.oracle

LASTS_NOT = 34
"""A door 0.92 m away that a TIAGo++ holds at each angle, and in no way that it can keep."""


path, service, _ = fixtures(LASTS_NOT)


@pytest.fixture(scope="module")
def found(service: Service) -> Verdict:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(plan, "FIRST", (0, 0))  # holds by descent open it too
        patch.setattr(plan, "freed", lambda *_: ())  # and so with its arms and head aside
        (verdict,) = service.achieve("open:front_door")
    return verdict


def test_it_is_certified_in_several_holds_and_says_so(found: Verdict) -> None:
    body = body_of(found)
    assert found.can_perform is not None
    assert found.can_perform.figures["holds"] == (2.0, "1")
    assert any("let go on the way: front_door is held from" in note for note in found.can_perform.notes)
    names = [name for name, _ in body.phases]
    assert names[:6] == ["drive", "approach", "grasp", "follow", "let go", "leave"]
    assert names[-1] == "follow 2"
    assert len(set(names)) == len(names)


def test_its_motion_of_the_door_is_that_of_the_body(found: Verdict) -> None:
    body = body_of(found)
    assert found.can_perform is not None
    motion = found.can_perform.case.motion
    assert isinstance(motion, Motion)
    begin = body.times[dict(body.phases)["follow"]]
    column = body.kitchen_joints.index(motion.of)
    follows = np.interp(begin + motion.times, body.times, body.kitchen_q[:, column])
    np.testing.assert_allclose(motion.values[:, 0], follows, atol=1e-6)


def test_nothing_jumps_where_one_part_follows_another(found: Verdict) -> None:
    body = body_of(found)
    for _, sample in body.phases[1:]:
        for q, v in ((body.base, body.base_v), (body.q, body.v), (body.kitchen_q, body.kitchen_v)):
            assert np.abs(v[sample]).max(initial=0.0) < 1e-9
            assert np.abs(q[sample] - q[sample - 1]).max(initial=0.0) < 0.2


def test_who_shares_no_code_with_it_finds_no_rule_broken(found: Verdict, path: Path) -> None:
    check_by_other_code(body_of(found), path)


def test_it_is_certified_again_when_somebody_gives_it(service: Service, found: Verdict) -> None:
    check_given_again(body_of(found), service)


def test_where_one_hold_is_asked_for_it_is_refused(service: Service, found: Verdict) -> None:
    assert found.can_perform is not None
    answer = WholeBody(Drive.FIXED, HERE, regrasps=False).perform(found.can_perform.case)
    assert not answer.holds
    assert any("is let go at" in each.reason for each in answer.diagnoses)
