"""A history that was kept is opened again: the same branches, or a refusal that says what was changed."""

from functools import cache

import numpy as np
import pyoxigraph as ox
import pytest

from sdt_kg.errors import GraphError, InputError
from sdt_kg.history import (
    Branch,
    Followed,
    History,
    TakenAway,
    Trajectory,
    brought,
    changed,
    has_history,
    moved,
    obstacle,
    reopened,
)
from sdt_kg.history.records import record_graph
from sdt_kg.iri import SDT, joint_iri
from sdt_kg.mechanism import Geometry, Pose, ShapeType
from sdt_kg.motion import Motion
from sdt_kg.store import MemoryStore
from tests.small import small_twin

PANEL, DRAWER = joint_iri("a", "upper_panel_joint"), joint_iri("a", "low_drawer_joint")
FOLDING = joint_iri("a", "folding_door_joint")
CUBE = (Geometry(ShapeType.BOX, Pose(), (0.2, 0.2, 0.2)),)
AJAR = 0.1 + 0.2
"""A number that needs all its digits."""


@cache
def kept() -> tuple[History, Trajectory]:
    """Every kind of edit, two branches from one parent, and an edit undone."""
    twin = small_twin("a", ("pr2", "stretch"))
    values, upper = np.linspace(0.0, 1.0, 11)[:, None], twin.container("low_drawer").upper
    turn = Trajectory.of(Motion(PANEL, np.linspace(0.0, 2.0, 11), values))
    history = History.of(twin, MemoryStore())
    history, turned = history.derived(history.first, Followed(turn))
    history, follower = history.derived(turned, moved({FOLDING: AJAR}))
    history, slow = history.derived(follower, changed(follower.twin, PANEL, velocityLimit=0.2))
    history, blocked = history.derived(slow, obstacle(slow.twin, "crate", CUBE, Pose((1.0, 0.0, 0.1))))
    history, alone = history.derived(blocked, TakenAway(twin.robots[1]))
    history, _ = history.derived(alone, brought(twin, twin.robots[1]))
    history, _ = history.undone(slow)
    history, _ = history.derived(turned, moved({PANEL: 1.0}))  # no change is an edit too
    history, still = history.derived(turned, moved({}))
    history, _ = history.derived(still, changed(still.twin, DRAWER, upperLimit=upper))
    return history, turn


def graphs(history: History) -> ox.Store:
    """Everything that the history's store holds, written and read."""
    assert isinstance(history.store, MemoryStore)
    text = history.store.everything().dump(format=ox.RdfFormat.TRIG)
    assert text is not None, "no output was given"
    read = ox.Store()
    read.load(text, format=ox.RdfFormat.TRIG)
    return read


def told(branch: Branch) -> tuple[object, ...]:
    sentence = None if branch.edit is None else branch.edit.sentence
    parent = None if branch.parent is None else branch.parent.iri
    return branch.iri, parent, sentence, branch.content_hash, branch.step, branch.events, branch.twin.state


def test_every_branch_is_there_again() -> None:
    history, turn = kept()
    again = reopened(graphs(history), {turn.iri: turn})
    assert {iri: told(each) for iri, each in again.branches.items()} == {
        iri: told(each) for iri, each in history.branches.items()
    }
    assert set(graphs(again)) == set(graphs(history))


def test_time_can_be_asked_about_and_edits_go_on() -> None:
    history, turn = kept()
    again = reopened(graphs(history), {turn.iri: turn})
    last = max(history.branches.values(), key=lambda branch: branch.step)
    for query in ("when_opened", "open_just_before", "open"):
        assert again.select(query, last.iri) == history.select(query, last)
    assert again.select("when_opened", last.iri)
    assert again.at(next(each for each in again.branches.values() if each.trajectory), 5).state[PANEL] == 0.5
    edit = moved({DRAWER: 0.05})
    assert again.derived(last.iri, edit)[1].iri == history.derived(last, edit)[1].iri
    undone, before = again.undone(last.iri), history.undone(last)
    assert undone[1].content_hash == before[1].content_hash


