"""History: edits make branches, the past stays, undoing restores content, and time can be asked about."""

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sdt_kg.errors import GraphError, InputError, MotionError, StateError, UnknownEntityError
from sdt_kg.history import (
    Branch,
    Event,
    EventType,
    Followed,
    History,
    Rewritten,
    TakenAway,
    Trajectory,
    brought,
    changed,
    moved,
    obstacle,
    posed,
    without_obstacle,
)
from sdt_kg.history.edits import Edit
from sdt_kg.iri import body_iri, joint_iri, local_name
from sdt_kg.mechanism import Geometry, Pose, ShapeType
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.twin import Twin
from tests.small import small_twin

FOLDING, PANEL = joint_iri("a", "folding_door_joint"), joint_iri("a", "upper_panel_joint")
CUBE = (Geometry(ShapeType.BOX, Pose(), (0.2, 0.2, 0.2)),)


@cache
def begun() -> History:
    return History.of(small_twin("a", ("pr2", "stretch")))


def test_a_history_and_its_branches_are_shown_on_one_line() -> None:
    history, ajar = begun().derived(begun().first, moved({FOLDING: 0.3}))
    assert repr(history) == "<History of <Twin of kitchen a with pr2, stretch>, 2 branches>"
    assert repr(ajar).endswith(" of <Twin of kitchen a with pr2, stretch>: moved folding_door_joint to 0.3>")
    assert repr(history.first).endswith(": the first>")
    assert len(repr(ajar)) < 120


def drawer(twin: Twin) -> str:
    (container,) = [each for each in twin.containers() if each.kind == "drawer"][:1]
    return container.active_joint


def path(joint: str, end: float, samples: int = 11) -> Trajectory:
    values = np.linspace(0.0, end, samples)[:, None]
    return Trajectory.of(Motion(joint, np.linspace(0.0, 2.0, samples), values))


def opened(history: History, branch: Branch) -> list[str]:
    return [local_name(str(row["container"])) for row in history.select("open", branch)]


def test_an_edit_makes_a_branch_and_leaves_the_past_as_it_was() -> None:
    history = begun()
    first, joint = history.first, drawer(history.first.twin)
    upper = next(each.upper for each in first.twin.containers() if each.active_joint == joint)
    later, branch = history.derived(first, moved({joint: upper}))
    assert len(history.branches) == 1
    assert list(later.branches.values()) == [first, branch]
    assert len(opened(later, branch)) == 1
    assert opened(later, first) == opened(history, first) == []
    rows = later.query("SELECT ?parent { ?here prov:wasDerivedFrom ?parent }", branch)[1]
    assert rows == [{"parent": first.iri}]
    assert later.query("SELECT ?parent { ?here prov:wasDerivedFrom ?parent }", first)[1] == []


def test_the_same_edit_of_the_same_branch_is_the_same_branch() -> None:
    history = begun()
    edit = changed(history.first.twin, joint_iri("a", "swing_door_joint"), velocityLimit=0.5)
    history, one = history.derived(history.first, edit)
    history, other = history.derived(history.first, edit)
    assert one is other
    assert len(history.branches) == 2


def edits_of(twin: Twin) -> list[Callable[[Twin], Edit]]:
    """One edit for each entity: they touch nothing in common."""
    robot = twin.robots[0]
    swing = joint_iri("a", "swing_door_joint")
    return [
        lambda now: moved({PANEL: 0.25}),
        lambda now: moved({drawer(now): 0.125}),
        lambda now: changed(now, PANEL, velocityLimit=0.75),
        lambda now: posed(now, swing, Pose((1.0, 2.0, 1.0), (0.0, 0.0, 1.0, 0.0))),
        lambda now: obstacle(now, "box", CUBE, Pose((0.5, 0.0, 0.1))),
        lambda now: obstacle(now, "another box", CUBE, Pose((0.0, 0.5, 0.1))),
        lambda now: TakenAway(robot),
    ]


@settings(max_examples=6, suppress_health_check=[HealthCheck.too_slow])
@given(order=st.permutations(range(7)), count=st.integers(2, 4))
def test_edits_of_different_entities_commute_and_are_undone_one_by_one(order: list[int], count: int) -> None:
    history, made = begun(), edits_of(begun().first.twin)
    ends: list[str] = []
    for chosen in (order[:count], order[:count][::-1]):
        branch = history.first
        for number in chosen:
            history, branch = history.derived(branch, made[number](branch.twin))
        ends.append(branch.content_hash)
        for past in list(branch.past())[:-1]:
            undo = past.undo
            assert undo is not None
            history, branch = history.derived(branch, undo)
            assert past.parent is not None
            assert branch.content_hash == past.parent.content_hash
        assert branch.content_hash == history.first.content_hash
    assert ends[0] == ends[1]


