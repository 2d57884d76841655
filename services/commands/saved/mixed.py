"""What differs between saved verdicts that rows, and queries by name, count together."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Final

from predicates.record.inputs import UNKNOWN_INPUT
from predicates.record.stored import StoredVerdict
from sdt_kg.iri import local_name
from sdt_kg.store import rows_of
from services.store.quads import QuadStore
from services.versions import ORACLES, outdated

MODELS: Final = ("environment", "robot")
"""Inputs that say which model, of which content."""
SHOWN_HASH: Final = 12
"""[characters] Of a model's content hash."""
COUNTED: Final = """SELECT ?name ?value (COUNT(?verdict) AS ?verdicts) WHERE {
  VALUES ?name { "environment" "robot" }
  ?input law:name ?name ; law:inputHash ?value .
  ?judging prov:used ?input .
  ?verdict prov:wasGeneratedBy ?judging ; a law:Verdict .
}
GROUP BY ?name ?value"""


def mixed(verdicts: Sequence[StoredVerdict]) -> Iterator[str]:
    """A sentence about each name that is of several models, and each oracle of several versions."""
    inputs = [(dict(each.inputs), name) for each in verdicts for name in (*MODELS, *ORACLES)]
    yield from _several(
        Counter(
            (name, said[name])
            for said, name in inputs
            if name in said and not (name in ORACLES and outdated(said))
        )
    )


def mixed_models(store: QuadStore) -> Iterator[str]:
    """A sentence about each name that is of several models, without reading each verdict."""
    _, rows = rows_of(store.query(COUNTED))
    yield from _several({(str(row["name"]), str(row["value"])): int(str(row["verdicts"])) for row in rows})


def _several(counts: Mapping[tuple[str, str], int]) -> Iterator[str]:
    """What is told of inputs, by name and value, with how many verdicts have each."""
    apart: dict[str, Counter[str]] = {}
    for (name, value), count in sorted(counts.items(), key=lambda each: (-each[1], each[0])):
        model, _, content = value.partition(" ")
        if name in ORACLES:
            apart.setdefault(f"judged by several versions of {name}", Counter())[f"by {value}"] += count
        elif value != UNKNOWN_INPUT:
            about = f"'{local_name(model)}' is there as several models of that name"
            apart.setdefault(about, Counter())[f"about {content[:SHOWN_HASH]}"] += count
    for what, found in sorted(apart.items()):
        if len(found) > 1:
            told = ", ".join(f"{count} {which}" for which, count in found.most_common())
            yield f"{what}: {told}; sdt recheck tells which hold for what is kept"
