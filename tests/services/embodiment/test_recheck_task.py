"""`sdt recheck` of a task's result: where each step begins, the rules, the outcome, J."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import pyoxigraph as ox
import pytest
from click.testing import CliRunner

from predicates.case import Artefact, Outcome
from predicates.record import StoredVerdict
from predicates.record.inputs import input_hash
from predicates.record.seal import RECORD_HASH
from predicates.specification.read import read_specification
from predicates.specification.results.stored import StoredResult, StoredStep
from predicates.specification.rules import Standing
from sdt_kg.iri import LAW, Iri, local_name, task_result_iri
from sdt_kg.twin import Twin
from services.app import Service, load
from services.commands.saved.recheck import recheck
from services.embodiment.recheck import Rechecked, Saved, recheck_verdict
from services.embodiment.recheck.models import Models, TwinOf
from services.embodiment.recheck.tasks import recheck_result
from services.physics.oracle import Kinematics
from services.specifications import TaskResult, achieve_task, keep
from services.store.files import SavedVerdicts

pytestmark = pytest.mark.oracle

Verdicts = dict[Iri, tuple[StoredVerdict, Artefact, Rechecked]]

TASK = """
@prefix law: <https://example.org/law#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix t: <https://example.org/id/t/> .
t:task a law:TaskSpecification ; rdfs:label "in turn" ; law:hasStep t:one , t:two ;
  law:keeps t:bounded , t:ordered ; law:optimises law:Time .
t:one a law:Task ; law:index 1 ; law:verb law:Open ; law:goalPosition 0.3 ;
  law:containerName "sink_area_left_middle_drawer_main" .
t:two a law:Task ; law:index 2 ; law:verb law:Open ; law:containerName "iai_fridge_door" .
t:bounded a law:NeverBeyond ; law:containerName "sink_area_left_middle_drawer_main" ; law:limitPosition %s .
t:ordered a law:OpensBefore ; law:containerName "iai_fridge_door" ;
  law:thenContainerName "sink_area_left_upper_drawer_main" .
"""


def asked(service: Service, limit: float) -> TaskResult:
    return achieve_task(service, read_specification(service.twin, TASK % limit, "task.ttl"))


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A store with one result that is certified, and one whose first rule is broken."""
    found = tmp_path_factory.mktemp("task") / "kept.trig"
    service = load("b", ["stretch"])
    service = replace(service, policy=replace(service.policy, budget=2.0))
    with SavedVerdicts(found) as saved:
        for limit in (0.31, 0.2):
            keep(saved, asked(service, limit))
    return found


@pytest.fixture(scope="module")
def saved(place: Path) -> Saved:
    return Saved(place)


@pytest.fixture(scope="module")
def twin_of(saved: Saved) -> TwinOf:
    """The saved twin, put together once for all that is about it, as `sdt recheck` does it."""
    return cache(saved.twin)


@pytest.fixture(scope="module")
def verdicts(saved: Saved, twin_of: TwinOf) -> Verdicts:
    found: Verdicts = {}
    for entry in saved.entries():
        assert entry.stored is not None
        assert entry.artefact is not None
        again = recheck_verdict(entry.stored, entry.artefact, twin_of)
        found[entry.iri] = (entry.stored, entry.artefact, again)
    return found


@pytest.fixture(scope="module")
def certified(saved: Saved, verdicts: Verdicts, twin_of: TwinOf) -> StoredResult:
    """The result that is certified; it holds as it was kept."""
    (found,) = [each for each in map(saved.result, saved.results()) if each.outcome is Outcome.CERTIFIED]
    assert recheck_result(found, verdicts.__getitem__, twin_of, Kinematics()).holds
    return found


@pytest.fixture(scope="module")
def broken(saved: Saved) -> StoredResult:
    (found,) = [each for each in map(saved.result, saved.results()) if each.outcome is not Outcome.CERTIFIED]
    return found


