"""The process that holds the data and forks workers, which share its memory until they write.

It evaluates no query itself, has one thread, and ends when its channel is closed. Run as
`python -m services.store.workers.nursery DESCRIPTOR MEMORY_BYTES`.
"""

import array
import os
import select
import signal
import socket
import sys
import threading
from typing import NoReturn

import pyoxigraph as ox

from sdt_kg.errors import InputError, QueryError
from services.store.guard import guarded
from services.store.workers.confine import (
    confine,
    die_with_parent,
    leave_network,
    limit_memory,
    own_size,
    peak,
)
from services.store.workers.deltas import Delta, Held
from services.store.workers.errors import Limit, LimitError
from services.store.workers.evaluate import Asked, answer, error_head
from services.store.workers.frames import Head, packed, receive

STACK = 256 * 2**20
"""[bytes] Of the thread that evaluates; a deeply nested query takes much. Only what is used is memory."""
SPENT = 4
"""A worker that has once taken this part of its memory is replaced, since it may not give all of it back."""
LAST_WORDS = 4096
"""[bytes] Of what a worker wrote to standard error before it died."""


def main(descriptor: int, memory: int) -> None:
    """Serve the channel until it is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    die_with_parent()
    channel = socket.socket(fileno=descriptor)
    channel.sendall(packed({"namespace": leave_network()}))
    _warm()
    nursery = _Nursery(channel, memory)
    while True:
        try:
            head, body = receive(channel)
        except (EOFError, ConnectionError):
            return
        nursery.do(head, body)


def _warm() -> None:
    """Everything is imported that a worker will need, since it cannot open a file."""
    guarded(
        "PREFIX a: <a:> SELECT * FROM <a:a> { ?a a:b 'service' FILTER(?a > 1 && EXISTS { ?a ?b ?c }) }", bool
    )
    "a".encode("utf-16")
    list(ox.parse_query_results(b"?a\n", format=ox.QueryResultsFormat.TSV))  # pyright: ignore[reportArgumentType]


class _Nursery:
    def __init__(self, channel: socket.socket, memory: int) -> None:
        self._channel, self._memory, self._held = channel, memory, Held()
        self._last_words: dict[int, int] = {}

    def do(self, head: Head, body: bytes) -> None:
        """Fork a worker, end one, or change the data; then say so."""
        if head["do"] == "fork":
            self._fork()
        elif head["do"] == "end":
            self._channel.sendall(packed(self._end(head["pid"])))
        else:
            self._channel.sendall(packed(_applied(self._held, head, body)))

    def _fork(self) -> None:
        ours, theirs = socket.socketpair()
        words, errors = os.pipe()
        pid = os.fork()
        if pid == 0:
            _work(self._held, theirs, errors, self._memory)
        os.close(errors)
        theirs.close()
        self._last_words[pid] = words
        self._channel.sendall(packed({"pid": pid}))
        rights = array.array("i", [ours.fileno()])
        self._channel.sendmsg([b"+"], [(socket.SOL_SOCKET, socket.SCM_RIGHTS, rights)])
        ours.close()

    def _end(self, pid: int) -> Head:
        """A worker is gone, of itself or killed; with the signal and what it said last."""
        words = self._last_words.pop(pid)
        os.kill(pid, signal.SIGKILL)
        _, status = os.waitpid(pid, 0)
        text = (
            os.read(words, LAST_WORDS).decode(errors="replace")
            if select.select([words], [], [], 0)[0]
            else ""
        )
        os.close(words)
        return {"signal": os.WTERMSIG(status) if os.WIFSIGNALED(status) else 0, "said": text}


def _applied(held: Held, head: Head, body: bytes) -> Head:
    try:
        held.apply(Delta(head, body))
    except (SyntaxError, ValueError) as error:  # of RDF, of an IRI
        return {"error": str(error)}
    return {}


def _work(held: Held, channel: socket.socket, errors: int, memory: int) -> NoReturn:
    """Answer until the channel is closed.

    In a thread of its own, whose random numbers and stack are its own: those of a forked thread are
    the same in every worker.
    """
    die_with_parent()
    threading.stack_size(STACK)
    thread = threading.Thread(target=_loop, args=(held, channel, errors, memory))
    thread.start()
    thread.join()
    os._exit(1)


def _confined(channel: socket.socket, errors: int, memory: int) -> socket.socket:
    """The channel of a process that can do nothing but answer, with so much more memory [bytes].

    What the allocator sets aside for a thread is there before the limit is set.
    """
    sys.setrecursionlimit(20_000)
    held = Held()
    answer(held, Asked("query", "SELECT (STRUUID() AS ?a) { VALUES ?b { 1 2 3 } } ORDER BY ?b"))
    most = own_size() + memory
    confined = confine(channel, errors)
    limit_memory(most)
    return confined


def _loop(held: Held, outer: socket.socket, errors: int, memory: int) -> None:
    channel = _confined(outer, errors, memory)
    most = peak() + memory // SPENT
    while True:
        try:
            head, body = receive(channel)
        except (EOFError, ConnectionError):
            os._exit(0)
        if "text" not in head:
            held.apply(Delta(head, body))
            continue
        try:
            answered = answer(held, Asked.of(head))
            said = {"media": answered.media, "found": answered.found, "spent": peak() > most}
            channel.sendall(packed(said, answered.body))
        except InputError as error:
            channel.sendall(packed(error_head(error) | {"spent": peak() > most}))
        except ValueError as error:  # of an IRI
            channel.sendall(
                packed(error_head(QueryError(str(error), allowed="absolute IRIs")) | {"spent": False})
            )
        except MemoryError:
            channel.sendall(packed(error_head(LimitError(Limit.MEMORY, f"{memory} bytes")) | {"spent": True}))


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]))
