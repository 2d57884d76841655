"""What is asked is counted under who answers it, and an answer has the id of its request."""

from tests.services.http.conftest import Serve


def test_metrics_count_what_was_asked_by_handler(serve: Serve) -> None:
    served = serve(kitchens=("a",))
    served.get("/api/v1/satisfies")
    served.get("/id/a/nothing")
    served.get("/graphs?graph=none")
    found = served.get("/metrics")
    assert found.headers["content-type"].startswith("text/plain; version=0.0.4")
    assert 'what="GET satisfies",end="answer"} 1' in found.text
    assert 'what="GET identified",end="404"} 1' in found.text
    assert "sdt_jobs_waiting 0" in found.text


def test_the_id_of_a_request_comes_back_unless_it_could_be_a_line_of_the_log(serve: Serve) -> None:
    served = serve()
    assert served.get("/healthz", headers={"X-Request-ID": "mine-1"}).headers["x-request-id"] == "mine-1"
    made = served.get("/healthz", headers={"X-Request-ID": 'x"} evil'}).headers["x-request-id"]
    assert len(made) == 32
