"""A stored certificate holds as it was stored, and not after any change of it, its verdict or its models."""

import base64
import hashlib
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pyoxigraph as ox
import pytest

from predicates.case import Case, Outcome
from predicates.law import law
from predicates.record.seal import RECORD_HASH, SECONDS, check_seal, sealed
from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from sdt_kg.iri import ID, LAW, RDF, SDT, graph_iri, local_name
from sdt_kg.task import Task, Verb
from services.embodiment.certify.certificate import read_certificate, said_in
from services.embodiment.certify.certificate import sealed as packed
from services.embodiment.oracle import WholeBody
from services.embodiment.recheck import Rechecked, Saved, recheck_artefact, recheck_verdict
from services.physics.oracle import Kinematics
from services.store.files import SavedVerdicts
from tests.services.embodiment.gantry import START, gantry_twin, opening

pytestmark = pytest.mark.oracle

Said = dict[str, object]
Change = Callable[[ox.Store], None]


@dataclass(frozen=True)
class Kept:
    """A saved verdict with its certificate and its twin."""

    folder: Path
    file: Path
    content: bytes
    iri: str


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Kept:
    return kept_in(tmp_path_factory.mktemp("kept"))


def kept_in(folder: Path) -> Kept:
    twin = gantry_twin(folder)
    task = Task(Verb.OPEN, twin.container("drawer_main").iri)
    case = Case(twin, twin.robots[0], task, body_motion=opening())
    (verdict,) = law(case, Kinematics(), WholeBody(Drive.OMNI, START))
    assert verdict.outcome is Outcome.CERTIFIED
    assert verdict.can_perform is not None
    assert verdict.can_perform.artefact is not None
    file = folder / "kept.nq"
    with SavedVerdicts(file) as saved:
        saved.add_twin(twin)
        saved.add(verdict)
    return Kept(folder, file, verdict.can_perform.artefact.content, verdict.iri)


def recheck(file: Path) -> Rechecked:
    saved = Saved(file)
    (entry,) = saved.entries()
    assert saved.entry(entry.iri) == entry
    if entry.stored is None:
        return Rechecked(entry.iri, "", None, (entry.damage,), (), 0.0)
    assert entry.artefact is not None
    return recheck_verdict(entry.stored, entry.artefact, saved.twin)


def test_what_was_stored_holds(kept: Kept) -> None:
    found = recheck(kept.file)
    assert found.reasons == ()
    assert found.notes == ("models of the saved graphs",)


def test_a_certificate_is_read_as_it_was_written(kept: Kept) -> None:
    certificate = read_certificate(kept.content)
    assert read_certificate(certificate.content()).content() == kept.content
    assert np.array_equal(certificate.motion.q, opening().q)
    assert certificate.nearest[0].startswith("nearest (")


def test_what_a_certificate_leaves_unsaid_is_told(kept: Kept) -> None:
    certificate = read_certificate(kept.content)
    silent = replace(certificate, nearest=("nothing comes near",)).content()
    found = recheck_artefact("silent.cert", silent, Saved(kept.file).twin)
    assert found.holds
    *_, invented = found.notes
    unsaid = tuple(f"the certificate does not say: {each}" for each in certificate.nearest)
    assert found.notes[-len(unsaid) - 1 : -1] == unsaid
    assert invented == "the certificate says, and it is not found again: nothing comes near"


def sealed_again(store: ox.Store, iri: str) -> None:
    """As one does who knows how a record is sealed."""
    graph = ox.NamedNode(graph_iri("verdict", local_name(iri)))
    for quad in list(store.quads_for_pattern(None, ox.NamedNode(RECORD_HASH), None, graph)):
        store.remove(quad)
    quads = list(store.quads_for_pattern(None, None, None, graph))
    subject, predicate, value = sealed(iri, [(q.subject.value, q.predicate.value, q.object) for q in quads])[
        -1
    ]
    store.add(ox.Quad(ox.NamedNode(subject), ox.NamedNode(predicate), value, graph))


