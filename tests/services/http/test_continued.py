"""A service that starts again has its branches, is where it was, and can compare them."""

import signal
import subprocess
import sys
import time
from contextlib import closing
from typing import Any

import pyoxigraph as ox
import pytest

from sdt_kg.errors import GraphError
from sdt_kg.iri import SDT
from services import cli
from services.store.files import opened
from services.store.on_disk import JOURNAL
from tests.ports import free_port
from tests.services.store.test_folder import files_of_at_most
from tests.small import FOLDER

DRAWERS = ("low_drawer", "high_drawer")


def moved(served, *states: str) -> dict[str, object]:
    answer = served.post("/api/v1/state", json={"state": list(states)})
    assert answer.status_code == 200, answer.text
    return answer.json()


def told(served) -> tuple[Any, Any]:
    return served.get("/api/v1/branches").json(), served.get("/api/v1/state").json()


def test_branches_present_events_and_differences_are_those_from_before(serve, tmp_path) -> None:
    with closing(opened(tmp_path / "store")) as archive:
        first = serve(kitchens=("a", "b"), robots=("pr2",), archive=archive)
        for name in DRAWERS:
            first.post("/api/v1/state", json={"kitchen": "a", "state": [f"{name}=open"]})
        limit = {"entity": joint(first, "low_drawer"), "changes": {"upperLimit": 0.6}}
        narrow = first.post("/api/v1/branch", json={"kitchen": "a", "edit": limit})
        assert narrow.status_code == 201, narrow.text
        before = [
            first.get(f"/api/v1/{what}?kitchen=a").json() for what in ("branches", "state", "satisfies")
        ]
        asked = {"kitchen": "a", "before": before[0][0]["iri"], "after": before[0][-1]["iri"]}
        differing = first.get("/api/v1/diff", params=asked).json()
    with closing(opened(tmp_path / "store")) as archive:
        second = serve(kitchens=("a", "b"), robots=("pr2",), archive=archive)
        after = [
            second.get(f"/api/v1/{what}?kitchen=a").json() for what in ("branches", "state", "satisfies")
        ]
        assert after == before
        assert len(after[0]) == 4
        opening = ["Opened", "NoLongerClosed", "UpperLimitReached"]
        assert [branch["events"] for branch in after[0]] == [[], opening, opening, after[0][-1]["events"]]
        assert "NoLongerOpen" in after[0][-1]["events"], "nine tenths of a higher limit are more"
        assert second.get("/api/v1/diff", params=asked).json() == differing
        assert any("closed → half open" in line for line in differing["sentences"]), differing
        assert second.get("/api/v1/branches?kitchen=b").json() == []
        present = f"SELECT ?branch {{ ?first <{SDT}presentBranch> ?branch }}"
        rows = second.query(present).json()["results"]["bindings"]
        assert [row["branch"]["value"] for row in rows] == [after[1]["branch"]]
        again = second.post("/api/v1/state", json={"kitchen": "a", "state": ["low_drawer=closed"]}).json()
        parents = {each["iri"]: each["parent"] for each in second.get("/api/v1/branches?kitchen=a").json()}
        assert parents[again["branch"]] == after[1]["branch"]
        unknown = second.get("/api/v1/diff", params=asked | {"after": "https://example.org/id/branch/0"})
        assert unknown.status_code == 404


def joint(served, container: str) -> str:
    found = served.get("/api/v1/containers?kitchen=a").json()["containers"]
    return next(each["joint"] for each in found if each["name"] == container)


def test_a_branch_that_did_not_fit_on_the_disk_is_there_when_it_is_asked_for_again(serve, tmp_path) -> None:
    journal = tmp_path / "store" / JOURNAL
    with closing(opened(tmp_path / "store")) as archive:
        first = serve(kitchens=("a",), robots=("pr2",), archive=archive)
        moved(first, "low_drawer=0.1")
        kept = told(first)
        limit = {"edit": {"entity": joint(first, "low_drawer"), "changes": {"upperLimit": 0.6}}}
        for more in (20, 20_000):  # bytes: none of its graphs is kept, some are
            with files_of_at_most(journal.stat().st_size + more):
                full = first.post("/api/v1/branch", json=limit)
            assert (full.status_code, "cannot be written" in full.json()["detail"]) == (503, True), full.text
            assert str(tmp_path) not in full.text
            assert told(first) == kept
        moved(first, "high_drawer=0.1")  # of the branch that failed nothing is said
        assert first.post("/api/v1/branch", json=limit).status_code == 201
        before = told(first)
    with closing(opened(tmp_path / "store")) as archive:
        assert told(serve(kitchens=("a",), robots=("pr2",), archive=archive)) == before


