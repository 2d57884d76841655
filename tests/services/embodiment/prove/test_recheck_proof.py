"""`sdt recheck` of a stored proof: the verdict says what the proof shows, or it does not hold."""

import json
import math
import zlib
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from predicates.case import Artefact, ArtefactKind, Outcome
from predicates.record.inputs import UNKNOWN_INPUT, verdict_iri
from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from sdt_kg.task import Verb
from services.app import Policy, load
from services.embodiment.proof_check.proof.claim import Timing
from services.embodiment.proof_check.proof.content import IN_HAND, Proof
from services.embodiment.proof_check.proof.written import read_proof, to_bytes
from services.embodiment.prove import Prover
from services.embodiment.recheck import Saved, recheck_artefact, recheck_verdict
from services.embodiment.recheck.models import at_hand
from services.embodiment.recheck.saved import Entry, by_name
from services.store.files import SavedVerdicts
from tests.soak.doors import draw, write

pytestmark = pytest.mark.oracle

BOXES = 1_000  # of a proof, for each gripper and value


@pytest.fixture(scope="module")
def entry(tmp_path_factory: pytest.TempPathFactory) -> Entry:
    """A TIAGo that must not drive, asked for a door across the kitchen."""
    path = tmp_path_factory.mktemp("saved") / "verdicts.trig"
    service = load("b", ["tiago_dual"], policy=Policy(drive=Drive.FIXED))
    (verdict,) = service.achieve("open:iai_fridge_door")
    assert verdict.outcome is Outcome.NOT_CERTIFIED
    with SavedVerdicts(path) as saved:
        saved.add_twin(service.twin)
        saved.add(verdict)
    (entry,) = Saved(path).entries()
    return entry


def test_a_stored_proof_holds_and_says_what_it_is_relative_to(entry: Entry) -> None:
    assert entry.stored is not None
    assert entry.artefact is not None
    found = recheck_verdict(entry.stored, entry.artefact, by_name)
    assert found.holds, found.reasons
    assert found.kind == "proof"
    assert any(note.startswith("base policy: fixed") for note in found.notes)
    alone = recheck_artefact("proof", entry.artefact.content, by_name)
    assert alone.holds, alone.reasons


def test_a_verdict_that_says_something_else_than_its_proof_does_not_hold(entry: Entry) -> None:
    assert entry.stored is not None
    assert entry.artefact is not None
    stored, artefact = entry.stored, entry.artefact
    others = (
        replace(stored, outcome=Outcome.CERTIFIED),
        replace(stored, container=f"{stored.container}2"),
        replace(stored, diagnoses=tuple(replace(each, proof=False) for each in stored.diagnoses)),
        replace(stored, inputs=tuple((k, v.replace("fixed", "omni")) for k, v in stored.inputs)),
        replace(stored, drive="omni"),
        replace(stored, tee_class="https://example.org/tee#D_artic_dyn"),
        replace(stored, moved={"https://example.org/id/b/joint/iai_fridge_door_joint": 0.3}),
    )
    for other in others:
        assert not recheck_verdict(other, artefact, by_name).holds
    damaged = Artefact(ArtefactKind.PROOF, artefact.content[:-9])
    assert not recheck_verdict(stored, damaged, by_name).holds


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("environment", "https://example.org/id/b 0", "input 'environment'"),
        ("robot", "https://example.org/id/tiago_dual 0", "input 'robot'"),
        ("state", "0", "input 'state'"),
        ("task", "close https://example.org/id/b/body/iai_fridge_door", "input 'task'"),
    ],
)
def test_a_verdict_about_another_question_than_its_proof_does_not_hold(
    entry: Entry, name: str, value: str, said: str
) -> None:
    assert entry.stored is not None
    assert entry.artefact is not None
    inputs = tuple((key, value if key == name else was) for key, was in entry.stored.inputs)
    other = replace(entry.stored, inputs=inputs, iri=verdict_iri(inputs))
    found = recheck_verdict(other, entry.artefact, by_name)
    assert said in "; ".join(found.reasons)


