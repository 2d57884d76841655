"""Twin: states, thresholds of Eq. (8), mimic doors, edits, hashes, serialisation."""

import math
from functools import cache
from pathlib import Path

import pyoxigraph as ox
import pytest

from sdt_kg.entities import KEPT_STATES
from sdt_kg.errors import StateError, UnknownEntityError
from sdt_kg.iri import LAW, joint_iri, local_name
from sdt_kg.load import load_twin
from sdt_kg.twin import Twin
from tests.sdt_kg.conftest import DRAWER, Write, joint, limit, link


@cache
def kitchen_a() -> Twin:
    return load_twin("a")


SLIDE = joint_iri("k", "slide")
SLIDING = joint("slide", "prismatic", "world", "third", limit(0.0, 0.5))


def requests(twin: Twin) -> list[tuple[str, str]]:
    return [
        (local_name(str(row["verb"])), local_name(str(row["container"])))
        for row in twin.select("satisfied_requests")
    ]


def test_all_is_closed_at_first(drawer: Path) -> None:
    twin = load_twin(drawer)
    assert dict(twin.state) == {SLIDE: 0.0}
    assert requests(twin) == [("Close", "cupboard_drawer")]


def test_eq08_thresholds_are_exact(drawer: Path) -> None:
    (container,) = load_twin(drawer).containers()
    assert (container.lower, container.upper) == (0.0, 0.5)
    assert container.open_from == 0.45
    assert container.closed_to == 0.01


@pytest.mark.parametrize(
    ("position", "expected"),
    [(0.0, ["Close"]), (0.01, ["Close"]), (0.010001, []), (0.449, []), (0.45, ["Open"]), (0.5, ["Open"])],
)
def test_eq08_decides_open_and_closed(drawer: Path, position: float, expected: list[str]) -> None:
    twin = load_twin(drawer).at({SLIDE: position})
    assert [verb for verb, _ in requests(twin)] == expected
    assert bool(twin.select("open")) == ("Open" in expected)
    assert bool(twin.select("closed")) == ("Close" in expected)


def test_a_request_is_asked_forwards_by_binding_it(drawer: Path) -> None:
    twin = load_twin(drawer)
    container = twin.container("cupboard_drawer").iri
    assert twin.select("satisfied_requests", verb=LAW + "Close", container=container)
    assert not twin.select("satisfied_requests", verb=LAW + "Open", container=container)


def test_a_joint_that_only_points_the_other_way_is_turned(write: Write) -> None:
    path = write(*door(f'<axis xyz="0 0 1"/>{limit(-math.pi / 2, 0)}'))
    twin = load_twin(path)
    (container,) = twin.containers()
    assert (container.lower, container.upper) == (0.0, math.pi / 2)
    assert requests(twin) == [("Close", "door")]
    assert any("axis turned" in note for note in twin.notes)


def door(inside: str, kind: str = "revolute") -> tuple[str, ...]:
    return (
        link("world"),
        link("door", '<box size="0.02 0.5 0.5"/>'),
        link("handle", '<box size="0.02 0.1 0.02"/>'),
        joint("hinge", kind, "world", "door", inside),
        joint("mount", "fixed", "door", "handle", '<origin xyz="0.05 0.4 0"/>'),
    )


def test_a_state_outside_limits_is_refused_with_the_limits(drawer: Path) -> None:
    with pytest.raises(StateError, match=r"'slide' at 0.6 m is outside its limits; allowed: 0 to 0.5 m"):
        load_twin(drawer).at({SLIDE: 0.6})
    with pytest.raises(StateError, match=r"'slide' at 0\.5000001 m .*; allowed: 0 to 0\.5 m"):
        load_twin(drawer).at({SLIDE: 0.5000001})
    with pytest.raises(StateError, match="finite number"):
        load_twin(drawer).at({SLIDE: math.nan})


