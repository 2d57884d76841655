"""JSON verbs over the small kitchen: what they answer, what they write, and who may."""

from contextlib import closing

import pyoxigraph as ox
import pytest

from sdt_kg.iri import ID, SDT
from services.store.files import opened
from services.store.workers import Asked, Delta, put
from tests.services.http.canary import singing

TOKEN = "a-token-of-decent-length"  # noqa: S105 - of a test
BEARER = {"authorization": f"Bearer {TOKEN}"}
WRITES = {
    "/api/v1/state": {"state": ["DRAWER=open"]},
    "/api/v1/branch": {"state": ["DRAWER=open"]},
    "/api/v1/observation": {"positions": {"JOINT": 0.1}, "time": "2026-01-31T12:00:00Z", "by": "camera"},
    "/api/v1/achieve": {"task": "open"},
    "/api/v1/causes": {"task": "open"},
    "/api/v1/task": {"task": "open_then_close"},
    "/api/v1/place": {"task": "open:DRAWER"},
    "/api/v1/whatif": {"task": "open:DRAWER", "edits": ["drive:fixed"]},
}
POSITION = "SELECT ?o WHERE {{ <{joint}> sdt:position ?o }}"


@pytest.fixture(scope="module")
def served(serve):
    return serve(kitchens=("a",), robots=("pr2",), token=TOKEN)


@pytest.fixture(scope="module")
def drawer(served):
    return next(
        each for each in served.get("/api/v1/containers").json()["containers"] if each["kind"] == "drawer"
    )


def position(served, drawer, **parts: object) -> list[float]:
    answer = served.query(POSITION.format(joint=drawer["joint"]), **parts)
    return [float(row["o"]["value"]) for row in answer.json()["results"]["bindings"]]


def moved(served, drawer, value: str):
    return served.post("/api/v1/state", json={"state": [f"{drawer['name']}={value}"]}, headers=BEARER)


@pytest.mark.parametrize("path", WRITES)
def test_who_writes_or_computes_needs_the_token(served, path: str) -> None:
    for headers in (
        {},
        {"authorization": "Bearer wrong-token-of-some-length"},
        {"authorization": f"Basic {TOKEN}"},
    ):
        answer = served.post(path, json=WRITES[path], headers=headers)
        assert answer.status_code == 401
        assert answer.headers["www-authenticate"].startswith("Bearer")


@pytest.mark.parametrize(("path", "allowed"), [("state", "GET, POST"), ("branch", "POST"), ("why", "GET")])
def test_a_method_that_a_verb_has_not_is_refused_with_all_that_it_has(
    served, path: str, allowed: str
) -> None:
    answer = served.request("PUT", f"/api/v1/{path}", headers=BEARER)
    assert (answer.status_code, answer.headers["allow"]) == (405, allowed)


def test_reading_needs_no_token(served) -> None:
    for path in ("kitchens", "containers?left_out=true", "satisfies", "state", "branches", "verdicts"):
        assert served.get(f"/api/v1/{path}").status_code == 200, path


@pytest.mark.parametrize(
    "path", ["/api/v1/state", "/api/v1/verdicts", "/sparql?query=ASK{}", "/graphs?default", "/"]
)
def test_no_cache_may_guess_for_how_long_an_answer_holds(served, path: str) -> None:
    assert served.get(path).headers["cache-control"] == "no-cache"


def test_a_state_becomes_the_present_and_the_past_stays(served, drawer) -> None:
    before = served.get("/api/v1/state").json()
    after = moved(served, drawer, "open").json()
    assert position(served, drawer) == [pytest.approx(drawer["upper"])]
    old = served.get("/graphs", params={"graph": before["graph"]})
    assert drawer["joint"].rsplit("/", 1)[1] in old.text
    assert {"task": "open", "container": drawer["name"]} in served.get("/api/v1/satisfies").json()
    branch, graph = after["branch"], after["graph"]
    chain = f"ASK {{ <{branch}> a sdt:Branch ; prov:wasDerivedFrom ?before ; sdt:stateGraph <{graph}> }}"
    assert served.query(chain).json()["boolean"]
    assert moved(served, drawer, "closed").status_code == 200
    assert position(served, drawer) == [pytest.approx(drawer["lower"])]
    assert served.get("/api/v1/state").json()["graph"] == before["graph"]


