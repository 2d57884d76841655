"""Kitchens that are served: the Law over each, its present state and its branches."""

from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import pyoxigraph as ox

from predicates.record.inputs import UNKNOWN_INPUT, model_input
from sdt_kg.errors import InputError
from sdt_kg.history import Branch, Edit, History, Trajectory, continued, has_history
from sdt_kg.iri import SDT, Iri, graph_iri, local_name
from sdt_kg.load import model_name
from sdt_kg.store import MemoryStore, Triple
from sdt_kg.twin import Twin
from services.app import Service, load
from services.dynamics.data import with_forces
from services.requests import state_texts

PRESENT: Final = SDT + "presentBranch"
"""Of the branch with which a history begins: the one that holds now."""


class Recording(MemoryStore):
    """A store that knows which of its graphs were written.

    Attributes:
        written: Their names, until they are kept.
    """

    def __init__(self) -> None:
        super().__init__()
        self.written: set[Iri] = set()

    def add(self, graph: Iri, triples: Iterable[Triple]) -> None:
        """Put triples into a named graph."""
        super().add(graph, triples)
        self.written.add(graph)


@dataclass(frozen=True)
class Kitchen:
    """A kitchen that is served.

    Attributes:
        source: Bundled name or path, for processes that load it too.
        robots: Bundled names or paths.
        service: The Law over its twin in its present state.
        history: Its branches; begun with the first write.
        present: The branch that is the present; None before the first write.
    """

    source: str
    robots: tuple[str, ...]
    service: Service
    history: History | None = None
    present: Branch | None = None

    @property
    def twin(self) -> Twin:
        """The twin in its present state."""
        return self.service.twin

    @property
    def name(self) -> str:
        """As people and processes call it."""
        return model_name(self.source)

    @cached_property
    def models(self) -> frozenset[tuple[str, str]]:
        """Kitchen and robot or none, as inputs of verdicts name them: as served, and with bundled forces."""
        twins = [self.twin]
        with suppress(InputError):  # forces do not fit a kitchen that was edited: nothing is asked with them
            twins.append(with_forces(self.twin))
        return frozenset(
            (model_input(twin, twin.environment), robot)
            for twin in twins
            for robot in (UNKNOWN_INPUT, *(model_input(twin, each) for each in twin.robots))
        )

    def is_subject(self, environment: str, robot: str) -> bool:
        """Whether a verdict is about this kitchen as it is, and not about a robot that is served as another.

        Args:
            environment: Input of the verdict: IRI, blank, content hash.
            robot: Likewise, or that none is given; it may be one that is not served.
        """
        served = {each.partition(" ")[0] for _, each in self.models}
        others = robot.partition(" ")[0] not in served and environment in {each for each, _ in self.models}
        return others or (environment, robot) in self.models

    @property
    def state_graph(self) -> Iri:
        """Named graph of the present state."""
        return self.twin.graphs()[-1]

    @property
    def moved(self) -> tuple[str, ...]:
        """The present state as texts, if something was moved; else none, and the kitchen is as loaded."""
        return () if self.present is None else state_texts(self.twin)

    @property
    def present_graph(self) -> Iri:
        """Named graph that says which branch is the present."""
        assert self.history is not None, "begun"
        return graph_iri("present", local_name(self.history.first.iri))

    def present_triple(self) -> ox.Triple:
        """Says which branch is the present."""
        assert self.history is not None, "begun"
        assert self.present is not None, "begun"
        return ox.Triple(
            ox.NamedNode(self.history.first.iri), ox.NamedNode(PRESENT), ox.NamedNode(self.present.iri)
        )

    def continued(self, kept: ox.Store, samples: Mapping[Iri, Trajectory]) -> "Kitchen":
        """The kitchen with the branches that were kept of it, in the state in which it was left.

        Branches of another model, or of other robots, are not its own.

        Raises:
            GraphError: What was kept was changed.
            InputError: The samples of a trajectory are not there.
        """
        if not has_history(kept):
            return self
        begun = self.begun()
        assert begun.history is not None, "begun"
        assert isinstance(begun.history.store, Recording), "as begun"
        history = continued(begun.history, kept, samples)
        begun.history.store.written.clear()
        found = replace(begun, history=history)
        for quad in kept.quads_for_pattern(None, None, None, ox.NamedNode(found.present_graph)):
            assert isinstance(quad.object, ox.NamedNode), "as written"
            return found.at(history.branch(quad.object.value))
        return found if len(history.branches) > 1 else self

    def begun(self) -> "Kitchen":
        """The kitchen with a history."""
        if self.history is not None:
            return self
        history = History.of(self.twin, Recording())
        return replace(self, history=history, present=history.first)

    def derived(self, edit: Edit, parent: Iri | None = None) -> "tuple[Kitchen, Branch]":
        """The kitchen with one branch more, and that branch; the present is as it was."""
        begun = self.begun()
        assert begun.history is not None, "begun"
        assert begun.present is not None, "begun"
        history, branch = begun.history.derived(parent or begun.present, edit)
        return replace(begun, history=history), branch

    def at(self, branch: Branch) -> "Kitchen":
        """The kitchen with this branch as its present."""
        return replace(self, present=branch, service=replace(self.service, twin=branch.twin))


def open_kitchens(sources: Iterable[str], robots: tuple[str, ...]) -> dict[str, Kitchen]:
    """Kitchens with all robots, by name.

    Raises:
        InputError: A model that is not there or not valid, or two kitchens of one name.
    """
    found: dict[str, Kitchen] = {}
    for source in sources:
        kitchen = Kitchen(source, robots, load(source, robots))
        if kitchen.name in found:
            raise InputError(f"two kitchens are named '{kitchen.name}'", allowed="each name once")
        found[kitchen.name] = kitchen
    return found
