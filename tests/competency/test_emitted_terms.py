"""Whatever is written uses terms of the ontology, of individuals and values that they are for."""

from collections.abc import Iterator
from functools import cache
from pathlib import Path

import numpy as np
import pyoxigraph as ox
import pytest
import rdflib
from rdflib.namespace import OWL, RDF, RDFS
from rdflib.term import URIRef

import ontology
from predicates.learn import learn
from predicates.learn.phases import Latch, Plain, PushToOpen
from predicates.learn.record import Key, learned_triples, phase_triples, proposal_triples
from sdt_kg.history import Followed, History, Trajectory, brought, changed, moved, obstacle, posed
from sdt_kg.iri import ID, LAW, SDT, TEE, Iri
from sdt_kg.load import load_twin
from sdt_kg.mechanism import Geometry, Pose, ShapeType
from sdt_kg.motion import Motion
from sdt_kg.store import MemoryStore, Triple
from sdt_kg.twin import Twin
from services.dynamics.data import with_forces
from services.http.api.write import observed_triples
from services.http.kitchens import open_kitchens
from services.learning import together_triples
from services.store.files import SavedVerdicts
from services.store.models import REPLACED
from services.store.reason import Engine, reasoned
from tests.predicates.learn.observed import stopping
from tests.predicates.learn.test_following import TWIN, slid, together
from tests.predicates.learn.test_proposal import proposed, turned
from tests.small import FOLDER, small_twin

OURS = (SDT, TEE, LAW)
XSD_TYPES = "http://www.w3.org/2001/XMLSchema#"
PROPERTIES = (OWL.ObjectProperty, OWL.DatatypeProperty, OWL.AnnotationProperty)


@cache
def terms() -> rdflib.Graph:
    graph = rdflib.Graph()
    for name in ("sdt", "tee", "law"):
        graph.parse(ontology.path(f"{name}.ttl"))
    return graph


@cache
def is_declared(term: Iri) -> bool:
    kinds = set(terms().objects(URIRef(term), RDF.type))
    return bool(kinds & {*PROPERTIES, OWL.Class, OWL.NamedIndividual})


@cache
def meant(predicate: Iri) -> tuple[Iri | None, Iri | None]:
    """Domain and range."""
    found = (terms().value(URIRef(predicate), each) for each in (RDFS.domain, RDFS.range))
    domain, span = (None if each is None else str(each) for each in found)
    return domain, span


@cache
def wider(kind: Iri) -> frozenset[Iri]:
    return frozenset(str(each) for each in terms().transitive_objects(URIRef(kind), RDFS.subClassOf))


def known(individual: ox.NamedNode, kinds: dict[object, set[Iri]]) -> set[Iri]:
    """Classes that the data or the ontology says it is of."""
    return kinds.get(individual, set()) | kinds_in_vocabulary(individual.value)


@cache
def kinds_in_vocabulary(individual: Iri) -> frozenset[Iri]:
    """Classes of what the ontology itself names, an outcome say."""
    return frozenset(
        each for kind in terms().objects(URIRef(individual), RDF.type) for each in wider(str(kind))
    )


def faults(store: ox.Store) -> Iterator[str]:
    """What is said with a term that is not there, of an individual or with a value that it is not for."""
    kinds: dict[object, set[Iri]] = {}
    for quad in store.quads_for_pattern(None, ox.NamedNode(str(RDF.type)), None):
        assert isinstance(quad.object, ox.NamedNode)
        kinds.setdefault(quad.subject, set()).update(wider(quad.object.value))
    for quad in store:
        predicate, value = quad.predicate.value, quad.object
        named = [predicate, value.value] if isinstance(value, ox.NamedNode) else [predicate]
        yield from (
            f"not declared: {each}" for each in named if each.startswith(OURS) and not is_declared(each)
        )
        domain, span = meant(predicate)
        if domain is not None and domain not in kinds.get(quad.subject, set()):
            yield f"{predicate} of what is no {domain}: {quad.subject}"
        if isinstance(value, ox.Literal) and span is not None and value.datatype.value != span:
            yield f"{predicate} is {value} and no {span}"
        if isinstance(value, ox.NamedNode) and str(span).startswith(XSD_TYPES):
            yield f"{predicate} is the individual {value}"
        elif (
            isinstance(value, ox.NamedNode) and str(span).startswith(OURS) and span not in known(value, kinds)
        ):
            yield f"{predicate} is what is no {span}: {value}"


def quads(triples: Iterator[Triple] | list[Triple], graph: Iri = f"{ID}graph/x") -> list[ox.Quad]:
    name = ox.NamedNode(graph)
    return [ox.Quad(ox.NamedNode(s), ox.NamedNode(p), o, name) for s, p, o in triples]


