"""Twins in the hands of other libraries and back: named graphs, rdflib, owlready2."""

from sdt_kg.interchange.forms import Quads, dumped, stored
from sdt_kg.interchange.owl import Owl, core_triples, ntriples, owlready_ontology, with_core
from sdt_kg.interchange.places import portable
from sdt_kg.interchange.rebuild import quads_of, rebuilt

__all__ = [
    "Owl",
    "Quads",
    "core_triples",
    "dumped",
    "ntriples",
    "owlready_ontology",
    "portable",
    "quads_of",
    "rebuilt",
    "stored",
    "with_core",
]
