"""Which changes are looked at where none is named, and how sure what they give is said to be."""

import time

import pytest

from predicates.case import Outcome
from predicates.law import law
from services.app import Policy, Service
from services.codesign.command.turn import sure
from services.codesign.deadline import Deadline
from services.codesign.entries import Found, How
from services.codesign.families import Family, base_family, families, pairs
from services.codesign.judge import one_of
from services.codesign.turning import Sought, Trial, _whole
from services.physics.oracle import Kinematics
from services.requests import parse_task
from services.whatif import World
from tests.small import small_twin
from tests.small.lift import Lift, Lifts

PROOF = ({"kind": "embodiment", "reason": "too high", "evidence": None, "proof": True, "search": None},)
SEARCH = ({**PROOF[0], "proof": False},)
WHOLE = Family("which robot", ("robot:a", "robot:b"))
GRADUAL = Family("which height", ("furniture:x=0,0,1",), 2, 0.1)


def refused(said=SEARCH) -> Trial:
    return Trial("robot:a", Found("", Outcome.NOT_CERTIFIED, How.LAW, {}, said))


def test_only_whole_edits_that_are_all_refused_by_proofs_are_proved_to_turn_nothing() -> None:
    assert "proved: each" in sure(Sought(WHOLE, tried=(refused(PROOF), refused(PROOF))))
    for one in (
        Sought(WHOLE, tried=(refused(PROOF), refused())),
        Sought(WHOLE, tried=(refused(PROOF),), stopped=True),
        Sought(GRADUAL, tried=(refused(PROOF), refused(PROOF))),
        Sought(WHOLE),
    ):
        assert sure(one).startswith("searched, not proved")


def test_a_turn_into_a_refusal_is_called_certified_by_nobody() -> None:
    assert sure(Sought(WHOLE, refused())) == "searched"
    assert sure(Sought(WHOLE, refused(PROOF))) == "proved"
    abstained = Trial("robot:a", Found("", Outcome.ABSTAINED, How.LAW, {}, SEARCH))
    assert sure(Sought(WHOLE, abstained)) == "outside the class"
    certified = Trial("robot:a", Found("", Outcome.CERTIFIED, How.LAW, {}))
    assert sure(Sought(WHOLE, certified)) == "certified"
    assert sure(Sought(GRADUAL, certified)) == "certified; smaller ones were searched, not proved"


def test_a_family_whose_edits_were_not_all_tried_in_time_says_so() -> None:
    assert "the time ended" in sure(Sought(GRADUAL, tried=(refused(),), stopped=True))
    assert "as finely" in sure(Sought(GRADUAL, refused(), tried=(refused(),), stopped=True))


def test_no_edit_is_begun_that_would_end_late_if_it_took_as_long_as_the_longest_before() -> None:
    twin = small_twin("b", ("pr2",))
    world = World(Service(twin), "pr2")
    deadline = Deadline(60.0, 1.0, "a test of deadlines")
    assert not deadline.is_late()
    deadline.judged(lambda: world, f"close:{twin.containers()[0].name}")
    assert not deadline.is_late()
    deadline.left = deadline.spent() + 0.5
    assert deadline.is_late()


def test_time_in_which_a_process_does_nothing_does_not_count() -> None:
    deadline = Deadline(60.0, 0.0, "another test of deadlines")
    assert deadline.spent() < 0.01
    time.sleep(0.1)
    assert deadline.spent() < 0.05
    again = Deadline(60.0, 0.0, "a third one")
    assert again.spent() < deadline.spent() + 0.01


def test_base_poses_are_told_to_a_tenth_of_a_metre() -> None:
    family = base_family((0, 0, 0), [(2, 0, 0), (0, 1, 0)])
    assert family.edits == ("base:2.0000,0.0000,0.0000", "base:0.0000,1.0000,0.0000")
    assert family.tolerance * 2 == pytest.approx(0.1)


def test_equal_shares_go_equally_far_towards_every_base_pose() -> None:
    twin = small_twin("b", ("pr2",))
    world = World(Service(twin, Policy(base=(0.0, 0.0, 0.0))), "pr2")
    family = base_family((0, 0, 0), [(2, 0, 0), (0, 1, 0)])
    assert all(each.amount for each in family.directions)
    amounts = [[each.amount(world, share) for share in (0.25, 0.5, 1.0)] for each in family.directions]
    assert amounts == [
        ["base:0.5,0,0", "base:1,0,0", "base:2,0,0"],
        ["base:0,0.5,0", "base:0,1,0", "base:0,1,0"],
    ]
    ends = [each.at(world, 0.25).service.policy.base for each in family.directions]
    assert ends == [(0.5, 0.0, 0.0), (0.0, 0.5, 0.0)]


def test_pairs_are_of_two_families_and_what_each_tries_first_comes_first() -> None:
    drives = Family("which drive", ("drive:omni", "drive:fixed"))
    found = pairs([WHOLE, drives, GRADUAL])
    assert found.edits[0] == "robot:a & drive:omni"
    assert len(found.edits) == 2 * 2 + 2 * 1 + 2 * 1
    assert found.edits[-1] == "robot:b & drive:fixed"
    assert "8 pairs of two of these: which robot; which drive; which height" in found.range
    assert "searched, not proved" in sure(Sought(found, tried=(refused(),), stopped=True))


def test_both_edits_of_a_pair_are_made() -> None:
    twin = small_twin("b", ("pr2",))
    world = World(Service(twin, oracles=Lifts()), "pr2")
    task, actual = "open:top_drawer", Found("", Outcome.CERTIFIED, How.LAW, {})
    tried = ("move:oven_door=open & drive:fixed", "drive:fixed & jam:top_drawer")
    found = _whole(
        world, task, actual, Deadline(60.0, 0.1, "a test of pairs"), Family("which two together", tried)
    )
    assert found.turn is not None
    assert (found.turn.edit, found.turn.found.outcome) == (tried[1], Outcome.ABSTAINED)
    assert [each.edit for each in found.tried] == list(tried)


def test_of_a_verdict_that_holds_nothing_is_cleared() -> None:
    twin = small_twin("b", ("pr2",))
    world = World(Service(twin), "pr2")
    container = twin.containers()[0]
    verdict = _certified(world, container.name)
    names = [each.name for each in families(world, verdict, container)]
    assert "which obstacle is cleared" not in names
    assert {"which robot", "where its handle is", "at which height it is"} <= set(names)


def _certified(world: World, container: str):
    case = world.service.case(parse_task(world.service.twin, f"open:{container}"), world.robot_iri)
    verdict = one_of(law(case, Kinematics(), Lift()))
    assert verdict.outcome is Outcome.CERTIFIED
    return verdict
