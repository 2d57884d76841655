"""What has happened, in order: numbered, published, and told again after a sequence number."""

import json
import logging
import queue
import threading
import uuid
from bisect import bisect_right
from collections import deque
from collections.abc import Callable, Iterable
from typing import Final
from urllib.parse import quote

import pyoxigraph as ox
import zenoh

from predicates.record import read_verdict
from sdt_kg.errors import SdtError
from sdt_kg.iri import DCTERMS, ID, Iri, graph_iri, local_name
from services.bus import keys
from services.bus.question import Question
from services.http.kitchens import Kitchen
from services.http.memory import Memory
from services.judging.codec import JSON, encode
from services.judging.messages import HistoryRequest
from services.judging.replies import EventTold, HistoryReply
from services.judging.workers.jobs import Done, Kept
from services.store.quads import QuadStore
from services.store.records import graph_of

KEPT: Final = 10_000
"""Events of a kind that can be told again; older ones are a gap."""
KINDS: Final = ("verdict", "state")

_IS: Final = ox.NamedNode(DCTERMS + "identifier")
_ABOUT: Final = ox.NamedNode(DCTERMS + "references")
_log = logging.getLogger(__name__)


class Log:
    """Events of one kind about one twin; in a store they outlive the server.

    Attributes:
        epoch: Of the numbering: another one means that numbers have begun anew.
    """

    def __init__(self, twin: str, kind: str, archive: QuadStore | None) -> None:
        self._stem = f"{ID}announced/{quote(twin, safe='')}/{kind}"
        self._graph, self._archive = ox.NamedNode(graph_iri("announced", f"{twin}/{kind}")), archive
        self._events: deque[tuple[int, Iri]] = deque(maxlen=KEPT)
        self.epoch = ""
        for quad in [] if archive is None else archive.graph(self._graph.value):
            self._read(quad)
        self._events = deque(sorted(self._events), maxlen=KEPT)
        if not self.epoch:
            self.epoch = uuid.uuid4().hex
            self._write(self._stem, _IS, ox.Literal(self.epoch))

    @property
    def last(self) -> int:
        """Number of the newest event; 0 before the first."""
        return self._events[-1][0] if self._events else 0

    def append(self, graph: Iri) -> int:
        """The number of one more event, whose triples are in that graph; kept before it is told."""
        number = self.last + 1
        self._write(f"{self._stem}/{number:012d}", _ABOUT, ox.NamedNode(graph))
        self._events.append((number, graph))
        return number

    def after(self, request: HistoryRequest) -> tuple[HistoryReply, list[tuple[int, Iri]]]:
        """What to tell: the reply without its events, and these as number and graph."""
        restarted = bool(request.epoch and request.epoch != self.epoch) or request.after > self.last
        after = 0 if restarted else request.after
        numbers = [number for number, _ in self._events]
        begin = bisect_right(numbers, after)
        told = list(self._events)[begin : begin + request.limit]
        first = numbers[0] if numbers else 0
        reply = HistoryReply(
            epoch=self.epoch,
            first=first,
            last=self.last,
            gap=(after + 1, first - 1) if after + 1 < first else None,
            restarted=restarted,
            more=begin + len(told) < len(numbers),
        )
        return reply, told

    def _read(self, quad: ox.Quad) -> None:
        if quad.predicate == _IS and isinstance(quad.object, ox.Literal):
            self.epoch = quad.object.value
        elif isinstance(quad.subject, ox.NamedNode) and isinstance(quad.object, ox.NamedNode):
            self._events.append((int(quad.subject.value.rpartition("/")[2]), quad.object.value))

    def _write(self, subject: Iri, predicate: ox.NamedNode, value: ox.NamedNode | ox.Literal) -> None:
        if self._archive is not None:
            self._archive.add([ox.Quad(ox.NamedNode(subject), predicate, value, self._graph)])


class Herald:
    """A thread that numbers, keeps and publishes what happens, and tells it again.

    Args:
        session: On which it is published, with who tells it and the epoch of its number attached.
        instance: Name of the server: another one numbers for itself.
        memory: The world in which it happens.
        twins: Names of those that are served.
    """

    def __init__(self, session: zenoh.Session, instance: str, memory: Memory, twins: Iterable[str]) -> None:
        self._session, self._instance, self._memory = session, instance, memory
        archive = memory.world.archive
        self._logs = {(twin, kind): Log(twin, kind, archive) for twin in twins for kind in KINDS}
        self._doing: queue.Queue[Callable[[], None] | None] = queue.Queue()
        self._thread = threading.Thread(target=self._run, name="herald", daemon=True)
        self._thread.start()
        memory.listen(lambda kept: self._doing.put(lambda: self._judged(kept)))
        memory.world.movers.append(lambda kitchen: self._doing.put(lambda: self._moved(kitchen)))

    def tell(self, question: Question, request: HistoryRequest) -> None:
        """Answer the question, soon."""
        self._doing.put(lambda: question.answer(self._told(question.twin, request)))

    def close(self) -> None:
        """What has happened until now is published and kept; nothing more is."""
        self._doing.put(None)
        self._thread.join()

    def _run(self) -> None:
        while (act := self._doing.get()) is not None:
            try:
                act()
            except (SdtError, zenoh.ZError):  # a store or network that is gone; others go on
                _log.exception("an event could not be kept, published or told")

    def _judged(self, kept: Kept) -> None:
        iri, quads = kept
        stored = read_verdict(ox.parse(quads, format=ox.RdfFormat.N_QUADS), iri)
        self._happened(local_name(stored.environment), "verdict", graph_of(iri), quads)

    def _moved(self, kitchen: Kitchen) -> None:
        graph = kitchen.state_graph
        self._happened(kitchen.name, "state", graph, self._memory.quads(graph))

    def _happened(self, twin: str, kind: str, graph: Iri, quads: bytes) -> None:
        log = self._logs.get((twin, kind))
        if log is not None:
            key = keys.event(twin, kind, log.append(graph))
            teller = json.dumps({"instance": self._instance, "epoch": log.epoch})
            self._session.put(key, quads, encoding="application/n-quads", attachment=teller)

    def _told(self, twin: str, request: HistoryRequest) -> Done:
        reply, events = self._logs[twin, request.kind].after(request)
        told = [
            EventTold(
                sequence=number,
                key=keys.event(twin, request.kind, number),
                quads=self._memory.quads(graph).decode(),
            )
            for number, graph in events
        ]
        return Done(encode(reply.model_copy(update={"events": told})), JSON)
