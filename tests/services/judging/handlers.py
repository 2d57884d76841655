"""Small handlers for workers: they sleep, die, fail or echo, as the payload says."""

import os
import signal
import time
from collections.abc import Callable
from pathlib import Path

from services.judging.loaded import OtherModelsError
from services.judging.problems import Problem
from services.judging.workers.jobs import Done, Task


class Obedient:
    """Does what the payload says."""

    def __init__(self) -> None:
        self.hoard = list[bytes]()

    def __call__(self, task: Task, recall: Callable[[str], bytes | None]) -> Done | Problem:
        word, _, rest = task.payload.decode().partition(" ")
        if word == "sleep":
            time.sleep(float(rest))
        if word == "die":
            os.kill(os.getpid(), signal.SIGKILL)
        if word == "die-once" and not Path(rest).exists():
            Path(rest).touch()
            os.kill(os.getpid(), signal.SIGKILL)
        if word == "count":
            with Path(rest).open("a") as log:
                log.write("x")
            time.sleep(0.3)
        if word == "hoard":
            self.hoard.append(b"x" * (int(rest) * 2**20))
        if word == "recall":
            return Done(recall(rest) or b"nothing", "text/plain")
        if word == "keep":
            return Done(b"kept", "text/plain", ((rest, b"<a:s> <a:p> <a:o> <a:g> .\n"),))
        return Done(f"{word} {rest}".encode(), "text/plain")


class Reader:
    """Tells its process, until it has read other files than are served."""

    def __call__(self, task: Task, recall: Callable[[str], bytes | None]) -> Done:
        if task.payload == b"changed":
            raise OtherModelsError("the files of b have changed")
        return Done(str(os.getpid()).encode(), "text/plain")


def obedient() -> Obedient:
    """Made in the worker's process."""
    return Obedient()


class Loading:
    """Makes a handler that is not ready before the tests are over."""

    def __call__(self) -> Obedient:
        time.sleep(300.0)
        return Obedient()


class Interrupted:
    """Makes a handler, in a process that Ctrl-C reaches before it has begun."""

    def __setstate__(self, state: object) -> None:
        os.kill(os.getpid(), signal.SIGINT)

    def __getstate__(self) -> dict[str, bool]:
        return {"is": True}  # what has no state is not told of it

    def __call__(self) -> Obedient:
        return Obedient()
