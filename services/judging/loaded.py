"""A service and the processes that judge for it have read the same models, though not at the same time."""

from collections.abc import Iterable

from sdt_kg.errors import OracleUnavailableError
from sdt_kg.iri import Iri, local_name
from sdt_kg.twin import Twin

Models = frozenset[tuple[Iri, str]]
"""IRI and content hash of each kitchen and robot."""


def models_of(twins: Iterable[Twin]) -> Models:
    """What the twins are made of, whatever their states."""
    return frozenset(
        (model, twin.content_hash(model)) for twin in twins for model in (twin.environment, *twin.robots)
    )


class OtherModelsError(OracleUnavailableError):
    """What a process has read is not what is served: no answer of it counts, and another has to read anew."""


def check_same(twins: Iterable[Twin], served: Models) -> None:
    """The twins are made of what is served.

    Raises:
        OtherModelsError: Files have changed since then: a verdict would be about other models.
    """
    other = sorted(local_name(model) for model, _ in models_of(twins) - served)
    if other:
        names = ", ".join(other)
        raise OtherModelsError(
            f"the files of {names} have changed since this service began: start it again, or put them back"
        )
