"""Consistency and inferred types of a graph under the core ontologies, by one of two engines.

`hermit` decides OWL 2 DL and needs Java; `owlrl` does the OWL 2 RL rules without Java. RL is sound: a
clash that it finds is one. It is incomplete: that it finds none is no proof of consistency.
"""

import shutil
from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from enum import Enum
from typing import Any, Final

import owlready2
import pyoxigraph as ox
import rdflib
import reasonable
from rdflib.namespace import OWL, RDF, RDFS

from sdt_kg.errors import InputError
from sdt_kg.interchange import core_triples, ntriples, owlready_ontology, with_core
from sdt_kg.iri import SDT, XSD, Iri, graph_iri, local_name

REASONED: Final = "https://example.org/id/owl"
TYPE: Final = ox.NamedNode(str(RDF.type))
_BYTES: Final = ox.NamedNode(XSD + "base64Binary")
_BUILT_IN: Final = (str(OWL), str(RDF), str(RDFS), "http://www.w3.org/2001/XMLSchema#")

# Neither library has types of its own.
Untyped = Any


class Engine(Enum):
    """What reasons."""

    HERMIT = "hermit"
    OWLRL = "owlrl"


@dataclass(frozen=True, slots=True)
class Reasoned:
    """What an engine found.

    Attributes:
        engine: Which one ran.
        consistent: False if it found a contradiction; True from `owlrl` means that it found none.
        clashes: Contradictions in sentences, as far as they can be told; those of `owlrl` always.
        types: (individual, class) which was inferred and not asserted; none if inconsistent.
    """

    engine: Engine
    consistent: bool
    clashes: tuple[str, ...]
    types: tuple[tuple[Iri, Iri], ...]

    @property
    def graph(self) -> Iri:
        """Named graph of the inferred types."""
        return graph_iri("reasoned", self.engine.value)

    def quads(self) -> Iterator[ox.Quad]:
        """The inferred types in their own named graph, which says what made it."""
        graph, maker = ox.NamedNode(self.graph), ox.NamedNode(f"{REASONED}/{self.engine.value}")
        yield ox.Quad(graph, ox.NamedNode(SDT + "inferredBy"), maker, graph)
        yield ox.Quad(maker, TYPE, ox.NamedNode(SDT + "Rule"), graph)
        for individual, kind in self.types:
            yield ox.Quad(ox.NamedNode(individual), TYPE, ox.NamedNode(kind), graph)


def default_engine() -> Engine:
    """HermiT where Java is there."""
    return Engine.HERMIT if shutil.which("java") else Engine.OWLRL


def reasoned(quads: Iterable[ox.Quad], engine: Engine) -> Reasoned:
    """What the engine finds in all graphs together with the core ontologies.

    Raises:
        InputError: HermiT without Java.
        GraphError: The graph cannot be read as OWL.
    """
    listed = list(quads)
    return _hermit(listed) if engine is Engine.HERMIT else _owlrl(listed)


def _hermit(quads: list[ox.Quad]) -> Reasoned:
    if shutil.which("java") is None:
        raise InputError(
            "HermiT needs Java, which is not there", allowed="--engine owlrl", remedy="or install it"
        )
    library: Untyped = owlready2
    # owlready2 forgets the datatype of bytes: HermiT would see texts that are out of range.
    made = owlready_ontology((quad for quad in quads if not _is_bytes(quad.object)), REASONED)
    try:
        library.sync_reasoner_hermit(made.world, debug=0)
    except library.OwlReadyInconsistentOntologyError:
        # HermiT says that, not why; what RL finds is a reason that people can look up.
        return Reasoned(Engine.HERMIT, False, _owlrl(quads).clashes, ())
    asserted = _asserted(quads)
    found = {
        (str(individual.iri), str(kind.iri))
        for individual in made.world.individuals()
        for kind in individual.INDIRECT_is_a
        if isinstance(kind, library.ThingClass)
    }
    return Reasoned(Engine.HERMIT, True, (), _fresh(found, asserted))


def _is_bytes(term: object) -> bool:
    return isinstance(term, ox.Literal) and term.datatype == _BYTES


def _owlrl(quads: list[ox.Quad]) -> Reasoned:
    triples = with_core(quads)
    base = rdflib.Graph()
    base.parse(data=ntriples(triples), format="nt")
    library: Untyped = reasonable
    engine: Untyped = library.PyReasoner()
    engine.from_graph(base)
    closed = rdflib.Graph()
    for triple in engine.reason():
        closed.add(triple)
    clashes = (*_disjoint(closed), *_doubled(base))
    individuals = set(base.subjects(RDF.type, OWL.NamedIndividual))
    found = {
        (str(individual), str(kind))
        for individual, kind in closed.subject_objects(RDF.type)
        if individual in individuals and isinstance(kind, rdflib.URIRef)
    }
    types = () if clashes else _fresh(found, _asserted(quads))
    return Reasoned(Engine.OWLRL, not clashes, clashes, types)


def _disjoint(closed: rdflib.Graph) -> list[str]:
    """Individuals of two classes that have none in common, or of the empty class."""
    members: dict[object, set[object]] = defaultdict(set)
    for individual, kind in closed.subject_objects(RDF.type):
        members[kind].add(individual)
    found = [f"{_name(each)} is of owl:Nothing" for each in members[OWL.Nothing]]
    for one, other in closed.subject_objects(OWL.disjointWith):
        if str(one) < str(other) or (other, OWL.disjointWith, one) not in closed:
            both = members[one] & members[other]
            kinds = f"{_name(one)} and {_name(other)}"
            found += [f"{_name(each)} is {kinds}, which nothing is at once" for each in both]
    return sorted(set(found))


def _doubled(base: rdflib.Graph) -> list[str]:
    """Functional properties with two different numbers, texts or truth values."""
    found: list[str] = []
    for one in base.subjects(RDF.type, OWL.FunctionalProperty):
        values: dict[object, set[object]] = defaultdict(set)
        for subject, value in base.subject_objects(one):
            if isinstance(value, rdflib.Literal):
                values[subject].add(value.toPython())
        found += [
            f"{_name(subject)} has {len(each)} values of {_name(one)}, which has one at most"
            for subject, each in values.items()
            if len(each) > 1
        ]
    return sorted(found)


def _asserted(quads: list[ox.Quad]) -> set[tuple[Iri, Iri]]:
    """Types that the graph or the ontology says."""
    return {
        (triple.subject.value, triple.object.value)
        for triple in (*(quad.triple for quad in quads), *core_triples())
        if triple.predicate == TYPE
        and isinstance(triple.subject, ox.NamedNode)
        and isinstance(triple.object, ox.NamedNode)
    }


def _fresh(found: set[tuple[Iri, Iri]], asserted: set[tuple[Iri, Iri]]) -> tuple[tuple[Iri, Iri], ...]:
    """Types of the graph's individuals which are not asserted, those of every graph left out."""
    subjects = {individual for individual, _ in asserted}
    return tuple(
        sorted(
            (individual, kind)
            for individual, kind in found - asserted
            if individual in subjects and not kind.startswith(_BUILT_IN)
        )
    )


def _name(node: object) -> str:
    return local_name(str(node))
