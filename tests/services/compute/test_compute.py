"""What is missing for a query is run before it, within bounds, and what was left out is said."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest

from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError, OracleUnavailableError, QueryError
from sdt_kg.iri import ID, LAW, local_name
from sdt_kg.store import rows_of
from services.app import Policy
from services.compute import Bounds, Computed, Loaded, compute
from services.compute.run import NO_QUESTION, NOT_JUDGED_IS_NOT_NO, Report
from services.store.files import SavedVerdicts
from services.table import Cell, run

SMALL = Path(__file__).resolve().parents[2] / "small"
A, B = str(SMALL / "a.urdf"), str(SMALL / "b.urdf")
PR2, STRETCH = str(SMALL / "pr2.urdf"), str(SMALL / "stretch.urdf")
LOADED = Loaded((B,), (PR2, STRETCH))
OMNI = Loaded((B,), (PR2,), policy=Policy(Drive.OMNI))
SWING = f"SELECT ?o {{ ?v law:container <{ID}a/body/swing_door> ; law:robot id:stretch ; law:outcome ?o }}"
CLOSED = (
    "SELECT ?c { ?v law:robot id:pr2 ; law:container ?c ; law:task/law:verb law:Close ; law:causes false }"
)


@pytest.fixture
def saved(tmp_path: Path) -> Iterator[SavedVerdicts]:
    with SavedVerdicts(tmp_path / "saved.trig") as opened:
        yield opened


def computed(saved: SavedVerdicts, sparql: str, loaded: Loaded = LOADED, limit: int = 10) -> Computed:
    return compute(sparql, loaded, Bounds(20.0, limit), saved)  # whose budget is not what is tested here


def answer(saved: SavedVerdicts, sparql: str) -> set[str]:
    return {local_name(str(value)) for row in rows_of(saved.store.query(sparql))[1] for value in row.values()}


def test_what_the_query_touches_is_run_kept_and_then_found(saved: SavedVerdicts) -> None:
    assert answer(saved, CLOSED) == set()
    done = computed(saved, CLOSED)
    assert {(each["robot"], each["task"], each["container"]) for each in done.ran} == {
        ("pr2", "close", "oven_door"),
        ("pr2", "close", "top_drawer"),
    }
    assert done.left_out == []
    assert answer(saved, CLOSED) == {"oven_door", "top_drawer"}  # they are closed: nothing to cause
    assert answer(saved, "SELECT ?door { ?door a sdt:Door }") == {"oven_door"}  # the twin is kept too


def test_the_verdicts_have_the_iris_that_were_planned(saved: SavedVerdicts) -> None:
    done = computed(saved, CLOSED)
    assert {str(each["iri"]) for each in done.ran} == {each.verdict for each in done.plan.missing}


def test_a_term_that_nothing_has_is_told_before_anything_is_run(saved: SavedVerdicts) -> None:
    for misspelled in (
        CLOSED.replace("law:Close", "law:Clos"),
        CLOSED.replace("?c {", "?c { ?c a sdt:Dor ."),
    ):
        with pytest.raises(QueryError, match=r"nothing was computed.*did you mean (law:Close|sdt:Door)\?"):
            computed(saved, misspelled)
    assert rows_of(saved.store.query("SELECT ?s { GRAPH ?g { ?s ?p ?o } }"))[1] == []
    meant = '# law:Clos\nSELECT ?v { ?v law:robot id:pr2 FILTER("law:robt" != "sdt:Dor") }'
    assert computed(saved, meant, limit=0).about_verdicts


def test_what_is_stored_is_not_run_again(saved: SavedVerdicts) -> None:
    computed(saved, CLOSED)
    again = computed(saved, CLOSED)
    assert (again.ran, len(again.plan.stored)) == ([], 2)
    wider = computed(saved, CLOSED.replace("law:robot id:pr2", "law:robot ?robot"))
    assert {each["robot"] for each in wider.ran} == {"stretch"}


def test_another_state_is_another_question(saved: SavedVerdicts) -> None:
    computed(saved, CLOSED)
    ajar = Loaded((B,), (PR2, STRETCH), ("oven_door=0.005",))
    assert len(computed(saved, CLOSED, ajar).ran) == 2


def test_beyond_the_limit_is_left_out_and_said(saved: SavedVerdicts) -> None:
    done = computed(saved, CLOSED, limit=1)
    assert len(done.ran) == 1
    ((request, why),) = done.left_out
    assert why == "beyond the limit of 1 cases"
    assert "left out 1 cases, beyond the limit of 1 cases: the answer may lack them" in done.told()
    assert done.to_json()["left_out"] == [request.to_json() | {"why": why}]
    assert computed(saved, CLOSED, limit=0).ran == []


@pytest.mark.parametrize(
    ("sparql", "holds"),
    [
        ("SELECT ?v { ?v law:robot id:pr2 ; law:outcome law:Certified }", True),
        (
            "SELECT DISTINCT ?v { { ?v law:robot id:pr2 } UNION { ?v law:robot id:stretch } } ORDER BY ?v",
            True,
        ),
        (
            "SELECT ?c { ?c a sdt:Door FILTER NOT EXISTS { ?v law:container ?c } }",
            False,
        ),
        ("SELECT ?c { ?c a sdt:Door FILTER (!EXISTS { ?v law:container ?c }) }", False),
        ("SELECT ?c { ?c a sdt:Door MINUS { ?v law:container ?c } }", False),
        ("SELECT ?c { ?c a sdt:Door OPTIONAL { ?v law:container ?c } FILTER (!BOUND(?v)) }", False),
        ("SELECT (COUNT(?v) AS ?n) { ?v a law:Verdict }", False),
        ("SELECT ?v { ?v law:seconds ?s } ORDER BY ?s LIMIT 1", False),
        ("ASK { ?v law:outcome law:Certified }", False),
        (
            "SELECT * { { SELECT ?c (COUNT(?v) AS ?n) { ?v law:container ?c } GROUP BY ?c } }",
            False,
        ),
    ],
)
def test_what_has_no_verdict_yet_is_not_taken_for_failed_without_a_word(
    saved: SavedVerdicts, sparql: str, holds: bool
) -> None:
    partly = computed(saved, sparql, limit=0)
    assert partly.left_out
    assert partly.to_json()["holds"] is holds
    assert (NOT_JUDGED_IS_NOT_NO in partly.told()) is not holds


def test_what_is_judged_whole_holds(saved: SavedVerdicts) -> None:
    assert computed(saved, CLOSED).holds
    assert computed(saved, f"ASK {CLOSED[CLOSED.index('{') :]}").holds


def test_beyond_the_budget_is_left_out_and_said(saved: SavedVerdicts) -> None:
    done = compute(CLOSED, LOADED, Bounds(1e-6, 10), saved)
    assert len(done.ran) == 1  # a case that has begun is finished
    assert [why for _, why in done.left_out] == ["beyond the budget of 1e-06 s"]


def test_what_is_not_loaded_is_said(saved: SavedVerdicts) -> None:
    done = computed(saved, SWING, Loaded((B,), (PR2,)))
    assert done.ran == []
    unplanned = {(each.kind, local_name(each.iri)) for each in done.plan.unplanned}
    assert unplanned == {("container", "swing_door"), ("robot", "stretch")}
    assert "nothing computed about container swing_door: it is not loaded" in done.told()


def ask(where: str) -> str:
    return f"SELECT * {{ ?v law:robot id:pr2 ; {where} }}"


@pytest.mark.parametrize(
    ("sparql", "loaded", "kind", "why"),
    [
        (ask('law:drive "hover"'), LOADED, "drive", "--drive says otherwise, or there is none"),
        (ask('law:drive "fixed"'), OMNI, "drive", "--drive says otherwise, or there is none"),
        (ask("law:task/law:verb law:Verdict"), LOADED, "verb", "there is no such verb"),
        (
            ask("law:teeClass tee:D_artic_dyn"),
            LOADED,
            "class",
            "cases are judged relative to another class D",
        ),
        (
            f"SELECT * {{ <{ID}verdict/0a/diagnosis/1> law:reason ?r }}",
            LOADED,
            "verdict",
            "no case of what is",
        ),
        (f"DESCRIBE <{ID}verdict/0a>", LOADED, "verdict", "no case of what is loaded has these inputs"),
    ],
)
def test_what_no_case_has_is_said(
    saved: SavedVerdicts, sparql: str, loaded: Loaded, kind: str, why: str
) -> None:
    done = computed(saved, sparql, loaded)
    assert done.ran == []
    assert [each.kind for each in done.plan.unplanned] == [kind]
    assert f"nothing computed about {kind}" in done.told()
    assert why in done.told()
    assert why in str(done.to_json()["not_loaded"])


def test_what_a_property_that_is_no_term_may_be_is_run(saved: SavedVerdicts) -> None:
    sparql = ask("?p law:NotCertified ; law:task/law:verb law:Close")
    assert len(computed(saved, sparql).ran) == 2
    assert answer(saved, sparql)


def test_what_is_not_computed_and_a_query_that_asks_about_no_verdict_are_said(saved: SavedVerdicts) -> None:
    rules = computed(saved, "SELECT * { ?r a law:TaskResult ; law:firstBroken ?b }")
    assert "no TaskResult is computed: sdt task makes them" in rules.told()
    assert rules.to_json()["not_judged"] == [{"class": f"{LAW}TaskResult", "made_by": "sdt task"}]
    everything = computed(saved, "SELECT * { ?s ?p ?o }")
    assert everything.told() == NO_QUESTION
    assert everything.to_json()["about_verdicts"] is False


def test_models_that_the_query_rules_out_are_not_read(saved: SavedVerdicts) -> None:
    assert len(computed(saved, CLOSED, Loaded((B,), (PR2, "no such robot"))).ran) == 2
    in_b = CLOSED.replace("law:robot id:pr2", "law:robot id:pr2 ; law:environment id:b")
    assert len(computed(saved, in_b, Loaded(("no such kitchen", B), (PR2,))).plan.stored) == 2


def test_an_abstention_is_an_answer_too(saved: SavedVerdicts) -> None:
    done = computed(saved, SWING, Loaded((A,), (STRETCH,)))
    assert [each["outcome"] for each in done.ran] == ["abstained", "abstained"]  # open and close
    assert answer(saved, SWING) == {"Abstained"}


def test_the_drive_that_the_query_names_is_tried(saved: SavedVerdicts) -> None:
    asked = CLOSED.replace("law:robot id:pr2", 'law:robot id:pr2 ; law:drive "fixed"')
    computed(saved, asked)
    assert answer(saved, asked) == {"oven_door", "top_drawer"}


def test_a_query_about_the_twin_runs_nothing(saved: SavedVerdicts) -> None:
    done = computed(saved, "SELECT ?door { ?door a sdt:Door }", Loaded(("no such kitchen",), ()))
    assert (done.ran, done.plan.missing) == ([], ())


def test_a_dead_oracle_is_an_error_and_what_was_finished_is_kept(saved: SavedVerdicts) -> None:
    def dies(cells: Sequence[Cell], jobs: int, report: Report) -> object:
        run(cells[:1], jobs, report)
        raise OracleUnavailableError("nobody answers")

    with pytest.raises(OracleUnavailableError):
        compute(CLOSED, LOADED, Bounds(5.0, 10), saved, dies)
    assert len(answer(saved, CLOSED)) == 1


@pytest.mark.parametrize(
    ("loaded", "said"),
    [
        (Loaded((B, B), (PR2,)), "share a name"),
        (Loaded((B,), (PR2,), ("nothing=0.1",)), "no kitchen has a joint for: nothing=0.1"),
        (Loaded(("zzz",), (PR2,)), "no kitchen named 'zzz'"),
    ],
)
def test_nonsense_is_refused(saved: SavedVerdicts, loaded: Loaded, said: str) -> None:
    with pytest.raises(InputError, match=said):
        computed(saved, f"SELECT ?v {{ ?v a <{LAW}Verdict> }}", loaded)
