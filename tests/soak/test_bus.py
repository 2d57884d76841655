"""Ten thousand mixed requests with faults: right or typed, never long after the deadline, memory flat."""

import logging
from collections import Counter
from collections.abc import Iterator

import numpy as np
import pytest

from services.app import Policy, load
from services.bus.client import Connection
from services.bus.sessions import open_session
from tests.ports import free_endpoint
from tests.services.bus.mixed import Cases, Outcomes, is_typed, run, scattered
from tests.services.bus.stage import Stage, staged

pytestmark = pytest.mark.oracle

log = logging.getLogger(__name__)

KINDS = ("causes", "canperform") * 2
"""Oracles: two of each, so that one may die."""
TASKS = (
    "open:sink_area_left_middle_drawer_main",
    "open:sink_area_left_upper_drawer_main",
    "open:kitchen_island_left_upper_drawer_main",
    "close:kitchen_island_left_upper_drawer_main",
)
SEEDS = range(10)
GROWTH = 1.05
"""[1] Of the server's own memory, from the first thousand requests to the last."""
SETTLING = 500
"""Small questions before memory is read."""
ANSWERED = 0.8
"""[1] Of what was asked rightly, at least, while everything is killed now and then."""


@pytest.fixture(scope="module")
def stage() -> Iterator[Stage]:
    with staged(free_endpoint(), KINDS) as one:
        yield one


@pytest.fixture(scope="module")
def cases() -> Cases:
    """Verdicts in process."""
    found: dict[tuple[str, int], tuple[str, str]] = {}
    for seed in SEEDS:
        here = load("b", ["pr2"], policy=Policy(seed=seed))
        for task in TASKS:
            (made,) = here.achieve(task)
            found[task, seed] = (made.iri, made.outcome.value)
    return found


def _settled(stage: Stage) -> int:
    with open_session(connect=stage.endpoint, mode="client") as session:
        for _ in range(SETTLING):
            assert Connection(session, "b").ask("ASK { ?d a sdt:Door }")
    return stage.resident()


def _right(found: Outcomes, requests: int) -> None:
    """Every request ended, rightly or typed."""
    assert sum(found.counts.values()) == requests
    assert not found.wrong
    assert all(is_typed(end) for _, end in found.counts)


def _mostly_answered(counts: Counter[tuple[str, str]]) -> None:
    """What is asked rightly and patiently is answered, but while there is no router."""
    for kind in ("satisfies", "select", "ask", "causes", "achieve"):
        ends = {end: often for (one, end), often in counts.items() if one == kind}
        assert ends["answer"] > ANSWERED * sum(ends.values()), (kind, ends)


def test_ten_thousand_mixed_requests(stage: Stage, cases: Cases) -> None:
    harms = {stage.kill_worker: 3, stage.kill_oracle: 2, stage.restart_router: 1}
    first = run(stage.endpoint, 1000, scattered(1000, harms), cases, 0, stage.is_excused)
    before = _settled(stage)
    more = {harm: 9 * often for harm, often in harms.items()}
    rest = run(stage.endpoint, 9000, scattered(9000, more, 1), cases, 1, stage.is_excused)
    grown = _settled(stage) / before
    for found, requests in ((first, 1000), (rest, 9000)):
        _right(found, requests)
    _mostly_answered(first.counts + rest.counts)
    late, bare = np.array(first.late + rest.late), np.array(first.bare + rest.bare)
    figures = {
        "late, 99.9 % [s]": np.quantile(late, 0.999),
        "late, most [s]": late.max(),
        "bare question, 99.9 % [s]": np.quantile(bare, 0.999),
        "bare question, most [s]": bare.max(),
        "memory, growth [1]": grown,
    }
    log.info("%s", {name: round(float(value), 4) for name, value in figures.items()})
    log.info("%s", dict(first.counts + rest.counts))
    assert grown < GROWTH, figures
    # What a question takes that nobody has to think about is the machine's.
    assert late.max() - bare.max() < 1.0, figures
    assert np.quantile(late, 0.999) - np.quantile(bare, 0.999) < 0.1, figures
    _kept(stage, first.verdicts | rest.verdicts)


def _kept(stage: Stage, verdicts: set[str]) -> None:
    """What was acknowledged is there."""
    assert verdicts
    with open_session(connect=stage.endpoint, mode="client") as session:
        _, rows = Connection(session, "b").select("SELECT ?v WHERE { ?v a law:Verdict }")
    assert verdicts <= {str(row["v"]) for row in rows}
