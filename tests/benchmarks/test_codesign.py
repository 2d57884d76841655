"""What reuse saves: a motion certified again by the pairs that an edit touches, against asking anew."""

import pytest

from services.app import Policy, load
from services.codesign.asked import Asked, worlds_of
from services.codesign.entries import Grid
from services.codesign.grid import run
from services.codesign.judge import Judge, judged_as_it_is
from services.codesign.report import reused
from services.whatif import World, changed, parse_change

DRAWER = "sink_area_left_middle_drawer_main"


@pytest.fixture(scope="module")
def worlds() -> tuple[World, World]:
    world = World(load("b", ["pr2"], policy=Policy(budget=5)), "pr2")
    return world, changed(world, (parse_change("box:crate=0.4,0.4,0.9@3,3,0.45"),))


def test_certified_again(benchmark, worlds) -> None:
    base = judged_as_it_is(worlds[0], "open", DRAWER)
    judge = Judge(*worlds, {})
    judge.judged(f"open:{DRAWER}", base)
    benchmark(judge.judged, f"open:{DRAWER}", base)


def test_asked_anew(benchmark, worlds) -> None:
    judge = Judge(*worlds, {})
    judge.judged(f"open:{DRAWER}", None)
    benchmark(judge.judged, f"open:{DRAWER}", None)


GRIDS = {
    "a": "box:crate=0.4,0.4,0.9@2.2,2.6,0.45 | box:stool=0.35,0.35,0.5@1,3,0.25 | "
    "box:chair=0.5,0.5,0.9@2.5,1.5,0.45 | box:bin=0.3,0.3,0.7@0.8,1.2,0.35 | "
    "box:trolley=0.6,0.4,0.8@3,3.5,0.4 | box:lamp=0.2,0.2,1.8@2,4,0.9 | "
    "move:cabinet7_door_bottom_left=open | move:wardrobe_door_left=open | move:cabinet9_drawer_top=0.2 | "
    "move:cabinet2_door_left=0.8 | handle:cabinet9_drawer_top=0,0,0.1 | handle:wardrobe_door_left=0,0,-0.2 | "
    "furniture:wardrobe=0.3,0 | furniture:table_area_main=0.3,0.2 | jam:cabinet1_drawer_middle | "
    "set:cabinet6_drawer_top_joint.upperLimit=0.3 | drive:omni | drive:differential | broken:left | "
    "payload:right=0.1,0.1,0.2,1",
    "b": "box:crate=0.4,0.4,0.9@0.6,1.2,0.45 | box:stool=0.35,0.35,0.5@0.5,-0.8,0.25 | "
    "box:chair=0.5,0.5,0.9@-0.3,1.3,0.45 | box:bin=0.3,0.3,0.7@0.7,0.3,0.35 | "
    "box:trolley=0.6,0.4,0.8@-1,2.5,0.4 | box:lamp=0.2,0.2,1.8@0.4,2.2,0.9 | "
    "move:iai_fridge_door=open | move:oven_area_oven_door=open | move:sink_area_left_upper_drawer_main=0.3 | "
    "move:kitchen_island_left_upper_drawer_main=0.3 | handle:iai_fridge_door=0,0,0.1 | "
    "handle:oven_area_oven_door=0,0,-0.1 | furniture:kitchen_island=0.2,0 | "
    "furniture:oven_area_oven_door=0,0,0.1 | jam:sink_area_left_middle_drawer_main | "
    "set:fridge_area_lower_drawer_main_joint.upperLimit=0.3 | drive:omni | drive:differential | "
    "broken:left | payload:right=0.1,0.1,0.2,1",
}
"""20 edits of each kitchen."""
ROBOTS = ("pr2", "tiago_dual", "stretch")


@pytest.mark.slow
def test_2640_cases_in_two_processes(benchmark) -> None:
    def grids() -> list[Grid]:
        policy = Policy(budget=5)
        return [
            run(Asked((kitchen,), ROBOTS, "open", worlds_of([edits]), policy), 2)
            for kitchen, edits in GRIDS.items()
        ]

    found = benchmark.pedantic(grids, rounds=1)
    assert sum(len(each.edited()) for each in found) == 2640
    benchmark.extra_info["reused"] = [reused(each) for each in found]
    benchmark.extra_info["cpu_seconds"] = sum(each.cpu_seconds for each in found)
