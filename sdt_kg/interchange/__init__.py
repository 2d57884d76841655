"""Twins in the hands of other libraries and back: named graphs, rdflib, owlready2."""

from sdt_kg.interchange.owl import Owl, core_triples, ntriples, owlready_ontology, with_core
from sdt_kg.interchange.rebuild import Quads, quads_of, rebuilt, stored

__all__ = [
    "Owl",
    "Quads",
    "core_triples",
    "ntriples",
    "owlready_ontology",
    "quads_of",
    "rebuilt",
    "stored",
    "with_core",
]
