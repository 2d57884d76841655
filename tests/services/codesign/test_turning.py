"""Which changes are looked at where none is named, and how sure what they give is said to be."""

import time

import pytest

from predicates.case import Outcome
from predicates.law import law
from sdt_kg.errors import InputError
from services.app import Policy, Service
from services.codesign.entries import Found, How, no_world
from services.codesign.judge import one_of
from services.codesign.smallest.coarse import whole
from services.codesign.smallest.deadline import Deadline
from services.codesign.smallest.families import Family, base_family, families, pairs
from services.codesign.smallest.finer import Line, Walked, finer
from services.codesign.smallest.sought import Question, Sought, Trial, Turned, trial
from services.codesign.smallest.told import sure, turned_json
from services.physics.oracle import Kinematics
from services.requests import parse_task
from services.whatif import World
from tests.small import small_twin
from tests.small.lift import Lift, Lifts

PROOF = ({"kind": "embodiment", "reason": "too high", "evidence": None, "proof": True, "search": None},)
SEARCH = ({**PROOF[0], "proof": False, "search": {"seeds": 9}},)
WHOLE = Family("which robot", ("robot:a", "robot:b"))
GRADUAL = Family("which height", ("furniture:x=0,0,1",), 2, 0.1, lengths=(1.0,))


ASKED = Question("b", "pr2", "open:x", (), Policy())
LONG = Deadline(1000.0, 0.0, "a long one")
REFUSED = Found("", Outcome.NOT_CERTIFIED, How.LAW, {}, SEARCH)
CERTIFIED = Found("", Outcome.CERTIFIED, How.LAW, {})


def refused(said=SEARCH, turns: bool = False) -> Trial:
    return Trial("robot:a", Found("", Outcome.NOT_CERTIFIED, How.LAW, {}, said), turns)


def sizes(*shares: float, turn: float | None = None) -> tuple[Trial, ...]:
    """Refused at each share, and certified at the last."""
    trials = [trial(f"furniture:x=0,0,{share}", REFUSED, REFUSED, 0, share) for share in (0.0, *shares)]
    last = [] if turn is None else [trial(f"furniture:x=0,0,{turn}", CERTIFIED, REFUSED, 0, turn)]
    return (*trials, *last)


def test_only_whole_edits_that_are_all_refused_by_proofs_are_proved_to_turn_nothing() -> None:
    assert "proved: each" in sure(Sought(WHOLE, (refused(PROOF), refused(PROOF))))
    for one in (
        Sought(WHOLE, (refused(PROOF), refused())),
        Sought(WHOLE, (refused(PROOF),), stopped=True),
        Sought(GRADUAL, (refused(PROOF), refused(PROOF))),
        Sought(WHOLE),
    ):
        assert sure(one).startswith("searched, not proved")


def test_a_turn_into_a_refusal_is_called_certified_by_nobody() -> None:
    assert sure(Sought(WHOLE, (refused(turns=True),))) == "searched"
    assert sure(Sought(WHOLE, (refused(PROOF, turns=True),))) == "proved"
    abstained = Trial("robot:a", Found("", Outcome.ABSTAINED, How.LAW, {}, SEARCH), turns=True)
    assert sure(Sought(WHOLE, (abstained,))) == "outside the class"
    assert sure(Sought(WHOLE, (trial("robot:a", CERTIFIED, REFUSED),))) == "certified"


def test_a_smallest_size_is_said_to_be_so_only_among_those_that_were_tried() -> None:
    fine = Sought(GRADUAL, sizes(0.1, 0.2, turn=0.3))
    assert fine.turn is not None
    assert fine.not_yet is not None
    assert (fine.turn.share, fine.not_yet.share, fine.is_complete) == (0.3, 0.2, True)
    assert sure(fine) == "certified; 2 smaller sizes tried, at most 0.1 m apart, turn nothing"
    coarse = Sought(GRADUAL, sizes(0.25, 0.5, turn=0.55))
    assert (coarse.gap, coarse.is_complete) == (0.25, False)
    assert "at most 0.25 m apart" in sure(coarse)
    assert sure(coarse).endswith("the time ended before 0.1 m")


def test_what_was_tried_in_one_direction_says_nothing_of_another() -> None:
    both = Family("which height", ("furniture:x=0,0,1", "furniture:x=0,0,-1"), 2, 0.1, lengths=(1.0, 0.5))
    one = Sought(both, sizes(0.1, 0.2, turn=0.3))
    assert one.gap == pytest.approx(0.3)
    beside = tuple(trial("", REFUSED, REFUSED, 1, share) for share in (0.1, 0.2))
    assert Sought(both, (*one.trials, *beside)).gap == pytest.approx(0.1)
    assert Sought(both, (*sizes(0.25, 0.5, 0.75), *beside)).gap == pytest.approx(0.3)


