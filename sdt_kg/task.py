"""Task (Π): what is requested."""

from dataclasses import dataclass
from enum import Enum

from sdt_kg.iri import Iri, local_name


class Unknown(Enum):
    """The value of a field that is to be solved for."""

    UNKNOWN = "unknown"


UNKNOWN = Unknown.UNKNOWN


class Verb(Enum):
    """Task types of D_artic."""

    OPEN = "open"
    CLOSE = "close"


@dataclass(frozen=True, slots=True)
class Task:
    """Π: a verb and the container it is about; `UNKNOWN` is the paper's *open()*."""

    verb: Verb
    container: Iri | Unknown = UNKNOWN

    def __str__(self) -> str:
        """As people type it: `open`, `open:CONTAINER`."""
        verb = self.verb.value
        return verb if self.container is UNKNOWN else f"{verb}:{local_name(self.container)}"
