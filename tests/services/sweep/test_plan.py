"""Cases come from a grid, a CSV file or a query; what they name is checked before anything is judged."""

from itertools import islice
from pathlib import Path

import pytest

from predicates.oracle import tee_class_of
from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError, QueryError, UnknownEntityError
from sdt_kg.scope import D_ARTIC, D_ARTIC_DYN
from services.app import Policy
from services.relative import KINEMATIC, Relative
from services.sweep.cell import Cell
from services.sweep.plan import Axes, Combined, classes, grid, policies
from services.sweep.sources import Listed, csv_rows, query_rows
from services.sweep.worker import SERVICES_KEPT, dear_first, service_of

BOTH_CLASSES = ("d_artic", "d_artic_dyn")
DOOR = "iai_fridge_door"
BOTH = Axes(("open", "close"), ((), (f"{DOOR}=open",)), policies([Drive.OMNI, Drive.FIXED], seeds=[1, 2, 3]))


def _at_once() -> None:
    """Nobody bounds what is asked here."""


def listed() -> Listed:
    return Listed(("b",), ("pr2", "stretch"), Axes())


def rows_of(tmp_path: Path, text: str) -> list[Cell]:
    file = tmp_path / "cases.csv"
    file.write_text(text)
    return list(listed().plan(csv_rows(file)).cells)


def test_a_grid_is_every_combination_kitchen_by_kitchen_and_robot_by_robot() -> None:
    plan = grid(["b"], ["pr2", "stretch"], BOTH)
    cells = list(plan.cells)
    assert plan.total == len(cells) == len(set(cells)) == 2 * 2 * 2 * 6 * 17
    assert [cell.robot for cell in cells] == ["pr2"] * 408 + ["stretch"] * 408


def test_a_million_cases_are_counted_and_begun_without_a_list() -> None:
    many = Axes(tuple(f"open:{number}" for number in range(100)), ((),) * 100, policies(seeds=range(100)))
    part = Combined("b", ("pr2",), many)
    assert len(part) == 1_000_000
    assert [cell.container for cell in islice(part, 2)] == ["0", "1"]


def test_a_state_that_a_kitchen_has_not_is_left_out_there_and_refused_where_none_has_it() -> None:
    plan = grid(["a", "b"], ["pr2"], Axes(states=((f"{DOOR}=open",),)))
    assert {cell.states for cell in plan.cells if cell.kitchen == "a"} == {()}
    with pytest.raises(InputError, match="no kitchen of these has a joint for: iai_fridge_door=open"):
        grid(["a"], ["pr2"], Axes(states=((f"{DOOR}=open",),)))


def test_asked_is_the_container_of_each_case(tmp_path: Path) -> None:
    plan = grid(["a", "b"], ["pr2"], Axes(("close",), (("asked=open",),)))
    assert plan.total == 44
    assert all(cell.states == (f"{cell.container}=open",) for cell in plan.cells)
    (row,) = rows_of(tmp_path, f"robot,task,state\npr2,close:{DOOR},asked=0.5\n")
    assert row.states == (f"{DOOR}=0.5",)
    with pytest.raises(InputError, match="outside its limits"):
        grid(["a", "b"], ["pr2"], Axes(("close",), (("asked=9",),)))


def test_a_row_takes_from_the_options_what_it_leaves_out(tmp_path: Path) -> None:
    found = rows_of(tmp_path, f"robot,container,seed,state\npr2,{DOOR},7,all=closed; {DOOR}=0.1\n,{DOOR},,\n")
    assert found[0].states == ("all=closed", f"{DOOR}=0.1")
    assert found[0].policy.seed == 7
    assert [(cell.robot, cell.task) for cell in found[1:]] == [
        ("pr2", f"open:{DOOR}"),
        ("stretch", f"open:{DOOR}"),
    ]


