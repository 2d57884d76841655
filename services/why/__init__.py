"""What is stored, in plain words: a verdict, or the result of a task specification."""

from collections.abc import Iterable, Sequence

import pyoxigraph as ox

from predicates.record.facts import Facts
from predicates.record.stored import read_verdict, verdicts_of
from predicates.specification.results.stored import read_result, results_of
from sdt_kg.errors import UnknownEntityError
from sdt_kg.iri import Iri, local_name, task_result_iri, verdict_iri
from services.store.records import graph_of, is_result
from services.why import task
from services.why import verdict as of_verdict
from services.why.verdict import PREDICATES, means, nothing_kept, options, outcome, question
from services.why.words import SHORT_KEY, STORE, Section, used

REMEDY = (
    "'sdt why FILE' lists those of a file; verdicts about edited worlds are not kept: "
    "'sdt whatif' with the edit asks again, and tells why"
)

__all__ = [
    "PREDICATES",
    "SHORT_KEY",
    "Section",
    "beginnings",
    "means",
    "named",
    "nothing_kept",
    "options",
    "outcome",
    "question",
    "results_of",
    "sections",
    "task",
    "text",
    "used",
    "verdicts_of",
    "why",
]


def why(source: ox.Store | Iterable[ox.Quad], iri: Iri, place: str = STORE) -> str:
    """The verdict, or the result of a task specification, in plain words.

    Args:
        source: A store that holds it, or the quads of its named graph.
        iri: Of the verdict or result, or the beginning of its hash.
        place: The store as a shell knows it, for the commands that check again.

    Raises:
        UnknownEntityError: No such verdict, or several whose hash begins like this.
        InputError: Its record is damaged.
    """
    return text(sections(source, iri, place))


def text(story: Iterable[Section]) -> str:
    """The parts one below the other."""
    return "\n\n".join("\n".join((each.title, *each.lines)) for each in story)


def sections(
    source: ox.Store | Iterable[ox.Quad], iri: Iri, place: str = STORE, edits: Sequence[str] = ()
) -> tuple[Section, ...]:
    """The same part by part.

    Args:
        source: Where it is.
        iri: Of the verdict or result, or the beginning of its hash.
        place: The store, as one who checks it again names it.
        edits: By which the world that it is about had become another one, as `sdt whatif` takes them.
    """
    store = source if isinstance(source, ox.Store) else _store_of(source)
    full = named(store, iri)
    quads = list(store.quads_for_pattern(None, None, None, ox.NamedNode(graph_of(full))))
    facts = Facts(quads)
    if is_result(full):
        read_result(quads, full)  # of one that was changed nothing is told
        return task.sections(full, facts, place)
    return of_verdict.sections(read_verdict(quads, full), facts, place, edits)


def _store_of(quads: Iterable[ox.Quad]) -> ox.Store:
    store = ox.Store()
    store.extend(quads)
    return store


def named(store: ox.Store, iri: Iri) -> Iri:
    """The verdict or result of this IRI, or whose hash begins like this.

    Raises:
        UnknownEntityError: There is none, or there are several.
    """
    return named_among([*verdicts_of(store), *results_of(store)], iri)


def named_among(known: Sequence[Iri], iri: Iri) -> Iri:
    """That of the verdicts and results which has this IRI, or whose hash begins like this.

    Raises:
        UnknownEntityError: There is none, or there are several.
    """
    starts = beginnings(iri)
    found = [each for each in known if each.startswith(starts)] if starts else []
    if iri in found or len(found) == 1:
        return iri if iri in found else found[0]
    near = [local_name(each)[:SHORT_KEY] for each in (found or known)]
    raise UnknownEntityError("verdict", iri, near, REMEDY)


def beginnings(iri: Iri) -> tuple[Iri, ...]:
    """What the IRI of a verdict or result begins with that is named so: by its own, or by its hash.

    Args:
        iri: As people type it: whole, shortened at its end, `id:verdict/…`, or a hash alone.

    Returns:
        None where nothing of a hash is named.
    """
    stems = (verdict_iri(""), task_result_iri(""))
    key = iri.removeprefix("id:verdict/").removeprefix("id:task_result/")
    starts = [iri] if iri.startswith(stems) else [stem + key for stem in stems]
    return tuple(each for each in starts if each not in stems)
