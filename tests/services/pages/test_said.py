"""What pages over the small kitchen say."""

import csv
import io
import re
from contextlib import closing
from pathlib import Path
from urllib.parse import urlencode

import numpy as np
import pyoxigraph as ox
import pytest

from predicates.case import Case, Kind
from predicates.law import law
from sdt_kg.motion import Motion
from sdt_kg.task import Task, Verb
from services.http.pages.graph.console import examples, with_prefixes
from services.http.pages.verdicts import listing
from services.http.world import lines
from services.physics.oracle import Kinematics
from services.store.files import SavedVerdicts, opened
from services.store.workers import put
from tests.services.http.conftest import Serve
from tests.services.pages.conftest import LEFT_OPEN, PAGE, text_of, verdict_link
from tests.small import small_twin
from tests.small.far import TO_ITSELF, TO_KITCHEN, Far
from tests.small.lift import Lift

QUERY = """SELECT ?robot ?container WHERE {
  ?verdict law:robot ?robot ; law:container ?container
} ORDER BY ?container"""


def test_the_matrix_says_of_every_case_how_it_stands(served) -> None:
    data = served.get("/kitchens/a.json").json()
    cells = {(each["robot"], each["container"]): each for each in data["cells"]}
    assert len(cells) == 2 * 5
    assert cells["pr2", "low_drawer"]["standing"] == "certified"
    assert cells["stretch", "high_drawer"]["standing"] == "embodiment"
    assert cells["stretch", "high_drawer"]["proved"] is True
    assert "needs the lift at 1.3 m" in cells["stretch", "high_drawer"]["reason"]
    assert cells["stretch", "swing_door"]["standing"] == "out_of_scope"
    for container in LEFT_OPEN:
        assert cells["pr2", container]["standing"] == "not_judged"
    pr2 = next(each for each in data["robots"] if each["name"] == "pr2")
    assert (pr2["containers"], pr2["unjudged"], pr2["standings"]["certified"]) == (5, 2, 3)


def test_the_matrix_shows_no_verdict_about_another_question(served) -> None:
    def judged(query: str) -> int:
        cells = served.get(f"/kitchens/a.json?{query}").json()["cells"]
        return sum(each["verdict"] is not None for each in cells)

    assert judged("") == 8
    assert judged("task=close") == 0
    assert judged("state=low_drawer=open") == 0
    data = served.get("/kitchens/a.json?drive=differential").json()
    shown = [each for each in data["cells"] if each["verdict"]]
    assert {each["drive"] for each in shown} <= {"differential"}
    assert sum(data["with_other_drives"].values()) == 8 - len(shown)


def test_what_fails_in_several_ways_is_marked_alike_on_every_page(serve: Serve, tmp_path: Path) -> None:
    twin = small_twin("a", ("pr2",))
    drawer = twin.container("low_drawer")
    half = Motion(drawer.joint, np.array([0.0, 0.05]), np.array([[0.0], [0.2]]))  # and too fast
    (verdict,) = law(
        Case(twin, robot=twin.robots[0], task=Task(Verb.OPEN, drawer.iri), motion=half), Kinematics(), Lift()
    )
    path = tmp_path / "half.nq"
    with SavedVerdicts(str(path)) as saved:
        saved.add(verdict)
    with closing(opened(path)) as archive:
        served = serve(kitchens=("a",), robots=("pr2",), archive=archive)
        (row,) = served.get("/verdicts.json").json()["verdicts"]
        page = served.get(row["link"], headers=PAGE).text
    assert {each.kind for each in verdict.diagnoses} == {Kind.SEMANTIC, Kind.CAUSAL}
    assert row["kinds"] == ["causal", "semantic"]
    assert '<div class="hero k-causal">' in page
    assert re.findall(r'class="badge k-(\w+)"', page)[:2] == row["kinds"]