@pytest.mark.parametrize(("turned", "holds"), [(0.0, True), (-math.tau, True), (9e-4, False)])
def test_a_proof_of_a_base_that_faces_the_handle_less_exactly_shows_nothing_of_one_that_does(
    entry: Entry, turned: float, holds: bool
) -> None:
    assert entry.stored is not None
    assert entry.artefact is not None
    claim = read_proof(entry.artefact.content).claim
    (twin, _), (x, y, yaw) = at_hand(by_name, claim.models, claim.state), claim.start
    about = twin, twin.robots[0], twin.container(claim.container), Drive.FIXED, (x, y, yaw + turned)
    proved = Prover(*about, np.array(claim.span)).prove(BOXES)
    assert proved is not None
    found = recheck_verdict(entry.stored, proved.artefact, by_name)
    assert found.holds is holds
    assert holds or "the verdict's start is" in found.reasons[0]


def test_a_proof_that_a_door_cannot_open_shows_nothing_about_closing_it(entry: Entry) -> None:
    assert entry.stored is not None
    assert entry.artefact is not None
    closing = f"close {entry.stored.container}"
    inputs = tuple((key, closing if key == "task" else was) for key, was in entry.stored.inputs)
    other = replace(entry.stored, verb=Verb.CLOSE, inputs=inputs, iri=verdict_iri(inputs))
    found = recheck_verdict(other, entry.artefact, by_name)
    assert "the proof is not about how it would close" in "; ".join(found.reasons)


def test_a_proof_about_times_shows_nothing_of_a_verdict_about_no_motion_that_has_any(entry: Entry) -> None:
    assert entry.stored is not None
    assert entry.artefact is not None
    claim = read_proof(entry.artefact.content).claim
    hurried = Proof(replace(claim, timing=Timing((0.0, 1e-3), claim.span)), (), (0, 1))
    artefact = Artefact(ArtefactKind.PROOF, to_bytes(hurried))
    assert recheck_artefact("proof", artefact.content, by_name).holds
    found = recheck_verdict(entry.stored, artefact, by_name)
    assert found.reasons == ("the proof is about times, and the verdict about no motion that has any",)


@pytest.mark.parametrize("part", ["span", "start"])
def test_a_number_larger_than_any_does_not_end_the_recheck(entry: Entry, part: str) -> None:
    assert entry.artefact is not None
    whole = json.loads(zlib.decompress(entry.artefact.content))
    whole["claim"][part][1] = 10**400
    found = recheck_artefact("large", zlib.compress(json.dumps(whole).encode()), by_name)
    assert "the proof is damaged" in found.reasons[0]


@pytest.mark.parametrize(
    "stated", [lambda told: told[1:], lambda told: [*told, "no wind"], lambda told: None]
)
def test_a_proof_that_states_other_assumptions_than_its_own_does_not_hold(
    entry: Entry, stated: Callable[[list[str]], list[str] | None]
) -> None:
    assert entry.artefact is not None
    whole = json.loads(zlib.decompress(entry.artefact.content))
    whole["assumptions"] = stated(whole["assumptions"])
    found = recheck_artefact("fewer", zlib.compress(json.dumps(whole).encode()), by_name)
    assert not found.holds
    assert found.reasons == ("the assumptions that the proof states are not those on which it rests",)


def test_lists_within_lists_without_end_do_not_end_the_recheck() -> None:
    with pytest.raises(InputError, match="cannot be read"):
        read_proof(zlib.compress(b"[" * 200_000))


@pytest.mark.parametrize(("lower", "holds"), [(0.1, False), (1.5, True)])
def test_a_proof_of_the_whole_way_shows_nothing_of_a_goal_before_its_end(
    entry: Entry, lower: float, holds: bool
) -> None:
    assert entry.stored is not None
    assert entry.artefact is not None
    goal = f"https://example.org/id/b/joint/iai_fridge_door_joint {lower} to {lower + 0.004}"
    told = {"final": goal, "task": UNKNOWN_INPUT}
    inputs = tuple((key, told.get(key, was)) for key, was in entry.stored.inputs)
    other = replace(entry.stored, verb=None, inputs=inputs, iri=verdict_iri(inputs))
    found = recheck_verdict(other, entry.artefact, by_name)
    assert found.holds is holds
    assert holds or "more than the way to the verdict's goal" in found.reasons[0]