def test_a_certified_result_and_a_broken_rule_hold_with_their_verdicts(place: Path) -> None:
    told = CliRunner().invoke(recheck, [str(place)])
    assert told.exit_code == 0, told.output
    assert told.output.count("holds: task result, in turn, stretch in b") == 2


@pytest.mark.parametrize("said", [str, local_name])
def test_a_result_is_rechecked_by_its_iri_or_hash(
    place: Path, broken: StoredResult, said: Callable[[Iri], str]
) -> None:
    told = CliRunner().invoke(recheck, [said(broken.iri), "--store", str(place)])
    assert told.exit_code == 0, told.output
    assert "1 of 1 hold" in told.output


def _steps(result: StoredResult, change: Callable[[list[StoredStep]], Sequence[StoredStep]]) -> StoredResult:
    return replace(result, steps=tuple(change(list(result.steps))))


def _first(result: StoredResult, **changes: object) -> StoredResult:
    return _steps(result, lambda steps: [replace(steps[0], **changes), *steps[1:]])


def _asked_as(result: StoredResult, **changes: str) -> StoredResult:
    """With inputs changed, and an IRI that fits them."""
    inputs = tuple((name, changes.get(name, value)) for name, value in result.inputs)
    return replace(result, inputs=inputs, iri=task_result_iri(input_hash(inputs)))


WRONG: dict[str, tuple[Callable[[StoredResult], StoredResult], str]] = {
    "outcome": (lambda r: replace(r, outcome=Outcome.NOT_CERTIFIED), "the result says not_certified"),
    "rule": (
        lambda r: replace(r, rules=((r.rules[0][0], Standing.BROKEN), *r.rules[1:])),
        "rule 1 is 'sink_area_left_middle_drawer_main never beyond 0.31', broken,",
    ),
    "rule lost": (lambda r: replace(r, rules=r.rules[:1]), "rule 2 is not there in the result"),
    "rule added": (lambda r: replace(r, rules=(*r.rules, r.rules[0])), "and not there"),
    "limit": (
        lambda r: replace(r, written=r.written.replace("0.31", "0.32")),
        "'specification' is not the specification that was kept",
    ),
    "text": (lambda r: replace(r, written="no Turtle"), "the specification that was kept is not Turtle"),
    "value": (lambda r: replace(r, value=(r.value or 0.0) / 2), "J of the whole is"),
    "value of a step": (
        lambda r: _first(r, value=1.0),
        "step 1, open sink_area_left_middle_drawer_main to 0.3: J",
    ),
    "asked": (lambda r: replace(r, asked=3), "the result has 2 of 3 steps, its specification asks 2 of 2"),
    "step lost": (lambda r: _steps(r, lambda steps: steps[:1]), "the result has no step 2"),
    "steps twice": (lambda r: _steps(r, lambda steps: steps * 2), "the result has 4 of 2 steps"),
    "steps changed": (
        lambda r: _steps(r, lambda steps: steps[::-1]),
        "the specification asks 'open sink_area",
    ),
    "position": (lambda r: _first(r, position=0.2), "the specification asks"),
    "verdict": (
        lambda r: _steps(r, lambda s: [s[0], replace(s[1], verdict=s[0].verdict, artefact=s[0].artefact)]),
        "step 2, open iai_fridge_door: its verdict does not begin where the step before ended",
    ),
    "step's outcome": (lambda r: _first(r, outcome=Outcome.ABSTAINED), "it is said to be abstained"),
    "motion": (
        lambda r: _first(r, artefact="0" * 64),
        "another motion or proof than the one that was chosen",
    ),
    "moved": (
        lambda r: replace(r, moved={"https://example.org/id/b/joint/iai_fridge_door_joint": 0.5}),
        "'state' is not the state in which its first step is said to begin",
    ),
    "input": (
        lambda r: replace(r, inputs=(*r.inputs, ("more", "x"))),
        "IRI is not the hash of its inputs",
    ),
    "drive": (
        lambda r: _asked_as(r, **{"embodiment.drive": "omni"}),
        "verdict's input 'embodiment.drive' is",
    ),
    "class": (lambda r: replace(r, tee_class="https://example.org/tee#D_artic_dyn"), "the result's class is"),
    "robot": (lambda r: replace(r, robot="https://example.org/id/pr2"), "the result's input 'robot' is"),
}


