"""Two processes against one over the same cases."""

import os
import resource

import pytest

from sdt_kg.annotation import Drive
from services.sweep.cell import CellResult
from services.sweep.engines import processes
from services.sweep.plan import Axes, grid, policies
from services.sweep.run import run

CASES = Axes(policies=policies([Drive.OMNI]))


def _cpu() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


@pytest.mark.benchmark(group="sweep: kitchen b, three robots")
@pytest.mark.parametrize("count", [1, 2])
def test_a_sweep_with_so_many_processes(benchmark, count: int) -> None:
    """Wall time, the CPU time of the workers, and how busy the machine was with others."""
    before = _cpu()

    def swept() -> int:
        found = list(run(grid(["b"], ["pr2", "tiago_dual", "stretch"], CASES).cells, processes(count)))
        assert all(isinstance(each, CellResult) for each in found)
        return len(found)

    assert benchmark.pedantic(swept, rounds=1) == 51
    benchmark.extra_info["CPU seconds of the workers"] = _cpu() - before
    benchmark.extra_info["load of the machine"] = os.getloadavg()[0]
