"""Two processes against one over the same cases, beside what two that share nothing reach on this machine."""

import logging
import multiprocessing as mp
import os
import resource
import time

import pytest

from sdt_kg.annotation import Drive
from services.sweep.cell import CellResult
from services.sweep.executors.engines import processes
from services.sweep.plan import Axes, Plan, grid, policies
from services.sweep.run import run
from services.sweep.worker import prepare

log = logging.getLogger(__name__)

STARTS = ((), ("all=half-open:1",), ("all=half-open:2",))
CASES = Axes(states=STARTS, policies=policies([Drive.OMNI]))
ROUNDS = 2
"""Alone, two, side by side, and again: a machine whose speed drifts is slow for each of them."""


def _plan() -> Plan:
    return grid(["b"], ["pr2", "tiago_dual", "stretch"], CASES)


def _cpu() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _swept(count: int) -> None:
    found = list(run(_plan().cells, processes(count)))
    assert len(found) == 51 * len(STARTS)
    assert all(isinstance(each, CellResult) for each in found)


def _side_by_side() -> None:
    """The same sweep twice at once, each with one process and nothing in common."""
    context = mp.get_context("fork")
    both = [context.Process(target=_swept, args=(1,)) for _ in range(2)]
    for each in both:
        each.start()
    for each in both:
        each.join()
    assert [each.exitcode for each in both] == [0, 0]


@pytest.mark.benchmark(group="sweep: what is loaded before processes begin")
def test_what_is_loaded_before_processes_begin(benchmark) -> None:
    """Once in the process that hands out; those that begin as its copies have it."""
    benchmark.pedantic(lambda: prepare(next(iter(_plan().cells))), rounds=1)


@pytest.mark.benchmark(group="sweep: kitchen b, three robots, three starts")
def test_two_processes_against_one_and_against_what_the_machine_gives(benchmark) -> None:
    """Wall time once what is shared is loaded, and the CPU time of the workers.

    The second core gives what two sweeps side by side, which share nothing, do in the time of one.
    """
    prepare(next(iter(_plan().cells)))
    ways = {"alone": lambda: _swept(1), "two": lambda: _swept(2), "side by side": _side_by_side}
    wall, cpu = dict.fromkeys(ways, 0.0), dict.fromkeys(ways, 0.0)

    def measured() -> None:
        for name, way in ways.items():
            began, before = time.perf_counter(), _cpu()
            way()
            wall[name] += time.perf_counter() - began
            cpu[name] += _cpu() - before

    benchmark.pedantic(measured, rounds=ROUNDS)
    ratio, ceiling = wall["alone"] / wall["two"], 2 * wall["alone"] / wall["side by side"]
    figures = {
        "two processes, times as fast as one [1]": ratio,
        "ceiling: two that share nothing [1]": ceiling,
        "of the ceiling [1]": ratio / ceiling,
        **{f"{name}, wall [s]": seconds / ROUNDS for name, seconds in wall.items()},
        **{f"{name}, CPU of the workers [s]": seconds / ROUNDS for name, seconds in cpu.items()},
        "load of the machine [1]": os.getloadavg()[0],
    }
    benchmark.extra_info.update({name: round(value, 3) for name, value in figures.items()})
    log.info("%s", benchmark.extra_info)
