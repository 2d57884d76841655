"""A history whose graphs were kept → the same history, or what is missing from them or was changed.

Nothing is believed: the first twin is rebuilt from its graphs (`Twin.from_quads`: the rules run again),
each edit is made again from what its record says, and the branch that comes of it must have the IRI,
the content hash, the step and the events that were recorded.
"""

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Final

import pyoxigraph as ox

from sdt_kg.annotating.annotate import TEE_GRAPH
from sdt_kg.entities import Replacement
from sdt_kg.errors import GraphError, InputError
from sdt_kg.history.branches import Branch, History
from sdt_kg.history.edits import Brought, Edit, Followed, Moved, Rewritten, TakenAway
from sdt_kg.history.records import record_graph
from sdt_kg.history.trajectory import Trajectory
from sdt_kg.interchange import Quads, stored
from sdt_kg.iri import PROV, SDT, Iri, graph_iri, local_name, model_iri
from sdt_kg.store import AnyTerm, Store, Triple, value_of
from sdt_kg.triples.facts import TYPE
from sdt_kg.twin import Twin

_ASSERTED: Final = graph_iri("asserted", "")
_NO_SAMPLES: Final[Mapping[Iri, Trajectory]] = {}
_REMEDY: Final = "save the history again: sdt branch KITCHEN EDIT... --history FILE.nq"


def has_history(quads: ox.Store) -> bool:
    """Whether these are the graphs of a history, and not of one of its twins alone."""
    return (
        next(iter(quads.quads_for_pattern(None, ox.NamedNode(SDT + "entityGraph"), None)), None) is not None
    )


def reopened(
    quads: Quads,
    trajectories: Mapping[Iri, Trajectory] = _NO_SAMPLES,
    *,
    environment: Iri | None = None,
    store: Store | None = None,
    beside: Path | None = None,
) -> History:
    """The history whose graphs these are, its branches in the order of their steps.

    Args:
        quads: What the history's store held; other graphs are not looked at.
        trajectories: By IRI, those that its branches followed: their samples are kept beside the graphs.
        environment: The kitchen that is meant; may be left out where there is one history.
        store: Where to write; by default in memory.
        beside: Folder of the file or store that the quads are from, if meshes may lie there.

    Raises:
        GraphError: Something is missing or was changed, or a mesh file is gone.
        InputError: There is none, there are several, or the samples of a trajectory were not given.
    """
    kept = _Kept(quads)
    first = _first(kept, environment)
    return _grown(History.of(kept.twin(first, beside), store), kept, first, trajectories)


def continued(
    history: History, quads: Quads, trajectories: Mapping[Iri, Trajectory] = _NO_SAMPLES
) -> History:
    """The history with all branches that were kept of it.

    Args:
        history: Of a twin, begun anew.
        quads: May hold other histories too, also of this kitchen as it was modelled before.
        trajectories: As `reopened` takes them.

    Raises:
        GraphError: Something is missing or was changed.
        InputError: The samples of a trajectory were not given.
    """
    kept, first = _Kept(quads), history.first.iri
    return _grown(history, kept, first, trajectories) if first in kept.branches() else history


def _grown(history: History, kept: "_Kept", first: Iri, trajectories: Mapping[Iri, Trajectory]) -> History:
    """The history with the branches that derive from its first one, made again and compared."""
    _check(history, history.first, kept, first)
    waiting = kept.children()
    parents = [first]
    while parents:
        parent = parents.pop(0)
        for iri in waiting.get(parent, []):
            edit = kept.edit(history.branch(parent), iri, trajectories)
            history, made = history.derived(parent, edit)
            _check(history, made, kept, iri)
            parents.append(iri)
    return history