def test_samples_that_are_not_given_or_are_others_are_named() -> None:
    history, turn = kept()
    with pytest.raises(InputError, match=turn.iri):
        reopened(graphs(history))
    other = Trajectory(turn.joints, turn.times, turn.positions * 0.5)
    with pytest.raises(GraphError, match="are others"):
        reopened(graphs(history), {turn.iri: other})


@pytest.mark.parametrize(
    ("update", "message"),
    [
        ("DELETE { GRAPH ?g { ?m sdt:movedTo ?v } } INSERT { GRAPH ?g { ?m sdt:movedTo 0.5e0 } }"
         " WHERE { GRAPH ?g { ?m sdt:movedTo ?v } }", "was changed"),
        ("DELETE { GRAPH ?g { ?e sdt:time ?v } } INSERT { GRAPH ?g { ?e sdt:time 9e0 } }"
         " WHERE { GRAPH ?g { ?e sdt:time ?v } }", "record of .* was changed"),
        ("DELETE WHERE { GRAPH ?g { ?b sdt:hasEvent ?e } }", "was changed"),
        ("DELETE { GRAPH ?g { ?b sdt:contentHash ?h } } INSERT { GRAPH ?g { ?b sdt:contentHash 'f' } }"
         " WHERE { GRAPH ?g { ?b a sdt:Branch ; sdt:contentHash ?h } }", "was changed"),
        ("DELETE { GRAPH ?g { ?j sdt:velocityLimit ?v } } INSERT { GRAPH ?g { ?j sdt:velocityLimit 0.3e0 } }"
         " WHERE { GRAPH ?g { ?j sdt:velocityLimit ?v } FILTER(?v = 0.2) }", "was changed"),
        ("DELETE { GRAPH ?g { ?j sdt:position ?v } } INSERT { GRAPH ?g { ?j sdt:position 0.01e0 } }"
         " WHERE { GRAPH ?g { ?j sdt:position ?v } }", "was changed"),
        ("DELETE WHERE { GRAPH ?g { ?b sdt:stateGraph ?s } }", "0 values for the stateGraph"),
        ("DELETE WHERE { GRAPH ?g { ?b sdt:entitySet ?s } }", "0 values for the entitySet"),
        ("DELETE { GRAPH ?g { ?b a sdt:Branch } } WHERE { GRAPH ?g { ?b sdt:step 11 } }", "is not there"),
        ("DELETE WHERE { GRAPH ?g { ?b a sdt:Branch } }", "0 histories"),
    ],
)  # fmt: skip
def test_what_was_changed_is_refused(update: str, message: str) -> None:
    history, turn = kept()
    tampered = graphs(history)
    before = set(tampered)
    tampered.update(f"PREFIX sdt: <{SDT}> {update}")
    assert set(tampered) != before, "an edit that changes nothing tests nothing"
    with pytest.raises(InputError, match=message):
        reopened(tampered, {turn.iri: turn})


def test_of_several_histories_one_is_named() -> None:
    both, twins = ox.Store(), [small_twin(kitchen) for kitchen in ("a", "b")]
    for twin in twins:
        both.extend(graphs(History.of(twin, MemoryStore())))
    with pytest.raises(InputError, match=r"2 histories .*a, b"):
        reopened(both)
    for twin in twins:
        assert reopened(both, environment=twin.environment).first.twin.environment == twin.environment


def test_a_twin_alone_is_no_history() -> None:
    history, _ = kept()
    twin = ox.Store()
    twin.load(history.first.twin.serialize("nquads"), format=ox.RdfFormat.N_QUADS)
    twin.extend(history.store.dump([record_graph(history.first.iri)]))
    assert not has_history(twin)
    assert has_history(graphs(history))
