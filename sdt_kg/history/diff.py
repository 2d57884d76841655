"""How two graphs differ: quads that only one of them has, and that in sentences."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import pyoxigraph as ox

from sdt_kg.errors import GraphError
from sdt_kg.iri import ID, RDF, SDT, Iri, graph_iri, local_name
from sdt_kg.numbers import DIGITS
from sdt_kg.state import Interval
from sdt_kg.store import value_of
from sdt_kg.twin import Twin

Node = ox.NamedNode | ox.BlankNode | ox.Literal | ox.Triple
"""The object of a quad."""

TYPE = ox.NamedNode(RDF + "type")
POSITION = SDT + "position"
_PARTS = ("/origin", "/pose", "/inertia", "/collision/", "/note/", "/event/")
_COUNTED = {
    graph_iri("inferred", ""): "inferred {}",
    graph_iri("branch", ""): "{} in what is recorded of branches",
}
"""How graphs begin that are about the world, not of it, and what is said of how many triples differ there."""
_SHORT = 6  # digits of a figure, as `g` tells it, unless two need more to be told apart
_UNITS = {"PrismaticJoint": " m", "RevoluteJoint": " rad", "ContinuousJoint": " rad"}


@dataclass(frozen=True, slots=True)
class Difference:
    """What has to be removed from one set of quads and added to it to make another one.

    Attributes:
        removed: Quads that only the first one has.
        added: Quads that only the second one has.
        known: Types and thresholds of what both are about, for sentences.
    """

    removed: frozenset[ox.Quad]
    added: frozenset[ox.Quad]
    known: "_Known"

    def sentences(self) -> list[str]:
        """The difference for people: what was added, removed, moved or changed, by name; same order always.

        What rules infer from it, and what is recorded of branches, is counted, not listed.
        """
        removed, added = _told(self.removed), _told(self.added)
        gone, come = set(self.known.gone), set(self.known.come)
        lines = [f"removed: {text}" for text in _wholes(gone, removed)]
        lines += [f"added: {text}" for text in _wholes(come, added)]
        old, new = _values(removed, gone), _values(added, come)
        for key in sorted(old.keys() | new.keys()):
            lines += self.known.change(key, old.get(key, []), new.get(key, []))
        return [*lines, *_counted(self.removed | self.added)]


@dataclass(frozen=True, slots=True)
class _Known:
    """Types of joints, what opens and closes where before and after, and subjects that only one side has."""

    types: dict[Iri, str]
    before: "_Thresholds"
    after: "_Thresholds"
    moves: dict[Iri, str]
    gone: frozenset[Iri]
    come: frozenset[Iri]

    def change(self, key: tuple[Iri, Iri], old: list[Node], new: list[Node]) -> Iterator[str]:
        """Sentences on one property of one subject that both sides have; none if only its graph differs."""
        subject, predicate = key
        what = local_name(predicate)
        if sorted(map(_meant, old)) == sorted(map(_meant, new)):
            return
        was, now = _apart(old, new)
        if predicate == POSITION and len(old) == len(new) == 1:
            yield f"{local_name(subject)} moved from {was} to {now}{self._turned(subject, old[0], new[0])}"
        elif old and new:
            yield f"{_owner(subject)}: {what} {was} → {now}"
        elif new:
            yield f"{_owner(subject)}: {what} {now} added"
        else:
            yield f"{_owner(subject)}: {what} {was} removed"

    def _turned(self, joint: Iri, old: Node, new: Node) -> str:
        """The unit of a joint's positions, and what was open or closed and is no more."""
        unit = _UNITS.get(self.types.get(joint, ""), "")
        was, now = self.before.word(joint, value_of(old)), self.after.word(joint, value_of(new))
        owner = self.moves.get(joint)
        return unit + (f": {owner} {was} → {now}" if owner and was != now else "")


@dataclass(frozen=True, slots=True)
class _Thresholds:
    """From where joints are open and up to where closed, on one side."""

    open_from: dict[Iri, float]
    closed_to: dict[Iri, float]

    def word(self, joint: Iri, at: object) -> str:
        if isinstance(at, float) and at in Interval(lower=self.open_from.get(joint, float("inf"))):
            return "open"
        if isinstance(at, float) and at in Interval(upper=self.closed_to.get(joint, float("-inf"))):
            return "closed"
        return "half open"


def difference(before: Iterable[ox.Quad], after: Iterable[ox.Quad]) -> Difference:
    """What makes the second set of quads of the first one.

    Raises:
        GraphError: A blank node: nobody can tell which of the other side's it is.
    """
    first, second = _named(before), _named(after)
    return Difference(first - second, second - first, _known(first, second))


def twin_difference(before: Twin, after: Twin) -> Difference:
    """How two twins differ, entities and state."""
    return difference(quads_of_twin(before), quads_of_twin(after))


def quads_of_twin(twin: Twin) -> Iterable[ox.Quad]:
    """The twin's named graphs, as `serialize` writes them."""
    return twin.entities.store.dump(twin.graphs())


