"""Where a computation finds verdicts, and what it wants to be kept."""

from collections.abc import Callable

from predicates.record import Record, StoredVerdict
from sdt_kg.iri import Iri
from sdt_kg.twin import Twin
from services.judging.answers import n_quads
from services.judging.loaded import Models, check_same


class Keeper:
    """Where a computation finds verdicts, and what it wants to be kept.

    Attributes:
        records: IRI and N-Quads of each new verdict.
    """

    def __init__(self, recall: Callable[[Iri], StoredVerdict | None], served: Models) -> None:
        self._recall, self._served = recall, served
        self.records: list[tuple[Iri, bytes]] = []

    def stored(self, verdict: Iri) -> StoredVerdict | None:
        """What the server holds of the verdict."""
        return self._recall(verdict)

    def add_twin(self, twin: Twin) -> None:
        """The server has its twins already, if they are these."""
        check_same([twin], self._served)

    def add_record(self, record: Record) -> None:
        """To be kept when the computation is done."""
        self.records.append((record.verdict, n_quads(record)))
