"""Kitchens that are served: the Law over each, its present state and its branches."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

from sdt_kg.errors import InputError
from sdt_kg.history import Branch, Edit, History
from sdt_kg.iri import Iri, local_name
from sdt_kg.load import model_name
from sdt_kg.store import MemoryStore, Triple
from sdt_kg.twin import Twin
from services.app import Service, load


class Recording(MemoryStore):
    """A store that knows which of its graphs were written.

    Attributes:
        written: Their names, until somebody takes them.
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

    @property
    def state_graph(self) -> Iri:
        """Named graph of the present state."""
        return self.twin.graphs()[-1]

    @property
    def states(self) -> tuple[str, ...]:
        """The present state as texts, for a process that loads the kitchen anew."""
        followers = self.twin.entities.coupling.followers
        free = (joint for joint in self.twin.state if joint not in followers)
        return tuple(f"{local_name(joint)}={self.twin.state[joint]!r}" for joint in free)

    @property
    def moved(self) -> tuple[str, ...]:
        """The present state as texts, if something was moved; else none, and the kitchen is as loaded."""
        return () if self.present is None else self.states

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
