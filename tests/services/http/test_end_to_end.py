"""`sdt serve` as a process on a real socket: a verdict from question to SPARQL, and how it ends."""

import json
import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import httpx
import pytest

from predicates.case import Outcome
from predicates.record import read_verdicts
from predicates.record.caused import caused_json
from services import connect, load
from services.store.files import opened
from tests.ports import free_endpoint
from tests.services.http.canary import singing
from tests.small import FOLDER

TOKEN = "a-token-of-decent-length"  # noqa: S105 - of a test
TASK = "open:sink_area_left_middle_drawer_main"
OTHER = "sink_area_left_upper_drawer_main"
SERVE = (
    sys.executable,
    "-m",
    "services.cli",
    "serve",
    "--http",
    "127.0.0.1:0",
    "--kitchen",
    "b",
    "--robot",
    "pr2",
)


OF_FILES = {"b": str(FOLDER / "b.urdf"), "pr2": str(FOLDER / "pr2.urdf")}
SERVE_SMALL = tuple(OF_FILES.get(word, word) for word in SERVE)
"""The same of a small kitchen and a lift, for who asks nothing about them."""


@pytest.fixture
def endpoint() -> str:
    return free_endpoint()


@pytest.fixture
def service(tmp_path: Path, endpoint: str) -> Iterator[httpx.Client]:
    environment = os.environ | {"SDT_TOKEN": TOKEN}
    command = [*SERVE, "--store", str(tmp_path / "store"), "--bus", endpoint]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env=environment)
    assert process.stderr is not None
    try:
        said = process.stderr.readline()
        found = re.match(r"http://127\.0\.0\.1:\d+", said)
        assert found, said
        # The token is HTTP's.
        assert f"bus at {endpoint}; whoever can reach it may ask" in process.stderr.readline()
        headers = {"authorization": f"Bearer {TOKEN}"}
        with httpx.Client(base_url=found[0], headers=headers, timeout=180) as client:
            yield client
    finally:
        process.send_signal(signal.SIGINT)
        rest = process.communicate(timeout=60)[1]
    assert "Traceback" not in rest
    with closing(opened(tmp_path / "store")) as store:
        assert any(each.outcome is Outcome.CERTIFIED for each in read_verdicts(store.dump()))


@pytest.mark.oracle
def test_a_verdict_from_question_to_sparql_and_over_the_bus(service: httpx.Client, endpoint: str) -> None:
    asked = {"task": TASK, "robot": "pr2", "drive": "omni", "motions": True, "seconds": 120}
    made = service.post("/api/v1/achieve", json=asked).json()
    (verdict,), (motion,) = made["verdicts"], made["motions"]
    assert verdict["outcome"] == "certified"
    again = service.post("/api/v1/achieve", json=asked | {"motions": False}).json()
    assert again["verdicts"][0]["iri"] == verdict["iri"]
    with connect("b", endpoint) as bus:
        (over,) = bus.achieve(TASK, "pr2", drive="omni").objects
        assert (over["iri"], over["stored"]) == (verdict["iri"], True)
    checked = service.post("/api/v1/achieve", json=asked | {"motion": motion, "motions": False}).json()
    assert checked["verdicts"][0]["outcome"] == "certified"
    assert checked["verdicts"][0]["iri"] != verdict["iri"]
    motion["robot_positions"][len(motion["times"]) // 2][0] += 0.3
    broken = service.post("/api/v1/achieve", json=asked | {"motion": motion, "motions": False})
    assert broken.status_code == 400 or broken.json()["verdicts"][0]["outcome"] == "not_certified"

    query = f"SELECT ?robot {{ <{verdict['iri']}> law:outcome law:Certified ; law:robot ?robot }}"
    (row,) = service.get("/sparql", params={"query": query}).json()["results"]["bindings"]
    assert row["robot"]["value"].endswith("/pr2")
    listed = service.get("/api/v1/verdicts", params={"robot": "pr2", "outcome": "certified"}).json()
    assert {verdict["iri"], checked["verdicts"][0]["iri"]} == {each["iri"] for each in listed}
    assert service.get("/api/v1/verdicts", params={"container": "iai_fridge_door"}).json() == []
    told = service.get("/api/v1/why", params={"iri": verdict["iri"]}).json()["text"]
    assert "CERTIFIED" in told
    page = service.get("/id/verdict/" + verdict["iri"].rsplit("/", 1)[1], headers={"accept": "text/html"})
    assert "CERTIFIED" in page.text

    needs = f"""SELECT ?outcome WHERE {{ ?v law:robot id:pr2 ; law:outcome ?outcome ; law:task ?t ;
      law:container <https://example.org/id/b/body/{OTHER}> . ?t law:verb law:Open }}"""
    assert service.get("/sparql", params={"query": needs}).json()["results"]["bindings"] == []
    computed = service.post("/api/v1/query", json={"query": needs, "budget": 120, "limit": 1}).json()
    assert [each["container"] for each in computed["computed"]["ran"]] == [OTHER]
    assert len(computed["results"]["results"]["bindings"]) == 1

    late = service.post("/api/v1/achieve", json={"task": "close", "seconds": 0.2, "state": ["all=open"]})
    assert late.status_code == 504
    with singing() as canary:
        wrong = service.post("/api/v1/achieve", json={"task": f"open:{canary.url}"})
        assert wrong.status_code == 400
        assert canary.hits == []
    caused = service.post("/api/v1/causes", json={"task": TASK}).json()
    assert [each["holds"] for each in caused] == [True]
    here = load("b").causes(TASK)
    told = json.loads(json.dumps([caused_json(answer, "d_artic") for answer in here]))
    assert [{name: each[name] for name in told[0]} for each in caused] == told
    assert json.dumps(caused[0]["motion"])


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_what_was_kept_in_a_file_is_written_when_the_service_is_told_to_end(
    tmp_path: Path, number: signal.Signals
) -> None:
    file = tmp_path / "kept.nq"
    before = signal.signal(number, signal.SIG_DFL)  # under nohup a closed terminal is ignored
    process = subprocess.Popen([*SERVE_SMALL, "--store", str(file)], stderr=subprocess.PIPE, text=True)
    signal.signal(number, before)
    assert process.stderr is not None
    found = re.match(r"http://127\.0\.0\.1:\d+", process.stderr.readline())
    assert found
    with httpx.Client(base_url=found[0], timeout=60) as client:
        branch = client.post("/api/v1/state", json={"state": ["top_drawer=open"]}).json()["branch"]
    process.send_signal(number)
    rest = process.communicate(timeout=60)[1]
    assert process.returncode == 128 + signal.SIGTERM, rest
    assert branch in file.read_text(encoding="utf-8")
