"""A verdict in plain words over HTTP: by its IRI, or by the beginning of its hash, as on the command line."""

from collections import Counter

import pytest

from sdt_kg.iri import local_name

pytestmark = pytest.mark.oracle


@pytest.fixture(scope="module")
def served(serve):
    return serve(kitchens=("a",), robots=("pr2",))


@pytest.fixture(scope="module")
def hashes(served) -> list[str]:
    """Of more verdicts than there are first digits: two begin alike."""
    for verb in ("open", "close"):
        for drive in ("omni", "fixed"):
            body = {"task": verb, "drive": drive, "budget": 0.01}
            assert served.post("/api/v1/achieve", json=body).status_code == 200
    found = [local_name(each["iri"]) for each in served.get("/api/v1/verdicts").json()]
    assert len(found) > 16
    return found


def test_the_beginning_of_a_hash_will_do(served, hashes: list[str]) -> None:
    whole = hashes[0]
    iri = f"https://example.org/id/verdict/{whole}"
    told = served.get("/api/v1/why", params={"iri": iri}).json()
    assert told["iri"] == iri
    assert told["text"].startswith("\n".join((told["sections"][0]["title"], *told["sections"][0]["lines"])))
    for short in (whole[:12], f"id:verdict/{whole[:12]}", iri[:-40], whole):
        assert served.get("/api/v1/why", params={"iri": short}).json() == told, short
    one = served.get(f"/api/v1/verdicts/{whole[:12]}").json()
    assert (one["iri"], one["why"]) == (iri, told["text"])


def test_a_beginning_that_several_have_or_none_is_told(served, hashes: list[str]) -> None:
    ((digit, times),) = Counter(each[0] for each in hashes).most_common(1)
    assert times > 1
    for path in (f"why?iri={digit}", f"verdicts/{digit}"):
        answer = served.get(f"/api/v1/{path}")
        assert (answer.status_code, answer.json()["detail"]) == (404, f"no verdict named '{digit}'")
    for nothing in ("", "x", "id:verdict/", "https://example.org/id/verdict/", "https://example.org/id/pr2"):
        answer = served.get("/api/v1/why", params={"iri": nothing})
        assert (answer.status_code, "no verdict <" in answer.json()["detail"]) == (404, True), nothing
