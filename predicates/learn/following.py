"""Φ′ of two containers seen together: the twin in which the second's joint follows the first's."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import pyoxigraph as ox

from predicates.learn.articulation import Learned
from predicates.learn.coupled import Coupled
from predicates.learn.frames import rejoined
from predicates.learn.record import Key, track_hash
from predicates.learn.track import Array
from sdt_kg.errors import InputError
from sdt_kg.iri import LAW, PROV, RDF, RDFS, Iri, local_name
from sdt_kg.mechanism import LEARNED, Joint, JointType, Mimic
from sdt_kg.store import Triple
from sdt_kg.twin import Container, Twin

PLAY = 0.02
"""[rad or m] How far the fitted line may pass beside the present state; more is play, which no mimic has."""


@dataclass(frozen=True, slots=True, eq=False)
class Following:
    """A joint of the kitchen as a follower of another.

    Attributes:
        leader, container: What leads, and what follows.
        before, after: The joint that follows.
        found: What it rests on, in the joints' own coordinates.
        twin: With the joint coupled, in the state in which the tracks began.
        assumptions: What the tracks do not say, one sentence each.
    """

    leader: Container
    container: Container
    before: Joint
    after: Joint
    found: Coupled
    twin: Twin
    assumptions: tuple[str, ...]


def in_joints(learned: Learned, values: Array, radius: float) -> Learned:
    """What was learned, its positions those of a twin's own joint, shape (T,), at a radius [m]."""
    best = replace(learned.best, positions=values, limits=(float(values.min()), float(values.max())))
    if best.joint_type is JointType.REVOLUTE:
        best = replace(best, radius=radius)
    return Learned(learned.track, (best, *learned.candidates[1:]))


def follow(twin: Twin, leader: Container, container: Container, found: Coupled) -> Following:
    """The twin in which a container's own joint follows that of another.

    Args:
        twin: In the state in which the tracks began.
        leader: Whose joint leads.
        container: Whose joint follows.
        found: In the coordinates of the two joints.

    Raises:
        InputError: It does not follow, follows with play, is the same, or one of them is coupled already.
    """
    kitchen = twin.mechanism(twin.environment)
    joint = kitchen.joint(local_name(container.joint))
    _check(twin, leader, container, found)
    now1, now2 = twin.state[leader.joint], twin.state[container.joint]
    play = found.multiplier * now1 + found.offset - now2
    if abs(play) > PLAY:
        raise InputError(
            f"{container.name} follows {leader.name} with a play of {abs(play):.3f}",
            allowed=f"at most {PLAY} rad or m: a joint that mimics has none",
        )
    offset = now2 - found.multiplier * now1
    mimic = Mimic(local_name(leader.joint), found.multiplier, offset)
    times = f"times {found.multiplier:.4g} ± {found.multiplier_deviation:.2g} (standard deviation)"
    note = f"{LEARNED} of each: it follows {leader.name}, {times}"
    after = replace(joint, mimic=mimic, notes=(*joint.notes, note))
    changed = rejoined(twin, after, np.eye(4), f"learned: joint '{joint.name}' follows '{mimic.joint}'")
    assumptions = (
        f"{leader.name} leads: that two joints move together does not show which drives the other",
        f"at the begin both are where the twin has them, {play:+.4f} beside the fitted line",
    )
    return Following(leader, container, joint, after, found, changed, assumptions)


def _check(twin: Twin, leader: Container, container: Container, found: Coupled) -> None:
    if not found.holds:
        raise InputError(
            f"{container.name} goes its own way", allowed="a joint that follows", remedy="nothing is learned"
        )
    coupling = twin.entities.coupling
    tied = set(coupling.followers) | {each.active for each in coupling.followers.values()}
    for each in (leader, container):
        if each.joint in tied:
            raise InputError(
                f"joint '{local_name(each.joint)}' is coupled to others",
                allowed="joints that neither mimic nor are mimicked",
            )
    if leader.joint == container.joint:
        raise InputError(f"both tracks are of {leader.name}", allowed="tracks of two containers")


def following_triples(twin: Twin, tracks: tuple[Learned, Learned], made: Following) -> Iterator[Triple]:
    """Φ′ of the coupling and the two observations that it rests on."""
    of = key_of(twin, tracks, made).iri
    yield of, RDF + "type", ox.NamedNode(LAW + "LearnedPhysics")
    label = f"{made.container.name} follows {made.leader.name}, times {made.found.multiplier:.4g}"
    yield of, RDFS + "label", ox.Literal(label)
    yield of, LAW + "entity", ox.NamedNode(made.container.joint)
    yield of, LAW + "container", ox.NamedNode(made.container.iri)
    yield of, LAW + "followsJoint", ox.NamedNode(made.leader.joint)
    yield of, LAW + "environment", ox.NamedNode(twin.environment)
    yield of, LAW + "parentHash", ox.Literal(twin.content_hash(twin.environment))
    yield of, LAW + "mechanismKind", ox.Literal("coupled")
    figures = {
        "ratio": made.found.multiplier,
        "ratioDeviation": made.found.multiplier_deviation,
        "couplingResidual": made.found.residual,
        "evidence": made.found.evidence,
    }
    for name, value in figures.items():
        yield of, LAW + name, ox.Literal(float(value))
    for assumption in made.assumptions:
        yield of, LAW + "assumes", ox.Literal(assumption)
    yield of, PROV + "wasDerivedFrom", ox.NamedNode(twin.environment)
    for number, learned in enumerate(tracks, 1):
        seen: Iri = f"{of}/observation/{number}"
        yield of, PROV + "wasDerivedFrom", ox.NamedNode(seen)
        yield seen, RDF + "type", ox.NamedNode(LAW + "Observation")
        yield seen, RDFS + "label", ox.Literal(learned.track.name)
        yield seen, LAW + "observedSamples", ox.Literal(len(learned.track.positions))
        yield seen, LAW + "missingSamples", ox.Literal(learned.track.missing)
        yield seen, LAW + "trackHash", ox.Literal(track_hash(learned.track))


def key_of(twin: Twin, tracks: tuple[Learned, Learned], made: Following) -> Key:
    """What names it: the hash of both tracks, both joints and the twin."""
    first = Key.of(twin, made.leader, tracks[0].track)
    second = Key.of(twin, made.container, tracks[1].track)
    return Key(f"{first.digest[:16]}{second.digest[:16]}")
