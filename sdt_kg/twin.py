"""Twin (G): a kitchen and robots as a graph, in one state."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Final

import rdflib

from sdt_kg.annotation import KitchenAnnotation, RobotAnnotation
from sdt_kg.display import card, grid
from sdt_kg.entities import Entities, Replacement
from sdt_kg.entities.container import Container, LeftOut
from sdt_kg.entities.stuck import stuck
from sdt_kg.errors import UnknownEntityError
from sdt_kg.interchange import Owl, Quads, dumped, owlready_ontology, portable, quads_of, rebuilt
from sdt_kg.iri import PREFIXES, SDT, Iri, joint_iri, local_name
from sdt_kg.mechanism import Mechanism, Pose
from sdt_kg.state import State
from sdt_kg.store import Row, Triple, Value, checked_query, rows_of
from sdt_kg.triples import read_robot
from sdt_kg.triples.facts import TYPE

__all__ = ["Container", "LeftOut", "Twin"]

NO_HASHES: Final[Mapping[Iri, str]] = MappingProxyType({})


class Twin:
    """G. Nothing writes to it; `at`, `with_edit` give another twin.

    Attributes:
        state: Complete: every movable kitchen joint, mimicking ones too.
    """

    def __init__(self, entities: Entities, state: State | None = None) -> None:
        self.entities = entities
        self.state = entities.coupling.start() if state is None else state

    def __repr__(self) -> str:
        robots = ", ".join(map(self.name, self.robots))
        return f"<Twin of kitchen {self.name(self.environment)}{f' with {robots}' if robots else ''}>"

    @staticmethod
    def from_quads(  # noqa: PLR0913 - what of the quads is meant, and what is known of them
        quads: Quads,
        environment: Iri | None = None,
        robots: Sequence[Iri] | None = None,
        *,
        state: Iri | None = None,
        hashes: Mapping[Iri, str] = NO_HASHES,
        beside: Path | None = None,
    ) -> "Twin":
        """The twin whose named graphs these are, as `serialize("nquads")` or `"trig"` wrote them.

        Rules run again and must find what the graphs say was inferred; mesh files must be where they
        were, or at any end of that path beside the graphs or in the folder that `SDT_MODELS` names, with
        the same content. Other graphs (verdicts, say) are not looked at.

        Args:
            quads: A store, or quads with named graphs.
            environment: The kitchen that is meant; may be left out where there is one.
            robots: The robots that are meant; by default all, by IRI.
            state: Graph of the state that is meant; may be left out where the kitchen has one.
            hashes: Model IRI → content hash that it must have: that alone shows a changed figure.
            beside: Folder of the file or store that the quads are from, if meshes may lie there.

        Raises:
            GraphError: Something is missing, was changed, or a mesh file is gone.
            UnknownEntityError: No such kitchen, robot or state in these graphs.
        """
        return Twin(*rebuilt(quads, environment, robots, state=state, hashes=hashes, beside=beside))

    @staticmethod
    def from_rdflib(
        dataset: rdflib.Dataset,
        environment: Iri | None = None,
        robots: Sequence[Iri] | None = None,
        *,
        state: Iri | None = None,
        hashes: Mapping[Iri, str] = NO_HASHES,
    ) -> "Twin":
        """The twin of an rdflib dataset with a twin's named graphs; see `from_quads`."""
        return Twin.from_quads(quads_of(dataset), environment, robots, state=state, hashes=hashes)

    @property
    def environment(self) -> Iri:
        """IRI of the kitchen."""
        return self.entities.environment

    @property
    def robots(self) -> tuple[Iri, ...]:
        """IRIs of the robots."""
        return self.entities.robots

    @property
    def obstacles(self) -> frozenset[Iri]:
        """Bodies of the kitchen that edits put there."""
        return frozenset(self.entities.facts.having(TYPE, SDT + "Obstacle"))

    @property
    def drawn_at(self) -> dict[str, Pose]:
        """Joints of the kitchen (names) whose frames edits put elsewhere, and where they were drawn."""
        kitchen, facts, found = self.mechanism(self.environment), self.entities.facts, dict[str, Pose]()
        for each in kitchen.joints:
            if (drawn := facts.one(joint_iri(kitchen.name, each.name), "drawnAt")) is not None:
                x, y, z, *turn = map(float, str(drawn).split())
                found[each.name] = Pose((x, y, z), (turn[0], turn[1], turn[2], turn[3]))
        return found

    @property
    def notes(self) -> tuple[str, ...]:
        """What loading changed, chose or assumed, one sentence each."""
        return self.entities.notes

    @staticmethod
    def name(model: Iri) -> str:
        """Name of the kitchen or robot."""
        return local_name(model)

    def graphs(self) -> tuple[Iri, ...]:
        """Named graphs of this twin: entities, then the present state."""
        return self.entities.states.graphs(self.state)

    def select(self, query: str, **known: Value) -> list[Row]:
        """Rows of a query of `ontology/queries` (by file stem), over [entities, state].

        Args:
            query: File stem.
            known: Values for variables that the query selects.
        """
        return self.entities.states.rows(self.state, query, **known)

    def has_row(self, query: str, **known: Value) -> bool:
        """Whether such a query has a row; found out once for each state."""
        return self.entities.states.has_row(self.state, query, **known)

    def query(self, sparql: str) -> tuple[list[str], list[Row]]:
        """Columns and rows of anybody's query, over [entities, state].

        Raises:
            QueryError: It does not parse, or would write or fetch.
        """
        return rows_of(self.entities.store.query(checked_query(sparql), self.graphs()))

    def containers(self) -> tuple[Container, ...]:
        """The counted containers, by name."""
        return self.entities.containers

    def container(self, name_or_iri: str) -> Container:
        """One container; UnknownEntityError names the nearest."""
        for container in self.containers():
            if name_or_iri in (container.name, container.iri):
                return container
        names = [container.name for container in self.containers()]
        left_out = {local_name(each.body): each.reason for each in self.left_out()}
        reason = left_out.get(name_or_iri)
        listed = f"sdt containers lists those of kitchen {self.name(self.environment)}"
        remedy = f"'{name_or_iri}' is not counted: {reason}" if reason else listed
        raise UnknownEntityError("container", local_name(name_or_iri), names, remedy)

    def left_out(self) -> tuple[LeftOut, ...]:
        """Joints that could be taken for a container's but are not counted, with the reason."""
        rows = self.select("left_out")
        found = {
            str(row["joint"]): LeftOut(str(row["joint"]), str(row["body"]), str(row["reason"]))
            for row in rows
        }
        found |= {each.joint: each for each in stuck(self.mechanism(self.environment))}
        return tuple(found.values())

    def mechanism(self, model: Iri) -> Mechanism:
        """The kitchen or a robot, read back from the graph alone (cached)."""
        return self.entities.mechanism(self._known(model))

    def robot(self, robot: Iri) -> RobotAnnotation:
        """Annotation of a robot, read back from the graph alone (cached)."""
        cached = self.entities.annotations
        if robot not in cached:
            cached[robot] = read_robot(self.entities.facts, self._known(robot))
        return cached[robot]

    def kitchen(self) -> KitchenAnnotation:
        """Annotation of the kitchen, read back from the graph alone (cached)."""
        return self.entities.kitchen

    def _known(self, model: Iri) -> Iri:
        if model not in self.entities.asserted:
            raise UnknownEntityError("model", model, self.entities.asserted, "load it with the twin")
        return model

    def content_hash(self, model: Iri) -> str:
        """SHA-256 over the model's entity triples (asserted and inferred), canonical order.

        Paths of mesh files are left out: their content counts, not where they lie.
        """
        return self.entities.content_hash(self._known(model))

    def at(self, state: Mapping[Iri, float]) -> "Twin":
        """The same twin with these joints elsewhere; StateError outside limits.

        A mimicking joint follows the one that it mimics; setting it sets that one.
        """
        if state is self.state:
            return self
        return Twin(self.entities, self.entities.coupling.moved(self.state, state))

    def with_edit(self, subject: Iri, **changes: Value) -> "Twin":
        """The same twin in the same state, with properties of one individual replaced.

        `twin.with_edit(joint, upperLimit=0.3)`; None removes. Rules run again, so that whatever
        follows from the property changes too.

        Raises:
            UnknownEntityError: No such individual, or no such property in `sdt.ttl`.
            StateError: The present state is outside the new limits.
        """
        return self._with(self.entities.edited(subject, changes))

    def rewritten(self, by: Replacement) -> "Twin":
        """The same twin in the same state, with asserted triples of one model replaced."""
        return self._with(self.entities.rewritten(by))

    def with_robot(self, robot: Iri, triples: Sequence[Triple], notes: Sequence[str] = ()) -> "Twin":
        """The same twin in the same state, with a robot of which these triples are asserted."""
        return Twin(self.entities.with_robot(robot, triples, notes), self.state)

    @property
    def bare(self) -> "Twin":
        """The same kitchen in the same state, without robots: twins with robots share what it is asked."""
        return Twin(self.entities.bare, self.state)

    def knowing(self, container: Container) -> "Twin":
        """The bare twin where the container is the kitchen's own, else this one."""
        bare = self.bare
        return bare if container in bare.containers() else self

    def without_robot(self, robot: Iri) -> "Twin":
        """The same twin in the same state, without one robot."""
        return Twin(self.entities.without_robot(robot), self.state)

    def _with(self, entities: Entities) -> "Twin":
        """Other entities, whose joints are where they were as far as they still are joints."""
        start = entities.coupling.start()
        kept = {joint: at for joint, at in self.state.items() if joint in start}
        return Twin(entities, entities.coupling.moved(start, kept))

    def serialize(self, form: str) -> bytes:
        """The twin as RDF: `turtle` (all graphs merged), `trig` or `nquads` (named graphs)."""
        return dumped(self.entities.store.dump(self.graphs()), form)

    def portable(self, form: str, *folders: Path) -> bytes:
        """The same for another machine: meshes are named `package://NAME/…`, not by folders of this one.

        `from_quads` finds them in the folder that `SDT_MODELS` names. NAME is the package of a file, or
        the one of these folders, of models, that holds it, or what all of them have in common.
        """
        return dumped(portable(self.entities.store.dump(self.graphs()), folders), form)

    def to_rdflib(self) -> rdflib.Dataset:
        """The twin as an rdflib dataset, for notebooks: a copy."""
        dataset = rdflib.Dataset(default_union=True)
        dataset.parse(data=self.serialize("nquads"), format="nquads")
        for prefix, namespace in PREFIXES.items():
            dataset.bind(prefix, namespace)
        return dataset

    def to_owlready(self) -> Owl:
        """The twin with the core ontologies as an owlready2 ontology in a world of its own: a copy.

        `onto.world[IRI]` is a class or an individual; nothing is fetched.
        """
        return owlready_ontology(self.entities.store.dump(self.graphs()), f"{self.environment}/owl")

    def triple_count(self) -> int:
        """How many triples the twin has, state included."""
        return len(self.entities.store.dump(self.graphs()))

    def _repr_html_(self) -> str:
        """The kitchen, its robots, its state and its containers, for Jupyter."""
        containers, start = self.containers(), self.entities.coupling.start()
        moved = [f"{local_name(joint)} at {at:.4g}" for joint, at in self.state.items() if at != start[joint]]
        kinds = [each.kind for each in containers]
        rows = [
            ("robots", ", ".join(map(self.name, self.robots)) or "none loaded"),
            ("containers", f"{kinds.count('door')} doors, {kinds.count('drawer')} drawers"),
            ("state", ", ".join(moved) or "everything at its start"),
        ]
        cells = [(each.name, each.kind, each.open_from, self.state[each.active_joint]) for each in containers]
        more = grid(("container", "kind", "open from", "actuated joint at"), cells, "containers")
        return card(f"Twin of kitchen {self.name(self.environment)}", rows, more=more)