def test_an_undone_edit_can_be_done_again() -> None:
    history = begun()
    history, branch = history.derived(history.first, moved({PANEL: 0.3}))
    history, back = history.undone(branch)
    history, again = history.undone(back)
    assert back.content_hash == history.first.content_hash
    assert again.content_hash == branch.content_hash
    assert again.iri != branch.iri
    with pytest.raises(InputError, match="first branch has no edit"):
        history.undone(history.first)


def test_an_obstacle_is_a_body_of_the_kitchen_and_can_be_taken_away() -> None:
    history = begun()
    history, with_box = history.derived(
        history.first, obstacle(history.first.twin, "box", CUBE, Pose((0.5, 0.0, 0.1)))
    )
    mechanism = with_box.twin.mechanism(with_box.twin.environment)
    assert mechanism.bodies[-1].collision == CUBE
    assert mechanism.joint("box_obstacle").origin.position == (0.5, 0.0, 0.1)
    with pytest.raises(InputError, match="'box' cannot name an obstacle"):
        obstacle(with_box.twin, "box", CUBE, Pose())
    history, without = history.derived(with_box, without_obstacle(with_box.twin, "box"))
    assert without.content_hash == history.first.content_hash
    with pytest.raises(UnknownEntityError, match="no obstacle named 'wall'"):
        without_obstacle(with_box.twin, "wall")


def test_an_undo_of_what_was_changed_since_is_refused() -> None:
    history = begun()
    history, once = history.derived(history.first, changed(history.first.twin, PANEL, upperLimit=0.8))
    history, twice = history.derived(once, changed(once.twin, PANEL, upperLimit=0.7))
    assert isinstance(once.undo, Rewritten)
    with pytest.raises(GraphError, match="was changed since"):
        history.derived(twice, once.undo)


def test_a_robot_leaves_and_comes_back_as_it_was() -> None:
    history = begun()
    robot = history.first.twin.robots[0]
    coming = brought(history.first.twin, robot)
    history, alone = history.derived(history.first, TakenAway(robot))
    assert robot not in alone.twin.robots
    history, both = history.derived(alone, coming)
    assert both.content_hash == history.first.content_hash
    assert both.twin.robot(robot) == history.first.twin.robot(robot)


def test_a_trajectory_has_events_at_the_first_sample_at_which_they_are_so() -> None:
    history = begun()
    folding = history.first.twin.container("folding_door")
    assert (folding.upper, folding.open_from) == (2.0, 1.8)
    history, branch = history.derived(history.first, Followed(path(PANEL, 1.0)))
    assert branch.events == (
        Event(EventType.NO_LONGER_CLOSED, folding.iri, 1, 0.2),
        Event(EventType.OPENED, folding.iri, 9, 1.8),
        Event(EventType.UPPER_LIMIT_REACHED, folding.iri, 10, 2.0),
    )
    assert history.at(branch, 5).state[FOLDING] == 1.0
    assert history.at(branch, -1).state == branch.twin.state
    with pytest.raises(MotionError, match="no sample 11; allowed: 0 to 10"):
        history.at(branch, 11)
    with pytest.raises(InputError, match="no trajectory ends in"):
        history.at(history.first, 0)


def test_when_did_this_become_open_and_what_was_open_just_before() -> None:
    history = begun()
    slide, folding = drawer(history.first.twin), history.first.twin.container("folding_door").iri
    slider = next(each for each in history.first.twin.containers() if each.active_joint == slide)
    history, pulled = history.derived(history.first, moved({slide: slider.upper}))
    history, turned = history.derived(pulled, Followed(path(PANEL, 1.0)))
    history, pushed = history.derived(turned, moved({slide: 0.0}))
    (row,) = history.select("when_opened", pushed, container=folding)
    assert (row["branch"], row["sample"], row["time"], row["step"]) == (turned.iri, 9, 1.8, 10)
    (row,) = history.select("when_opened", pushed, container=slider.iri)
    assert (row["branch"], row["time"]) == (pulled.iri, None)
    asked = {"container": folding}
    assert [row["other"] for row in history.select("open_just_before", pushed, **asked)] == [slider.iri]
    assert history.select("when_opened", pulled, container=folding) == []

    # Had the drawer been pushed in first, nothing would have been open: another branch, other answers.
    history, empty = history.derived(pulled, moved({slide: 0.0}))
    history, other = history.derived(empty, Followed(path(PANEL, 1.0)))
    assert history.select("open_just_before", other, **asked) == []