def test_an_unknown_joint_is_refused_with_the_nearest_name(drawer: Path) -> None:
    with pytest.raises(UnknownEntityError, match="no joint named 'slid'; did you mean 'slide'"):
        load_twin(drawer).at({joint_iri("k", "slid"): 0.1})


def test_a_nearest_name_that_several_things_have_is_told_once() -> None:
    assert str(UnknownEntityError("setting", "robots", ("robot", "robot"))).count("'robot'") == 1


def test_a_name_in_capitals_is_told_the_one_that_there_is() -> None:
    assert UnknownEntityError("robot", "PR2", ("pr2", "stretch", "tiago_dual")).near == ["pr2"]
    assert UnknownEntityError("joint", "DOOR_HINGE", ("Door_Hinge", "door_hing")).near == ["Door_Hinge"]
    assert UnknownEntityError("joint", "Dor_Hinge", ("door_hinge", "x")).near == ["door_hinge"]
    assert UnknownEntityError("joint", "DOOR", ("Door", "door")).near == ["Door", "door"]


def test_an_unknown_container_is_refused_with_the_nearest_name(drawer: Path) -> None:
    with pytest.raises(UnknownEntityError, match="did you mean 'cupboard_drawer'"):
        load_twin(drawer).container("cupbord_drawer")


def test_a_container_that_is_left_out_is_refused_with_the_reason() -> None:
    with pytest.raises(UnknownEntityError, match="'cabinet8_drawer_middle' is not counted: it has no handle"):
        kitchen_a().container("cabinet8_drawer_middle")


# Kitchen A's folding door: the lower panel turns at 1.2 times the upper one.

UPPER, LOWER = (
    joint_iri("a", "cabinet4_door_top_top_joint"),
    joint_iri("a", "cabinet4_door_bottom_bottom_joint"),
)


def test_a_mimic_door_is_driven_by_the_mimicked_joint() -> None:
    folding = kitchen_a().container("cabinet4_door_bottom")
    assert (folding.joint, folding.active_joint) == (LOWER, UPPER)
    assert (folding.multiplier, folding.offset) == (1.2, 0.0)
    assert (folding.lower, folding.upper) == (
        0.0,
        1.5708,
    )  # its own; the upper panel's 2.0 rad would allow 2.4


def test_the_effective_limit_is_the_minimum_over_the_coupling() -> None:
    twin = kitchen_a().with_edit(UPPER, upperLimit=1.0)
    folding = twin.container("cabinet4_door_bottom")
    assert folding.upper == 1.2
    assert folding.open_from == 0.9 * 1.2
    slow = kitchen_a().with_edit(UPPER, velocityLimit=0.5, accelerationLimit=0.25)
    assert slow.container("cabinet4_door_bottom").velocity == 0.6
    assert slow.container("cabinet4_door_bottom").acceleration == 0.3


def test_a_wheel_without_limits_that_turns_along_allows_everything(write: Write) -> None:
    wheel = '<axis xyz="0 0 1"/>{}<mimic joint="slide" multiplier="-8"/>'
    for own, velocity in (("", 1.0), ('<limit velocity="4" effort="1"/>', 0.5)):
        turning = joint("wheel_joint", "continuous", "world", "wheel", wheel.format(own))
        (drawer,) = load_twin(write(*DRAWER, link("wheel"), turning)).containers()
        assert (drawer.lower, drawer.upper, drawer.open_from, drawer.closed_to) == (0.0, 0.5, 0.45, 0.01)
        assert (drawer.velocity, drawer.acceleration) == (velocity, 1 / 8)


