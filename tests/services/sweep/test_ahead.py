"""Kitchens that another process reads are those that are read here."""

import multiprocessing as mp
import os
from collections.abc import Callable
from pathlib import Path
from typing import NoReturn

import pytest

from predicates.scope import verb_iri
from sdt_kg import scope
from sdt_kg.errors import UrdfError
from sdt_kg.load import load_twin
from sdt_kg.scope import look, violations
from sdt_kg.task import Verb
from sdt_kg.twin import Twin
from services.sweep import ahead, worker
from services.sweep.ahead import reading
from services.sweep.worker import kitchen_of, reading_ahead, remember_looks, twin_of

OUTSIDE = """<robot name="k">
  <link name="world"/>
  <link name="door"><collision><geometry><box size="0.02 0.5 0.5"/></geometry></collision></link>
  <link name="handle"><collision><geometry><box size="0.02 0.1 0.02"/></geometry></collision></link>
  <joint name="hinge" type="continuous">
    <parent link="world"/><child link="door"/><axis xyz="0 0 1"/><limit velocity="1" effort="1"/>
  </joint>
  <joint name="mount" type="fixed">
    <parent link="door"/><child link="handle"/><origin xyz="0.05 0.4 0"/>
  </joint>
</robot>"""
"""A door that turns without end."""


@pytest.fixture(autouse=True)
def nothing_read() -> None:
    worker._kitchen.cache_clear()
    worker._ahead.clear()
    scope._elsewhere.clear()


@pytest.fixture
def read_here(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Kitchens that this process read."""
    names: list[str] = []

    def read(name: str) -> Twin:
        names.append(name)
        return load_twin(name)

    monkeypatch.setattr(worker, "load_twin", read)
    return names


@pytest.mark.parametrize("name", ["a", "b"])
def test_it_says_the_same_as_one_that_is_read_here(name: str) -> None:
    with reading([name], load_twin, look) as read:
        found = read.kitchens()
    one, other = found[name], load_twin(name)
    kitchen = other.environment
    assert one.mechanism(kitchen) == other.mechanism(kitchen)
    assert one.content_hash(kitchen) == other.content_hash(kitchen)
    assert (one.containers(), one.kitchen(), one.state) == (other.containers(), other.kitchen(), other.state)
    assert (one.notes, one.graphs()) == (other.notes, other.graphs())
    facts = [list(each.entities._facts_of(kitchen).triples()) for each in (one, other)]
    assert facts[0] == facts[1]
    quads = [frozenset(map(str, each.entities.store.dump(each.entities.graphs))) for each in (one, other)]
    assert quads[0] == quads[1]


def test_what_was_read_ahead_is_not_read_here(read_here: list[str]) -> None:
    with reading_ahead(["a", "b"], ["pr2"], Verb.OPEN):
        assert kitchen_of("b").name(kitchen_of("b").environment) == "b"
    assert read_here == []


def test_one_that_was_written_since_is_read_here(read_here: list[str], tmp_path: Path) -> None:
    path = tmp_path / "kitchen.urdf"
    path.write_text('<robot name="k"><link name="room"/></robot>', encoding="utf-8")
    with reading_ahead([str(path)], [], Verb.OPEN):
        pass
    path.write_text('<robot name="k"><link name="house"/></robot>', encoding="utf-8")
    os.utime(path, ns=(1, 1))
    kitchen = kitchen_of(str(path))
    assert read_here == [str(path)]
    assert kitchen.mechanism(kitchen.environment).root == "house"


def test_one_that_cannot_be_read_is_told_when_it_is_asked_for(tmp_path: Path) -> None:
    path = tmp_path / "kitchen.urdf"
    path.write_text("<robot", encoding="utf-8")
    with reading_ahead(["b", str(path)], [], Verb.OPEN):
        assert kitchen_of("b").containers()
    with pytest.raises(UrdfError, match="is not XML"):
        kitchen_of(str(path))


@pytest.mark.parametrize("verb", list(Verb))
def test_what_another_process_looked_at_is_not_looked_at_here(
    verb: Verb, monkeypatch: pytest.MonkeyPatch
) -> None:
    def looks(*_: object) -> NoReturn:
        raise AssertionError("another process has looked at it")

    scope._checked.cache_clear()
    with reading_ahead(["b"], [], verb):
        kitchen = kitchen_of("b")
        expected = {each: violations(kitchen, each, verb=verb_iri(verb)) for each in kitchen.containers()}
        scope._checked.cache_clear()
        remember_looks()
    monkeypatch.setattr(scope, "check", looks)
    assert {each: violations(kitchen, each, verb=verb_iri(verb)) for each in expected} == expected


@pytest.mark.parametrize("robot", ["pr2", "stretch"])
def test_what_another_process_saw_of_a_robot_is_not_looked_at_here(
    robot: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def looks(*_: object) -> NoReturn:
        raise AssertionError("another process has looked at it")

    twin = load_twin("b", [robot])
    container, iri = twin.containers()[0], twin.robots[0]
    scope._checked.cache_clear()
    expected = violations(twin, container, iri, verb_iri(Verb.OPEN))
    scope._checked.cache_clear()
    with reading_ahead(["b"], [robot, "nothing.urdf"], Verb.OPEN):
        remember_looks()
    monkeypatch.setattr(scope, "check", looks)
    assert violations(twin_of("b", robot), container, iri, verb_iri(Verb.OPEN)) == expected


def test_what_is_outside_is_told_as_another_process_saw_it(tmp_path: Path) -> None:
    path = tmp_path / "kitchen.urdf"
    path.write_text(OUTSIDE, encoding="utf-8")
    scope._checked.cache_clear()
    here = load_twin(path)
    expected = {each.name: violations(here, each, verb=verb_iri(Verb.OPEN)) for each in here.containers()}
    assert any(expected.values())
    scope._checked.cache_clear()
    with reading_ahead([str(path)], [], Verb.OPEN):
        remember_looks()
    assert scope._elsewhere
    kitchen = kitchen_of(str(path))
    found = {each.name: violations(kitchen, each, verb=verb_iri(Verb.OPEN)) for each in kitchen.containers()}
    assert found == expected
    assert not scope._elsewhere


def test_more_than_can_be_looked_at_meanwhile_is_left_to_the_workers(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ahead, "LOOKED_AT", len(load_twin("b").containers()))
    with reading(["a", "b"], load_twin, look) as read:
        assert read.kitchens().keys() == {"a", "b"}
        assert len(read.seen()) == ahead.LOOKED_AT


def _dies(_: str) -> Twin:
    os._exit(1)


@pytest.mark.parametrize("read", [_dies])
def test_where_the_other_process_dies_nothing_was_read(read: Callable[[str], Twin]) -> None:
    with reading(["a", "b"], read, look) as come:
        assert come.kitchens() == {}
        assert come.seen() == {}


def test_who_does_not_wait_leaves_no_process_behind() -> None:
    before = {each.pid for each in mp.active_children()}
    with reading(["a", "b"], load_twin, look):
        assert len(mp.active_children()) == len(before) + 1
    assert {each.pid for each in mp.active_children()} == before
