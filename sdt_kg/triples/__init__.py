"""Values ↔ triples: mechanisms and annotations."""

from sdt_kg.triples.annotation import read_kitchen, read_robot
from sdt_kg.triples.check import checked_model
from sdt_kg.triples.facts import Facts
from sdt_kg.triples.from_mechanism import mechanism_triples
from sdt_kg.triples.same import Same, same
from sdt_kg.triples.to_mechanism import read_mechanism_of

__all__ = [
    "Facts",
    "Same",
    "checked_model",
    "mechanism_triples",
    "read_kitchen",
    "read_mechanism_of",
    "read_robot",
    "same",
]
