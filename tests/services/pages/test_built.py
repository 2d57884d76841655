"""How pages are built: for keyboards and readers, from here alone, in every form; and their errors."""

import csv
import io
import re
from html.parser import HTMLParser
from urllib.parse import urlencode

import pytest

from tests.services.pages.conftest import PAGE, text_of, verdict_link

QUERY = "SELECT ?robot WHERE { ?verdict law:robot ?robot }"
TABLES = ("/index", "/kitchens/a", "/kitchens/a/containers", "/verdicts", "/id/a/body/low_drawer")
"""Pages which are tables, as their data are addressed."""


class Page(HTMLParser):
    """What of a page can be wrong without being seen."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.feed(text)

    def handle_starttag(self, tag, attrs) -> None:
        self.tags.append((tag, dict(attrs)))

    def of(self, tag: str) -> list[dict[str, str | None]]:
        return [attributes for name, attributes in self.tags if name == tag]


@pytest.fixture(scope="module")
def pages(served) -> dict[str, str]:
    """Every kind of page, by its address."""
    addresses = [
        "/",
        "/kitchens/a",
        "/kitchens/a/containers",
        "/verdicts",
        "/tasks",
        "/id/a",
        "/id/a/body/low_drawer",
        "/about?" + urlencode({"iri": "https://example.org/law#Certified"}),
        verdict_link(served, robot="pr2", outcome="certified"),
        verdict_link(served, robot="stretch", outcome="not_certified"),
        verdict_link(served, robot="stretch", outcome="abstained"),
        "/console",
        "/console?" + urlencode({"query": QUERY}),
        "/console?" + urlencode({"query": "SELEKT"}),
        "/sign-in",
        "/kitchens/zoo",
    ]
    return {each: served.get(each, headers=PAGE).text for each in addresses}


def test_every_page_is_built_for_keyboards_and_readers(pages) -> None:
    for address, text in pages.items():
        page = Page(text)
        assert page.of("html")[0]["lang"] == "en", address
        assert len(page.of("h1")) == 1, address
        assert len(page.of("main")) == 1, address
        assert page.tags[[tag for tag, _ in page.tags].index("body") + 1] == (
            "a",
            {"class": "skip", "href": "#main"},
        )
        assert all(each.get("scope") in {"col", "row"} for each in page.of("th")), address
        assert all(
            {"tabindex", "aria-label"} <= each.keys()
            for each in page.of("div")
            if each.get("class") == "scroll"
        )
        ids = [each["id"] for _, each in page.tags if "id" in each]
        assert len(ids) == len(set(ids)), address
        labelled = re.findall(r"<label[^>]*>.*?</label>", text, re.DOTALL)
        fields = [
            each
            for tag in ("input", "select", "textarea")
            for each in page.of(tag)
            if each.get("type") != "hidden"
        ]
        named = {each["for"] for each in page.of("label") if "for" in each}
        inside = sum(len(re.findall(r"<(?:input|select|textarea)", each)) for each in labelled)
        assert inside + sum(each.get("id") in named for each in fields) == len(fields), address


def test_pages_ask_for_nothing_from_elsewhere_and_have_no_script_but_ours(pages) -> None:
    for address, text in pages.items():
        page = Page(text)
        asked = [
            each.get("src") or each.get("href") for tag in ("script", "link", "img") for each in page.of(tag)
        ]
        assert asked, address
        assert all(each and each.startswith("/static/") for each in asked), address
        assert "<style" not in text, address
        assert not any({"style", "onclick", "onsubmit"} & each.keys() for _, each in page.tags), address
        assert "<script>" not in text, address


def test_policies_forbid_what_pages_do_not_need(served) -> None:
    matrix = served.get("/kitchens/a", headers=PAGE).headers["content-security-policy"]
    other = served.get("/id/a", headers=PAGE).headers["content-security-policy"]
    assert "script-src 'self'" in matrix
    assert "script-src" not in other
    for policy in (matrix, other):
        assert "default-src 'none'" in policy
        assert "unsafe" not in policy


def test_static_files_are_kept_under_the_hash_of_their_content(served, pages) -> None:
    for address in set(re.findall(r'(?:src|href)="(/static/[^"]+)"', "".join(pages.values()))):
        found = served.get(address)
        assert found.status_code == 200
        assert "immutable" in found.headers["cache-control"]
    assert served.get("/static/..%2fapp.py").status_code == 404


def test_what_a_resource_says_of_itself_is_told_once(served) -> None:
    rows = served.get("/id/a/body/low_drawer.csv").text.splitlines()
    assert [each for each in rows if each.count("/id/a/body/low_drawer,") == 2]  # it has itself as a body
    assert len(rows) == len(set(rows))


@pytest.mark.parametrize("stem", TABLES)
def test_json_and_csv_say_the_same(served, stem: str) -> None:
    data = served.get(f"{stem}.json")
    rows = list(csv.DictReader(io.StringIO(served.get(f"{stem}.csv").text)))
    assert data.headers["content-type"] == "application/json"
    assert rows
    listed = next(value for value in _lists(data.json()) if len(value) == len(rows))
    for row, item in zip(rows, listed, strict=True):
        told = {name: _as_csv(item[name]) for name in row if name in item}
        assert told.items() <= row.items()
        assert len(told) >= 4


def _lists(data: dict) -> list[list[dict]]:
    lists = [
        value for value in data.values() if isinstance(value, list) and value and isinstance(value[0], dict)
    ]
    return [*lists, [each for value in lists for each in value]]


def _as_csv(value: object) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, list):
        return " ".join(map(str, value))
    return "" if value is None else str(value)


def test_the_form_follows_what_the_reader_accepts(served) -> None:
    for accept, media in (
        ("text/html", "text/html; charset=utf-8"),
        ("*/*", "text/html; charset=utf-8"),
        ("application/json", "application/json"),
        ("text/csv, text/html;q=0.5", "text/csv; charset=utf-8"),
    ):
        found = served.get("/kitchens/a", headers={"accept": accept})
        assert (found.status_code, found.headers["content-type"]) == (200, media)
    assert served.get("/kitchens/a", headers={"accept": "image/png"}).status_code == 406


ERRORS = {
    "/kitchens/zoo": (404, "no kitchen named 'zoo'"),
    "/kitchens/a?task=juggle": (400, "no task type 'juggle'"),
    "/kitchens/a?drive=fly": (400, "no drive 'fly'"),
    "/kitchens/a?state=nobody=open": (404, "no joint"),
    "/kitchens/a?state=low_drawer=77": (400, "low_drawer"),
    "/kitchens/a?show=everything": (400, "no 'show' of 'everything'"),
    "/verdicts?outcome=maybe": (404, "no outcome named 'maybe'"),
    "/id/verdict/0": (404, "nothing is known about"),
    "/about": (400, "is no IRI"),
    "/about?iri=%3Cscript%3E": (400, "is no IRI"),
    "/console.csv": (400, "there is no parameter 'query'"),
    "/verdicts/0/artefact": (404, "no verdict"),
    "/nowhere": (404, "GET /nowhere"),
}


@pytest.mark.parametrize("address", ERRORS)
def test_errors_on_pages_have_the_words_that_machines_get(served, address: str) -> None:
    status, words = ERRORS[address]
    problem = served.get(address, headers={"accept": "application/problem+json, application/json"})
    page = served.get(address, headers=PAGE)
    assert problem.status_code == page.status_code == status
    document = problem.json()
    assert words in document["detail"]
    text = text_of(page.text)
    for part in ("detail", "allowed", "remedy"):
        assert document.get(part, "") in text


def test_what_somebody_wrote_is_text_on_every_page(served) -> None:
    evil = "<script>alert(1)</script>"
    for address in (
        "/verdicts?" + urlencode({"container": evil, "kitchen": "a"}),
        "/console?" + urlencode({"query": f"# {evil}\nSELECT ('{evil}' AS ?x) {{}}"}),
        "/kitchens/a?" + urlencode({"state": f"{evil}=1"}),
        "/sign-in?" + urlencode({"next": f'/"{evil}'}),
        "/kitchens/" + evil,
    ):
        assert evil not in served.get(address, headers=PAGE).text, address
