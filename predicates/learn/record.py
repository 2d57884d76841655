"""What was learned → triples: Φ′ with its residuals and the interval in which it was seen, PROV-O."""

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass

import pyoxigraph as ox

from predicates.learn.articulation import Articulation
from predicates.learn.phases import Latch, Plain, PushToOpen
from predicates.learn.proposal import Proposal
from predicates.learn.track import Track
from sdt_kg.iri import ID, LAW, PROV, RDF, RDFS, Iri, graph_iri
from sdt_kg.mechanism import JointType
from sdt_kg.store import Triple
from sdt_kg.twin import Container, Twin

DEVIATIONS = (("axis", "axis"), ("origin", "origin"), ("limit", "limits"), ("radius", "radius"))
"""Name of a property before its `Deviation`, and of the figure."""

MILLIMETRE = 1e-3
"""[m] Figures in labels are given in millimetres."""


@dataclass(frozen=True, slots=True)
class Key:
    """What names a learned Φ′: a hash of all of the track, of the joint, and of the twin and its state."""

    digest: str

    @staticmethod
    def of(twin: Twin, container: Container, track: Track) -> "Key":
        """The key of what a track says of a container of a twin."""
        parent = twin.content_hash(twin.environment)
        more = ("" if each is None else each.tobytes().hex() for each in (track.orientations, track.forces))
        seen = hashlib.sha256(" ".join(more).encode()).hexdigest()
        text = f"{track_hash(track)} {seen} {container.joint} {parent} {sorted(twin.state.items())}"
        return Key(hashlib.sha256(text.encode()).hexdigest()[:32])

    @property
    def iri(self) -> Iri:
        """Individual of Φ′."""
        return f"{ID}learned/{self.digest}"

    @property
    def graph(self) -> Iri:
        """Named graph of what was observed and learned."""
        return graph_iri("observed", self.digest)


def learned_triples(twin: Twin, container: Container, track: Track, joint: Articulation) -> Iterator[Triple]:
    """Φ′ and the observation that it rests on.

    Args:
        twin: What was there before.
        container: What was seen to move.
        track: What was observed.
        joint: What was learned from it.
    """
    of = Key.of(twin, container, track).iri
    seen = f"{of}/observation"
    yield of, RDF + "type", ox.NamedNode(LAW + "LearnedPhysics")
    yield of, RDFS + "label", ox.Literal(_label(container, joint))
    yield of, LAW + "entity", ox.NamedNode(container.joint)
    yield of, LAW + "container", ox.NamedNode(container.iri)
    yield of, LAW + "environment", ox.NamedNode(twin.environment)
    yield of, LAW + "jointType", ox.Literal(joint.joint_type.value)
    yield of, LAW + "parentHash", ox.Literal(twin.content_hash(twin.environment))
    yield of, PROV + "wasDerivedFrom", ox.NamedNode(twin.environment)
    yield of, PROV + "wasDerivedFrom", ox.NamedNode(seen)
    figures = {"residual": joint.residual_rms, "evidence": joint.evidence}
    figures |= {
        f"{name}Deviation": joint.deviations[key] for name, key in DEVIATIONS if key in joint.deviations
    }
    if joint.joint_type is JointType.REVOLUTE:
        figures["circleRadius"] = joint.radius
    yield from _figures(of, figures)
    yield seen, RDF + "type", ox.NamedNode(LAW + "Observation")
    yield seen, RDFS + "label", ox.Literal(track.name)
    yield seen, LAW + "observedSamples", ox.Literal(len(track.positions))
    yield seen, LAW + "missingSamples", ox.Literal(track.missing)
    yield seen, LAW + "outliers", ox.Literal(joint.outliers)
    yield seen, LAW + "trackHash", ox.Literal(track_hash(track))


def proposal_triples(of: Iri, proposal: Proposal) -> Iterator[Triple]:
    """What a proposed joint adds to Φ′: what it replaces, the interval that was seen, assumptions."""
    yield of, LAW + "replacedJointType", ox.Literal(proposal.before.type.value)
    yield from _figures(of, {"validFrom": min(proposal.seen), "validTo": max(proposal.seen)})
    for assumption in proposal.assumptions:
        yield of, LAW + "assumes", ox.Literal(assumption)


def phase_triples(of: Iri, phase: Latch | PushToOpen | Plain) -> Iterator[Triple]:
    """What held the container, as terms of Φ′."""
    if isinstance(phase, Latch):
        kind = "latch"
        figures = {
            "breakAwayForce": phase.force,
            "forceDeviation": phase.force_deviation,
            "latchTravel": phase.travel,
            "slidingForce": phase.friction,
        }
    elif isinstance(phase, PushToOpen):
        kind = "push_to_open"
        figures = {
            "pushForce": phase.force,
            "pushDepth": phase.depth,
            "depthDeviation": phase.depth_deviation,
            "springOut": phase.spring_out,
        }
    else:
        kind, figures = "plain", {"slidingForce": phase.friction}
    yield of, LAW + "mechanismKind", ox.Literal(kind)
    yield from _figures(of, figures)


def track_hash(track: Track) -> str:
    """SHA-256 of the observed positions and times."""
    return hashlib.sha256(track.positions.tobytes() + track.times.tobytes()).hexdigest()


def _figures(of: Iri, figures: dict[str, float]) -> Iterator[Triple]:
    for name, value in figures.items():
        yield of, LAW + name, ox.Literal(float(value))


def _label(container: Container, joint: Articulation) -> str:
    rms = joint.residual_rms / MILLIMETRE
    return f"{container.name}: {joint.joint_type.value} joint, {rms:.1f} mm rms from the path"