@pytest.mark.parametrize(
    ("low", "multiplier", "offset", "start"),
    [(0.0, 1.0, 0.0, 0.0), (0.1, 1.0, 0.0, 0.1), (0.0, -0.5, 0.0499999, 0.0), (0.0, 0.5, -1e-7, 2e-7)],
)
def test_all_starts_where_the_limits_of_what_moves_together_allow(
    write: Write, low: float, multiplier: float, offset: float, start: float
) -> None:
    """Figures of a file are rounded: half of 1.2 less 1e-7, say, is below 0."""
    mimic = f'<mimic joint="turn" multiplier="{multiplier!r}" offset="{offset!r}"/>'
    turns = (
        joint("turn", "revolute", "world", "leaf", limit(0.0, 1.2)),
        joint("follow", "revolute", "world", "other", limit(low, 1.2) + mimic),
    )
    twin = load_twin(write(link("world"), link("leaf"), link("other"), link("third"), *turns, SLIDING))
    active, follower = joint_iri("k", "turn"), joint_iri("k", "follow")
    assert twin.state[active] == pytest.approx(start, abs=1e-12)
    assert twin.state[follower] == pytest.approx(multiplier * start + offset, abs=1e-12)
    assert twin.at({SLIDE: 0.3}).state[active] == twin.state[active]


def test_joints_that_contradict_each_other_are_in_nobody_elses_way(write: Write) -> None:
    turns = (
        joint("turn", "revolute", "world", "leaf", limit(0.0, 1.0)),
        joint("follow", "revolute", "world", "other", limit(2.0, 3.0) + '<mimic joint="turn"/>'),
    )
    twin = load_twin(write(link("world"), link("leaf"), link("other"), link("third"), *turns, SLIDING))
    assert twin.at({SLIDE: 0.3}).state[SLIDE] == 0.3
    with pytest.raises(StateError, match=r"'follow' at 0\.5 rad is outside"):
        twin.at({joint_iri("k", "turn"): 0.5})


def test_moving_one_panel_moves_the_other() -> None:
    twin = kitchen_a()
    assert twin.at({UPPER: 1.0}).state[LOWER] == 1.2
    assert twin.at({LOWER: 1.5}).state[UPPER] == 1.25
    assert twin.at({UPPER: 1.0}).at({LOWER: 0.6}).state[UPPER] == 0.5
    assert [local_name(str(row["container"])) for row in twin.at({LOWER: 1.5}).select("open")] == [
        "cabinet4_door_bottom"
    ]


def test_panels_that_contradict_each_other_are_refused() -> None:
    with pytest.raises(StateError, match="contradicts 'cabinet4_door_top_top_joint'"):
        kitchen_a().at({UPPER: 1.0, LOWER: 1.0})
    with pytest.raises(StateError, match="outside its limits"):
        kitchen_a().at({UPPER: 1.9})  # allowed for itself, but the lower panel would be at 2.28 rad


def test_a_complete_state_can_be_given_back_with_one_change() -> None:
    twin = kitchen_a().at({UPPER: 1.0})
    assert twin.at({**twin.state, UPPER: 0.5}).state[LOWER] == 0.6


def test_other_branches_do_not_see_a_state(drawer: Path) -> None:
    closed = load_twin(drawer)
    opened = closed.at({SLIDE: 0.5})
    assert requests(opened) == [("Open", "cupboard_drawer")]
    assert requests(closed) == [("Close", "cupboard_drawer")]


def test_many_states_are_not_all_kept_and_none_is_lost(drawer: Path) -> None:
    first = load_twin(drawer)
    branches = [first.at({SLIDE: 0.5 * number / 1000}) for number in range(KEPT_STATES + 20)]
    for branch in branches:
        assert len(branch.select("closed")) == (branch.state[SLIDE] <= 0.01)
    assert requests(first) == [("Close", "cupboard_drawer")]
    assert first.triple_count() == branches[-1].triple_count()


def test_an_edit_changes_what_follows_from_it_and_nothing_else(drawer: Path) -> None:
    before = load_twin(drawer)
    after = before.with_edit(SLIDE, upperLimit=0.3)
    assert after.mechanism(after.environment).joint("slide").limits.upper == 0.3
    assert after.container("cupboard_drawer").upper == 0.3
    assert before.container("cupboard_drawer").upper == 0.5
    assert after.notes[-1] == "k: edited: slide: upperLimit = 0.3"
    assert before.content_hash(before.environment) != after.content_hash(after.environment)
    again = after.with_edit(SLIDE, upperLimit=0.5)
    assert again.content_hash(again.environment) == before.content_hash(before.environment)