def test_what_cannot_be_made_turns_nothing() -> None:
    none = no_world(InputError("the handle is in a wall"))
    assert not trial("x", none, CERTIFIED).turns
    assert not trial("x", none, REFUSED).turns


def test_a_family_whose_edits_were_not_all_tried_in_time_says_so() -> None:
    assert "the time ended" in sure(Sought(WHOLE, (refused(),), stopped=True))
    assert "the time ended before 0.1 m" in sure(Sought(GRADUAL, sizes(0.5), stopped=True))


def walk_of(opens):
    """Tries sizes of an imagined door that opens where it is said to, a hundredth of a second each."""

    def walk(deadline: Deadline, line: Line) -> Walked:
        trials = []
        for share in line.shares:
            if len(trials) * 0.01 > deadline.left:
                return Walked(tuple(trials), True, 0.01 * len(trials))
            found = CERTIFIED if opens(share) else REFUSED
            trials.append(trial(f"furniture:x=0,0,{share}", found, REFUSED, line.direction, share))
            if trials[-1].turns:
                break
        return Walked(tuple(trials), False, 0.01 * len(trials))

    return walk


def test_an_outcome_that_turns_back_is_found_out_by_the_sizes_between() -> None:
    before = Sought(GRADUAL, sizes(0.5, turn=0.75))
    (after,), _ = finer([before], walk_of(lambda share: 0.3 < share < 0.35 or share > 0.6), LONG, 1)
    assert after.turn is not None
    assert (after.turn.share, after.is_complete) == (0.3125, True)
    assert after.gap <= GRADUAL.finest
    (same,), _ = finer([before], walk_of(lambda share: share > 0.6), LONG, 1)
    assert same.turn is not None
    assert same.turn.share == 0.625


def test_a_family_that_turned_nowhere_is_looked_at_again_between_its_first_sizes() -> None:
    (after,), _ = finer([Sought(GRADUAL, sizes(0.5, 1.0))], walk_of(lambda share: share == 0.25), LONG, 1)
    assert after.turn is not None
    assert after.turn.share == 0.25
    (none,), _ = finer([Sought(GRADUAL, sizes(0.5, 1.0))], walk_of(lambda share: False), LONG, 1)
    assert sure(none) == "searched, not proved; 16 sizes tried, at most 0.062 m apart, turn nothing"


def test_when_the_time_ends_only_what_was_tried_is_claimed() -> None:
    before = Sought(GRADUAL, sizes(0.5, turn=1.0))
    (after,), spent = finer([before], walk_of(lambda share: False), Deadline(0.02, 0.0, "short"), 1)
    assert spent < 0.05
    assert not after.is_complete
    assert after.gap > GRADUAL.finest
    said = turned_json(Turned(ASKED, REFUSED, (after,), 0.0, 0.0))
    looked_at = said["families"][0]["looked_at"]
    assert (looked_at["up_to"], looked_at["complete"]) == (1.0, False)
    assert looked_at["smaller_tried"] == len(after.smaller)


def test_no_edit_is_begun_that_would_end_late_if_it_took_as_long_as_the_longest_before() -> None:
    twin = small_twin("b", ("pr2",))
    world = World(Service(twin), "pr2")
    deadline = Deadline(60.0, 1.0, "a test of deadlines")
    assert not deadline.is_late()
    deadline.judged(world, REFUSED, lambda: world, f"close:{twin.containers()[0].name}")
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
    assert "searched, not proved" in sure(Sought(found, (refused(),), stopped=True))


def test_both_edits_of_a_pair_are_made() -> None:
    twin = small_twin("b", ("pr2",))
    world = World(Service(twin, oracles=Lifts()), "pr2")
    task, actual = "open:top_drawer", Found("", Outcome.CERTIFIED, How.LAW, {})
    tried = ("move:oven_door=open & drive:fixed", "drive:fixed & jam:top_drawer")
    found = whole(
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


def test_where_a_size_has_turned_smaller_ones_are_tried_first() -> None:
    both = Family("which height", ("furniture:x=0,0,1", "furniture:x=0,0,-1"), 2, 0.1, lengths=(1.0, 1.0))
    ends = tuple(trial("", REFUSED, REFUSED, 1, share) for share in (0.5, 1.0))
    order: list[int] = []

    def walk(deadline: Deadline, line: Line) -> Walked:
        order.append(line.direction)
        return walk_of(lambda share: False)(deadline, line)

    (after,), _ = finer([Sought(both, (*sizes(0.5, turn=1.0), *ends))], walk, LONG, 1)
    assert order == sorted(order)
    assert set(order) == {0, 1}
    assert after.is_complete
    (early,), _ = finer([Sought(both, (*sizes(0.5, turn=1.0), *ends))], walk, Deadline(0.07, 0.0, "a"), 1)
    assert early.own_gap < early.gap
    assert "apart in its direction and 0.5 m in others" in sure(early)
