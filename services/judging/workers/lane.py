"""One process that judges, and the thread that feeds it."""

import logging
import multiprocessing as mp
import queue
import resource
import select
import signal
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path

from sdt_kg.errors import SdtError
from services.judging.loaded import OtherModelsError
from services.judging.problems import Problem, ProblemType, problem, problem_of
from services.judging.workers.jobs import Counts, Done, Handler, Job, Keeper, Unfit, Wanted
from services.sweep.executors.process import end_with_parent
from services.telemetry import logs
from services.telemetry.origin import within
from services.telemetry.told import Telemetry

log = logging.getLogger(__name__)

GRACE = 1.0
"""[s] How long a worker may go on after its job's deadline before it is killed."""
START_TIME = 120.0
"""[s] How long a worker may take to load its kitchens."""
TICK = 0.02
"""[s] How often a lane looks whether a running job was cancelled or is late."""
PAUSE = 0.1
"""[s] How often a lane without a job looks whether it is to be warmed or to stop."""
MOST_MEMORY = 4 * 2**30
"""[bytes] A process that holds more when its job is done is replaced; its models take a tenth of that."""
TRIES = 2
"""A job whose worker dies is tried once more."""


class Lane(threading.Thread):
    """One worker process, started with the first job or when it is warmed, and the thread that feeds it.

    Attributes:
        warming: Set to have the process started before there is a job.
        ready: Set when the process has loaded everything, or could not.
    """

    def __init__(
        self,
        make_handler: Callable[[], Handler],
        jobs: "queue.Queue[Job]",
        memory: Keeper,
        counts: Counts,
        telemetry: Telemetry,
    ) -> None:
        super().__init__(name="lane", daemon=True)
        self._make_handler, self._jobs = make_handler, jobs
        self._memory, self._counts, self._telemetry = memory, counts, telemetry
        self._process: BaseProcess | None = None
        self._pipe: Connection | None = None
        self.warming, self.ready, self.stopping = threading.Event(), threading.Event(), threading.Event()

    @property
    def pid(self) -> int | None:
        """Process id of the worker."""
        return None if self._process is None else self._process.pid

    @property
    def resident(self) -> int:
        """Memory of the worker [bytes]; 0 without one, and on systems that have no /proc."""
        try:
            pages = int(Path(f"/proc/{self.pid}/statm").read_text().split()[1])
        except OSError:
            return 0
        return pages * resource.getpagesize()

    def run(self) -> None:
        """Feed the worker until told to stop."""
        # Ctrl-C reaches all processes of a terminal; what begins in this thread inherits that it is held.
        # The resource tracker is started before, as it would let interrupts pass again.
        resource_tracker.ensure_running()
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        while not self.stopping.is_set():
            job = self._next()
            if self._process is None and (job is not None or self.warming.is_set()):
                self._start()
                self.ready.set()
            if job is not None:
                self._told(job)
        self._kill()

    def _told(self, job: Job) -> None:
        """The job is served, and a span says from when to when."""
        job.began = began = time.monotonic()
        task = job.task
        span = self._telemetry.spans.begin(
            f"judge {task.verb}", task.origin.traceparent, twin=task.twin, waited=began - job.asked
        )
        self._serve(job)
        span.end(request=task.origin.request)
        if self.resident > MOST_MEMORY:
            self._counts.replaced += 1
            log.warning("a worker held %.1f GiB after %s and is replaced", self.resident / 2**30, task.verb)
            self._start()

    def _next(self) -> Job | None:
        """The next job; None for now."""
        try:
            return self._jobs.get(timeout=PAUSE)
        except queue.Empty:
            return None

    def _serve(self, job: Job) -> None:
        for tries_left in reversed(range(TRIES)):
            if job.cancelled.is_set() or job.over:
                job.answer(problem(ProblemType.CONFLICT, "cancelled"))
                return
            if self._tried(job, max(0.0, job.deadline - time.monotonic())):
                return
            self._counts.crashed += 1
            log.warning("a worker died while it answered %s", job.task.verb)
            if not tries_left:
                job.answer(problem(ProblemType.INTERNAL, "the worker died twice while it answered this"))
            self._start()

    def _tried(self, job: Job, left: float) -> bool:
        """Whether the job is over; False: the worker died."""
        pipe = self._pipe
        if pipe is None:
            return False
        try:
            pipe.send(replace(job.task, seconds=left))
            answers = select.poll()  # Connection.poll makes such an object each time: 0.05 ms
            answers.register(pipe, select.POLLIN)
            while True:
                if not answers.poll(TICK * 1000):
                    if self._given_up(job):
                        return True
                    continue
                said = pipe.recv()
                if isinstance(said, Wanted):
                    pipe.send(self._memory.recall(said.iri))
                    continue
                self._finish(job, said)
                return True
        except SdtError as error:
            log.error("what is stored cannot be asked or added to: %s", error)  # noqa: TRY400 - typed, and said
            job.answer(problem_of(error, ProblemType.UNAVAILABLE))
            self._start()  # it may be waiting for what was stored
            return True
        except (EOFError, OSError):
            return False

    def _given_up(self, job: Job) -> bool:
        """Whether the worker was killed, because nobody waits for the job any more."""
        late = time.monotonic() > job.deadline + GRACE
        if late or job.cancelled.is_set() or self.stopping.is_set():
            job.answer(problem(ProblemType.CONFLICT, "cancelled"))
            self._start()
            return True
        return False

    def _finish(self, job: Job, said: Done | Problem | Unfit) -> None:
        if isinstance(said, Unfit):
            self._kill()
            job.answer(said.problem)
            return
        if isinstance(said, Done) and said.records:
            self._memory.keep(said.records)
        if isinstance(said, Done):
            self._telemetry.metrics.judged(said.judged)
        self._counts.answered += 1
        job.answer(said)

    def _start(self) -> None:
        """A new worker in place of the old one, ready to answer."""
        self._kill()
        if self.stopping.is_set():
            return
        context = mp.get_context("forkserver")
        context.set_forkserver_preload([self._make_handler.__module__])
        ours, theirs = context.Pipe()
        process = context.Process(target=work, args=(theirs, self._make_handler, logs.is_json()), daemon=True)
        process.start()
        theirs.close()
        self._process, self._pipe = process, ours
        try:
            until = time.monotonic() + START_TIME
            while not ours.poll(PAUSE):
                if self.stopping.is_set():
                    return
                if time.monotonic() > until:
                    log.error("a worker was not ready after %s s", START_TIME)
                    return
            ours.recv()
        except (EOFError, OSError):
            log.exception("a worker did not start")

    def _kill(self) -> None:
        if self._process is not None:
            self._process.kill()
            self._process.join(GRACE)
        if self._pipe is not None:
            self._pipe.close()
        self._process = self._pipe = None


def work(pipe: Connection, make_handler: Callable[[], Handler], json_logs: bool) -> None:
    """Main of a worker's process: load, say ready, answer until the parent is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    end_with_parent()
    logs.configure(logs.Form.JSON if json_logs else logs.Form.TEXT)
    handler = make_handler()
    pipe.send("ready")

    def recall(iri: str) -> bytes | None:
        pipe.send(Wanted(iri))
        return pipe.recv()

    while True:
        try:
            task = pipe.recv()
        except EOFError:
            return
        with within(task.origin):
            try:
                pipe.send(handler(task, recall))
            except OtherModelsError as error:
                pipe.send(Unfit(problem_of(error)))
                return