def test_a_margin_that_is_a_bound_says_so(serve: Serve, tmp_path: Path) -> None:
    twin = small_twin("a", ("pr2",))
    asked = Task(Verb.OPEN, twin.container("low_drawer").iri)
    (verdict,) = law(Case(twin, robot=twin.robots[0], task=asked), Kinematics(), Far())
    path = tmp_path / "far.nq"
    with SavedVerdicts(str(path)) as saved:
        saved.add(verdict)
    with closing(opened(path)) as archive:
        served = serve(kitchens=("a",), robots=("pr2",), archive=archive)
        link = served.get("/verdicts.json").json()["verdicts"][0]["link"]
        page, data = served.get(link, headers=PAGE).text, served.get(f"{link}.json").json()
    assert {each["name"]: each["at_least"] for each in data["margins"]} == {
        TO_KITCHEN: True,
        TO_ITSELF: False,
    }
    assert {each["name"]: each["nearest"] for each in data["margins"]} == {
        TO_KITCHEN: None,
        TO_ITSELF: {"links": ["base", "carriage"], "time": 1.25},
    }
    assert f"<dt>{TO_KITCHEN}</dt><dd>at least 0.02 m</dd>" in page
    assert f"<dt>{TO_ITSELF}</dt><dd>0.0145 m</dd>" in page


def test_the_state_of_a_view_is_in_its_address(served) -> None:
    text = served.get("/kitchens/a?task=close&show=certified&state=low_drawer%3Dopen", headers=PAGE).text
    assert "What can each robot close in kitchen a?" in text
    assert '<option value="certified" selected>' in text
    assert 'value="low_drawer=open"' in text
    assert "No container stands like that." in text
    assert re.search(r'href="(/kitchens/a\.csv\?[^"]*)"', text)[1].count("&amp;") == 2


@pytest.mark.parametrize(
    ("path", "near"),
    [
        ("/kitchens/a.json?drve=fixed", "drive"),
        ("/kitchens/a/containers.csv?states=all%3Dopen", "state"),
        ("/verdicts.csv?outcom=certified", "outcome"),
    ],
)
def test_a_misspelled_part_of_an_address_is_no_other_question(served, path: str, near: str) -> None:
    answer = served.get(path)
    assert (answer.status_code, answer.json()["allowed"]) == (400, f"did you mean '{near}'?")


def test_a_verdict_that_abstained_has_the_figures_of_its_shacl_result(served) -> None:
    link = verdict_link(served, robot="stretch", outcome="abstained")
    reasons = served.get(f"{link}.json").json()["diagnoses"]
    assert {(each["quantity"], each["value"], each["bound"]) for each in reasons} >= {
        ("lowerLimit", -1.0, 0.0)
    }
    page = served.get(link, headers=PAGE).text
    assert [cell in page for cell in ('<td class="number">-1</td>', '<td class="number">0</td>')] == [
        True
    ] * 2
    assert '/judging/1">the judging</a></dd>' in page, "no answer was asked for, so none is named after it"


def test_a_verdict_page_has_its_answers_reasons_evidence_and_provenance(served) -> None:
    link = verdict_link(served, robot="stretch", container="high_drawer")
    page, data = served.get(link, headers=PAGE).text, served.get(f"{link}.json").json()
    assert "Can stretch open high_" in page.replace("\u200b", "")
    assert "Proved: a sound bound excludes every motion" in page
    assert [each["holds"] for each in data["predicates"]] == [True, True, False]
    (reason,) = data["diagnoses"]
    assert (reason["kind"], reason["quantity"], reason["unit"], reason["proved"]) == (
        "embodiment",
        "position",
        "m",
        True,
    )
    assert reason["value"] > reason["bound"]
    assert data["inputs"]["physics"] in text_of(page)
    assert "No certificate or proof goes with this verdict: what it calls proved is a calculation" in page
    rows = list(csv.DictReader(io.StringIO(served.get(f"{link}.csv").text)))
    assert [row["reason"] for row in rows] == [reason["reason"]]
    graph = re.search(r'href="(/id/graph/verdict/[^"]+)\.ttl"', page)[1]
    for ending, media in (("ttl", "text/turtle"), ("jsonld", "application/ld+json")):
        found = served.get(f"{graph}.{ending}", headers=PAGE)
        assert (found.status_code, found.headers["content-type"].partition(";")[0]) == (200, media)


