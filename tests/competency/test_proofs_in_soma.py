"""Only a proof is an Inability or Infeasibility of SOMA; a search that gave up is neither."""

import pyoxigraph as ox

import ontology
from sdt_kg.iri import LAW, local_name

RULE = ontology.path("alignments/soma_of_proofs.rq").read_text(encoding="utf-8")
SOMA = "http://www.ease-crc.org/ont/SOMA.owl#"


def classes(store: ox.Store) -> dict[str, str]:
    """Diagnosis → class of SOMA."""
    found = store.query(RULE, use_default_graph_as_union=True)
    assert isinstance(found, ox.QueryTriples)
    return {triple.subject.value: local_name(triple.object.value) for triple in found}  # type: ignore[union-attr]


def of_kind(store: ox.Store, kind: str) -> set[str]:
    pattern = store.quads_for_pattern(None, None, ox.NamedNode(LAW + kind), None)
    return {quad.subject.value for quad in pattern if isinstance(quad.subject, ox.NamedNode)}


def edited(store: ox.Store, update: str) -> ox.Store:
    copy = ox.Store()
    copy.extend(store)
    copy.update(f"PREFIX law: <{LAW}> {update}")
    return copy


def test_proofs_are_classified_by_what_failed(verdicts: ox.Store) -> None:
    found = classes(verdicts)
    assert {each for each, name in found.items() if name == "Inability"} == of_kind(
        verdicts, "EmbodimentFailure"
    )
    assert {each for each, name in found.items() if name == "Infeasibility"} == of_kind(
        verdicts, "CausalFailure"
    )
    assert set(found.values()) == {"Inability", "Infeasibility"}


def test_a_search_that_gave_up_is_no_inability(verdicts: ox.Store) -> None:
    searched = edited(
        verdicts,
        "DELETE { GRAPH ?g { ?d law:proof true } } INSERT { GRAPH ?g { ?d law:proof false } }"
        " WHERE { GRAPH ?g { ?d law:proof true } }",
    )
    assert classes(searched) == {}


def test_a_proof_about_a_motion_that_was_given_is_no_inability(verdicts: ox.Store) -> None:
    given = edited(
        verdicts,
        'DELETE { GRAPH ?g { ?i law:inputHash "unknown" } } INSERT { GRAPH ?g { ?i law:inputHash "0a" } }'
        ' WHERE { GRAPH ?g { ?i law:name "motion" ; law:inputHash "unknown" } }',
    )
    assert classes(given) == {}