def changed(kept: Kept, folder: Path, change: Change, seal: bool = True) -> Rechecked:
    store = ox.Store()
    store.load(path=str(kept.file), format=ox.RdfFormat.N_QUADS)
    change(store)
    if seal:
        sealed_again(store, kept.iri)
    file = folder / "changed.nq"
    with file.open("wb") as out:
        store.dump(out, ox.RdfFormat.N_QUADS)
    return recheck(file)


def setting(property_iri: str, value: str | float, subject_ends: str = "", was: str | None = None) -> Change:
    """Replace the value of the only triple with this property, whose subject ends and whose value is so."""

    def change(store: ox.Store) -> None:
        quads = [
            quad
            for quad in store.quads_for_pattern(None, ox.NamedNode(property_iri), None)
            if isinstance(quad.subject, ox.NamedNode) and quad.subject.value.endswith(subject_ends)
            if was is None or quad.object.value == was
        ]
        assert len(quads) == 1
        old = quads[0].object
        new = ox.NamedNode(str(value)) if isinstance(old, ox.NamedNode) else ox.Literal(value)
        if isinstance(old, ox.Literal) and isinstance(value, str):
            new = ox.Literal(value, datatype=old.datatype)
        store.remove(quads[0])
        store.add(ox.Quad(quads[0].subject, quads[0].predicate, new, quads[0].graph_name))

    return change


def rewritten(kept: Kept, edit: Callable[[Said], None]) -> bytes:
    said = said_in(kept.content)
    edit(said)
    return packed(said)


def with_artefact(content: bytes) -> Change:
    """The artefact replaced by one that is whole: its hash is right."""

    def change(store: ox.Store) -> None:
        setting(LAW + "content", base64.b64encode(content).decode())(store)
        setting(LAW + "contentHash", hashlib.sha256(content).hexdigest())(store)

    return change


def test_a_flipped_byte_of_the_artefact_is_found(kept: Kept, tmp_path: Path) -> None:
    flipped = bytes([*kept.content[:100], kept.content[100] ^ 1, *kept.content[101:]])
    found = changed(kept, tmp_path, setting(LAW + "content", base64.b64encode(flipped).decode()))
    assert "its bytes have the hash" in found.reasons[0]


def test_no_flipped_byte_of_a_certificate_alone_goes_unnoticed(kept: Kept) -> None:
    def no_twin(*_: object) -> None:
        pytest.fail("it was believed")

    for at in np.random.default_rng(3).integers(0, len(kept.content), 60):
        flipped = bytearray(kept.content)
        flipped[at] ^= 4
        assert not recheck_artefact("flipped", bytes(flipped), no_twin).holds  # type: ignore[arg-type]
    assert not recheck_artefact("short", kept.content[:-1], no_twin).holds  # type: ignore[arg-type]
    assert not recheck_artefact("long", kept.content + b"0", no_twin).holds  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (setting(LAW + "value", 0.5, was="0.02"), "'smallest distance, environment'"),
        (setting(LAW + "robot", "https://example.org/id/other"), "robot is other"),
        (setting(LAW + "outcome", LAW + "NotCertified"), "has a certificate"),
        (setting(LAW + "causes", False), "all three predicates"),
        (setting(LAW + "inputHash", "differential", was="omni"), "IRI is not the hash"),
        (setting(SDT + "upperLimit", 0.7, "drawer_main_joint"), "effectiveUpperLimit"),
        (setting(SDT + "velocityLimit", 0.7, "drawer_main_joint"), "effectiveVelocityLimit"),
    ],
    ids=["figure", "robot", "outcome", "predicate", "input", "limit in the twin", "speed in the twin"],
)
def test_a_changed_graph_does_not_hold(kept: Kept, tmp_path: Path, change: Change, said: str) -> None:
    found = changed(kept, tmp_path, change)
    assert not found.holds
    assert said in "; ".join(found.reasons)