def test_an_abstention_shows_the_shape_that_is_violated(served) -> None:
    link = verdict_link(served, robot="stretch", container="swing_door")
    page, data = served.get(link, headers=PAGE).text, served.get(f"{link}.json").json()
    assert data["outcome"] == "abstained"
    assert {each["kind"] for each in data["diagnoses"]} == {"out_of_scope"}
    assert all(each["holds"] is None for each in data["predicates"])
    assert page.count("not asked") == 3
    assert "SHACL shape" in page
    assert "not proved" not in page  # nothing is claimed


def test_verdicts_are_selected_and_listed_some_at_a_time(served) -> None:
    def found(**wanted: str) -> list[dict]:
        return served.get("/verdicts.json", params=wanted).json()["verdicts"]

    every = found()
    assert len(every) == 8
    assert len(found(robot="stretch")) == 5
    assert {each["outcome"] for each in found(outcome="certified")} == {"certified"}
    assert {each["container"] for each in found(container="low_drawer")} == {"low_drawer"}
    assert found(kitchen="b") == []
    key = " ".join(["https://example.org/id/a", "https://example.org/id/a/body/low_drawer", "z"])
    later = found(after=key)
    assert later == every[len(every) - len(later) :]
    assert 0 < len(later) < len(every)


@pytest.mark.parametrize("sort", listing.SORTS)
def test_the_table_of_verdicts_to_take_along_is_whole_and_pages_lead_through_all_of_it(
    served, monkeypatch: pytest.MonkeyPatch, sort: str
) -> None:
    every = [each["verdict"] for each in served.get(f"/verdicts.json?sort={sort}").json()["verdicts"]]
    monkeypatch.setattr(listing, "PAGE", 3)
    rows = csv.DictReader(io.StringIO(served.get(f"/verdicts.csv?sort={sort}").text))
    assert [row["verdict"] for row in rows] == every
    led, following = list[str](), f"/verdicts.json?sort={sort}"
    while following:
        page = served.get(following).json()
        led, following = led + [each["verdict"] for each in page["verdicts"]], page["next"]
    assert led == every
    monkeypatch.setattr(listing, "MOST", 7)
    assert served.get(f"/verdicts.csv?sort={sort}").status_code == 413


def test_verdicts_are_sorted_by_the_column_that_the_address_names(served) -> None:
    def sorted_by(column: str) -> list:
        return [each[column] for each in served.get(f"/verdicts.json?sort={column}").json()["verdicts"]]

    assert sorted_by("robot") == ["pr2"] * 3 + ["stretch"] * 5
    assert sorted_by("outcome") == sorted(sorted_by("outcome"))
    seconds = sorted_by("seconds")
    assert seconds == sorted(seconds, reverse=True)
    page = served.get("/verdicts?sort=seconds&outcome=certified", headers=PAGE).text
    assert '<th scope="col" class="number" aria-sort="descending">Seconds' in page
    assert '<a href="/verdicts?outcome=certified&amp;sort=robot">Robot</a>' in page
    wrong = text_of(served.get("/verdicts?sort=price", headers=PAGE).text)
    assert "no column to sort by named 'price'" in wrong


def test_containers_are_sorted_by_the_column_that_the_address_names(served) -> None:
    def sorted_by(column: str) -> list:
        page = served.get(f"/kitchens/a/containers.json?sort={column}").json()
        return [each[column] for each in page["containers"]]

    assert sorted_by("name") == sorted(sorted_by("name"))
    assert sorted_by("upper") == sorted(sorted_by("upper"), reverse=True)
    assert len(set(sorted_by("upper"))) > 1
    page = served.get("/kitchens/a/containers?sort=upper", headers=PAGE).text
    assert '<th scope="col" class="number" aria-sort="descending">Upper' in page


def test_the_console_fills_in_prefixes_and_answers_in_a_table(served) -> None:
    page = served.get("/console?" + urlencode({"query": QUERY}), headers=PAGE).text
    assert "PREFIX law: &lt;https://example.org/law#&gt;\nSELECT" in page
    assert "8 rows" in page
    assert '<a href="/id/a/body/low_drawer"' in page
    rows = served.get("/console.csv?" + urlencode({"query": QUERY}))
    assert rows.headers["content-disposition"] == 'attachment; filename="answer.csv"'
    assert rows.text.splitlines()[0] == "robot,container"
    assert len(rows.text.splitlines()) == 9
    assert len(served.get("/console.json?" + urlencode({"query": QUERY})).json()["results"]["bindings"]) == 8


