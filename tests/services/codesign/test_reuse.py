"""What an edit touches, when a search answers for another world, and that what is reused is true there."""

import pytest

from predicates.case import Case, Outcome
from predicates.law import law
from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from sdt_kg.iri import local_name
from services.app import Policy, Service, load
from services.codesign.again import Again
from services.codesign.asked import worlds_of
from services.codesign.entries import How
from services.codesign.judge import Judge, judged_as_it_is, motion_of
from services.codesign.room import reusable
from services.codesign.touched import touched
from services.requests import parse_task
from services.whatif import World, changed, parse_change
from tests.small import small_twin

SMALL = World(Service(small_twin("a", ("pr2", "stretch")), Policy(drive=Drive.OMNI)), "pr2")
FIRST, SECOND = (each.name for each in SMALL.service.twin.containers()[:2])
DRAWER = "sink_area_left_middle_drawer_main"


def otherwise(*texts: str, world: World = SMALL) -> World:
    return changed(world, tuple(map(parse_change, texts)))


def answering(before: World, after: World, container: str = FIRST) -> How | None:
    """Why a search in one world answers for the other."""
    case = after.service.case(f"open:{container}", after.robot_iri)
    found = touched(before.service.twin, after.service.twin, before.robot_iri)
    return reusable(before, after, case, found)


def touched_by(*texts: str) -> set[str]:
    found = touched(SMALL.service.twin, otherwise(*texts).service.twin, SMALL.robot_iri)
    assert not found.robot
    return set(map(local_name, found.bodies))


def test_an_obstacle_touches_itself_and_nothing_else() -> None:
    assert touched_by("box:crate=1,1,1@3,3,0") == {"crate"}


def test_a_limit_moves_nothing() -> None:
    joint = local_name(SMALL.service.twin.container(FIRST).joint)
    assert touched_by(f"set:{joint}.velocityLimit=0.05") == set()


def test_a_state_touches_what_moves_with_the_joint_and_its_handle() -> None:
    container = SMALL.service.twin.container(FIRST)
    assert touched_by(f"move:{FIRST}=open") >= {FIRST, local_name(container.handle)}
    assert SECOND not in touched_by(f"move:{FIRST}=open")


def test_a_handle_that_is_moved_touches_the_handle_and_not_its_drawer() -> None:
    container = SMALL.service.twin.container(FIRST)
    assert touched_by(f"handle:{FIRST}=0,0,0.1") == {local_name(container.handle)}


def test_what_an_undone_edit_touched_is_as_it_was() -> None:
    there = otherwise("box:crate=1,1,1@3,3,0")
    assert touched_by("box:crate=1,1,1@3,3,0", "without:crate") == set()
    assert there.service.twin.content_hash(SMALL.service.twin.environment) != ""


@pytest.mark.parametrize(
    ("edits", "how"),
    [
        ((), How.NOTHING),
        (("box:crate=1,1,1@3,3,0",), How.LESS_ROOM),
        (("drive:differential",), How.LESS_ROOM),
        (("drive:fixed", "box:crate=1,1,1@3,3,0"), How.LESS_ROOM),
        ((f"jam:{SECOND}",), How.NOTHING),
        ((f"jam:{FIRST}",), None),
        ((f"move:{SECOND}=open",), None),
        ((f"handle:{FIRST}=0,0,0.1",), None),
        (("base:1,1,0",), None),
        (("robot:stretch",), None),
    ],
)
def test_a_search_answers_only_for_a_world_with_no_more_room(edits: tuple[str, ...], how: How | None) -> None:
    after = otherwise(*edits)
    assert answering(SMALL, after) is how


def test_taking_an_obstacle_away_or_letting_the_base_roll_more_freely_asks_for_a_new_search() -> None:
    before = otherwise("box:crate=1,1,1@3,3,0", "drive:fixed")
    for text in ("without:crate", "drive:omni"):
        after = otherwise(text, world=before)
        assert answering(before, after) is None


def test_a_container_that_is_slowed_less_near_its_limit_asks_for_a_new_search() -> None:
    twin = SMALL.service.twin
    joint = twin.container(FIRST).joint
    slowed = SMALL.with_twin(twin.with_edit(joint, softLimitGain=0.05))
    assert answering(slowed, otherwise(f"set:{local_name(joint)}.softLimitGain=5", world=slowed)) is None


@pytest.mark.oracle
@pytest.mark.parametrize(("at", "how"), [((3.0, 3.0), How.LESS_ROOM), ((0.0, 0.0), None)])
def test_a_search_answers_for_no_world_in_which_the_robot_must_start_elsewhere(at, how) -> None:
    world = World(load("b", ["pr2"]), "pr2")
    x, y, _ = world.service.twin.kitchen().start
    after = otherwise(f"box:crate=0.3,0.3,0.3@{x + at[0]},{y + at[1]},0.15", world=world)
    assert answering(world, after, DRAWER) is how


def test_worlds_are_all_choices_of_each_axis_but_none_at_all() -> None:
    assert worlds_of(["drive:omni | drive:fixed", "broken:left"]) == (
        ("broken:left",),
        ("drive:omni",),
        ("drive:omni", "broken:left"),
        ("drive:fixed",),
        ("drive:fixed", "broken:left"),
    )
    for wrong in (["drive:omni | "], ["dance:x"], ["drive:omni | drive:omni"], [""]):
        with pytest.raises(InputError):
            worlds_of(wrong)


@pytest.mark.oracle
def test_a_motion_certified_again_by_touched_pairs_alone_is_certified_in_full_and_refused_in_full() -> None:
    world = World(load("b", ["pr2"], policy=Policy(budget=30)), "pr2")
    base = judged_as_it_is(world, "open", DRAWER)
    motion = motion_of(base)
    assert motion is not None
    x, y = motion.base[len(motion.base) // 2][:2]
    texts = ["box:crate=0.3,0.3,0.9@3,3,0.45", f"box:crate=0.2,0.2,1@{x},{y + 0.5},0.5"]
    outcomes = [_again_and_in_full(world, text, base) for text in texts]
    assert outcomes == [(True, True), (False, False)]


def _again_and_in_full(world: World, text: str, base) -> tuple[bool, bool]:
    after = otherwise(text, world=world)
    service, motion = after.service, motion_of(base)
    case = Case(service.twin, after.robot_iri, parse_task(service.twin, f"open:{DRAWER}"), body_motion=motion)
    found = []
    for difference in (
        touched(world.service.twin, service.twin, after.robot_iri),
        touched(world.service.twin, service.twin, "https://example.org/nobody"),
    ):
        again = Again(service.embodiment, difference)
        (verdict,) = law(case, service.physics, again)
        found.append(verdict.outcome is Outcome.CERTIFIED)
        assert (again.swept.pairs == again.swept.of) == difference.robot
    judged = Judge(world, after, {}).judged(f"open:{DRAWER}", base)
    assert (judged.how is How.AGAIN) == found[0]
    return found[0], found[1]