def test_what_is_open_from_the_first_is_open_just_before() -> None:
    twin = small_twin("a")
    slide = drawer(twin)
    slider = next(each for each in twin.containers() if each.active_joint == slide)
    history = History.of(twin.at({slide: slider.upper}))
    history, turned = history.derived(history.first, Followed(path(PANEL, 1.0)))
    (row,) = history.select("open_just_before", turned)
    assert row["other"] == slider.iri


def test_a_state_of_the_past_is_a_named_graph() -> None:
    history = begun()
    history, turned = history.derived(history.first, Followed(path(PANEL, 1.0)))
    query = (
        "SELECT ?now ?then { ?here prov:wasDerivedFrom/sdt:stateGraph ?g . "
        f"<{PANEL}> sdt:position ?now . GRAPH ?g {{ <{PANEL}> sdt:position ?then }} }}"
    )
    assert history.query(query, turned)[1] == [{"now": 1.0, "then": 0.0}]


def test_a_limit_that_is_edited_can_open_a_container_without_moving_it() -> None:
    history = begun()
    slide = drawer(history.first.twin)
    slider = next(each for each in history.first.twin.containers() if each.active_joint == slide)
    history, half = history.derived(history.first, moved({slide: slider.upper / 2}))
    history, short = history.derived(half, changed(half.twin, slide, upperLimit=slider.upper / 2))
    assert [event.type for event in short.events] == [EventType.OPENED, EventType.UPPER_LIMIT_REACHED]


def test_a_body_motion_tells_who_grasped_and_when() -> None:
    twin = small_twin("a", ("pr2", "stretch"))
    still, none = np.zeros((11, 3)), np.zeros((11, 0))
    values = np.concatenate([np.zeros(5), np.linspace(0, 1, 6)])[:, None]
    motion = BodyMotion(
        twin.robots[0], "gripper", (), np.linspace(0.0, 1.0, 11), still, none, none, still,
        (PANEL,), values, np.zeros((11, 1)), (("drive", 0), ("grasp", 2), ("follow", 5)),
    )  # fmt: skip
    trajectory = Trajectory.of(motion)
    history, branch = begun().derived(begun().first, Followed(trajectory))
    grasped = branch.events[0]
    handle = twin.container("folding_door").handle
    assert grasped == Event(EventType.GRASPED, handle, 5, 0.5, twin.robots[0])
    ask = "SELECT ?robot ?time { ?e a sdt:ContactMade ; sdt:by ?robot ; sdt:time ?time }"
    assert history.query(ask, branch)[1] == [{"robot": twin.robots[0], "time": 0.5}]


def test_samples_come_back_from_bytes() -> None:
    trajectory = path(PANEL, 1.0)
    back = Trajectory.from_bytes(trajectory.to_bytes())
    assert back.iri == trajectory.iri
    assert np.array_equal(back.positions, trajectory.positions)
    assert path(PANEL, 0.9).iri != trajectory.iri
    for content in (b"", b"nonsense", trajectory.to_bytes()[:100]):
        with pytest.raises(MotionError, match="no archive of a trajectory"):
            Trajectory.from_bytes(content)


def test_a_trajectory_that_does_not_fit_is_refused() -> None:
    history = begun()
    history, turned = history.derived(history.first, moved({PANEL: 0.5}))
    with pytest.raises(StateError, match=r"begins with 'upper_panel_joint' at 0; allowed: 0\.5"):
        history.derived(turned, Followed(path(PANEL, 1.0)))
    with pytest.raises(StateError, match="outside its limits"):
        history.derived(history.first, Followed(path(PANEL, 1.5)))
    with pytest.raises(MotionError, match="replay it"):
        Trajectory.of(Motion(body_iri("a", "folding_door"), np.arange(2.0), np.zeros((2, 7))))
    with pytest.raises(MotionError, match="increasing times"):
        Trajectory.of(Motion(PANEL, np.zeros(2), np.zeros((2, 1))))
    with pytest.raises(UnknownEntityError, match="no branch named"):
        history.branch("https://example.org/id/branch/none")