@pytest.mark.parametrize("what", WRONG)
def test_a_result_that_its_steps_do_not_show_does_not_hold(
    what: str,
    certified: StoredResult,
    verdicts: Verdicts,
    twin_of: TwinOf,
) -> None:
    change, reason = WRONG[what]
    found = recheck_result(change(certified), verdicts.__getitem__, twin_of, Kinematics())
    assert reason in "; ".join(found.reasons)


def test_a_broken_rule_that_is_said_to_be_kept_does_not_hold(
    broken: StoredResult, verdicts: Verdicts, twin_of: TwinOf
) -> None:
    kept = tuple((rule, Standing.KEPT) for rule, _ in broken.rules)
    better = replace(broken, outcome=Outcome.CERTIFIED, rules=kept)
    found = recheck_result(better, verdicts.__getitem__, twin_of, Kinematics())
    assert "the result says certified, its steps and rules not_certified" in found.reasons


def test_a_result_does_not_hold_where_the_verdict_of_a_step_does_not(
    certified: StoredResult, verdicts: Verdicts, twin_of: TwinOf
) -> None:
    stored, artefact, found = verdicts[certified.steps[1].verdict]
    bad = {**verdicts, stored.iri: (stored, artefact, replace(found, reasons=("it touches something",)))}
    again = recheck_result(certified, bad.__getitem__, twin_of, Kinematics())
    assert again.reasons == ("step 2, open iai_fridge_door: its verdict does not hold: it touches something",)


def test_the_verdict_of_a_step_that_is_gone_is_a_reason(
    certified: StoredResult, place: Path, tmp_path: Path
) -> None:
    store = ox.Store()
    store.load(path=str(place), format=ox.RdfFormat.TRIG)
    key = certified.steps[1].verdict.rsplit("/", 1)[1]
    (graph,) = [each for each in store.named_graphs() if each.value.endswith(f"/verdict/{key}")]
    store.remove_graph(graph)
    left = tmp_path / "left.trig"
    store.dump(str(left), format=ox.RdfFormat.TRIG)
    told = CliRunner().invoke(recheck, [certified.iri, "--store", str(left)])
    assert told.exit_code == 1
    assert "no verdict https://example.org/id/verdict/" in told.output


@pytest.mark.parametrize("is_sealed", [True, False])
def test_a_result_is_read_only_as_it_was_written(
    certified: StoredResult, place: Path, tmp_path: Path, is_sealed: bool
) -> None:
    """Also that its specification was taken out is seen; one of a version that sealed nothing is left out."""
    store = ox.Store()
    store.load(path=str(place), format=ox.RdfFormat.TRIG)
    subject = ox.NamedNode(certified.iri)
    gone = [LAW + "writtenAs"] if is_sealed else [LAW + "writtenAs", RECORD_HASH]
    for name in gone:
        for quad in list(store.quads_for_pattern(subject, ox.NamedNode(name), None, None)):
            store.remove(quad)
    left = tmp_path / "left.trig"
    store.dump(str(left), format=ox.RdfFormat.TRIG)
    told = CliRunner().invoke(recheck, [str(left)])
    assert told.exit_code == (1 if is_sealed else 0)
    assert ("was changed after it was written" in told.output) is is_sealed
    assert ("1 result of a task was kept without specification" in told.output) is not is_sealed


def test_models_are_put_together_once_for_all_that_is_about_them(
    place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked, usual = list[Models](), Saved.twin

    def counted(saved: Saved, models: Models) -> tuple[Twin, str]:
        asked.append(models)
        return usual(saved, models)

    monkeypatch.setattr(Saved, "twin", counted)
    assert CliRunner().invoke(recheck, [str(place)]).exit_code == 0
    assert len(asked) == 1
