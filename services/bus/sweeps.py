"""Sweeps: jobs of many cases, a few at a time, with progress, result and cancellation."""

import json
import threading
import time
import uuid
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal

from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError, UnknownEntityError
from services.bus import keys
from services.judging.codec import JSON, decode, encode
from services.judging.messages import AchieveRequest, SweepRequest
from services.judging.problems import BusUnavailableError, Problem, ProblemType, problem
from services.judging.replies import JobReply, VerdictsReply
from services.judging.workers.jobs import Done, Job, Task, Waiter
from services.judging.workers.pool import Pool
from services.sweep.cell import Cell
from services.sweep.plan import Axes, Models, combined, policies

AT_ONCE = 4
"""Cases of one sweep that are in the pool at once: others get their turn too."""
AT_ONCE_JOBS = 32
"""Sweeps that go on at once; one more is refused."""
MARGIN = 60.0
"""[s] A case may take beyond its budget of search."""
JOBS_KEPT = 100
"""Finished jobs that can still be asked about."""
MOST = 10_000
"""Cases of one job: their verdicts are held until they are fetched."""
PAUSE = 0.5
"""[s] Before a case is offered again to a pool that was full."""

State = Literal["queued", "running", "done", "cancelled", "failed"]


@dataclass(slots=True, eq=False)
class Sweep:
    """One job.

    Attributes:
        present: The kitchen's present state when it began, as texts; the cases' own come after it.
    """

    id: str
    twin: str
    present: tuple[str, ...]
    total: int
    state: State = "queued"
    objects: list[dict[str, Any]] = field(default_factory=list[dict[str, Any]])
    problems: list[str] = field(default_factory=list[str])
    running: set[Job] = field(default_factory=set[Job])
    lock: threading.Lock = field(default_factory=threading.Lock)

    @property
    def over(self) -> bool:
        """Whether nothing more is judged."""
        return self.state not in {"queued", "running"}

    def reply(self) -> JobReply:
        """How far it is."""
        return JobReply(
            job=self.id, state=self.state, done=len(self.objects) + len(self.problems), total=self.total
        )


class Sweeps:
    """The sweeps of a server.

    Attributes:
        catalogue: Twin → what it can be swept over.
        instance: Name of the server.
    """

    def __init__(self, pool: Pool, catalogue: Mapping[str, Models], instance: str) -> None:
        self.catalogue, self.instance = dict(catalogue), instance
        self._pool = pool
        self._jobs: dict[str, Sweep] = {}
        self._lock = threading.Lock()

    def start(self, twin: str, request: SweepRequest, present: tuple[str, ...] = ()) -> JobReply:
        """A new job, in the kitchen as it is now.

        Raises:
            UnknownEntityError: A robot that the server does not hold.
            BusUnavailableError: Too many sweeps are going on.
        """
        models = self.catalogue[twin]
        for robot in request.robots:
            if robot not in models.robots:
                raise UnknownEntityError("robot", robot, models.robots)
        chosen = replace(models, robots=tuple(request.robots) or models.robots)
        cases = combined(chosen, _axes(request))
        if len(cases) > MOST:
            raise InputError(f"{len(cases)} cases", allowed=f"{MOST} in a job", remedy="sdt sweep")
        with self._lock:
            going = sum(not each.over for each in self._jobs.values())
            if going >= AT_ONCE_JOBS:
                said = f"{going} sweeps are going on already"
                raise BusUnavailableError(problem(ProblemType.UNAVAILABLE, said, retry_after=10.0))
            sweep = Sweep(keys.job_id(self.instance, uuid.uuid4().hex[:16]), twin, present, len(cases))
            self._jobs[sweep.id] = sweep
            finished = [job for job, each in self._jobs.items() if each.over]
            for job in finished[: max(0, len(self._jobs) - JOBS_KEPT)]:
                del self._jobs[job]
        threading.Thread(target=self._run, args=(sweep, cases), name=f"sweep {sweep.id}", daemon=True).start()
        return sweep.reply()

    def progress(self, job: str) -> JobReply:
        """How far the job is."""
        return self._known(job).reply()

    def result(self, job: str) -> bytes:
        """The verdicts so far, as JSON: `{job, state, verdicts, problems}`."""
        sweep = self._known(job)
        with sweep.lock:
            said = {"job": job, "state": sweep.state, "verdicts": sweep.objects, "problems": sweep.problems}
            return json.dumps(said).encode()

    def cancel(self, job: str) -> JobReply:
        """The job stops; what it has found stays."""
        sweep = self._known(job)
        with sweep.lock:
            if not sweep.over:
                sweep.state = "cancelled"
            for each in sweep.running:
                each.cancelled.set()
        return sweep.reply()

    def close(self) -> None:
        """Every sweep is cancelled."""
        for job in list(self._jobs):
            self.cancel(job)

    def _known(self, job: str) -> Sweep:
        if job not in self._jobs:
            raise InputError(f"no job '{job}'", allowed="the id that rpc/sweep gave, on the same server")
        return self._jobs[job]

    def _run(self, sweep: Sweep, cases: Iterable[Cell]) -> None:
        """Offer the cases, a few at a time, until all are answered or the job is cancelled."""
        with sweep.lock:
            if sweep.over:
                return
            sweep.state = "running"
        slots = threading.Semaphore(AT_ONCE)
        for case in cases:
            slots.acquire()
            if sweep.state == "cancelled":
                return
            self._offer(sweep, _request(case), slots.release)
        for _ in range(AT_ONCE):
            slots.acquire()
        if sweep.state == "running":
            sweep.state = "failed" if sweep.problems and not sweep.objects else "done"

    def _offer(self, sweep: Sweep, case: AchieveRequest, over: Callable[[], None]) -> None:
        seconds = case.budget + MARGIN

        def answer(outcome: Done | Problem) -> None:
            if isinstance(outcome, Problem) and outcome.retry_after:  # the pool is full
                threading.Timer(PAUSE, self._offer, (sweep, case, over)).start()
                return
            with sweep.lock:
                if isinstance(outcome, Done):
                    sweep.objects += decode(VerdictsReply, outcome.payload, outcome.encoding).verdicts
                else:
                    sweep.problems.append(f"{case.robot} {case.task}: {outcome.detail}")
            over()

        task = Task(sweep.twin, "canachieve", encode(case), JSON, seconds, sweep.present)
        # Cases wait their turn behind others: the deadline counts from when a worker could have begun.
        waiter = Waiter(time.monotonic() + AT_ONCE * seconds, answer)
        job = self._pool.submit(task, waiter, share=True)
        with sweep.lock:
            sweep.running = {each for each in sweep.running if not each.over} | {job}


def _axes(request: SweepRequest) -> Axes:
    """What the request varies."""
    drives = [Drive(each) for each in request.drives] or [Drive(request.drive) if request.drive else None]
    return Axes(
        tasks=tuple(request.tasks) or (request.verb,),
        states=tuple((*request.state, *each) for each in request.starts) or (tuple(request.state),),
        policies=policies(drives, seeds=request.seeds, budget=request.budget, frictions=[request.friction]),
        classes=(request.relative,),
    )


def _request(cell: Cell) -> AchieveRequest:
    drive = cell.policy.drive
    return AchieveRequest(
        task=cell.task,
        robot=cell.robot,
        state=list(cell.states),
        drive=None if drive is None else drive.value,
        friction=cell.policy.friction,
        budget=cell.policy.budget,
        seed=cell.policy.seed,
        tee=cell.relative.tee,
        handle_force=cell.relative.handle_force,
    )
