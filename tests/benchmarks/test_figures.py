"""Figures, never assertions on time: `make bench`."""

import subprocess
import sys
from collections.abc import Callable
from typing import Any

import pytest

from sdt_kg.load import load_twin
from sdt_kg.scope import D_ARTIC, request_graph
from sdt_kg.shacl import check
from services import load
from services.physics.oracle import Kinematics

Benchmark = Callable[..., Any]

CONTAINER = "sink_area_left_middle_drawer_main"


def test_start_of_the_command(benchmark: Benchmark) -> None:
    benchmark(subprocess.run, [sys.executable, "-c", "import services.cli"], check=True)


@pytest.mark.parametrize("kitchen", ["a", "b"])
def test_twin_build(benchmark: Benchmark, kitchen: str) -> None:
    twin = benchmark(load_twin, kitchen, ["pr2"])
    assert twin.robots


def test_scope_check_of_one_request(benchmark: Benchmark) -> None:
    twin = load_twin("b", ["pr2"])
    graph = request_graph(twin, twin.container(CONTAINER), twin.robots[0])
    assert benchmark(check, graph, D_ARTIC.shapes, []) == []


def test_causes_replay(benchmark: Benchmark) -> None:
    service, physics = load("b"), Kinematics()
    (answer,) = service.causes(f"open:{CONTAINER}")
    replayed = benchmark(physics.replay, service.twin, answer.case.motion)
    assert replayed.violations == ()


@pytest.mark.parametrize("robot", ["pr2", "tiago_dual", "stretch"])
def test_one_can_achieve(benchmark: Benchmark, robot: str) -> None:
    service = load("b", [robot])

    def ask() -> str:
        (verdict,) = service.achieve(f"open:{CONTAINER}")
        return verdict.outcome.value

    assert benchmark.pedantic(ask, rounds=3, warmup_rounds=1) == "certified"


def test_one_achieve_from_the_shell(benchmark: Benchmark) -> None:
    command = [sys.executable, "-m", "services.cli", "achieve", "--kitchen", "b", "--robot", "pr2"]
    task = ["--task", f"open:{CONTAINER}", "--json"]
    benchmark.pedantic(
        subprocess.run, ([*command, *task],), {"check": True, "capture_output": True}, rounds=3
    )


def test_memory_of_the_table(benchmark: Benchmark) -> None:
    """Peak resident size of a worker that runs the table of kitchen b [MiB], as extra_info."""
    code = (
        "import atexit, resource, sys; from services.cli import main;"
        " atexit.register(lambda: print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss));"
        " sys.argv = ['sdt', 'table', '--kitchens', 'b', '--drive', 'omni', '--jobs', '1']; main()"
    )
    done = benchmark.pedantic(
        subprocess.run,
        ([sys.executable, "-c", code],),
        {"check": True, "capture_output": True, "text": True},
        rounds=1,
    )
    benchmark.extra_info["peak_rss_mib"] = int(done.stdout.split()[-1]) / 1024
