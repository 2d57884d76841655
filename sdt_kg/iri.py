"""The only place where an IRI is spelled."""

from functools import lru_cache
from typing import Final
from urllib.parse import quote, unquote

SDT: Final = "https://example.org/sdt#"
"""V, E and P of a Semantic Digital Twin."""
TEE: Final = "https://example.org/tee#"
"""Task-Environment-Embodiment classes."""
LAW: Final = "https://example.org/law#"
"""Tasks, cases, verdicts and diagnoses."""
ID: Final = "https://example.org/id/"
"""Individuals: models, bodies, joints, states, verdicts."""

RDF: Final = "http://www.w3.org/1999/02/22-rdf-syntax-ns#"
RDFS: Final = "http://www.w3.org/2000/01/rdf-schema#"
XSD: Final = "http://www.w3.org/2001/XMLSchema#"
OWL: Final = "http://www.w3.org/2002/07/owl#"
PROV: Final = "http://www.w3.org/ns/prov#"
DCTERMS: Final = "http://purl.org/dc/terms/"
SH: Final = "http://www.w3.org/ns/shacl#"

PREFIXES: Final = {
    "dcterms": DCTERMS,
    "id": ID,
    "law": LAW,
    "owl": OWL,
    "prov": PROV,
    "rdf": RDF,
    "rdfs": RDFS,
    "sdt": SDT,
    "sh": SH,
    "tee": TEE,
    "xsd": XSD,
}

Iri = str


@lru_cache(maxsize=16_384)
def _quoted(name: str) -> str:
    """The name as a segment of an IRI; kept, since a twin spells each of its names many times."""
    return quote(name, safe="")


def model_iri(model: str) -> Iri:
    """Individual that stands for a whole kitchen or robot, `id:a` say."""
    return ID + _quoted(model)


def body_iri(model: str, link: str) -> Iri:
    """Individual of a link. Links and joints may share a name, hence the segment."""
    return f"{model_iri(model)}/body/{_quoted(link)}"


def joint_iri(model: str, joint: str) -> Iri:
    """Individual of a joint."""
    return f"{model_iri(model)}/joint/{_quoted(joint)}"


def local_name(iri: Iri) -> str:
    """Name of a link or joint, as its URDF spells it."""
    return unquote(iri.rsplit("/", 1)[-1].rsplit("#", 1)[-1])


def graph_iri(kind: str, key: str) -> Iri:
    """Named graph: kind is asserted, inferred, state, branch, observed, verdict or task_result."""
    return f"{ID}graph/{kind}/{_quoted(key)}"


def verdict_iri(key: str) -> Iri:
    """Verdict whose inputs have this hash."""
    return f"{ID}verdict/{_quoted(key)}"


def task_result_iri(key: str) -> Iri:
    """Result of a task specification whose inputs have this hash."""
    return f"{ID}task_result/{_quoted(key)}"


def branch_iri(key: str) -> Iri:
    """Branch whose parent and edit have this hash."""
    return f"{ID}branch/{_quoted(key)}"


def trajectory_iri(key: str) -> Iri:
    """Trajectory whose samples have this hash."""
    return f"{ID}trajectory/{_quoted(key)}"


def part_iri(whole: Iri, kind: str, index: int) -> Iri:
    """The index-th part of that kind, counted from 1: a verdict's diagnosis, say."""
    return f"{whole}/{kind}/{index}"
