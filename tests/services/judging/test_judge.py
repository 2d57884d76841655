"""What a process that judges keeps of a state, and that another state is another question."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from services.app import Service, load
from services.compute.run import Loaded
from services.judging import judge
from services.judging.codec import JSON
from services.judging.judge import Judge, Setup
from services.judging.loaded import OtherModelsError, models_of
from services.judging.problems import Problem, ProblemType
from services.judging.workers.jobs import Done, Task
from tests.small import FOLDER

KITCHEN = "b"


def alone(service: Service) -> Judge:
    """A process that judges about one kitchen without robots."""
    return Judge({KITCHEN: service}, Loaded((KITCHEN,), ()), models_of([service.twin]))


def met(judging: Judge, *state: str, present: tuple[str, ...] = ()) -> set[tuple[str, str]]:
    """(verb, container) of the requests that a state meets."""
    payload = json.dumps({"state": list(state)}).encode()
    done = judging(Task(KITCHEN, "satisfies", payload, JSON, 1.0, present), lambda _: None)
    assert isinstance(done, Done)
    return {(one["verb"], one["container"]) for one in json.loads(done.payload)["requests"]}


def test_a_state_is_asked_about_once_and_another_is_another(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Service] = []
    stated = judge.stated
    monkeypatch.setattr(judge, "stated", lambda service: asked.append(service) or stated(service))
    judging = alone(load(KITCHEN, ()))
    closed = met(judging)
    assert ("close", "iai_fridge_door") in closed
    assert met(judging) == closed
    assert len(asked) == 1
    opened = met(judging, "iai_fridge_door=open")
    assert len(asked) == 2
    assert opened == met(judging, present=("iai_fridge_door=open",))
    assert opened ^ closed == {("close", "iai_fridge_door"), ("open", "iai_fridge_door")}


def test_what_is_computed_is_of_the_kitchen_that_is_asked_in_its_state_and_as_is_asked() -> None:
    kitchens = tuple(str(FOLDER / f"{name}.urdf") for name in ("a", "b"))
    robots = (str(FOLDER / "pr2.urdf"),)
    judging = Judge({}, Loaded(kitchens, robots), models_of(load(each, robots).twin for each in kitchens))
    asked = {"query": "SELECT ?v { ?v a law:Verdict }", "limit": 1, "budget": 1}

    def computed(twin: str, *present: str, **how: object) -> dict[str, set[str]]:
        payload = json.dumps(asked | how).encode()
        done = judging(Task(twin, "compute", payload, JSON, 60.0, present), lambda _: None)
        assert isinstance(done, Done), done
        found = json.loads(done.payload)["computed"]
        verdicts = [each["iri"] for each in found["ran"]] + [each["verdict"] for each in found["left_out"]]
        return {
            "of": {each["kitchen"] for each in (*found["ran"], *found["left_out"])},
            "iris": set(verdicts),
        }

    assert computed("")["of"] == {"a", "b"}
    closed, opened = computed("a"), computed("a", "low_drawer_joint=0.2")
    assert closed["of"] == opened["of"] == {"a"}
    assert not closed["iris"] & opened["iris"]
    for how in ({"friction": 0.3}, {"drive": "fixed"}):
        assert not closed["iris"] & computed("a", **how)["iris"]


def test_models_whose_files_changed_since_the_service_read_them_are_not_judged(tmp_path: Path) -> None:
    kitchen = tmp_path / "a.urdf"
    kitchen.write_text((FOLDER / "a.urdf").read_text())
    setup = Setup((str(kitchen),), (str(FOLDER / "pr2.urdf"),), frozenset())
    services = [load(str(kitchen), setup.robots)]
    setup = replace(setup, served=models_of(each.twin for each in services))
    asked = [
        Task("a", "satisfies", b"{}", JSON, 9.0),
        Task("a", "compute", b'{"query": "SELECT ?v { ?v a law:Verdict }", "limit": 1}', JSON, 60.0),
    ]
    before = setup()
    assert all(isinstance(before(each, lambda _: None), Done) for each in asked)
    kitchen.write_text(kitchen.read_text().replace('upper="0.5"', 'upper="0.4"', 1))
    later = setup()
    for each in asked:
        with pytest.raises(OtherModelsError, match="the files of a"):
            later(each, lambda _: None)
    said = before(asked[1], lambda _: None)  # it reads again
    assert isinstance(said, Problem)
    assert (said.kind, said.detail[:14]) == (ProblemType.UNAVAILABLE, "the files of a")


def test_no_more_states_are_kept_than_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(judge, "STATES_KEPT", 2)
    judging = alone(load(KITCHEN, ()))
    for degree in range(5):
        met(judging, f"iai_fridge_door={degree / 10}")
    assert len(judging._met) == 2


def test_a_misspelled_term_is_told_before_anything_is_judged() -> None:
    kitchen, robot = str(FOLDER / "a.urdf"), str(FOLDER / "pr2.urdf")
    judging = Setup((kitchen,), (robot,), models_of([load(kitchen, (robot,)).twin]))()
    asked = b'{"query": "SELECT ?v { ?v law:robot id:pr2 ; law:outcom ?o }"}'
    said = judging(Task("a", "compute", asked, JSON, 60.0), lambda _: None)
    assert isinstance(said, Problem)
    assert "law:outcom: no term of the ontology, so nothing was computed" in said.detail
