"""Branches, trajectories and events as triples; no blank nodes."""

from collections.abc import Iterable, Iterator, Sequence
from typing import Final

import pyoxigraph as ox

from sdt_kg.history.events import Event, EventType
from sdt_kg.history.trajectory import Trajectory
from sdt_kg.iri import LAW, PROV, SDT, Iri, graph_iri, local_name, part_iri
from sdt_kg.store import Triple, double
from sdt_kg.triples.facts import TYPE

HELD: Final = ox.NamedNode(SDT + "ContactMade")


def record_graph(branch: Iri) -> Iri:
    """Named graph of what is said of a branch: from what, by which edit, with which events."""
    return graph_iri("branch", local_name(branch))


def branch_triples(
    branch: Iri, parent: Iri | None, edit: str, content_hash: str, step: int
) -> Iterator[Triple]:
    """Where the branch comes from and what it holds."""
    yield branch, TYPE, ox.NamedNode(SDT + "Branch")
    yield branch, SDT + "edit", ox.Literal(edit)
    yield branch, SDT + "contentHash", ox.Literal(content_hash)
    yield branch, SDT + "step", ox.Literal(step)
    if parent is not None:
        yield branch, PROV + "wasDerivedFrom", ox.NamedNode(parent)


def graph_triples(branch: Iri, entities: Iri, state: Iri) -> Iterator[Triple]:
    """Which graphs hold the branch's entities and state."""
    yield branch, SDT + "entitySet", ox.NamedNode(entities)
    yield branch, SDT + "stateGraph", ox.NamedNode(state)


def trajectory_triples(branch: Iri, parent: Iri, trajectory: Trajectory) -> Iterator[Triple]:
    """The trajectory from G_0, the parent, to G_final, the branch; its samples are beside the graph."""
    iri = trajectory.iri
    yield iri, TYPE, ox.NamedNode(SDT + "Trajectory")
    yield iri, SDT + "contentHash", ox.Literal(local_name(iri))
    yield iri, SDT + "sampleCount", ox.Literal(len(trajectory.times))
    yield iri, LAW + "duration", double(trajectory.duration)
    yield iri, PROV + "used", ox.NamedNode(parent)
    yield branch, PROV + "wasGeneratedBy", ox.NamedNode(iri)
    for joint in trajectory.joints:
        yield iri, SDT + "moves", ox.NamedNode(joint)


def move_triples(branch: Iri, positions: Sequence[tuple[Iri, float]]) -> Iterator[Triple]:
    """Which joints the edit moved, and where to [rad or m], to the last digit."""
    for number, (joint, at) in enumerate(positions, 1):
        iri = part_iri(branch, "move", number)
        yield branch, SDT + "hasMove", ox.NamedNode(iri)
        yield iri, TYPE, ox.NamedNode(SDT + "Move")
        yield iri, SDT + "movedJoint", ox.NamedNode(joint)
        yield iri, SDT + "movedTo", double(at)


def first_triples(branch: Iri, opened: Iterable[Iri]) -> Iterator[Triple]:
    """Which containers are open where the history begins."""
    return ((branch, SDT + "openAtFirst", ox.NamedNode(container)) for container in opened)


def event_triples(
    branch: Iri, events: Sequence[Event], trajectory: Iri | None, before: int
) -> Iterator[Triple]:
    """What happened on the way to the branch; `before` is its parent's step."""
    for number, event in enumerate(events, 1):
        iri = part_iri(branch, "event", number)
        yield branch, SDT + "hasEvent", ox.NamedNode(iri)
        yield iri, TYPE, ox.NamedNode(SDT + event.type.value)
        yield iri, SDT + "about", ox.NamedNode(event.about)
        yield iri, SDT + "step", ox.Literal(before + (1 if event.sample is None else event.sample))
        if event.type is EventType.GRASPED:
            yield iri, TYPE, HELD
        if event.by is not None:
            yield iri, SDT + "by", ox.NamedNode(event.by)
        if event.sample is not None and event.time is not None and trajectory is not None:
            yield iri, SDT + "during", ox.NamedNode(trajectory)
            yield iri, SDT + "sample", ox.Literal(event.sample)
            yield iri, SDT + "time", double(event.time)