def _first(kept: "_Kept", environment: Iri | None) -> Iri:
    """The branch with which the history begins."""
    firsts = [iri for iri in kept.branches() if kept.parent(iri) is None]
    known = {iri: kept.environment(iri) for iri in firsts}
    meant = [iri for iri in firsts if environment in (None, known[iri])]
    if len(meant) == 1:
        return meant[0]
    names = ", ".join(sorted(map(local_name, known.values()))) or "none"
    raise InputError(
        f"the graphs hold {len(meant)} histories that could be meant",
        allowed=f"one; there are those of: {names}",
        remedy="name the kitchen" if meant else _REMEDY,
    )


def _check(history: History, made: Branch, kept: "_Kept", iri: Iri) -> None:
    """That the branch which was made again is the one that was recorded."""
    if made.iri != iri:
        raise GraphError(f"<{iri}> was changed: what is recorded makes <{made.iri}>", remedy=_REMEDY)
    graph = record_graph(iri)
    made_again, recorded = set(history.store.triples(graph)), set(kept.triples(graph))
    if made_again != recorded:
        _, predicate, value = min(made_again ^ recorded, key=str)
        what = f"{local_name(predicate)} {value_of(value)}"
        raise GraphError(f"the record of <{iri}> was changed, see '{what}'", remedy=_REMEDY)


