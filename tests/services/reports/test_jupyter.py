"""What Jupyter shows of a twin, a verdict and a table; needs nothing of the extra `notebook`."""

from dataclasses import replace

from predicates.case import Case, Diagnosis, Kind, Outcome, Search
from predicates.law import law
from sdt_kg.display import Badge, card, grid
from sdt_kg.task import Task, Verb
from services.app import Policy
from services.physics.oracle import Kinematics
from services.sweep.cell import Cell, Unjudged
from services.table import TableResult
from tests.small import small_twin
from tests.small.lift import Lift

TWIN = small_twin("a", ("pr2", "stretch"))


def test_words_are_escaped_and_badges_have_contrast() -> None:
    text = card("a <b>", [("x", "1 & 2")], ("certified", Badge.GOOD), grid(("n",), [("<i>",)], "more"))
    assert "a &lt;b&gt;" in text
    assert "1 &amp; 2" in text
    assert "&lt;i&gt;" in text
    for badge in Badge:
        ink, ground = (_luminance(each) for each in badge.value)
        assert (max(ink, ground) + 0.05) / (min(ink, ground) + 0.05) >= 4.5


def _luminance(color: str) -> float:
    """WCAG's relative luminance."""
    parts = [int(color[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [each / 12.92 if each <= 0.04045 else ((each + 0.055) / 1.055) ** 2.4 for each in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def test_a_twin_shows_its_robots_its_containers_and_what_was_moved() -> None:
    text = TWIN._repr_html_()
    assert "Twin of kitchen a" in text
    assert "pr2, stretch" in text
    assert "everything at its start" in text
    assert all(each.name in text for each in TWIN.containers())
    container = next(each for each in TWIN.containers() if each.joint == each.active_joint)
    moved = TWIN.at({container.active_joint: container.upper})
    assert "everything at its start" not in moved._repr_html_()


def test_a_verdict_shows_outcome_predicates_and_how_sure_each_reason_is() -> None:
    container = TWIN.containers()[0]
    (verdict,) = law(Case(TWIN, TWIN.robots[0], Task(Verb.OPEN, container.iri)), Kinematics(), Lift())
    assert ">certified<" in verdict._repr_html_()
    assert verdict.iri in verdict._repr_html_()
    search = Search(seeds=1, seconds=2.0)
    reasons = (
        Diagnosis(Kind.EMBODIMENT, "too far", search=search),
        Diagnosis(Kind.EMBODIMENT, "too high", proof=True),
    )
    text = replace(verdict, outcome=Outcome.NOT_CERTIFIED, diagnoses=reasons)._repr_html_()
    assert ">not certified<" in text
    assert "too far (not proved: a search gave up)" in text
    assert "too high (proved)" in text


def test_a_table_says_how_many_cases_have_no_verdict() -> None:
    case = Cell("a", "pr2", "open:drawer", (), Policy())
    shown = TableResult(unjudged=[Unjudged(case, "the process that judged it died twice")])._repr_html_()
    assert "0 / 1, 1 without a verdict" in shown
