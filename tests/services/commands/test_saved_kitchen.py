"""A kitchen that was saved with one robot is asked about another, and about its own."""

from pathlib import Path

import pytest

from services.app import load
from services.commands.exits import Exit

pytestmark = pytest.mark.oracle

DRAWER = "sink_area_left_middle_drawer_main"
TASK = f"open:{DRAWER}"


@pytest.fixture(scope="module")
def kitchen(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Kitchen B with stretch, as `sdt graph` writes it."""
    path = tmp_path_factory.mktemp("saved") / "yesterday.nq"
    path.write_text(load("b", ["stretch"]).twin.serialize("nquads").decode())
    return str(path)


@pytest.mark.parametrize("robot", ["pr2", "stretch"])
def test_the_robot_that_is_named_is_asked(sdt, kitchen: str, robot: str) -> None:
    one = sdt("achieve", "--kitchen", kitchen, "--robot", robot, "--task", TASK)
    assert one.code == Exit.DONE, one.err
    assert f"certified  open({DRAWER})  {robot} in kitchen b" in one.out


def test_other_commands_ask_another_robot_too(sdt, kitchen: str) -> None:
    case = "--kitchen", kitchen, "--robot", "pr2"
    where = sdt("place", *case, "--task", TASK, "--budget", "1")
    assert where.code in {Exit.DONE, Exit.NO}, where.err
    assert sdt("task", "open_drawer_fast", *case, "--budget", "5").code == Exit.DONE


def test_so_do_many_cases_and_what_a_query_asks_for(sdt, kitchen: str, tmp_path: Path) -> None:
    store, cases = tmp_path / "kept", tmp_path / "cases.csv"
    cases.write_text(f"container\n{DRAWER}\n")
    many = ("--kitchens", kitchen, "--robots", "pr2,stretch", "--jobs", "1", "--save", str(store))
    swept = sdt("sweep", "--cases", str(cases), *many, "--json")
    assert swept.code == Exit.DONE, swept.err
    container = f"<https://example.org/id/b/body/{DRAWER}>"
    query = f"SELECT ?r {{ ?v law:outcome law:Certified ; law:robot ?r ; law:container {container} }}"
    computed = sdt(
        "query", str(tmp_path / "other"), query, "--kitchen", kitchen, "--robot", "pr2", "--compute", "--json"
    )
    assert computed.code == Exit.DONE, computed.err
    assert {each["r"].rpartition("/")[2] for each in computed.json["rows"]} == {"pr2", "stretch"}