def test_prefixes_are_filled_in_only_where_they_are_used_and_not_declared() -> None:
    law = "PREFIX law: <https://example.org/law#>\n"
    assert with_prefixes("ASK { ?s law:robot ?r }") == f"{law}ASK {{ ?s law:robot ?r }}"
    for text in (
        f"{law}ASK {{ ?s law:robot ?r }}",
        'ASK { ?s ?p "law:robot" }',
        "ASK { ?s ?p <https://example.org/law#robot> } # sdt:x",
        "ASK { ?s ?p foo:bar }",
    ):
        assert with_prefixes(text) == text
    assert with_prefixes(with_prefixes("ASK { ?s a sdt:Door }")) == with_prefixes("ASK { ?s a sdt:Door }")


def test_every_question_of_the_console_is_answered(served) -> None:
    assert len(examples()) >= 20
    for example in examples():
        page = served.get("/console?" + urlencode({"query": example.text}), headers=PAGE)
        assert page.status_code == 200, example.name
        assert 'role="alert"' not in page.text, example.name


def test_the_console_tells_what_is_wrong_or_too_much(served) -> None:
    def answered(query: str) -> tuple[int, str]:
        found = served.get("/console?" + urlencode({"query": query}), headers=PAGE)
        return found.status_code, text_of(found.text)

    status, text = answered("SELECT ?s { SERVICE <http://e/> { ?s ?p ?o } }")
    assert status == 403
    assert "the query has a SERVICE" in text
    status, text = answered("SELEKT")
    assert status == 400
    assert "the query is not SPARQL that reads" in text
    status, text = answered("SELECT * { ?a a ?b . ?c a ?d . ?e a ?f }")
    assert status == 413
    assert "A page shows less than a download takes" in text
    assert answered("ASK { ?v law:outcome law:Certified }")[1].count("Yes") == 1
    assert "Turtle" in answered("CONSTRUCT WHERE { ?v law:robot ?robot }")[1]


def test_the_page_of_a_damaged_record_claims_nothing(served) -> None:
    key = "d" * 64
    verdict = ox.NamedNode(f"https://example.org/id/verdict/{key}")
    kind = ox.Triple(
        verdict,
        ox.NamedNode("http://www.w3.org/1999/02/22-rdf-syntax-ns#type"),
        ox.NamedNode("https://example.org/law#Verdict"),
    )
    served.apply(put(f"https://example.org/id/graph/verdict/{key}", lines([kind])))
    page = served.get(f"/id/verdict/{key}", headers=PAGE)
    assert page.status_code == 200
    assert "This record cannot be read" in page.text
    assert "certified" not in page.text.lower()
    assert "damage" in served.get(f"/id/verdict/{key}.json").json()


def test_a_page_asks_a_bounded_number_of_queries(served, monkeypatch) -> None:
    asked: list[object] = []
    real = served.world.workers.ask

    async def counted(question):
        asked.append(question)
        return await real(question)

    monkeypatch.setattr(served.world.workers, "ask", counted)
    link = verdict_link(served, robot="pr2", outcome="certified")
    for address, most in {
        "/": 1,
        "/kitchens/a": 2,
        "/kitchens/a/containers": 0,
        "/verdicts": 1,
        link: 2,
        "/id/a": 1,
    }.items():
        asked.clear()
        assert served.get(address, headers=PAGE).status_code == 200
        assert len(asked) <= most, address


def test_the_console_tells_names_that_are_not_there_beside_its_answer(served) -> None:
    def told(query: str) -> str:
        return text_of(served.get("/console?" + urlencode({"query": query}), headers=PAGE).text)

    assert "nothing here is called id:tiago:" in told("SELECT ?v { ?v law:robot id:tiago, id:pr2 }")
    assert "law:outcom is no term of the ontology" in told("SELECT ?v { ?v law:outcom ?o }")
    assert "is called" not in told("SELECT ?v { ?v law:robot id:pr2 }")