class _Kept:
    """What was kept of histories, each graph read when it is asked for."""

    def __init__(self, quads: Quads) -> None:
        self._store = stored(quads)

    def branches(self) -> list[Iri]:
        """Branches that have a record, the earliest steps first."""
        found: dict[Iri, int] = {}
        branch = ox.NamedNode(SDT + "Branch")
        for quad in self._store.quads_for_pattern(None, ox.NamedNode(TYPE), branch):
            iri = quad.subject
            if isinstance(iri, ox.NamedNode) and quad.graph_name == ox.NamedNode(record_graph(iri.value)):
                step = value_of(self._one(iri.value, SDT + "step"))
                found[iri.value] = step if isinstance(step, int) else 0
        return sorted(found, key=lambda iri: (found[iri], iri))

    def children(self) -> dict[Iri, list[Iri]]:
        """Parent → its branches.

        Raises:
            GraphError: A parent has no record.
        """
        branches, found = self.branches(), dict[Iri, list[Iri]]()
        known = frozenset(branches)
        for iri in branches:
            parent = self.parent(iri)
            if parent is not None and parent not in known:
                raise GraphError(f"<{parent}>, from which <{iri}> derives, is not there", remedy=_REMEDY)
            if parent is not None:
                found.setdefault(parent, []).append(iri)
        return found

    def parent(self, branch: Iri) -> Iri | None:
        """Where a branch comes from."""
        found = self._all(branch, PROV + "wasDerivedFrom")
        return str(value_of(found[0])) if found else None

    def environment(self, branch: Iri) -> Iri:
        """The kitchen of a branch."""
        environment = ox.NamedNode(SDT + "Environment")
        for model, graph in self._asserted(branch).items():
            if any(
                self._store.quads_for_pattern(ox.NamedNode(model), None, environment, ox.NamedNode(graph))
            ):
                return model
        raise GraphError(f"<{branch}> has no kitchen", remedy=_REMEDY)

    def twin(self, branch: Iri, beside: Path | None) -> Twin:
        """The twin of a branch, from its own graphs alone."""
        state = str(value_of(self._one(branch, SDT + "stateGraph")))
        quads = [*self._quads(TEE_GRAPH), *self._quads(state)]
        for graph in self._entity_graphs(branch):
            quads += self._quads(graph, _unversioned(graph))
        return Twin.from_quads(quads, state=state, beside=beside)

    def edit(self, parent: Branch, branch: Iri, trajectories: Mapping[Iri, Trajectory]) -> Edit:
        """What made a branch from its parent."""
        followed = self._all(branch, PROV + "wasGeneratedBy")
        if followed:
            return _followed(str(value_of(followed[0])), trajectories)
        moves = self._all(branch, SDT + "hasMove")
        if moves:
            return Moved(tuple(sorted(self._move(str(value_of(each))) for each in moves)))
        return self._rewritten(parent, branch)

    def _rewritten(self, parent: Branch, branch: Iri) -> Edit:
        before, after = self._asserted(parent.iri), self._asserted(branch)
        for robot in sorted(before.keys() ^ after.keys()):
            return Brought(robot, self._content(after[robot])) if robot in after else TakenAway(robot)
        sentence = str(value_of(self._one(branch, SDT + "edit")))
        if before == after and sentence == Moved(()).sentence:
            return Moved(())
        differing = [model for model in before if before[model] != after[model]]
        if before == after:  # a property was given the value that it had
            differing = [model for model in before if sentence.startswith(f"{local_name(model)}: ")]
        if len(differing) != 1:
            raise GraphError(f"what made <{branch}> is not recorded", remedy=_REMEDY)
        (model,) = differing
        old, new = self._content(before[model]), self._content(after[model])
        words = sentence.removeprefix(f"{local_name(model)}: ")
        return Rewritten(Replacement(model, old - new, new - old, words))

    def _move(self, move: Iri) -> tuple[Iri, float]:
        at = value_of(self._one(move, SDT + "movedTo"))
        if not isinstance(at, float):
            raise GraphError(f"<{move}> leads to no position", remedy=_REMEDY)
        return str(value_of(self._one(move, SDT + "movedJoint"))), at

    def _asserted(self, branch: Iri) -> dict[Iri, Iri]:
        """Model → its asserted graph."""
        graphs = [graph for graph in self._entity_graphs(branch) if graph.startswith(_ASSERTED)]
        return {model_iri(local_name(_unversioned(graph))): graph for graph in graphs}

    def _entity_graphs(self, branch: Iri) -> list[Iri]:
        manifest = str(value_of(self._one(branch, SDT + "entitySet")))
        return sorted(str(value_of(term)) for term in self._all(manifest, SDT + "entityGraph"))

    def _content(self, graph: Iri) -> frozenset[Triple]:
        old = _unversioned(graph)
        return frozenset((old if s == graph else s, p, o) for s, p, o in self.triples(graph))

    def triples(self, graph: Iri) -> Iterator[Triple]:
        """Triples of a named graph."""
        for quad in self._store.quads_for_pattern(None, None, None, ox.NamedNode(graph)):
            subject, value = quad.subject, quad.object
            if not isinstance(subject, ox.NamedNode) or not isinstance(value, ox.NamedNode | ox.Literal):
                raise GraphError(f"<{graph}> has a blank node or a quoted triple: {quad}", remedy=_REMEDY)
            yield subject.value, quad.predicate.value, value

    def _quads(self, graph: Iri, name: Iri | None = None) -> Iterable[ox.Quad]:
        """A graph's quads, under another name of the graph if one is given."""
        node = ox.NamedNode(name or graph)
        for subject, predicate, value in self.triples(graph):
            about = node if subject == graph else ox.NamedNode(subject)
            yield ox.Quad(about, ox.NamedNode(predicate), value, node)

    def _all(self, subject: Iri, predicate: Iri) -> list[AnyTerm]:
        quads = self._store.quads_for_pattern(ox.NamedNode(subject), ox.NamedNode(predicate), None)
        return sorted({quad.object for quad in quads}, key=str)

    def _one(self, subject: Iri, predicate: Iri) -> AnyTerm:
        found = self._all(subject, predicate)
        if len(found) != 1:
            what = f"{local_name(predicate)} of <{subject}>"
            raise GraphError(f"there are {len(found)} values for the {what}", allowed="one", remedy=_REMEDY)
        return found[0]


def _followed(iri: Iri, trajectories: Mapping[Iri, Trajectory]) -> Followed:
    if iri not in trajectories:
        raise InputError(
            f"the samples of the trajectory <{iri}> were not given",
            allowed="the .npz files that were written beside the history",
        )
    if trajectories[iri].iri != iri:
        raise GraphError(f"the samples that were given for <{iri}> are others", remedy="put the file back")
    return Followed(trajectories[iri])


def _unversioned(graph: Iri) -> Iri:
    """Name of the graph whose content at some time this one holds."""
    return graph.rpartition("/")[0]
