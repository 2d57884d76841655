"""A service that starts again has its branches, is where it was, and can compare them."""

import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import httpx
import pyoxigraph as ox
import pytest

from sdt_kg.errors import GraphError
from sdt_kg.iri import SDT
from services.store.files import opened
from tests.small import FOLDER

STARTED = 60.0
"""[s] For a service to listen, on a machine that does other things too."""

DRAWERS = ("low_drawer", "high_drawer")


def moved(served, *states: str) -> dict[str, object]:
    answer = served.post("/api/v1/state", json={"state": list(states)})
    assert answer.status_code == 200, answer.text
    return answer.json()


def told(served) -> tuple[object, object]:
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


def test_another_model_begins_anew_and_the_first_one_goes_on_where_it_was(serve, tmp_path) -> None:
    def at_start(*robots: str) -> tuple[object, object]:
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


def test_a_history_that_was_changed_is_refused(serve, tmp_path) -> None:
    with closing(opened(tmp_path / "store")) as archive:
        served = serve(kitchens=("a",), archive=archive)
        moved(served, "low_drawer=open")
        (move,) = [quad for quad in archive.dump() if quad.predicate == ox.NamedNode(f"{SDT}movedTo")]
        rest = [quad for quad in archive.graph(move.graph_name.value) if quad != move]
        forged = ox.Quad(move.subject, move.predicate, ox.Literal(0.1), move.graph_name)
        archive.replace(move.graph_name.value, [*rest, forged])
        with pytest.raises(GraphError, match="was changed"):
            serve(kitchens=("a",), archive=archive)


@contextmanager
def serving(store: Path) -> Iterator[tuple[httpx.Client, "subprocess.Popen[str]"]]:
    """`sdt serve` in a process of its own, with what it says of its address."""
    command = [sys.executable, "-m", "services.cli", "serve", "--http", "127.0.0.1:0", "--store", str(store)]
    models = ["--kitchen", str(FOLDER / "a.urdf")]
    with subprocess.Popen([*command, *models], stderr=subprocess.PIPE, text=True) as process:
        try:
            assert process.stderr is not None
            address = process.stderr.readline().split()[0]
            with httpx.Client(base_url=address, timeout=30) as client:
                end = time.monotonic() + STARTED
                while not _ready(client):
                    assert time.monotonic() < end, "it does not start"
                    time.sleep(0.05)
                yield client, process
        finally:
            process.kill()


def _ready(client: httpx.Client) -> bool:
    try:
        return client.get("/readyz").status_code == 200
    except httpx.TransportError:
        return False


def test_every_state_that_was_acknowledged_is_there_after_kill_9(tmp_path) -> None:
    acknowledged: list[dict[str, object]] = []
    with serving(tmp_path / "store") as (client, process):
        killer = threading.Timer(0.7, os.kill, (process.pid, signal.SIGKILL))
        killer.start()
        try:
            for number in range(10_000):
                acknowledged.append(moved(client, f"low_drawer={0.001 * (number % 400 + 1):.3f}"))
        except (httpx.TransportError, json.JSONDecodeError):
            assert process.wait() == -signal.SIGKILL
    assert len(acknowledged) > 2
    with serving(tmp_path / "store") as (client, _):
        known = [each["iri"] for each in client.get("/api/v1/branches").json()]
        state = client.get("/api/v1/state").json()
        there = {each["branch"] for each in acknowledged}
        assert there <= set(known)
        assert len(known) <= len(acknowledged) + 2, "what was not acknowledged is one branch at most"
        assert state == acknowledged[-1] or state["branch"] not in there