def test_an_edit_of_what_is_not_there_is_refused(drawer: Path) -> None:
    twin = load_twin(drawer)
    with pytest.raises(UnknownEntityError, match="did you mean 'upperLimit'"):
        twin.with_edit(SLIDE, uperLimit=0.3)
    with pytest.raises(UnknownEntityError, match="no individual"):
        twin.with_edit(joint_iri("k", "other"), upperLimit=0.3)


def test_an_edit_that_the_present_state_contradicts_is_refused(drawer: Path) -> None:
    with pytest.raises(StateError):
        load_twin(drawer).at({SLIDE: 0.5}).with_edit(SLIDE, upperLimit=0.3)


def test_an_edit_of_a_robot_leaves_the_kitchen_as_it_is() -> None:
    before = load_twin("b", ["stretch"])
    (robot,) = before.robots
    after = before.with_edit(joint_iri("stretch", "joint_lift"), upperLimit=0.8)
    assert after.mechanism(robot).joint("joint_lift").limits.upper == 0.8
    assert after.content_hash(robot) != before.content_hash(robot)
    assert after.content_hash(after.environment) == before.content_hash(before.environment)
    assert after.containers() == before.containers()


def test_the_hash_is_of_content_not_of_where_meshes_lie(tmp_path: Path) -> None:
    hashes = set[str]()
    for place, content in (("one", b"solid"), ("two", b"solid"), ("three", b"other")):
        (tmp_path / place).mkdir()
        (tmp_path / place / "m.stl").write_bytes(content)
        path = tmp_path / place / "k.urdf"
        path.write_text(f'<robot name="k">{link("w", MESH)}</robot>', encoding="utf-8")
        twin = load_twin(path)
        hashes.add(twin.content_hash(twin.environment))
    assert len(hashes) == 2


MESH = '<mesh filename="m.stl"/>'


def test_the_hash_does_not_depend_on_the_run(drawer: Path) -> None:
    one, other = load_twin(drawer), load_twin(drawer)
    assert one.content_hash(one.environment) == other.content_hash(other.environment)


@pytest.mark.parametrize(
    ("form", "parsed"),
    [("turtle", ox.RdfFormat.TURTLE), ("trig", ox.RdfFormat.TRIG), ("nquads", ox.RdfFormat.N_QUADS)],
)
def test_what_is_written_reads_back(drawer: Path, form: str, parsed: ox.RdfFormat) -> None:
    twin = load_twin(drawer)
    written = {q.triple for q in ox.parse(twin.serialize(form), format=parsed)}
    store = twin.entities.store.dump(twin.graphs())
    assert written == {quad.triple for quad in store}
    assert not any(isinstance(t.subject, ox.BlankNode) or isinstance(t.object, ox.BlankNode) for t in written)


def test_rdflib_sees_the_same(drawer: Path) -> None:
    dataset = load_twin(drawer).to_rdflib()
    rows = dataset.query("SELECT ?p { ?j <https://example.org/sdt#position> ?p }")
    assert [float(str(row[0])) for row in rows] == [0.0]  # type: ignore[index]


def test_a_user_query_sees_entities_and_state(drawer: Path) -> None:
    columns, rows = load_twin(drawer).query(
        "SELECT ?joint ?p { ?joint sdt:position ?p ; sdt:openFrom ?from }"
    )
    assert columns == ["joint", "p"]
    assert rows == [{"joint": SLIDE, "p": 0.0}]


def test_a_continuous_door_has_no_thresholds_and_is_neither_open_nor_closed(write: Write) -> None:
    twin = load_twin(write(*door('<limit velocity="1" effort="1"/>', "continuous")))
    (container,) = twin.containers()
    assert (container.lower, container.upper) == (-math.inf, math.inf)
    assert requests(twin) == []