def test_no_query_sees_two_states_or_a_branch_that_is_not_the_state(
    served, drawer, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert moved(served, drawer, "open").status_code == 200
    there = f"""SELECT ?at ?said WHERE {{ <{drawer["joint"]}> sdt:position ?at .
      ?first sdt:presentBranch/sdt:stateGraph ?state .
      GRAPH ?state {{ <{drawer["joint"]}> sdt:position ?said }} }}"""
    workers, seen = served.world.workers, list[list[str]]()
    apply = workers.apply

    async def watched(delta: Delta) -> None:
        await apply(delta)
        answered = await workers.ask(Asked("query", there, accepted=("text/csv",)))
        seen.append(answered.body.decode().split()[1:])

    monkeypatch.setattr(workers, "apply", watched)
    assert moved(served, drawer, "closed").status_code == 200
    assert [len(rows) for rows in seen] == [1] * len(seen)
    assert [row.split(",")[0] == row.split(",")[1] for (row,) in seen] == [True] * len(seen)
    assert seen[0] != seen[-1]


def test_a_branch_changes_nothing_but_can_be_asked(served, drawer) -> None:
    before = position(served, drawer)
    body = {"state": [f"{drawer['name']}=open"]}
    made = served.post("/api/v1/branch", json=body, headers=BEARER)
    assert made.status_code == 201
    assert position(served, drawer) == before
    there = served.get(
        "/sparql",
        params={
            "query": POSITION.format(joint=drawer["joint"]),
            "default-graph-uri": made.json()["state_graph"],
        },
    )
    assert float(there.json()["results"]["bindings"][0]["o"]["value"]) == pytest.approx(drawer["upper"])
    limit = {"entity": drawer["joint"], "changes": {"upperLimit": drawer["upper"] / 2}}
    narrow = served.post("/api/v1/branch", json={"edit": limit, "parent": None}, headers=BEARER)
    assert narrow.status_code == 201
    again = served.post("/api/v1/branch", json={"edit": limit}, headers=BEARER).json()
    assert again["iri"] == narrow.json()["iri"]
    assert position(served, drawer) == before
    assert len(served.get("/api/v1/branches").json()) >= 3


def test_an_observation_is_kept_in_its_own_graph_and_moves_nothing(served, drawer) -> None:
    joint = drawer["joint"].rsplit("/", 1)[1]
    body = {"positions": {joint: 0.25}, "time": "2026-01-31T12:00:00+01:00", "by": "camera <1>"}
    before = position(served, drawer)
    kept = served.post("/api/v1/observation", json=body, headers=BEARER)
    assert kept.status_code == 201
    assert position(served, drawer) == before
    query = """SELECT ?o WHERE {{ GRAPH <{graph}> {{
      ?s <http://www.w3.org/ns/sosa/hasFeatureOfInterest> <{joint}> ;
         <http://www.w3.org/ns/sosa/hasSimpleResult> ?o }} }}"""
    rows = served.query(query.format(graph=kept.json()["graph"], joint=drawer["joint"])).json()["results"]
    assert [float(row["o"]["value"]) for row in rows["bindings"]] == [0.25]


def test_a_verdict_is_about_the_class_that_was_asked_for(served, drawer) -> None:
    body = {"task": f"open:{drawer['name']}", "tee": "d_artic_dyn", "budget": 2}
    (verdict,) = served.post("/api/v1/achieve", json=body, headers=BEARER).json()["verdicts"]
    assert (verdict["tee_class"], verdict["outcome"]) == ("D_artic_dyn", "abstained")
    assert "hasForceModel" in verdict["diagnoses"][0]["reason"]


def test_what_is_asked_of_fingers_is_asked_of_the_motion(served, drawer) -> None:
    body = {"task": f"open:{drawer['name']}", "friction": 0.3, "contact": 0.001, "budget": 2}
    (verdict,) = served.post("/api/v1/achieve", json=body, headers=BEARER).json()["verdicts"]
    assert "holds that need friction of more than 0.3 are refused: as asked" in verdict["notes"]
    assert any("may be 1 mm from the handle" in note for note in verdict["notes"])


BAD = {
    "force without its class": ("causes", {"task": "open", "handle_force": 20}, 400),
    "force that is none": ("achieve", {"task": "open", "tee": "d_artic_dyn", "handle_force": 0}, 422),
    "friction of none": ("achieve", {"task": "open", "friction": 0}, 422),
    "two starts": ("achieve", {"task": "open", "any_start": True, "base": [0.0, 0.0, 0.0]}, 400),
    "unknown class": ("achieve", {"task": "open", "tee": "d_rigid"}, 422),
    "unknown kitchen": ("state", {"kitchen": "zoo", "state": ["all=open"]}, 404),
    "unknown joint": ("state", {"state": ["nobody=open"]}, 404),
    "outside the limits": ("state", {"state": ["all=77"]}, 400),
    "no state": ("state", {"state": []}, 422),
    "unknown field": ("state", {"state": ["all=open"], "update": "DROP ALL"}, 422),
    "verdict of one's own": ("verdicts", {"outcome": "certified"}, 405),
    "both": ("branch", {"state": ["all=open"], "edit": {"entity": "x", "changes": {"upperLimit": 1}}}, 400),
    "unknown property": ("branch", {"edit": {"entity": "x", "changes": {"evil": 1}}}, 404),
    "unknown parent": ("branch", {"state": ["all=open"], "parent": f"{ID}branch/0"}, 404),
    "not a number": ("observation", WRITES["/api/v1/observation"] | {"positions": {"x": "NaN"}}, 422),
    "no zone": ("observation", WRITES["/api/v1/observation"] | {"time": "2026-01-31T12:00:00"}, 400),
    "observed nobody": ("observation", WRITES["/api/v1/observation"], 404),
    "unknown task": ("task", {"task": "dance"}, 400),
    "file as a task": ("task", {"task": "/etc/passwd"}, 400),
    "a seed below 0": ("achieve", {"task": "open", "seed": -1}, 422),
    "a seed that cannot be kept": ("task", {"task": "open_then_close", "seed": 2**63}, 422),
    "another question in the URL": ("achieve?robot=stretch", {"task": "open"}, 400),
    "a text for a number": ("achieve", {"task": "open", "seconds": "20"}, 422),
    "a truth for a number": ("observation", WRITES["/api/v1/observation"] | {"positions": {"x": True}}, 422),
    "a text for a truth": ("achieve", {"task": "open", "motions": "no"}, 422),
    "texts in a base": ("achieve", {"task": "open", "base": ["0", "0", "0"]}, 422),
    "seconds for a time": ("observation", WRITES["/api/v1/observation"] | {"time": 0}, 422),
    "no number of seconds": ("achieve", {"task": "open", "seconds": 1e9}, 422),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_named_and_writes_nothing(served, name: str) -> None:
    verb, body, status = BAD[name]
    before = served.world.version
    answer = served.post(f"/api/v1/{verb}", json=body, headers=BEARER)
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    assert served.world.version == before


@pytest.mark.parametrize(
    ("body", "said", "allowed"),
    [
        (
            b'{"task": "open", "robott": "pr2"}',
            "body.robott: there is no such field",
            "body: kitchen, state, ",
        ),
        (b'["open"]', "body: a JSON object is expected", ""),
        (b'{"task": }', "body.9: this is not JSON: Expecting value", ""),
        (b'{"task": "open", "budget": "x"}', "body.budget: Input should be a valid number", ""),
        (
            b'{"task": "open", "state": {"low_drawer": "open"}}',
            "body.state: a JSON array is expected",
            'for example "state": ["iai_fridge_door=open"]',
        ),
    ],
)
def test_what_is_wrong_with_a_body_is_said_in_words_about_json(
    served, body: bytes, said: str, allowed: str
) -> None:
    headers = BEARER | {"content-type": "application/json"}
    problem = served.post("/api/v1/achieve", content=body, headers=headers).json()
    assert problem["status"] == 422
    assert problem["detail"].startswith(said)
    assert problem.get("allowed", "").startswith(allowed)
    assert bool(problem.get("allowed")) == bool(allowed)
    assert problem["remedy"] == "/openapi.json has the details"


@pytest.mark.parametrize(
    ("body", "status", "said"),
    [
        (b'{"task": "open", "robot": "pr2", "task": "close"}', 400, "'task' is there twice"),
        (b'{"task": "open", "motion": {"times": [0, 1], "times": [0, 9]}}', 400, "'times' is there twice"),
        (b'{"task": "open", "motion": {"joint": "\\ud800"}}', 422, "body: Error serializing to JSON"),
    ],
)
def test_a_body_that_says_two_things_or_half_a_letter_is_refused(
    served, body: bytes, status: int, said: str
) -> None:
    headers = BEARER | {"content-type": "application/json"}
    problem = served.post("/api/v1/achieve", content=body, headers=headers).json()
    assert problem["status"] == status
    assert problem["detail"].startswith(said)


def test_a_body_in_another_charset_is_refused_where_it_would_be_read_as_other_letters(served) -> None:
    headers = BEARER | {"content-type": "application/json; charset=latin-1"}
    problem = served.post("/api/v1/state", content=b'{"state": ["all=open"]}', headers=headers).json()
    assert (problem["status"], problem["detail"]) == (415, "the body is in latin-1")


@pytest.mark.parametrize(
    ("path", "body", "allowed"),
    [
        ("state", {"state": {"low_drawer": 0.2}}, 'for example "state": ["iai_fridge_door=open"]'),
        ("branch", {"edit": {"entity": "x", "change": {}}}, "body.edit: entity, changes"),
        (
            "branch",
            {"edit": {"upperLimit": 1}},
            '"changes": {"upperLimit": 1.2}}; body.edit: entity, changes',
        ),
        ("branch", {"edit": "x"}, 'for example "edit": {"entity": '),
        ("observation", {"positions": [1], "time": "2026-01-31T12:00:00Z", "by": "x"}, '"positions": {'),
    ],
)
def test_the_shape_that_is_wanted_of_a_body_is_said(served, path: str, body: object, allowed: str) -> None:
    problem = served.post(f"/api/v1/{path}", json=body, headers=BEARER).json()
    assert problem["status"] == 422
    assert allowed in problem["allowed"]


@pytest.mark.parametrize(
    ("question", "said"),
    [
        ("satisfies?sate=all%3Dopen", "no parameter 'sate'"),
        ("verdicts?outcom=certified", "no parameter 'outcom'"),
        ("kitchens?kitchen=a", "no parameter 'kitchen'"),
        ("state?kitchen=a&kitchen=b", "2 parameters 'kitchen'"),
    ],
)
def test_a_parameter_that_a_verb_does_not_know_is_refused(served, question: str, said: str) -> None:
    answer = served.get(f"/api/v1/{question}")
    assert answer.status_code == 400
    assert said in answer.json()["detail"]
    assert served.get("/api/v1/satisfies?state=all%3Dopen&state=all%3Dclosed").status_code == 200


@pytest.mark.parametrize("name", ["kitchen", "robot", "container"])
def test_a_list_of_verdicts_about_what_there_is_not_is_no_empty_list(served, name: str) -> None:
    problem = served.get(f"/api/v1/verdicts?{name}=nobody").json()
    assert (problem["status"], problem["detail"]) == (404, f"no {name} named 'nobody'")
    assert served.get("/api/v1/verdicts?kitchen=a&robot=pr2&container=swing_door").status_code == 200


def test_of_a_verdict_that_is_not_kept_nobody_says_that_there_are_none(served) -> None:
    for path in ("why?iri=x", "verdicts/x"):
        problem = served.get(f"/api/v1/{path}").json()
        assert (problem["status"], problem["allowed"]) == (
            404,
            "the IRI of one that is, or the beginning of its hash",
        )


def test_what_is_posted_is_data_and_is_never_fetched(served, drawer) -> None:
    joint = drawer["joint"].rsplit("/", 1)[1]
    with singing() as canary:
        url = canary.url
        bodies = [
            ("observation", {"positions": {joint: 0.1}, "time": "2026-01-31T12:00:00Z", "by": url}),
            (
                "observation",
                {"@context": url, "positions": {joint: 0.1}, "time": "2026-01-31T12:00:00Z", "by": "x"},
            ),
            ("branch", {"edit": {"entity": drawer["joint"], "changes": {"meshFile": url}}}),
            ("branch", {"edit": {"entity": url, "changes": {"upperLimit": 1}}}),
            ("state", {"state": [f"{url}=open"]}),
        ]
        for verb, body in bodies:
            assert served.post(f"/api/v1/{verb}", json=body, headers=BEARER).status_code < 500
        kinds = {"application/ld+json": 422, "application/rdf+xml": 415, "text/turtle": 415}
        for media, status in kinds.items():
            sent = f"<{url}> <http://www.w3.org/2002/07/owl#imports> <{url}> ."
            headers = BEARER | {"content-type": media}
            assert served.post("/api/v1/observation", content=sent, headers=headers).status_code == status
        assert canary.hits == []


def test_too_much_is_refused_before_it_is_read(serve) -> None:
    small = serve(kitchens=("a",), upload=10_000)
    body = {"state": ["x" * 20_000]}
    assert small.post("/api/v1/state", json=body).status_code == 413

    async def chunks():
        for _ in range(20):
            yield b"[" * 1000

    headers = {"content-type": "application/json"}
    assert small.post("/api/v1/state", content=chunks(), headers=headers).status_code == 413


def test_resources_resolve_as_pages_and_as_rdf(served, drawer) -> None:
    path = "/id/" + drawer["iri"].removeprefix(ID)
    page = served.get(path, headers={"accept": "text/html"})
    assert page.headers["content-type"].startswith("text/html")
    assert "script" not in page.text
    assert drawer["name"] in page.text
    turtle = served.get(path, headers={"accept": "text/turtle"})
    about = {str(quad.subject) for quad in ox.parse(turtle.content, format=ox.RdfFormat.TURTLE)}
    assert f"<{drawer['iri']}>" in about


def test_rdf_of_a_resource_is_what_holds_now_and_its_page_says_what_is_said_where(served, drawer) -> None:
    limit = {"entity": drawer["joint"], "changes": {"upperLimit": drawer["upper"] / 2}}
    assert moved(served, drawer, "closed").status_code == 200
    assert served.post("/api/v1/branch", json={"edit": limit}, headers=BEARER).status_code == 201
    assert moved(served, drawer, "open").status_code == 200
    path = "/id/" + drawer["joint"].removeprefix(ID)
    for media, form in (("text/turtle", ox.RdfFormat.TURTLE), ("application/ld+json", ox.RdfFormat.JSON_LD)):
        said = list(ox.parse(served.get(path, headers={"accept": media}).content, format=form))
        for name, value in (("position", drawer["upper"]), ("upperLimit", drawer["upper"])):
            found = [each.object.value for each in said if each.predicate.value == SDT + name]
            assert list(map(float, found)) == [value], name
    rows = served.get(f"{path}.json").json()["about"]
    assert len({each["graph"] for each in rows if each["predicate"] == SDT + "position"}) > 1


def test_what_holds_no_more_is_no_rdf_of_now(served) -> None:
    served.apply(put(f"{ID}graph/state/then", f'<{ID}a/ghost> <{SDT}position> "1" .'.encode(), shown=False))
    problem = served.get("/id/a/ghost", headers={"accept": "text/turtle"})
    assert (problem.status_code, "nothing holds now of" in problem.json()["detail"]) == (404, True)
    assert served.get("/id/a/ghost", headers={"accept": "text/html"}).status_code == 200


def test_rdf_of_a_resource_is_whole_or_refused(served) -> None:
    many = "".join(f"<{ID}v/{number}> <{SDT}about> <{ID}a/busy> .\n" for number in range(2500))
    served.apply(put(f"{ID}graph/verdict/many", many.encode()))
    answer = served.get("/id/a/busy", headers={"accept": "application/n-triples"})
    assert len(answer.text.splitlines()) == 2500


def test_writes_outlive_the_service_where_there_is_an_archive(serve, tmp_path, drawer) -> None:
    joint = drawer["joint"].rsplit("/", 1)[1]
    body = {"positions": {joint: 0.2}, "time": "2026-01-31T12:00:00Z", "by": "camera"}
    with closing(opened(tmp_path / "store")) as archive:
        first = serve(kitchens=("a",), archive=archive)
        graph = first.post("/api/v1/observation", json=body).json()["graph"]
        assert moved(first, drawer, "open").status_code == 200
    with closing(opened(tmp_path / "store")) as archive:
        second = serve(kitchens=("a",), archive=archive)
        assert second.get("/graphs", params={"graph": graph}).status_code == 200
        assert second.query("ASK { ?b a sdt:Branch ; prov:wasDerivedFrom ?a }").json()["boolean"]
        assert position(second, drawer) == [pytest.approx(drawer["upper"])]