def test_no_triple_of_a_record_can_be_changed_added_or_removed_unseen(kept: Kept, tmp_path: Path) -> None:
    store = ox.Store()
    store.load(path=str(kept.file), format=ox.RdfFormat.N_QUADS)
    graph = ox.NamedNode(graph_iri("verdict", local_name(kept.iri)))
    quads = list(store.quads_for_pattern(None, None, None, graph))
    check_seal(kept.iri, quads)
    claims = [quad for quad in quads if quad.predicate.value not in SECONDS]
    for quad in claims:
        others = [each for each in quads if each != quad]
        for value in (None, ox.NamedNode("a:b"), ox.Literal("another")):
            more = [] if value is None else [ox.Quad(quad.subject, quad.predicate, value, graph)]
            with pytest.raises(InputError, match=r"changed after it was written|has no hash"):
                check_seal(kept.iri, [*others, *more])
    note = ox.Quad(ox.NamedNode(kept.iri), ox.NamedNode(LAW + "note"), ox.Literal("for certain"), graph)
    found = changed(kept, tmp_path, lambda one: one.add(note), seal=False)
    assert "was changed after it was written" in found.reasons[0]


def shift_a_waypoint(said: Said) -> None:
    motion = said["motion"]
    assert isinstance(motion, dict)
    q = np.frombuffer(base64.b64decode(motion["q"]["f8"])).reshape(motion["q"]["shape"]).copy()
    q[len(q) // 2, 1] += 0.01
    motion["q"]["f8"] = base64.b64encode(q.tobytes()).decode()


def improve(said: Said) -> None:
    assert isinstance(said["figures"], dict)
    said["figures"]["tool slip"] = [0.0, "m"]


@pytest.mark.parametrize(
    ("edit", "said"),
    [
        (shift_a_waypoint, "another one"),
        (lambda said: said["tolerances"].update(contact=0.001), "embodiment.tolerances"),
        (improve, "'tool slip'"),
        (lambda said: said.update(drive="fixed"), "embodiment.drive"),
        (lambda said: said.update(start=[0.0, 0.0, 1.0]), "start"),
        (lambda said: said.update(container="https://example.org/id/cell/body/bar"), "container"),
        (lambda said: said["state"].update({next(iter(said["state"])): 0.1}), "state"),
        (lambda said: said.pop("motion"), "lacks a part"),
        (lambda said: said["motion"]["q"].update(shape=[-1, 4]), "ValueError the shape"),
        (lambda said: said.update(start=[*said["start"][:2], float("nan")]), "NaN"),
        (lambda said: said.update(start=[*said["start"][:2], 10**400]), "OverflowError"),
    ],
)
def test_a_changed_certificate_with_the_right_hash_does_not_hold(
    kept: Kept, tmp_path: Path, edit: Callable[[Said], None], said: str
) -> None:
    found = changed(kept, tmp_path, with_artefact(rewritten(kept, edit)))
    assert not found.holds
    assert said in "; ".join(found.reasons)


def test_a_better_figure_in_verdict_and_certificate_does_not_hold(kept: Kept, tmp_path: Path) -> None:
    slip = read_certificate(kept.content).figures["tool slip"][0]

    def both(store: ox.Store) -> None:
        with_artefact(rewritten(kept, improve))(store)
        setting(LAW + "value", 0.0, was=repr(slip))(store)

    found = changed(kept, tmp_path, both)
    assert "in the recheck" in found.reasons[0]


def test_a_shifted_waypoint_does_not_hold_without_a_verdict_either(kept: Kept) -> None:
    found = recheck_artefact("shifted", rewritten(kept, shift_a_waypoint), Saved(kept.file).twin)
    assert "acceleration" in "; ".join(found.reasons)


def test_an_artefact_alone_holds_for_its_models_and_for_no_others(kept: Kept) -> None:
    twin = gantry_twin(kept.folder)
    found = recheck_artefact("one", kept.content, lambda *_: (twin, "given"))
    assert found.reasons == ()
    assert "no verdict with it" in found.notes[-1]
    joint = twin.container("drawer_main").joint
    edited = replace(found) and twin.with_edit(joint, upperLimit=0.6)
    other = recheck_artefact("one", kept.content, lambda *_: (edited, "given"))
    assert "content hash" in other.reasons[0]


def test_a_record_that_is_called_no_verdict_and_sealed_again_is_told(kept: Kept, tmp_path: Path) -> None:
    verdict = kept.iri.removeprefix(ID)
    found = changed(kept, tmp_path, setting(RDF + "type", SDT + "Door", verdict, LAW + "Verdict"))
    assert (found.of, found.holds) == (kept.iri, False)
    assert "is of no law:Verdict" in found.reasons[0]
