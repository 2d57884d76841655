"""What reuse saves: a motion certified again by the pairs that an edit touches, against asking anew."""

import pytest

from services.app import Policy, load
from services.codesign.judge import Judge, judged_as_it_is
from services.whatif import World, changed, parse_change

DRAWER = "sink_area_left_middle_drawer_main"


@pytest.fixture(scope="module")
def worlds() -> tuple[World, World]:
    world = World(load("b", ["pr2"], policy=Policy(budget=5)), "pr2")
    return world, changed(world, (parse_change("box:crate=0.4,0.4,0.9@3,3,0.45"),))


def test_certified_again(benchmark, worlds) -> None:
    base = judged_as_it_is(worlds[0], "open", DRAWER)
    judge = Judge(*worlds, {})
    judge.judged("open", DRAWER, base)
    benchmark(judge.judged, "open", DRAWER, base)


def test_asked_anew(benchmark, worlds) -> None:
    judge = Judge(*worlds, {})
    judge.judged("open", DRAWER, None)
    benchmark(judge.judged, "open", DRAWER, None)
