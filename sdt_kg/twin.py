"""Twin (G): a kitchen and robots as a graph, in one state."""
# SKELETON by the coordinator: signatures are fixed, bodies belong to the twin's author.

from collections.abc import Mapping
from dataclasses import dataclass

from sdt_kg.annotation import KitchenAnnotation, RobotAnnotation
from sdt_kg.iri import Iri
from sdt_kg.mechanism import Mechanism
from sdt_kg.state import State


@dataclass(frozen=True, slots=True)
class Container:
    """A counted container of a kitchen.

    Attributes:
        iri: IRI of its body.
        name: Name of its body.
        kind: `door` or `drawer`.
        joint: IRI of its own joint p_c.
        active_joint: IRI of the joint that is actuated: the mimicked one for a mimic door.
        multiplier: p_c = multiplier · p_active + offset.
        offset: See multiplier.
        handle: IRI of its handle's body.
        lower, upper: Effective limits of p_c [rad or m], over the coupling.
        open_from: Threshold of open(c): 0.9 · upper.
        closed_to: Threshold of closed(c): lower + epsilon.
        velocity, acceleration: Effective limits of p_c.
    """

    iri: Iri
    name: str
    kind: str
    joint: Iri
    active_joint: Iri
    multiplier: float
    offset: float
    handle: Iri
    lower: float
    upper: float
    open_from: float
    closed_to: float
    velocity: float
    acceleration: float


class Twin:
    """G. Nothing writes to it; `at`, `with_edit` give another twin.

    Attributes (properties): environment: Iri; robots: tuple[Iri, ...]; state: State (complete:
    every movable kitchen joint).
    """

    environment: Iri
    robots: tuple[Iri, ...]
    state: State

    def select(self, query: str, **known: Iri | float | str) -> list[dict[str, object]]:
        """Rows of a query of `ontology/queries` (by file stem), over [entities, state]."""
        ...

    def containers(self) -> tuple[Container, ...]:
        """The counted containers, by name."""
        ...

    def container(self, name_or_iri: str) -> Container:
        """One container; UnknownEntityError names the nearest."""
        ...

    def mechanism(self, model: Iri) -> Mechanism:
        """The kitchen or a robot, read back from the graph alone (cached)."""
        ...

    def robot(self, robot: Iri) -> RobotAnnotation:
        """Annotation of a robot, read back from the graph alone."""
        ...

    def kitchen(self) -> KitchenAnnotation:
        """Annotation of the kitchen, read back from the graph alone."""
        ...

    def content_hash(self, model: Iri) -> str:
        """SHA-256 over the model's entity triples (asserted and inferred), canonical order."""
        ...

    def at(self, state: Mapping[Iri, float]) -> "Twin":
        """The same twin with these joints elsewhere; StateError outside limits."""
        ...
