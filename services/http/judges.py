"""Processes that judge, as the event loop asks them."""

import asyncio
import time
from typing import TypeVar

from pydantic_core import PydanticSerializationError

from sdt_kg.errors import OracleUnavailableError, SdtError
from services.http.problems import RefusedError
from services.http.world import World
from services.judging.codec import JSON, decode, encode
from services.judging.judge import Setup
from services.judging.loaded import models_of
from services.judging.messages import Message, Verb
from services.judging.problems import Problem, ProblemType, error_of
from services.judging.replies import Reply
from services.judging.workers.jobs import Done, Task, Waiter
from services.judging.workers.pool import Pool
from services.store.workers import BusyError
from services.telemetry.origin import current

R = TypeVar("R", bound=Reply)


def setup_of(world: World) -> Setup:
    """What the processes load that judge about this world."""
    kitchens = tuple(world.kitchens.values())
    served = models_of(each.twin for each in kitchens)
    return Setup(tuple(each.source for each in kitchens), kitchens[0].robots if kitchens else (), served)


def question(verb: Verb, twin: str, request: Message, seconds: float, states: tuple[str, ...] = ()) -> Task:
    """What a process is asked.

    Args:
        verb: What is asked.
        twin: Name of the kitchen; empty for a verb about all.
        request: Of the verb.
        seconds: After which nobody waits, and the process is stopped.
        states: The kitchen's present state as texts.

    Raises:
        RefusedError: A text in it is half of a surrogate pair, in a motion say.
    """
    try:
        payload = encode(request)
    except PydanticSerializationError as error:
        raise RefusedError(422, f"body: {error}", allowed="text that can be written as UTF-8") from None
    return Task(twin, verb.value, payload, JSON, seconds, states, current())


class Judges:
    """A pool that is asked from an event loop.

    Attributes:
        pool: Shared with whoever else asks, the bus say.
    """

    def __init__(self, pool: Pool) -> None:
        self.pool = pool

    async def warm(self) -> None:
        """One process is there."""
        await asyncio.to_thread(self.pool.warm, 1)

    async def close(self) -> None:
        """No process is left."""
        await asyncio.to_thread(self.pool.close)

    async def ask(self, task: Task, kind: type[R]) -> R:
        """The reply of that kind; new verdicts are kept by then.

        Raises:
            InputError: The question is wrong.
            RefusedError: There was no answer in time: nothing is kept.
            BusyError: Too many cases are waiting.
            OracleUnavailableError: There is no process or oracle that could judge.
            InternalError: The process died twice, or failed.
        """
        done = await self.answer(task)
        return decode(kind, done.payload, done.encoding)

    async def answer(self, task: Task) -> Done:
        """What came of a task; raises as `ask`."""
        loop = asyncio.get_running_loop()
        future: asyncio.Future[Done | Problem] = loop.create_future()

        def answered(outcome: Done | Problem) -> None:
            loop.call_soon_threadsafe(_settle, future, outcome)

        job = self.pool.submit(task, Waiter(time.monotonic() + task.seconds, answered))
        try:
            outcome = await future
        except asyncio.CancelledError:
            job.cancelled.set()
            raise
        if isinstance(outcome, Problem):
            raise _error(outcome, task.seconds)
        return outcome


def _settle(future: "asyncio.Future[Done | Problem]", outcome: Done | Problem) -> None:
    if not future.done():
        future.set_result(outcome)


def _error(said: Problem, seconds: float) -> SdtError:
    if said.kind is ProblemType.DEADLINE:
        return RefusedError(
            504,
            f"there is no verdict after {seconds:g} s",
            allowed="600 s",
            remedy="ask with more 'seconds', about one container, or with a smaller 'budget'",
        )
    if said.kind in {ProblemType.INVALID_REQUEST, ProblemType.INTERNAL}:
        return error_of(said)
    if said.retry_after:
        return BusyError(f"{said.detail}: ask again later")
    return OracleUnavailableError(said.detail)
