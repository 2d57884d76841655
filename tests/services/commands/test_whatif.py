"""`sdt whatif`: other robots, kitchens, obstacles, limits; what turns, and at which share of a change."""

import pytest

from predicates.record.inputs import inputs_of, verdict_iri
from services.app import Policy, load
from services.commands.exits import Exit
from services.requests import parse_task
from services.whatif import KINDS, World, changed, parse_change

pytestmark = pytest.mark.oracle

DRAWER = "sink_area_left_middle_drawer_main"


def whatif(sdt, *arguments: str, robot: str = "pr2"):
    return sdt(
        "whatif", "--kitchen", "b", "--robot", robot, "--task", f"open:{DRAWER}", "--budget", "30", *arguments
    )


def test_an_obstacle_in_front_turns_causes_and_names_what_is_hit(sdt) -> None:
    done = whatif(sdt, "--edit", "box:crate=0.4,0.4,1@0.6,0.5,0.5", "--json")
    assert done.code == 1, done.err
    assert done.json["turned"]
    assert {"predicate": "causes", "actual": True, "counterfactual": False} in done.json["predicates"]
    assert any("crate" in each["reason"] for each in done.json["now"])
    assert done.json["actual"]["iri"] != done.json["counterfactual"]["iri"]


def test_a_drawer_that_is_pulled_out_further_turns_where_eq08_says(sdt) -> None:
    done = whatif(sdt, "--edit", f"move:{DRAWER}=0.45", "--turn", "--json")
    assert done.code == 0, done.err
    found = done.json
    ((at,), (not_yet,)) = (
        [float(each.partition("=")[2]) for each in found[key]] for key in ("edits", "not_yet")
    )
    assert not_yet < 0.432 <= at, "0.9 of the upper limit, 0.48 m"
    assert found["tolerance"] <= 0.01
    assert found["counterfactual"]["diagnoses"][0]["kind"] == "causal", "nothing to cause"


@pytest.mark.parametrize("more", [(), ("--turn",), ("--grid",)])
def test_time_for_the_smallest_change_says_nothing_to_a_named_one(sdt, more: tuple[str, ...]) -> None:
    done = whatif(sdt, "--edit", f"jam:{DRAWER}", "--within", "5", *more)
    assert done.code == Exit.BAD_INPUT
    assert "--within is of --turn without --edit" in done.err


@pytest.mark.parametrize(
    "edits",
    [
        ("box:crate",),
        ("dance:x",),
        ("broken:nose",),
        ("robot:nobody",),
        ("drive:hover",),
        ("move:nothing=1",),
        (f"handle:{DRAWER}=1,2",),
        ("robot:stretch", "broken:gripper"),
        (),
    ],
)
def test_what_is_no_edit_is_named(sdt, edits: tuple[str, ...]) -> None:
    done = whatif(sdt, *(part for each in edits for part in ("--edit", each)))
    assert done.code == 2
    assert "Traceback" not in done.err
    assert done.err.startswith("error: ")


def test_what_turns_at_the_smallest_share_and_why_is_told(sdt) -> None:
    asked = ("--kitchen", "b", "--robot", "pr2", "--task", "open:iai_fridge_door")
    done = sdt("whatif", *asked, "--edit", "move:iai_fridge_door=1.5", "--turn")
    assert "  causes: yes, otherwise no" in done.out
    assert "  now: causal: nothing to cause: iai_fridge_door at 1.418 rad already meets open" in done.out


def test_an_edit_that_is_nearly_one_is_told_how_that_is_written(sdt) -> None:
    asked = ("whatif", "--kitchen", "b", "--robot", "pr2", "--task", "open:iai_fridge_door", "--edit")
    for text in ("box:", "Box"):
        done = sdt(*asked, text)
        assert done.code == Exit.BAD_INPUT
        assert done.err.startswith(f"error: '{text}' is no edit; allowed: box:NAME=SX,SY,SZ@X,Y,Z[,YAW] (")
        assert "robot:NAME" not in done.err


def test_an_edit_of_no_kind_is_told_all_kinds_in_short_and_those_that_are_meant(sdt) -> None:
    asked = ("whatif", "--kitchen", "b", "--robot", "pr2", "--task", "open:iai_fridge_door", "--edit")
    for text, near in (
        ("bx:crate=1", "did you mean box:NAME=SX,SY,SZ@X,Y,Z[,YAW] (an obstacle"),
        ("remove:crate", "did you mean without:NAME (of an obstacle or robot) or clear:BODY (of the kitchen"),
        ("foo:bar", "; sdt whatif --edit help says what each does"),
    ):
        done = sdt(*asked, text)
        assert done.code == Exit.BAD_INPUT
        assert f"error: '{text}' is no edit; allowed: robot:NAME, kitchen:NAME, drive:omni|diff" in done.err
        assert near in done.err
        assert len(done.err) < 700
    assert "sdt branch --help" in sdt("branch", "b", "foo:bar").err


def test_alternatives_without_a_grid_are_told_of_it(sdt) -> None:
    asked = ("whatif", "--kitchen", "b", "--robot", "pr2", "--task", "open:iai_fridge_door", "--edit")
    done = sdt(*asked, "move:iai_fridge_door=0.7 | robot:stretch")
    assert done.code == Exit.BAD_INPUT
    assert "has alternatives; allowed: one edit" in done.err
    assert "--grid judges each" in done.err


def test_of_edits_that_cannot_be_made_in_part_no_turn_is_sought(sdt) -> None:
    asked = ("whatif", "--kitchen", "b", "--robot", "pr2", "--task", "open:iai_fridge_door", "--turn")
    done = sdt(*asked, "--edit", "robot:stretch")
    assert done.code == Exit.BAD_INPUT
    assert "no edit can be made in part, and a turn is sought between nothing and all of one" in done.err
    assert "allowed: at least one of move:, set:, base:, handle:, furniture:" in done.err


def test_a_container_that_the_other_kitchen_has_not_is_told_of_that_kitchen(sdt) -> None:
    asked = ("whatif", "--kitchen", "b", "--robot", "pr2", "--task", "open:iai_fridge_door", "--edit")
    assert "sdt containers lists those of kitchen a" in sdt(*asked, "kitchen:a").err


def test_help_lists_every_kind_of_edit(sdt) -> None:
    done = sdt("whatif", "--edit", "help")
    assert done.code == 0
    assert all(kind in done.out for kind in KINDS)


@pytest.mark.parametrize(
    "text", [f"move:{DRAWER}=0.2", f"handle:{DRAWER}=0,0,0.1", "base:1,0,0", "robot:stretch", "broken:left"]
)
def test_nothing_of_a_change_is_no_change_and_all_of_it_is_another_question(text: str) -> None:
    world = World(load("b", ["pr2"], policy=Policy(base=(0.0, 0.0, 0.0))), "pr2")
    change = parse_change(text)
    assert _iri(changed(world, (change,), 0.0)) == _iri(world)
    assert _iri(changed(world, (change,))) != _iri(world)


def test_changes_of_different_things_commute() -> None:
    world = World(load("b", ["pr2"]), "pr2")
    changes = [parse_change(text) for text in ("box:crate=1,1,1@3,3,0.5", f"handle:{DRAWER}=0,0,0.1")]
    one, other = (changed(world, tuple(order)) for order in (changes, changes[::-1]))
    assert _iri(one) == _iri(other) != _iri(world)


def _iri(world: World) -> str:
    service = world.service
    case = service.case(parse_task(service.twin, f"open:{DRAWER}"), world.robot_iri)
    return verdict_iri(inputs_of(case, service.physics, service.embodiment))
