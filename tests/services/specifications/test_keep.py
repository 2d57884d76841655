"""Results of task specifications as triples: the rule that broke, when, J, the motions that were chosen."""

from dataclasses import replace
from pathlib import Path

import pyoxigraph as ox
import pytest
from click.testing import CliRunner

from predicates.case import Outcome
from predicates.record.facts import Facts
from predicates.specification.read import read_specification
from predicates.specification.results.record import gives_way, task_record
from sdt_kg.iri import LAW, local_name
from services.app import Policy, Service
from services.commands.saved.recheck import recheck
from services.specifications import TaskResult, achieve_task, keep
from services.store.files import SavedVerdicts, readable
from services.why import why
from tests.small import small_twin
from tests.small.lift import Lifts

TASK = """
@prefix law: <https://example.org/law#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix t: <https://example.org/id/t/> .
t:task a law:TaskSpecification ; rdfs:label "fetch" ; law:hasStep t:one , t:two ;
  law:keeps t:rule ; law:optimises law:Time .
t:one a law:Task ; law:index 1 ; law:verb law:Open ; law:containerName "low_drawer" ; law:goalPosition 0.2 .
t:two a law:Task ; law:index 2 ; law:verb law:Open ; law:containerName "side_door" .
t:rule a law:NeverBeyond ; law:containerName "side_door" ; law:limitPosition %s .
"""


def run(limit: float, **policy: float) -> TaskResult:
    service = Service(small_twin("a", ("pr2",)), oracles=Lifts(), policy=Policy(**policy))
    return achieve_task(service, read_specification(service.twin, TASK % limit, "task.ttl"))


@pytest.fixture(scope="module")
def broken() -> TaskResult:
    return run(1.0)


@pytest.fixture(scope="module")
def kept() -> TaskResult:
    return run(1.5)


def test_a_recheck_of_a_task_needs_the_certificates_of_its_steps(kept: TaskResult, tmp_path: Path) -> None:
    place = tmp_path / "kept.trig"
    with SavedVerdicts(place) as saved:
        assert keep(saved, kept)
    asked = CliRunner().invoke(recheck, [str(place)])
    assert asked.exit_code == 1
    assert "step 1, open low_drawer to 0.2: its verdict is certified, and has no certificate" in asked.output


def test_the_rule_that_broke_is_told_with_step_time_and_state(broken: TaskResult, tmp_path: Path) -> None:
    place = tmp_path / "kept.trig"
    with SavedVerdicts(place) as saved:
        assert keep(saved, broken)
    store = readable(place).dump()
    facts = Facts(store.quads_for_pattern(None, None, None, ox.NamedNode(task_record(broken).graph)))
    (first,) = facts.all(broken.iri, LAW + "firstBroken")
    assert local_name(facts.needed(first, LAW + "inStep")) == "2"
    assert facts.measured(first, LAW + "time") == broken.broken.time > 0
    assert facts.measured(facts.needed(first, LAW + "diagnosis"), LAW + "bound") == 1.0
    text = why(store, broken.iri)
    assert text.startswith("Can pr2 do 'fetch' in kitchen a? NOT CERTIFIED")
    assert "1. BROKEN: side_door never beyond 1" in text
    assert f"in step 2 at {broken.broken.time:.4g} s, before any other rule" in text
    assert "1. open low_drawer to 0.2: CERTIFIED" in text
    assert f"sdt recheck {broken.iri} --store STORE" in text


def test_every_step_names_a_verdict_that_is_kept_too(kept: TaskResult, tmp_path: Path) -> None:
    place = tmp_path / "kept.trig"
    with SavedVerdicts(place) as saved:
        keep(saved, kept)
        for step in kept.steps:
            assert step.verdict.iri in saved
            assert saved.stored(step.verdict.iri).container == step.request.container.iri
    total = sum(step.value for step in kept.steps)
    text = why(readable(place).dump(), kept.iri)
    assert kept.outcome is Outcome.CERTIFIED
    assert f"J = Time: {total:.6g} s" in text
    assert "of 8 certified that broke no rule, 8 searched" in text


def test_the_iri_is_the_hash_of_what_decides_and_of_nothing_else(
    kept: TaskResult, broken: TaskResult
) -> None:
    assert kept.iri != broken.iri
    assert run(1.5, budget=3.0).iri == kept.iri, "a longer search answers the same question"
    renamed = read_specification(kept.case.twin, (TASK % 1.5).replace("fetch", "get"), "task.ttl")
    service = Service(kept.case.twin, oracles=Lifts())
    assert achieve_task(service, renamed).iri == kept.iri
    assert achieve_task(service.at("high_drawer=0.1"), renamed).iri != kept.iri


def test_a_result_gives_way_to_a_better_one_only(kept: TaskResult) -> None:
    worse, best = replace(kept, value=kept.value + 1), replace(kept, value=kept.value - 1)
    refused = replace(kept, outcome=Outcome.NOT_CERTIFIED, value=None)
    results = {"kept": kept, "worse": worse, "best": best, "refused": refused}
    of = {name: list(task_record(each).quads()) for name, each in results.items()}
    assert gives_way(of["kept"], of["best"], kept.iri)
    assert not gives_way(of["kept"], of["worse"], kept.iri)
    assert not gives_way(of["kept"], of["kept"], kept.iri)
    assert not gives_way(of["kept"], of["refused"], kept.iri)
    assert gives_way(of["refused"], of["kept"], kept.iri)


def test_what_was_kept_is_not_written_again(kept: TaskResult, tmp_path: Path) -> None:
    with SavedVerdicts(tmp_path / "kept.trig") as saved:
        assert keep(saved, kept)
        before = set(saved.store.graph(task_record(kept).graph))
        assert not keep(saved, kept)
        assert set(saved.store.graph(task_record(kept).graph)) == before
