"""What re-verifies a verdict comes back from the store byte by byte, or not at all."""

import pickle
from dataclasses import replace

import pyoxigraph as ox
import pytest

from predicates.case import Artefact, ArtefactKind, Case, Verdict
from predicates.law import law
from predicates.record import read_artefact, to_record, write
from sdt_kg.errors import InputError
from sdt_kg.iri import LAW
from sdt_kg.task import Task, Verb
from services.physics.oracle import Kinematics
from tests.small import small_twin
from tests.small.lift import Lift

ARTEFACT = Artefact(ArtefactKind.CERTIFICATE, bytes(range(256)))


def verdict(artefact: Artefact | None) -> Verdict:
    twin = small_twin("a", ("pr2",))
    task = Task(Verb.OPEN, twin.container("low_drawer").iri)
    (made,) = law(Case(twin, robot=twin.robots[0], task=task), Kinematics(), Lift())
    assert made.can_perform is not None
    return replace(made, can_perform=replace(made.can_perform, artefact=artefact))


def stored(artefact: Artefact | None) -> tuple[ox.Store, str]:
    store, made = ox.Store(), verdict(artefact)
    assert write(store, to_record(made))
    return store, made.iri


def edited(name: str, value: str) -> tuple[ox.Store, str]:
    store, iri = stored(ARTEFACT)
    (quad,) = store.quads_for_pattern(None, ox.NamedNode(LAW + name), None)
    assert isinstance(quad.object, ox.Literal)
    store.remove(quad)
    literal = ox.Literal(value, datatype=quad.object.datatype)
    store.add(ox.Quad(quad.subject, quad.predicate, literal, quad.graph_name))
    return store, iri


def test_an_artefact_comes_back_as_it_was() -> None:
    assert read_artefact(*stored(ARTEFACT)) == ARTEFACT


def test_a_verdict_without_one_has_none() -> None:
    assert read_artefact(*stored(None)) is None


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("content", "AAEC", "its bytes have the hash"),
        ("content", "no base 64!", "is damaged"),
        ("contentHash", "0" * 64, "its bytes have the hash"),
        ("artefactKind", "rumour", "allowed: certificate or proof"),
    ],
)
def test_a_damaged_artefact_is_refused(name: str, value: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        read_artefact(*edited(name, value))


def test_an_artefact_without_its_bytes_is_refused() -> None:
    store, iri = stored(ARTEFACT)
    (quad,) = store.quads_for_pattern(None, ox.NamedNode(LAW + "content"), None)
    store.remove(quad)
    with pytest.raises(InputError, match="0 values of law:content"):
        read_artefact(store, iri)


def test_an_artefact_that_is_still_to_be_written_is_written_once() -> None:
    written: list[bytes] = []

    def write() -> bytes:
        written.append(ARTEFACT.content)
        return written[-1]

    late = Artefact(ArtefactKind.CERTIFICATE, write)
    assert not written
    assert late == ARTEFACT
    assert hash(late) == hash(ARTEFACT)
    assert pickle.loads(pickle.dumps(late)) == ARTEFACT  # noqa: S301 - just written
    assert len(written) == 1
    assert late != Artefact(ArtefactKind.PROOF, ARTEFACT.content)
