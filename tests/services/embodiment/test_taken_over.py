"""A door that no gripper opens alone from where the base stands: both do, in turn."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from predicates.case import Verdict
from predicates.record.report import gripper
from services.app import Service
from services.codesign.entries import How, found_of
from services.codesign.judge import Judge
from services.embodiment.certify import Certified, Refused, certify
from services.embodiment.certify.certificate import read_certificate
from services.embodiment.recheck.embodiment import Certifier
from services.whatif import World, changed, parse_change
from tests.services.embodiment.standing_front import (
    body_of,
    check_by_other_code,
    check_found_again,
    check_given_again,
    fixtures,
)

pytestmark = pytest.mark.oracle

IN_TURN = 301
"""A door of 0.56 m that a TIAGo++'s right hand does not hold open, nor its left one shut."""


path, service, found = fixtures(IN_TURN)


def test_it_is_certified_in_holds_of_both_and_says_so(found: Verdict) -> None:
    body = body_of(found)
    assert found.can_perform is not None
    assert found.can_perform.figures["holds"][0] >= 2
    assert any("then anew, by gripper left after right" in note for note in found.can_perform.notes)
    assert any("by gripper right, by descent; let go at" in note for note in found.can_perform.notes)
    assert body.gripper == ""
    assert gripper(found) is None
    assert {"arm_left_7_joint", "arm_right_7_joint"} <= {*body.joints}
    assert len(set(body.joints)) == len(body.joints)


def test_an_arm_rests_parked_while_the_other_holds(found: Verdict, service: Service) -> None:
    body, parked = body_of(found), service.twin.robot(service.twin.robots[0]).parked
    starts = dict(body.phases)
    for side, phase in (("left", "follow"), ("right", [*starts][-1])):
        first = starts[phase]
        last = min((at for at in starts.values() if at > first), default=len(body.times) - 1)
        own = [k for k, name in enumerate(body.joints) if name.startswith(f"arm_{side}")]
        rest = [parked.get(body.joints[k], 0.0) for k in own]
        np.testing.assert_allclose(body.q[first : last + 1, own], np.tile(rest, (last + 1 - first, 1)))
        assert not body.v[first : last + 1, own].any()


def test_who_shares_no_code_with_it_finds_no_rule_broken(found: Verdict, path: Path) -> None:
    check_by_other_code(body_of(found), path)


def test_it_is_certified_again_when_somebody_gives_it(service: Service, found: Verdict) -> None:
    check_given_again(body_of(found), service)


@pytest.mark.parametrize("name", ["left", "right"])
def test_neither_gripper_is_said_to_hold_alone(service: Service, found: Verdict, name: str) -> None:
    assert found.can_perform is not None
    assert found.can_perform.artefact is not None
    kept = read_certificate(found.can_perform.artefact.content)
    twin = service.twin
    about = kept.held_in(twin), kept.tolerances
    scene = Certifier(twin, kept).scene
    drive = {"drive": kept.drive, "start": kept.start, "scene": scene}
    assert isinstance(certify(twin, kept.robot, kept.motion, *about, **drive), Certified)
    named = certify(twin, kept.robot, replace(kept.motion, gripper=name), *about, **drive)
    assert isinstance(named, Refused)


def test_the_same_seed_gives_the_same_motion(found: Verdict, path: Path) -> None:
    check_found_again(body_of(found), path)


def test_it_is_certified_again_in_another_world_where_both_are_there(
    service: Service, found: Verdict
) -> None:
    actual = found_of(found, How.LAW, found.seconds)
    world = World(service, "tiago_dual")
    brief = world.under(budget=0.5)  # of a search, where it is not
    for edit, how in (("box:crate=0.3,0.3,0.3@-3,-3,0.15", How.AGAIN), ("broken:left", How.LAW)):
        after = changed(brief, (parse_change(edit),))
        judged = Judge(world, after, {}).judged("open:front_door", actual)
        assert judged.how is how, edit
        assert judged.is_certified == (how is How.AGAIN)
