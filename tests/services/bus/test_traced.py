"""A question over the bus is a span below its asker's, and what a process does for it one below that."""

import json
from pathlib import Path

import pytest

from services.bus.sessions import open_session
from services.telemetry.spans import SpansInFile
from services.telemetry.told import Telemetry
from tests.ports import free_endpoint
from tests.services.bus.served import small

TRACE, SPAN = "0af7651916cd43dd8448eb211c80319c", "b7ad6b7169203331"


@pytest.mark.oracle
def test_a_question_and_what_is_judged_for_it_are_spans_of_the_askers_trace(tmp_path: Path) -> None:
    file, endpoint = tmp_path / "spans.jsonl", free_endpoint()
    spans = SpansInFile(file)
    attachment = json.dumps({"id": "r1", "traceparent": f"00-{TRACE}-{SPAN}-01"})
    with (
        open_session(listen=endpoint) as session,
        small(session, Telemetry(spans=spans)),
        open_session(connect=endpoint, mode="client") as client,
    ):
        for verb, payload in (("satisfies", "{}"), ("ask", "{")):
            assert list(
                client.get(f"sdt/v1/a/rpc/{verb}", payload=payload, attachment=attachment, timeout=60)
            )
    spans.close()
    told = {each["name"]: each for each in map(json.loads, file.read_text().splitlines())}
    asked, judged, refused = told["bus satisfies"], told["judge satisfies"], told["bus ask"]
    assert {each["context"]["trace_id"] for each in told.values()} == {f"0x{TRACE}"}
    assert asked["parent_id"] == refused["parent_id"] == f"0x{SPAN}"
    assert judged["parent_id"] == asked["context"]["span_id"]
    assert asked["attributes"] == {"twin": "a", "request": "r1", "end": "answer"}
    assert refused["attributes"]["end"] == "invalid-request"
    assert judged["attributes"]["request"] == "r1"
