"""Figures of branches, trajectories and diffs, never assertions on time: `make bench`."""

from collections.abc import Callable
from typing import Any

import numpy as np

from sdt_kg.history import Branch, Edit, Followed, History, Trajectory, moved
from sdt_kg.load import load_twin

Benchmark = Callable[..., Any]

BRANCHES = 10_000


def states(history: History, count: int) -> list[Edit]:
    """As many different states of kitchen B, one joint moved in each."""
    draw = np.random.default_rng(0)
    containers = history.first.twin.containers()
    return [
        moved({containers[number % len(containers)].active_joint: float(draw.uniform(0.0, 0.3))})
        for number in range(count)
    ]


def test_ten_thousand_branches(benchmark: Benchmark) -> None:
    twin = load_twin("b")

    def begun() -> tuple[tuple[History, list[Edit]], dict[str, Any]]:
        history = History.of(twin)
        return (history, states(history, BRANCHES)), {}

    def spread(history: History, edits: list[Edit]) -> list[Branch]:
        return history.spread(history.first, edits)[1]

    made = benchmark.pedantic(spread, setup=begun, rounds=3)
    assert len({branch.iri for branch in made}) == BRANCHES


def test_query_of_one_branch(benchmark: Benchmark) -> None:
    history = History.of(load_twin("b"))
    history, branches = history.spread(history.first, states(history, 256))
    assert benchmark(history.select, "closed", branches[-1])


def test_a_trajectory_with_its_events(benchmark: Benchmark) -> None:
    history = History.of(load_twin("b"))
    door = history.first.twin.container("iai_fridge_door")
    values = np.linspace(0.0, door.upper, 1000)[:, None]
    edit = Followed(Trajectory((door.joint,), np.linspace(0.0, 10.0, 1000), values))
    _, branch = benchmark(history.derived, history.first, edit)
    assert len(branch.events) == 3