def test_another_model_begins_anew_and_the_first_one_goes_on_where_it_was(serve, tmp_path) -> None:
    def at_start(*robots: str) -> tuple[Any, Any]:
        with closing(opened(tmp_path / "store")) as archive:
            served = serve(kitchens=("a",), robots=robots, archive=archive)
            before = told(served)
            moved(served, "low_drawer=0.2")
            return before

    assert at_start("pr2")[0] == []
    assert at_start("pr2", "stretch")[0] == []
    branches, state = at_start("pr2")
    assert len(branches) == 2
    assert state["branch"] == branches[1]["iri"]


def refused(place: str, capsys: pytest.CaptureFixture[str]) -> tuple[int, str]:
    """How `sdt serve` ends over a store that it cannot take up."""
    model = str(FOLDER / "a.urdf")
    code = cli.run(["serve", "--http", "127.0.0.1:0", "--store", place, "--kitchen", model])
    return code, capsys.readouterr().err.splitlines()[-1]


def test_a_history_that_was_changed_is_refused(serve, tmp_path, capsys) -> None:
    with closing(opened(tmp_path / "store")) as archive:
        moved(serve(kitchens=("a",), archive=archive), "low_drawer=open")
        (move,) = [quad for quad in archive.dump() if quad.predicate == ox.NamedNode(f"{SDT}movedTo")]
        rest = [quad for quad in archive.graph(move.graph_name.value) if quad != move]
        forged = ox.Quad(move.subject, move.predicate, ox.Literal(0.1), move.graph_name)
        archive.replace(move.graph_name.value, [*rest, forged])
        with pytest.raises(GraphError, match="was changed"):
            serve(kitchens=("a",), archive=archive)
    code, said = refused(str(tmp_path / "store"), capsys)
    assert (code, "was changed" in said) == (2, True), said


def test_a_store_that_is_gone_is_said_in_a_line(capsys) -> None:
    code, said = refused(f"http://127.0.0.1:{free_port()}", capsys)
    assert (code, "is the server running?" in said) == (4, True), said


WRITER = """
import asyncio, itertools, sys
from services.http.kitchens import open_kitchens
from services.http.world import World
from services.store.files import opened
from services.store.workers import Workers

async def moving():
    world = World(open_kitchens((sys.argv[1],), ()), Workers(1), opened(sys.argv[2]))
    await world.start()
    for number in itertools.count():
        kitchen = await world.move("a", (f"low_drawer={0.001 * (number % 400 + 1):.3f}",))
        print(kitchen.present.iri, flush=True)

asyncio.run(moving())
"""
"""What `POST /api/v1/state` does, again and again, each time said when it is acknowledged."""


def test_every_state_that_was_acknowledged_is_there_after_kill_9(serve, tmp_path) -> None:
    command = [sys.executable, "-c", WRITER, str(FOLDER / "a.urdf"), str(tmp_path / "store")]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as writer:
        assert writer.stdout is not None
        first = writer.stdout.readline()
        time.sleep(0.2)
        assert writer.poll() is None, "it was done before it was killed"
        writer.send_signal(signal.SIGKILL)
        acknowledged = (first + writer.stdout.read()).decode().split()
    with closing(opened(tmp_path / "store")) as archive:
        branches, state = told(serve(kitchens=("a",), archive=archive))
    assert len(acknowledged) > 2
    known = [each["iri"] for each in branches]
    assert known[1:][: len(acknowledged)] == acknowledged
    assert len(known) <= 1 + len(acknowledged) + 1, "one that was not acknowledged, at most"
    assert state["branch"] in known[-2:]
