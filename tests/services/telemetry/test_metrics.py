"""What Prometheus reads is what was counted; logs and spans name the request, and stay on the machine."""

import io
import json
import logging
from pathlib import Path

import pytest

from services.telemetry import logs
from services.telemetry.metrics import Judged, Metrics
from services.telemetry.origin import Origin, within
from services.telemetry.spans import NoSpans, SpansInFile

TRACE = "0af7651916cd43dd8448eb211c80319c"


def lines(metrics: Metrics) -> set[str]:
    return set(metrics.text().splitlines())


def test_requests_are_counted_by_how_they_ended_and_timed_in_buckets() -> None:
    metrics = Metrics()
    metrics.asked("bus", "ask", "answer", 0.002)
    metrics.asked("bus", "ask", "answer", 0.3)
    metrics.asked("bus", "ask", "deadline", 9999.0)
    found = lines(metrics)
    assert 'sdt_requests_total{surface="bus",what="ask",end="answer"} 2' in found
    assert 'sdt_requests_total{surface="bus",what="ask",end="deadline"} 1' in found
    assert 'sdt_request_seconds_bucket{surface="bus",what="ask",le="0.001"} 0' in found
    assert 'sdt_request_seconds_bucket{surface="bus",what="ask",le="0.0025"} 1' in found
    assert 'sdt_request_seconds_bucket{surface="bus",what="ask",le="120"} 2' in found
    assert 'sdt_request_seconds_bucket{surface="bus",what="ask",le="+Inf"} 3' in found
    assert 'sdt_request_seconds_count{surface="bus",what="ask"} 3' in found


def test_a_stored_verdict_is_a_hit_and_its_steps_are_not_timed_again() -> None:
    metrics = Metrics()
    steps = {"causes": 0.01}
    metrics.judged([Judged("certified", False, steps), Judged("certified", True, steps)])
    found = lines(metrics)
    assert 'sdt_verdicts_total{outcome="certified",stored="true"} 1' in found
    assert 'sdt_step_seconds_count{step="causes"} 1' in found


def test_a_label_cannot_break_out_of_its_quotes() -> None:
    metrics = Metrics()
    metrics.asked("http", 'GET /"\n\\', "answer", 0.1)
    assert 'sdt_requests_total{surface="http",what="GET /\\"\\n\\\\",end="answer"} 1' in lines(metrics)


@pytest.mark.usefixtures("loggers")
def test_a_line_of_the_log_is_an_object_with_the_request(monkeypatch: pytest.MonkeyPatch) -> None:
    out = io.StringIO()
    monkeypatch.setattr("sys.stderr", out)
    logs.configure(logs.Form.JSON)
    with within(Origin("r1")):
        logging.getLogger("sdt").info("done", extra={"fields": {"status": 200}})
    assert logs.is_json()
    said = json.loads(out.getvalue())
    assert (said["request"], said["status"], said["message"], said["level"]) == ("r1", 200, "done", "info")


def test_a_span_is_below_the_callers_and_goes_to_the_file(tmp_path: Path) -> None:
    file = tmp_path / "spans.jsonl"
    spans = SpansInFile(file)
    outer = spans.begin("GET /", f"00-{TRACE}-b7ad6b7169203331-01")
    inner = spans.begin("judge canachieve", outer.traceparent, twin="b")
    inner.end(request="r1")
    outer.end(status=200)
    spans.close()
    below, above = (json.loads(line) for line in file.read_text().splitlines())
    assert above["context"]["trace_id"] == below["context"]["trace_id"] == f"0x{TRACE}"
    assert above["parent_id"] == "0xb7ad6b7169203331"
    assert below["parent_id"] == above["context"]["span_id"]
    assert below["attributes"] == {"twin": "b", "request": "r1"}


def test_without_a_file_nothing_is_recorded_and_the_callers_trace_is_handed_on() -> None:
    assert NoSpans().begin("x", "00-a-b-01").traceparent == "00-a-b-01"