def _named(quads: Iterable[ox.Quad]) -> frozenset[ox.Quad]:
    found = frozenset(quads)
    for quad in found:
        if any(isinstance(node, ox.BlankNode) for node in (quad.subject, quad.object, quad.graph_name)):
            raise GraphError(f"a blank node cannot be compared: {quad}", remedy="name it by an IRI")
    return found


def _known(first: frozenset[ox.Quad], second: frozenset[ox.Quad]) -> _Known:
    types: dict[Iri, str] = {}
    moves: dict[Iri, str] = {}
    for quad in (*first, *second):
        subject, value = _text(quad.subject), value_of(quad.object)
        if quad.predicate.value == SDT + "hasJoint":
            moves[str(value)] = local_name(subject)
        elif quad.predicate == TYPE and local_name(str(value)) in _UNITS:
            types[subject] = local_name(str(value))
    before, after = ({_text(quad.subject) for quad in side} for side in (first, second))
    gone, come = frozenset(before - after), frozenset(after - before)
    return _Known(types, _thresholds(first), _thresholds(second), moves, gone, come)


def _thresholds(quads: Iterable[ox.Quad]) -> _Thresholds:
    found: dict[str, dict[Iri, float]] = {"openFrom": {}, "closedTo": {}}
    for quad in quads:
        value, numbers = value_of(quad.object), found.get(quad.predicate.value.removeprefix(SDT))
        if numbers is not None and isinstance(value, float):
            numbers[_text(quad.subject)] = value
    return _Thresholds(found["openFrom"], found["closedTo"])


def _text(term: object) -> str:
    return term.value if isinstance(term, ox.NamedNode) else str(term)


def _told(quads: Iterable[ox.Quad]) -> list[ox.Quad]:
    """Those that are of the world: not inferred by a rule, and no record of how a branch was made."""
    return [quad for quad in quads if not _text(quad.graph_name).startswith(tuple(_COUNTED))]


def _counted(quads: Iterable[ox.Quad]) -> Iterator[str]:
    """How many of the others there are, of each kind."""
    graphs = [_text(quad.graph_name) for quad in quads]
    for begins, kind in _COUNTED.items():
        count = sum(graph.startswith(begins) for graph in graphs)
        if count:
            yield f"and {count} {kind.format('triple differs' if count == 1 else 'triples differ')}"


def _wholes(subjects: set[Iri], quads: list[ox.Quad]) -> list[str]:
    """One text for each subject that only one side has, its parts counted with it."""
    told = {_text(quad.subject) for quad in quads} & subjects
    heads: dict[Iri, int] = {}
    for quad in quads:
        subject = _text(quad.subject)
        if subject in subjects:
            head = _head(subject, told)
            heads[head] = heads.get(head, 0) + 1
    kinds: dict[Iri, set[str]] = {}
    for quad in quads:
        if quad.predicate == TYPE and _text(quad.subject) in heads:
            kinds.setdefault(_text(quad.subject), set()).add(local_name(_text(quad.object)))
    return [
        f"{local_name(head)} ({', '.join(sorted(kinds.get(head, set()))) or 'no type'}, {count} triples)"
        for head, count in sorted(heads.items())
    ]


def _head(subject: Iri, told: set[Iri]) -> Iri:
    """The largest whole that the subject is part of: its model, else its body or joint."""
    model = "/".join(subject.split("/")[:5])
    if subject.startswith(ID) and model in told:
        return model
    head = _whole(subject)
    return head if head in told else subject


def _whole(iri: Iri) -> Iri:
    """What a pose, shape, inertia, note or event is part of; else itself."""
    return min((iri.partition(part)[0] for part in _PARTS), key=len)


def _values(quads: list[ox.Quad], wholes: set[Iri]) -> dict[tuple[Iri, Iri], list[Node]]:
    """Subject and property → values, of what both sides have."""
    found: dict[tuple[Iri, Iri], list[Node]] = {}
    for quad in quads:
        subject = _text(quad.subject)
        if subject not in wholes:
            found.setdefault((subject, quad.predicate.value), []).append(quad.object)
    return found


def _owner(subject: Iri) -> str:
    """Name of the subject; of a part, with the name of what it is part of."""
    whole = _whole(subject)
    part = subject.removeprefix(whole).strip("/").replace("/", " ")
    return f"{local_name(whole)} {part}".strip()


def _meant(node: Node) -> str:
    """What a term says, however its number is spelled: of one datatype 0 and 0.0 are the same."""
    if isinstance(node, ox.Literal):
        return f"{value_of(node)!r} {node.datatype.value} {node.language}"
    return str(node)


def _apart(old: list[Node], new: list[Node]) -> tuple[str, str]:
    """Both as people write them; where that is the same text, with more digits, or as triples have them."""
    for digits in range(_SHORT, DIGITS + 1):
        told = _list(old, digits), _list(new, digits)
        if told[0] != told[1]:
            return told
    return ", ".join(sorted(map(str, old))), ", ".join(sorted(map(str, new)))


def _list(nodes: list[Node], digits: int) -> str:
    values = map(value_of, nodes)
    texts = (f"{each:.{digits}g}" if isinstance(each, float) else local_name(str(each)) for each in values)
    return ", ".join(sorted(texts))
