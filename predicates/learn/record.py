"""A proposal → triples: Φ′ with its residuals and the interval in which it was seen, PROV-O."""

import hashlib
from collections.abc import Iterator

import pyoxigraph as ox

from predicates.learn.proposal import Proposal
from predicates.learn.track import Track
from sdt_kg.iri import ID, LAW, PROV, RDF, RDFS, Iri, graph_iri
from sdt_kg.mechanism import JointType
from sdt_kg.store import Term, Triple

MILLIMETRE = 1e-3
"""[m] Figures in labels are given in millimetres."""


def learned_iri(proposal: Proposal, track: Track, parent: str) -> Iri:
    """Individual of Φ′: a hash of the track, the joint and the twin that it was proposed for."""
    return f"{ID}learned/{_key(proposal, track, parent)}"


def learned_graph(proposal: Proposal, track: Track, parent: str) -> Iri:
    """Named graph of what was observed and learned."""
    return graph_iri("observed", _key(proposal, track, parent))


def learned_triples(proposal: Proposal, track: Track, parent: str) -> Iterator[Triple]:
    """Φ′ and the observation that it rests on.

    Args:
        proposal: What was learned.
        track: What was observed.
        parent: Content hash of the kitchen that the proposal changes.
    """
    of, joint = learned_iri(proposal, track, parent), proposal.learned
    seen = f"{of}/observation"
    yield of, RDF + "type", ox.NamedNode(LAW + "LearnedPhysics")
    yield of, RDFS + "label", ox.Literal(_label(proposal))
    yield of, LAW + "entity", ox.NamedNode(proposal.container.joint)
    yield of, LAW + "container", ox.NamedNode(proposal.container.iri)
    yield of, LAW + "environment", ox.NamedNode(proposal.twin.environment)
    yield of, LAW + "jointType", ox.Literal(joint.joint_type.value)
    yield of, LAW + "replacedJointType", ox.Literal(proposal.before.type.value)
    yield of, LAW + "parentHash", ox.Literal(parent)
    yield of, PROV + "wasDerivedFrom", ox.NamedNode(proposal.twin.environment)
    yield of, PROV + "wasDerivedFrom", ox.NamedNode(seen)
    for name, value in (
        ("residual", joint.residual_rms),
        ("evidence", joint.evidence),
        ("validFrom", min(proposal.seen)),
        ("validTo", max(proposal.seen)),
        ("axisDeviation", joint.deviations["axis"]),
        ("originDeviation", joint.deviations["origin"]),
        ("limitDeviation", joint.deviations["limits"]),
    ):
        yield of, LAW + name, _double(value)
    if joint.joint_type is JointType.REVOLUTE:
        yield of, LAW + "circleRadius", _double(joint.radius)
        yield of, LAW + "radiusDeviation", _double(joint.deviations["radius"])
    for assumption in proposal.assumptions:
        yield of, LAW + "assumes", ox.Literal(assumption)
    yield seen, RDF + "type", ox.NamedNode(LAW + "Observation")
    yield seen, RDFS + "label", ox.Literal(track.name)
    yield seen, LAW + "observedSamples", ox.Literal(len(track.positions))
    yield seen, LAW + "missingSamples", ox.Literal(track.missing)
    yield seen, LAW + "outliers", ox.Literal(joint.outliers)
    yield seen, LAW + "trackHash", ox.Literal(track_hash(track))


def track_hash(track: Track) -> str:
    """SHA-256 of the observed positions and times."""
    return hashlib.sha256(track.positions.tobytes() + track.times.tobytes()).hexdigest()


def _key(proposal: Proposal, track: Track, parent: str) -> str:
    text = f"{track_hash(track)} {proposal.container.joint} {parent}"
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def _label(proposal: Proposal) -> str:
    name, rms = proposal.container.name, proposal.learned.residual_rms / MILLIMETRE
    return f"{name}: {proposal.after.type.value} joint, {rms:.1f} mm rms from the path"


def _double(value: float) -> Term:
    return ox.Literal(float(value))