@pytest.mark.parametrize(("motion", "holds"), [(UNKNOWN_INPUT, False), ("0" * 64, True)])
def test_a_motion_that_was_given_ends_anywhere_in_its_goal(entry: Entry, motion: str, holds: bool) -> None:
    assert entry.stored is not None
    assert entry.artefact is not None
    goal = "https://example.org/id/b/joint/iai_fridge_door_joint 0.1 to 1.57"
    told = {"final": goal, "task": UNKNOWN_INPUT, "motion": motion}
    inputs = tuple((key, told.get(key, was)) for key, was in entry.stored.inputs)
    other = replace(entry.stored, verb=None, inputs=inputs, iri=verdict_iri(inputs))
    found = recheck_verdict(other, entry.artefact, by_name)
    assert found.holds is holds, found.reasons
    assert holds or "more than the way to the verdict's goal" in found.reasons[0]


@pytest.mark.parametrize(("value", "holds"), [(0.018, True), (0.02, False)])
def test_a_proof_where_a_goal_is_met_already_shows_nothing_of_reaching_it(
    entry: Entry, value: float, holds: bool
) -> None:
    assert entry.stored is not None
    assert entry.artefact is not None
    whole = json.loads(zlib.decompress(entry.artefact.content))
    whole["claim"]["span"] = [0.0, 0.02]
    for one in whole["refutations"]:
        one["value"] = value
    goal = "https://example.org/id/b/joint/iai_fridge_door_joint 0.018 to 0.022"
    told = {"final": goal, "task": UNKNOWN_INPUT}
    inputs = tuple((key, told.get(key, was)) for key, was in entry.stored.inputs)
    other = replace(entry.stored, verb=None, inputs=inputs, iri=verdict_iri(inputs))
    changed = Artefact(ArtefactKind.PROOF, zlib.compress(json.dumps(whole).encode()))
    found = recheck_verdict(other, changed, by_name)
    assert found.holds is holds, found.reasons
    assert holds or "need not be passed" in found.reasons[0]


@pytest.fixture(scope="module")
def in_hand(tmp_path_factory: pytest.TempPathFactory) -> tuple[Entry, Saved]:
    """A standing TIAGo++ before a door, and a proof of holds in hand kept in place of one of every hold."""
    folder = tmp_path_factory.mktemp("front")
    front = write(draw(np.random.default_rng(95)), folder, "front95")
    soon = Policy(Drive.FIXED, (0.0, 0.0, 0.0), budget=0.1)  # before it is found in several holds
    service = load(front, ["tiago_dual"], policy=soon)
    (verdict,) = service.achieve("open:front_door")
    twin, door = service.twin, service.twin.container("front_door")
    about = twin, twin.robots[0], door, Drive.FIXED, (0.0, 0.0, 0.0), np.array([0.0, door.open_from])
    partial = Prover(*about, within=IN_HAND).prove(BOXES, one_hold=True)
    assert partial is not None
    assert verdict.can_perform is not None
    answer = replace(verdict.can_perform, diagnoses=(partial.diagnosis,), artefact=partial.artefact)
    verdict = replace(verdict, can_perform=answer, diagnoses=answer.diagnoses)
    with SavedVerdicts(folder / "verdicts.trig") as saved:
        saved.add_twin(service.twin)
        saved.add(verdict)
    saved = Saved(folder / "verdicts.trig")
    (entry,) = saved.entries()
    return entry, saved


def test_a_proof_of_holds_in_hand_is_kept_with_a_verdict_that_nothing_is_proved_of_others(
    in_hand: tuple[Entry, Saved],
) -> None:
    entry, saved = in_hand
    assert entry.stored is not None
    assert entry.artefact is not None
    assert not any(each.proof for each in entry.stored.diagnoses)
    found = recheck_verdict(entry.stored, entry.artefact, saved.twin)
    assert found.holds, found.reasons
    assert any("20 mm" in note for note in found.notes)
    sure = tuple(replace(each, proof=True) for each in entry.stored.diagnoses)
    other = recheck_verdict(replace(entry.stored, diagnoses=sure), entry.artefact, saved.twin)
    assert any("its proof is about less" in reason for reason in other.reasons)
