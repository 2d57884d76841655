"""Whether the models at hand are those that an artefact, and its verdict, are about."""

from collections.abc import Callable, Iterator

from predicates.record.stored import StoredVerdict
from predicates.scope import tee_class_of_hash
from sdt_kg.errors import InputError
from sdt_kg.iri import Iri, local_name
from sdt_kg.twin import Twin

Models = tuple[tuple[Iri, str], tuple[Iri, str]]
"""Environment, then robot: IRI and content hash."""

TwinOf = Callable[[Models], tuple[Twin, str]]
"""Models → a twin of these names in whatever state, and in words where it is from.

Where there is one of this content, it is that one.
"""


class OtherModelsError(InputError):
    """What is there is another model, or one of that name of another content: nothing can be checked with it.

    Attributes:
        found: Content hash of what is there; None where nothing of that name is.
    """

    def __init__(self, model: Iri, stated: str, found: str | None, source: str) -> None:
        self.model, self.stated, self.found = model, stated, found
        which = name = local_name(model)
        if found is not None:
            which = f"another {name}, of content hash {stated[:16]}…, not {found[:16]}…"
        super().__init__(
            f"it is about {which} ({source})",
            remedy="name the models that it is about with --kitchen and --robot",
        )


class OtherClassError(InputError):
    """A verdict is relative to a class that has other figures or shapes here: nothing can be said of it."""

    def __init__(self, stated: str, known: str) -> None:
        super().__init__(
            f"it is relative to {known} of another version, of content hash {stated[:16]}…",
            remedy="judge its case again",
        )


def check_class(stored: StoredVerdict) -> None:
    """The class D that a verdict is relative to is one of this version's.

    Raises:
        OtherClassError: It is not.
    """
    stated = dict(stored.inputs).get("tee_class", "")
    if tee_class_of_hash(stated) is None:
        raise OtherClassError(stated, local_name(stored.tee_class or "a class D"))


def at_hand(twin_of: TwinOf, models: Models, state: dict[Iri, float]) -> tuple[Twin, str]:
    """The twin of these models in this state, and where it is from.

    Raises:
        OtherModelsError: Other models are there, or one of that name of another content.
        InputError: The models cannot be had, or not in this state.
    """
    twin, source = twin_of(models)
    for model, stated in models:
        there = model in {twin.environment, *twin.robots}
        found = twin.content_hash(model) if there else None
        if found != stated:
            raise OtherModelsError(model, stated, found, source)
    return twin.at(state), source


def models_differ(stored: StoredVerdict, models: Models, whose: str) -> Iterator[str]:
    """Which models of a verdict's inputs are not, with their content, those of its artefact."""
    said = dict(stored.inputs)
    for name, model in zip(("environment", "robot"), models, strict=True):
        if said.get(name) != " ".join(model):
            yield f"the verdict's input '{name}' is {said.get(name)}, its {whose}'s {' '.join(model)}"
