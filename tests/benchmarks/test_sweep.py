"""Two processes against one over the same cases, and what a sweep loads before its processes begin."""

import os
import resource

import pytest

from sdt_kg.annotation import Drive
from services.sweep.cell import CellResult
from services.sweep.engines import processes
from services.sweep.plan import Axes, Plan, grid, policies
from services.sweep.run import run
from services.sweep.worker import prepare

CASES = Axes(policies=policies([Drive.OMNI]))


def _plan() -> Plan:
    return grid(["b"], ["pr2", "tiago_dual", "stretch"], CASES)


def _cpu() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


@pytest.mark.benchmark(group="sweep: what is loaded before processes begin")
def test_what_is_loaded_before_processes_begin(benchmark) -> None:
    """Once in the process that hands out; those that begin as its copies have it."""
    benchmark.pedantic(lambda: prepare(next(iter(_plan().cells))), rounds=1)


@pytest.mark.benchmark(group="sweep: kitchen b, three robots")
@pytest.mark.parametrize("count", [1, 2])
def test_a_sweep_with_so_many_processes(benchmark, count: int) -> None:
    """Wall time once that is loaded, the CPU time of the workers, and how busy the machine was."""
    prepare(next(iter(_plan().cells)))
    before = _cpu()

    def swept() -> int:
        found = list(run(_plan().cells, processes(count)))
        assert all(isinstance(each, CellResult) for each in found)
        return len(found)

    assert benchmark.pedantic(swept, rounds=1) == 51
    benchmark.extra_info["CPU seconds of the workers"] = _cpu() - before
    benchmark.extra_info["load of the machine"] = os.getloadavg()[0]
