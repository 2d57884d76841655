"""Worker processes that hold loaded kitchens; each lane of the pool is a thread with one process.

A waiter is answered exactly once: by the worker, at its deadline, by being cancelled, or as a failure
after the worker has died twice. A worker that is busy with what nobody waits for is killed and
replaced.
"""

import queue
import threading
from collections.abc import Callable

from services.judging.problems import ProblemType, problem
from services.judging.workers.deadlines import Deadlines
from services.judging.workers.jobs import Counts, Handler, Job, Keeper, Task, Waiter
from services.judging.workers.lane import GRACE, START_TIME, Lane
from services.telemetry.metrics import Metrics
from services.telemetry.told import Telemetry

WAITING = 64
"""Jobs that may wait for a process."""

Key = tuple[str, str, bytes, str, tuple[str, ...], float]


class Pool:
    """Lanes that share a bounded queue.

    Attributes:
        counts: For health reports.
        telemetry: What is counted and traced.
        deadlines: Answers whoever's time is up; of questions that need no process too.
    """

    def __init__(
        self,
        make_handler: Callable[[], Handler],
        size: int,
        memory: Keeper,
        waiting: int = WAITING,
        telemetry: Telemetry | None = None,
    ) -> None:
        """Processes are started with the first jobs, or by `warm`.

        Args:
            make_handler: Called in each worker's process; has to be picklable.
            size: Worker processes.
            memory: Keeps verdicts; a reply is sent when its verdicts are kept.
            waiting: Jobs that may wait; one more is refused.
            telemetry: What is counted and traced; None: counted only.
        """
        self._jobs: queue.PriorityQueue[Job] = queue.PriorityQueue(maxsize=waiting)
        self.counts = Counts()
        self.telemetry = telemetry or Telemetry()
        self._lanes = [
            Lane(make_handler, self._jobs, memory, self.counts, self.telemetry) for _ in range(size)
        ]
        self._lock = threading.Lock()
        self._shared: dict[Key, Job] = {}
        self.deadlines = Deadlines()
        self._told(self.telemetry.metrics)
        for lane in self._lanes:
            lane.start()

    def _told(self, metrics: Metrics) -> None:
        """The pool's own figures are read when metrics are asked for."""
        metrics.gauge("sdt_jobs_waiting", lambda: self.queued)
        metrics.gauge("sdt_processes", lambda: len(self.pids()))
        metrics.gauge("sdt_process_deaths_total", lambda: self.counts.crashed, "counter")
        metrics.gauge("sdt_process_replacements_total", lambda: self.counts.replaced, "counter")
        metrics.gauge("sdt_process_resident_bytes", lambda: sum(lane.resident for lane in self._lanes))
        metrics.gauge("sdt_jobs_refused_total", lambda: self.counts.refused, "counter")
        metrics.gauge("sdt_deadlines_missed_total", lambda: self.deadlines.missed, "counter")

    def warm(self, count: int | None = None, seconds: float = START_TIME) -> None:
        """So many processes are ready, or all; or so long was waited for each, and they load still."""
        for lane in self._lanes[:count]:
            lane.warming.set()
        for lane in self._lanes[:count]:
            lane.ready.wait(seconds)

    @property
    def ready(self) -> bool:
        """Whether some process has loaded everything."""
        return any(lane.ready.is_set() for lane in self._lanes)

    @property
    def queued(self) -> int:
        """Jobs that wait."""
        return self._jobs.qsize()

    def submit(self, task: Task, waiter: Waiter, *, share: bool = False, urgent: bool = False) -> Job:
        """The job that answers the waiter: a new one, or with `share` one that does the same already.

        It is not the same if there is less time for it: what is searched ends with it.

        Where too many jobs wait, the waiter is told so at once.
        """
        key = (task.twin, task.verb, task.payload, task.encoding, task.states, task.seconds)
        self.deadlines.watch(waiter)
        with self._lock:
            running = self._shared.get(key) if share else None
            if running is not None and running.join(waiter):
                self.telemetry.metrics.count("sdt_shared_total")
                return running
            job = Job(task, [waiter], urgent)
            if share:
                self._shared = {key: each for key, each in self._shared.items() if not each.over} | {key: job}
        try:
            self._jobs.put_nowait(job)
        except queue.Full:
            self.counts.refused += 1
            job.answer(
                problem(ProblemType.UNAVAILABLE, f"{self.queued} requests wait already", retry_after=1.0)
            )
        return job

    def pids(self) -> list[int]:
        """Process ids of the workers, for tests and health reports."""
        return [pid for pid in (lane.pid for lane in self._lanes) if pid is not None]

    def close(self) -> None:
        """Stop the lanes and their processes; jobs that wait are answered Unavailable."""
        for lane in self._lanes:
            lane.stopping.set()
        while True:
            try:
                job = self._jobs.get_nowait()
            except queue.Empty:
                break
            job.answer(problem(ProblemType.UNAVAILABLE, "the server is stopping"))
        for lane in self._lanes:
            lane.join(GRACE + 2.0)
        self.deadlines.close()
