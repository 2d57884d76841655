"""What pages may have done, and by whom: asking, rechecking, signing in."""

from urllib.parse import parse_qs, urlsplit

import pytest
from fastapi import FastAPI

from services.http.pages.asking import MOST, Asking, Wish
from services.http.pages.kinds import Standing
from services.http.pages.session import COOKIE, local
from services.store.workers import BusyError
from tests.services.http.conftest import HOST
from tests.services.pages.conftest import PAGE, TOKEN, text_of, verdict_link

FORM = {"content-type": "application/x-www-form-urlencoded"} | PAGE
BEARER = {"authorization": f"Bearer {TOKEN}"}


def sign_in(served, token: str = TOKEN, back: str = "/verdicts"):
    answer = served.post("/sign-in", data={"token": token, "next": back}, headers=PAGE)
    served.client.cookies.clear()  # each test says itself what it sends
    return answer


def test_reading_needs_nothing_and_writing_needs_the_token(served) -> None:
    key = verdict_link(served, robot="pr2").rsplit("/", 1)[1]
    for address in ("/kitchens/a/ask", f"/verdicts/{key}/recheck"):
        for headers in (
            FORM,
            FORM | {"authorization": "Bearer wrong-token-of-some-length"},
            FORM | {"cookie": f"{COOKIE}=guess"},
        ):
            refused = served.post(address, content="case=/", headers=headers)
            assert refused.status_code == 401
            assert "this needs the token" in refused.text
    page = served.get("/kitchens/a", headers=PAGE).text
    assert "sign in to ask" in page
    assert 'name="case"' not in page


def test_who_knows_the_token_signs_in_and_out(served) -> None:
    wrong = sign_in(served, "another-token-of-some-length")
    assert wrong.status_code == 303
    assert parse_qs(urlsplit(wrong.headers["location"]).query)["wrong"] == ["1"]
    assert "set-cookie" not in wrong.headers
    right = sign_in(served)
    assert (right.status_code, right.headers["location"]) == (303, "/verdicts")
    cookie = right.headers["set-cookie"]
    assert all(part in cookie.lower() for part in ("httponly", "samesite=strict", "path=/"))
    assert TOKEN not in cookie
    session = FORM | {"cookie": cookie.partition(";")[0]}
    assert 'name="case"' in served.get("/kitchens/a", headers=session).text
    assert (
        served.post(
            "/api/v1/state", json={"state": ["all=open"]}, headers={"cookie": session["cookie"]}
        ).status_code
        == 401
    )
    served.post("/sign-out", content="next=/", headers=session)
    assert served.post("/kitchens/a/ask", content="case=/", headers=session).status_code == 401


@pytest.mark.parametrize(
    "address", ["//evil.example", "https://evil.example/", "/\\evil.example", "evil", "", "/\r\nX: y"]
)
def test_nobody_is_sent_elsewhere(served, address: str) -> None:
    assert local(address) == "/"
    assert sign_in(served, back=address).headers["location"] == "/"


def test_a_page_of_another_site_can_do_nothing(served) -> None:
    session = sign_in(served).headers["set-cookie"].partition(";")[0]
    for origin in ("https://evil.example", "null", f"http://{HOST}.evil.example"):
        refused = served.post(
            "/kitchens/a/ask", content="case=/", headers=FORM | {"cookie": session, "origin": origin}
        )
        assert refused.status_code == 403, origin


WRONG = {
    "case=pr2/nobody": (404, "no container named 'nobody'"),
    "case=zoo/low_drawer": (400, "no loaded robot 'zoo'"),
    "case=/&task=juggle": (400, "no task type 'juggle'"),
    "case=/&friction=much": (400, "'much' is no coefficient of friction"),
    "case=/&frction=0.3": (400, "no parameter 'frction'"),
    "case=/&state=low_drawer=77": (400, "low_drawer"),
}


@pytest.mark.parametrize("fields", WRONG)
def test_what_cannot_be_asked_is_told_and_nothing_is_judged(served, fields: str) -> None:
    status, words = WRONG[fields]
    before = served.world.version
    refused = served.post("/kitchens/a/ask", content=fields, headers=FORM | BEARER)
    assert refused.status_code == status
    assert words in refused.text.replace("\u200b", "").replace("&#39;", "'")
    assert served.world.version == before


def test_only_forms_are_taken_and_only_posted(served) -> None:
    assert served.post("/kitchens/a/ask", json={"case": "/"}, headers=BEARER).status_code == 415
    assert served.post("/kitchens/a/ask", content=b"case=%ff", headers=FORM | BEARER).status_code == 400
    assert served.get("/kitchens/a/ask", headers=PAGE).status_code == 405


def test_a_verdict_without_certificate_says_that_there_is_nothing_to_recheck(served) -> None:
    key = verdict_link(served, robot="pr2", outcome="certified").rsplit("/", 1)[1]
    found = served.post(f"/verdicts/{key}/recheck", content="", headers=FORM | BEARER)
    assert found.status_code == 400
    assert "nothing to recheck" in found.text
    assert served.get(f"/verdicts/{key}/artefact", headers=PAGE).status_code == 404
    assert served.post("/verdicts/0/recheck", content="", headers=FORM | BEARER).status_code == 400


def test_more_cases_than_may_wait_are_refused_together() -> None:
    asking = Asking(FastAPI())
    wishes = [Wish("a", "pr2", f"open:{index}", (), None) for index in range(MOST + 1)]
    with pytest.raises(BusyError, match="ask again later"):
        asking.ask(wishes)
    assert {asking.standing(each) for each in wishes} == {Standing.NOT_JUDGED}


async def endless():
    """A body that says no length and goes on for 300 MB, if anybody reads it."""
    for _ in range(300):
        yield bytes(2**20)


def test_a_form_of_300_mb_is_refused_as_a_page_before_it_is_read_and_the_pages_live_on(served) -> None:
    declared = FORM | BEARER | {"content-length": str(300 * 2**20)}
    told = served.post("/kitchens/a/ask", content=b"case=/", headers=declared)
    streamed = served.post("/kitchens/a/ask", content=endless(), headers=FORM | BEARER)
    for refused in (told, streamed):
        assert refused.status_code == 413
        assert refused.headers["content-type"] == "text/html; charset=utf-8"
        assert "the request is longer than 262144 bytes" in text_of(refused.text)
    assert served.get("/kitchens/a", headers=PAGE).status_code == 200