def test_a_case_that_is_listed_twice_is_one_case(tmp_path: Path) -> None:
    assert len(rows_of(tmp_path, f"robot,task\npr2,open:{DOOR}\npr2,open:{DOOR}\n")) == 1


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            "robot,task\npr2,open:iai_fridge_dor\n",
            r"line 2: no container named 'iai_fridge_dor'.*iai_fridge_door",
        ),
        ("robot,task\npr3,open\n", "line 2: no robot named 'pr3'"),
        ("robot,task\npr2,push\n", "line 2: no task type 'push'"),
        ("robot,task,drive\npr2,open,flying\n", "line 2: .*flying.*omni"),
        ("robot,task,budget\npr2,open,-1\n", "line 2: a budget of -1 s"),
        ("robot,tsk\npr2,open\n", "no column named 'tsk'.*task"),
        ("robot,task\npr2,open,1\n", "line 2 has more cells than the head; quote a cell"),
        ("robot;task\npr2;open\n", "has ';' between its cells; allowed: commas"),
        ("robot\ttask\npr2\topen\n", "between its cells; allowed: commas"),
        ("robot,task\n", "there is no row"),
        ("robot,seed\npr2,-1\n", "line 2: a seed of -1"),
        ("robot,container,container\npr2,sink_area_trash_drawer_main,iai_fridge_door\n", "'container' twice"),
        (
            "robot,task,container\npr2,open:iai_fridge_door,sink_area_trash_drawer_main\n",
            "line 2: the task is about 'iai_fridge_door', and the container is 'sink_area_trash_drawer_main'",
        ),
        ("robot,state\npr2,iai_fridge_door=wide\n", "line 2: 'iai_fridge_door=wide' has no number"),
    ],
)
def test_a_wrong_row_says_where_and_what_is_allowed(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        rows_of(tmp_path, text)


def test_a_query_over_the_twin_chooses_the_cases() -> None:
    sparql = "SELECT ?robot ?container { ?container a sdt:Door . ?robot a sdt:Robot }"
    found = list(listed().plan(query_rows(sparql, ["b"], ["pr2", "stretch"], None, _at_once)).cells)
    assert len(found) == 3 * 2
    assert {cell.robot for cell in found} == {"pr2", "stretch"}


def test_a_query_that_selects_something_else_or_writes_is_refused() -> None:
    with pytest.raises(UnknownEntityError, match="no column named 'door'"):
        query_rows("SELECT ?door { ?door a sdt:Door }", ["b"], [], None, _at_once)
    with pytest.raises(QueryError):
        query_rows("DELETE WHERE { ?a ?b ?c }", ["b"], [], None, _at_once)


def test_classes_and_forces_are_varied_and_those_without_a_class_that_knows_any_are_refused(
    tmp_path: Path,
) -> None:
    plan = grid(["b"], ["pr2"], Axes((f"open:{DOOR}",), classes=classes(BOTH_CLASSES, None, (5.0, 9.0))))
    assert plan.total == 3
    assert [(each.relative.tee, each.relative.handle_force) for each in plan.cells] == [
        ("d_artic", None),
        ("d_artic_dyn", 5.0),
        ("d_artic_dyn", 9.0),
    ]
    head = f"container,tee,handle_force\n{DOOR}"
    assert rows_of(tmp_path, f"{head},D_ARTIC_DYN,7\n")[0].relative == Relative("d_artic_dyn", None, 7.0)
    for row, said in (
        (",,7", "says nothing to d_artic"),
        (",d_artic_dyn,nan", "finite"),
        (",d,", "TEE class"),
    ):
        with pytest.raises(InputError, match=said):
            rows_of(tmp_path, f"{head}{row}\n")
    with pytest.raises(InputError, match="says nothing to d_artic"):
        classes(["d_artic"], None, (5.0,))


def test_a_row_takes_the_forces_that_the_options_give_its_class(tmp_path: Path) -> None:
    file = tmp_path / "cases.csv"
    file.write_text(f"container,tee\n{DOOR},d_artic_dyn\n")
    both = Listed(("b",), ("pr2",), Axes(classes=classes(BOTH_CLASSES, None, (5.0,))))
    cells = both.plan(csv_rows(file)).cells
    assert [each.relative for each in cells] == [Relative("d_artic_dyn", None, 5.0)]


@pytest.mark.parametrize(
    ("cells", "said"),
    [
        ("OMNI,,", "line 2: drive is 'OMNI'; allowed: omni, differential, fixed"),
        (",2s,", "line 2: budget is '2s'; allowed: seconds"),
        (",,1.5", "line 2: seed is '1.5'; allowed: a whole number"),
    ],
)
def test_a_cell_that_says_nothing_is_named(tmp_path: Path, cells: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        rows_of(tmp_path, f"container,drive,budget,seed\n{DOOR},{cells}\n")


@pytest.mark.parametrize("base", ["1, -2, 0.5", "1,-2,0.5", "1 -2  0.5"])
def test_a_base_pose_in_a_row_is_apart_by_commas_or_spaces(tmp_path: Path, base: str) -> None:
    cells = rows_of(tmp_path, f'container,base\n{DOOR},"{base}"\n')
    assert {cell.policy.base for cell in cells} == {(1.0, -2.0, 0.5)}


def test_a_file_that_ends_in_an_open_quote_is_no_csv(tmp_path: Path) -> None:
    # Else what is left of its last row would be about every container.
    with pytest.raises(InputError, match="is no CSV: unexpected end of data"):
        rows_of(tmp_path, f'container,task\n{DOOR},open\n"')


def test_names_in_a_row_keep_their_capitals(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no container named 'Door'"):
        rows_of(tmp_path, "robot,task\npr2,OPEN:Door\n")


def test_a_case_of_a_sweep_is_judged_relative_to_its_class() -> None:
    for relative, expected in (
        (KINEMATIC, (True, D_ARTIC)),
        (Relative("d_artic_dyn", handle_force=2.0), (False, D_ARTIC_DYN)),
    ):
        cell = Cell("b", "pr2", f"open:{DOOR}", (), Policy(), relative)
        (answer,) = service_of(cell).causes(cell.task)
        assert (answer.holds, tee_class_of(service_of(cell).physics)) == expected


def test_doors_are_begun_before_drawers_and_robots_of_few_joints_before_others() -> None:
    cells = list(grid(["b"], ["pr2", "stretch"], Axes()).cells)
    begun = dear_first(cells)
    assert [(cell.robot, cell.container.endswith("_door")) for cell in begun] == (
        [("stretch", True)] * 3 + [("pr2", True)] * 3 + [("stretch", False)] * 14 + [("pr2", False)] * 14
    )
    assert set(begun) == set(cells)


def test_more_than_a_worker_keeps_loaded_is_gone_through_once() -> None:
    seeds = policies(seeds=range(SERVICES_KEPT + 1))
    cells = list(grid(["b"], ["pr2"], Axes(policies=seeds)).cells)
    assert dear_first(cells) == cells
