"""Oracles on the bus, asked: work is shared among them, and who gives no answer leaves it to another."""

import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any, TypeVar

import zenoh

from sdt_kg.errors import InputError
from sdt_kg.twin import Twin
from services import versions
from services.bus import keys
from services.bus.asking import Header, present, problem_in
from services.bus.keys import Oracle
from services.bus.oracles.bound import UnfitReplyError
from services.bus.oracles.codec import Plain, twin_key
from services.bus.oracles.handler import UNKNOWN_TWIN
from services.judging.codec import CBOR, encode, from_cbor, to_cbor
from services.judging.problems import BusUnavailableError, ConflictError, ProblemType, error_of, problem
from services.relative import TeeName

T = TypeVar("T")

_LATE = problem(ProblemType.UNAVAILABLE, "the oracle gave no answer in time")
QUICK = 60.0
"""[s] For everything but a search; the first question builds models."""


@dataclass(slots=True, eq=False)
class Callers:
    """The oracles of one kind that are there, work shared among them.

    Attributes:
        session: Connected to the bus.
        tee: The class D that is asked about.
        asked: How often each instance that is there was asked.
    """

    session: zenoh.Session
    kind: Oracle
    tee: TeeName = "d_artic"
    asked: Counter[str] = field(default_factory=Counter[str])

    def instances(self) -> list[str]:
        """Who is there now."""
        return present(self.session, keys.any_oracle(self.kind))

    def call(
        self,
        verb: str,
        twin: Twin | None,
        read: Callable[[Any], T],
        seconds: float = QUICK,
        **given: Any,  # noqa: ANN401 - what CBOR carries
    ) -> T:
        """The answer of whichever oracle was asked least.

        If that dies, has another version, or replies what is no answer to this question, of another.

        Args:
            verb: What is asked.
            twin: About which; None: about the oracle.
            read: What is answered, of what CBOR carries; an error where that is no answer.
            seconds: After which nobody waits any more.
            given: Fields of the question.

        Raises:
            BusUnavailableError: No oracle is there, or none of those that were there has answered.
            BusError, InputError: What the oracle says.
        """
        silent: dict[str, str] = {}
        while True:
            there = [each for each in self.instances() if each not in silent]
            if not there:
                why = "; ".join(silent.values()) or f"sdt oracle {self.kind.value} --connect … starts one"
                said = f"no oracle for {self.kind.value} answers on the bus; {why}"
                raise BusUnavailableError(problem(ProblemType.UNAVAILABLE, said))
            instance = self._least_asked(there)
            try:
                return _read(self._answer(instance, verb, twin, seconds, given), read)
            except (BusUnavailableError, ConflictError) as error:
                silent[instance] = error.problem.detail
            except UnfitReplyError as error:
                silent[instance] = f"what {instance} replies is no answer to {verb}: {error}"

    def _least_asked(self, there: list[str]) -> str:
        """Whose turn it is; one that has just come has been asked as often as who was asked least."""
        least = min((self.asked[each] for each in there if each in self.asked), default=0)
        self.asked = Counter({each: self.asked.get(each, least) for each in there})
        instance = min(there, key=lambda each: self.asked[each])
        self.asked[instance] += 1
        return instance

    def _answer(self, instance: str, verb: str, twin: Twin | None, seconds: float, given: Plain) -> bytes:
        """The answer of one oracle, which is sent the twin if it does not hold it."""
        about = {} if twin is None else {"twin": _twin_plain(twin)}
        try:
            return self._once(instance, verb, seconds, given | about)
        except ConflictError as error:
            if twin is None or error.problem.detail != UNKNOWN_TWIN:
                raise
        return self._once(instance, verb, seconds, given | {"twin": _twin_plain(twin, whole=True)})

    def _once(self, instance: str, verb: str, seconds: float, plain: Plain) -> bytes:
        began = time.monotonic()
        header = Header(deadline_ms=int(seconds * 1000))
        # In the verb, not in the payload: an oracle that does not know the class has to refuse.
        asked = verb if self.tee == "d_artic" else f"{verb};{self.tee}"
        replies = self.session.get(
            f"{keys.oracle(self.kind, instance)}?{asked}",
            payload=to_cbor(plain),
            encoding=CBOR,
            attachment=encode(header),
            timeout=seconds + 1.0,
            consolidation=zenoh.ConsolidationMode.NONE,
        )
        for reply in replies:
            if reply.ok is not None:
                return reply.ok.payload.to_bytes()
            if reply.err is not None:
                raise error_of(problem_in(reply.err) or _LATE)
        waited = time.monotonic() - began
        said = f"{self.kind.value} oracle {instance} gave no answer within {waited:.1f} s"
        raise BusUnavailableError(problem(ProblemType.UNAVAILABLE, said))


@dataclass(slots=True, eq=False)
class Pinned:
    """Calls to oracles of the version that was told last, which is what verdicts name.

    Attributes:
        policy: What goes with every call, beside the version.
        told: That version; empty before any was.
    """

    callers: Callers
    policy: Plain = field(default_factory=dict[str, Any])
    told: str = ""

    def version(self) -> str:
        """The oracle's own, as it is now: this installation's, where an oracle of that is there."""
        ours = partial(_version, own=_own(self.callers.kind, self.callers.tee))
        try:
            self.told = self.callers.call("version", None, ours, **self.policy)
        except BusUnavailableError:
            self.told = self.callers.call("version", None, _version, **self.policy)
        return self.told

    def call(
        self,
        verb: str,
        twin: Twin,
        read: Callable[[Any], T],
        seconds: float = QUICK,
        **given: Any,  # noqa: ANN401 - what CBOR carries
    ) -> T:
        """The answer of an oracle of that version; raises as `Callers.call`."""
        version = self.told or self.version()
        return self.callers.call(verb, twin, read, seconds, version=version, **self.policy, **given)


def _read(content: bytes, read: Callable[[Any], T]) -> T:
    """What an oracle answered.

    Raises:
        UnfitReplyError: It is no answer.
    """
    try:
        return read(from_cbor(content))
    except InputError as error:
        raise UnfitReplyError(str(error)) from None


def _version(said: object, own: str = "") -> str:
    """The version that was told; only our own will do, where that is given."""
    if not isinstance(said, str) or not said or own not in {"", said}:
        raise UnfitReplyError("it is no version" if not own else f"it is not '{own}'")
    return said


def _own(kind: Oracle, tee: TeeName) -> str:
    """Version of the oracle of this installation."""
    if kind is Oracle.CAUSES:
        return versions.kinematics() if tee == "d_artic" else versions.dynamics()
    return versions.whole_body() if tee == "d_artic" else versions.bearing(versions.whole_body())


def _twin_plain(twin: Twin, *, whole: bool = False) -> Plain:
    """Which twin is meant, in which state; whole: with its graphs."""
    plain: Plain = {"key": twin_key(twin), "state": dict(twin.state)}
    if whole:
        plain |= {
            "quads": twin.serialize("nquads"),
            "environment": twin.environment,
            "robots": list(twin.robots),
        }
    return plain