def of_history() -> Iterator[ox.Quad]:
    """Every kind of edit, and a trajectory with its events."""
    twin = small_twin("a", ("pr2", "stretch"))
    history = History.of(twin)
    drawer = twin.container("low_drawer")
    times, values = np.linspace(0, 2, 11), np.linspace(0, drawer.upper, 11)[:, None]
    box = (Geometry(ShapeType.BOX, Pose(), (0.2, 0.2, 0.2)),)
    for edit in (
        moved({drawer.joint: 0.1}),
        changed(twin, drawer.joint, upperLimit=0.6),
        posed(twin, drawer.joint, Pose((0.1, 0.0, 0.5))),
        obstacle(twin, "crate", box, Pose((3.0, 0.0, 0.1))),
        Followed(Trajectory.of(Motion(drawer.joint, times, values))),
    ):
        history, _ = history.derived(history.first, edit)
    history, _ = history.derived(history.first, brought(twin, twin.robots[0]).inverse(twin))
    assert isinstance(history.store, MemoryStore)
    yield from history.store.everything()


def of_learning() -> Iterator[ox.Quad]:
    """A drawer that is a door, held in each way; one that follows another."""
    track = turned("low_drawer", (0.4, 0.6), 0.9)
    proposal, twin = proposed("low_drawer", track), TWIN
    of = Key.of(twin, proposal.container, track).iri
    yield from quads(learned_triples(twin, proposal.container, track, learn(track).best))
    yield from quads(proposal_triples(of, proposal))
    held = (Latch(20, 1, 0.01, 5, 1, 9), PushToOpen(9, 0.01, 0.001, 0.03, 1, 9), Plain(4))
    for number, phase in enumerate(held):
        yield from quads(phase_triples(of, phase), f"{ID}graph/{number}")
    tracks = slid("low_drawer", stopping(0.46), 0), slid("high_drawer", 0.5 * stopping(0.46), 50)
    yield from quads(list(together_triples(twin, tracks, together(0.5 * stopping(0.46)))[1]))
    yield from _twin(twin)


def of_service() -> Iterator[ox.Quad]:
    """What HTTP writes beside verdicts and branches: what was observed, and which state is the present."""
    kitchen = open_kitchens([str(FOLDER / "a.urdf")], ())["a"].begun()
    assert kitchen.history is not None
    joint = kitchen.twin.container("low_drawer").joint
    seen = observed_triples(f"{ID}observation/1", {joint: 0.1}, "2026-01-31T12:00:00Z", "camera")
    graph = ox.NamedNode(kitchen.present_graph)
    for each in (kitchen.present_triple(), *seen):
        yield ox.Quad(each.subject, each.predicate, each.object, graph)
    assert isinstance(kitchen.history.store, MemoryStore)
    yield from kitchen.history.store.everything()


def of_kitchen_a() -> Iterator[ox.Quad]:
    """The larger bundled kitchen."""
    yield from _twin(load_twin("a"))


def of_forces() -> Iterator[ox.Quad]:
    """The other one and all bundled robots, with force data."""
    yield from _twin(with_forces(load_twin("b", ["pr2", "tiago_dual", "stretch"]), handle_force=20.0))


def of_reasoning() -> Iterator[ox.Quad]:
    """Inferred types."""
    twin = list(_twin(small_twin("a", ("pr2",))))
    yield from (*twin, *reasoned(twin, Engine.OWLRL).quads())


def _twin(twin: Twin) -> Iterator[ox.Quad]:
    yield from twin.entities.store.dump(twin.graphs())


SOURCES = (of_history, of_learning, of_service, of_kitchen_a, of_forces, of_reasoning)
WRITTEN = {each.__name__: each for each in SOURCES}


def kept(written: Iterator[ox.Quad]) -> ox.Store:
    store = ox.Store()
    store.extend(written)
    return store


@pytest.mark.parametrize("name", WRITTEN)
def test_what_is_written_uses_terms_as_they_are_meant(name: str) -> None:
    store = kept(WRITTEN[name]())
    assert len(store) > 50
    assert sorted(set(faults(store))) == []


def test_verdicts_and_results_of_tasks_use_terms_as_they_are_meant(verdicts: ox.Store) -> None:
    assert sorted(set(faults(verdicts))) == []


def test_a_store_where_a_kitchen_took_the_place_of_another_uses_terms_as_they_are_meant(
    tmp_path: Path,
) -> None:
    file, twin = tmp_path / "kept.nq", small_twin("a", ("pr2",))
    with SavedVerdicts(str(file)) as saved:
        saved.add_twin(twin)
        saved.add_twin(twin.with_edit(twin.container("low_drawer").joint, upperLimit=0.6))
    store = kept(iter(list(ox.parse(path=file))))
    assert len(list(store.quads_for_pattern(None, REPLACED, None))) == 1
    assert sorted(set(faults(store))) == []


@pytest.mark.parametrize(
    ("predicate", "value", "said"),
    [
        (f"{LAW}nothing", ox.Literal(1), "not declared"),
        (f"{LAW}outcome", ox.NamedNode(f"{LAW}Certain"), "not declared"),
        (f"{LAW}reason", ox.Literal("why"), "of what is no"),
        (f"{LAW}seconds", ox.Literal("0.5"), "and no"),
        (f"{LAW}seconds", ox.NamedNode(f"{ID}x"), "is the individual"),
        (f"{LAW}specification", ox.NamedNode(f"{ID}x"), "is what is no"),
    ],
)
def test_a_term_that_is_misused_is_found(predicate: Iri, value: ox.NamedNode | ox.Literal, said: str) -> None:
    found = kept(iter(quads([(f"{ID}verdict/x", predicate, value)])))
    assert any(said in fault for fault in faults(found))
