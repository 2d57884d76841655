"""Cases that pages have asked for: judged one after the other, beside the pages that show how far it is."""

import asyncio
import logging
from dataclasses import dataclass, field
from typing import Final

from fastapi import FastAPI

from sdt_kg.errors import SdtError
from services.app import DEFAULT_BUDGET
from services.http.api.models import AchieveBody
from services.http.api.write import GRACE, judged
from services.http.pages.kinds import Standing
from services.store.workers import BusyError

MOST: Final = 1000
"""Cases that may wait, and refusals that are remembered."""

_log = logging.getLogger("sdt.http")


@dataclass(frozen=True, slots=True)
class Wish:
    """One case to be judged.

    Attributes:
        kitchen: Name.
        robot: Name.
        task: As people type it.
        states: Texts of the whole state, so that what is judged is what was shown.
        drive: None takes the robot's own.
        friction: Coefficient with which fingers rub on handles [1]; None: the verdict says what is needed.
    """

    kitchen: str
    robot: str
    task: str
    states: tuple[str, ...]
    drive: str | None
    friction: float | None = None

    def body(self) -> AchieveBody:
        """As the verb under /api/v1 takes it."""
        return AchieveBody.model_validate(
            {
                "kitchen": self.kitchen,
                "robot": self.robot,
                "task": self.task,
                "state": list(self.states),
                "drive": self.drive,
                "friction": self.friction,
                "budget": DEFAULT_BUDGET,
                "seconds": DEFAULT_BUDGET + GRACE,
            }
        )


@dataclass(eq=False)
class Asking:
    """What is asked for, being judged, or was refused.

    Attributes:
        app: Whose world and judges are meant.
    """

    app: FastAPI
    _waiting: dict[Wish, None] = field(default_factory=dict[Wish, None])
    _now: Wish | None = None
    _refused: dict[Wish, str] = field(default_factory=dict[Wish, str])
    _work: "asyncio.Task[None] | None" = None

    def ask(self, wishes: list[Wish]) -> None:
        """They will be judged, unless they are already about to be.

        Raises:
            BusyError: Too many are waiting; none of these was added.
        """
        fresh = [each for each in wishes if each not in self._waiting and each != self._now]
        if len(self._waiting) + len(fresh) > MOST:
            raise BusyError(f"{len(self._waiting)} cases are waiting already: ask again later")
        for each in fresh:
            self._waiting[each] = None
            self._refused.pop(each, None)
        if self._waiting and (self._work is None or self._work.done()):
            self._work = asyncio.create_task(self._judge())

    def as_it_is(self) -> "Asking":
        """A copy that stays: taken before verdicts are read, it loses no case that ends in between."""
        return Asking(self.app, dict(self._waiting), self._now, dict(self._refused))

    def standing(self, wish: Wish) -> Standing:
        """How far a case is that has no verdict."""
        if wish == self._now:
            return Standing.BEING_JUDGED
        if wish in self._waiting:
            return Standing.WAITING
        return Standing.NO_VERDICT if wish in self._refused else Standing.NOT_JUDGED

    def refusal(self, wish: Wish) -> str | None:
        """Why there is no verdict though it was asked for, in the words of the shell."""
        return self._refused.get(wish)

    async def over(self, wish: Wish, seconds: float) -> bool:
        """Whether it is over after so many seconds; what goes on goes on."""
        end = asyncio.get_running_loop().time() + seconds
        while self.standing(wish) in {Standing.WAITING, Standing.BEING_JUDGED}:
            if asyncio.get_running_loop().time() >= end:
                return False
            await asyncio.sleep(0.05)
        return True

    async def close(self) -> None:
        """Nothing is judged any more."""
        if self._work is not None:
            self._work.cancel()
            await asyncio.wait([self._work])

    async def _judge(self) -> None:
        """One case after the other, until none waits."""
        while self._waiting:
            self._now = next(iter(self._waiting))
            del self._waiting[self._now]
            try:
                await judged(self.app, self._now.body())
            except SdtError as error:
                self._refuse(self._now, str(error))
            except Exception:  # noqa: BLE001 - the edge of a service: logged, and told on the page
                _log.exception("a case that a page asked for could not be judged")
                self._refuse(self._now, "the case could not be judged; the service's log says why")
            finally:
                self._now = None

    def _refuse(self, wish: Wish, why: str) -> None:
        while len(self._refused) >= MOST:
            del self._refused[next(iter(self._refused))]
        self._refused[wish] = why
