"""What was measured, counted or bounded is told in words that say which it is."""

import pytest

from predicates.case import Diagnosis, Evidence, Kind, Quantity
from predicates.margins import told_figures
from predicates.record import diagnosis_json
from predicates.record.report import evidence_line
from sdt_kg.iri import SDT, body_iri, joint_iri

PAIR = body_iri("pr2", "wrist"), body_iri("a", "door")
JOINT = joint_iri("a", "hinge")


def told(quantity: Quantity, value: float, bound: float, unit: str = "1", **more: object) -> str:
    evidence = Evidence(quantity, value, bound, unit, **more)  # type: ignore[arg-type]
    said = diagnosis_json(Diagnosis(Kind.EMBODIMENT, "", evidence))["evidence"]
    assert isinstance(said, dict)
    return evidence_line(said, "none")


@pytest.mark.parametrize(
    ("line", "evidence"),
    [
        ("wrist and door: in the way 812 times in the search", (Quantity.COUNT, 812.0, 0.0, "1", PAIR)),
        ("count of hinge: 0, 1 needed", (Quantity.COUNT, 0.0, 1.0, "1")),
        ("velocity of hinge: 0.5 rad/s, 0.2 rad/s allowed", (Quantity.VELOCITY, 0.5, 0.2, "rad/s")),
        ("tool error of hinge: 0.003 m, at most 0.002 m allowed", (Quantity.TOOL_ERROR, 0.003, 0.002, "m")),
        (
            "distance of wrist and door: -0.01 m, at least 0 m needed",
            (Quantity.DISTANCE, -0.01, 0.0, "m", PAIR),
        ),
        (
            "distance of wrist and door: 0.8 m, at most 0.002 m allowed",
            (Quantity.DISTANCE, 0.8, 0.002, "m", PAIR),
        ),
        ("position of hinge: 0.4 rad, compared with 1.4 rad", (Quantity.POSITION, 0.4, 1.4, "rad")),
        (
            "demanded position of hinge: 1.4 rad, refuted at 0 rad",
            (Quantity.DEMANDED_POSITION, 1.4, 0.0, "rad"),
        ),
    ],
)
def test_a_bound_is_told_as_what_it_is(line: str, evidence: tuple[Quantity, float, float, str]) -> None:
    links = evidence[4] if len(evidence) > 4 else None  # type: ignore[misc]
    assert told(*evidence[:4], links=links, entity=None if links else JOINT) == line


def test_a_limit_of_a_class_is_told_by_the_property_that_it_is_of() -> None:
    more = {"entity": JOINT, "scope": "D_artic", "path": SDT + "closedTo"}
    line = told(Quantity.LIMIT, 0.01, 0.0, **more)
    assert line == "closedTo of hinge: 0.01, where the class has the bound 0"
    assert told(Quantity.LIMIT, float("nan"), 1.0, **more) == "", "too few or too many: the reason says which"


def test_when_it_was_is_told_after_a_comma() -> None:
    assert told(Quantity.ACCELERATION, 2.0, 1.0, "rad/s2", entity=JOINT, time=1.5).endswith(
        "allowed, at 1.5 s"
    )


def test_margins_come_first_and_what_was_computed_for_them_in_one_line() -> None:
    figures = {
        "largest velocity ratio": (0.98, "1"),
        "distance queries, self": (1007.0, "1"),
        "smallest distance, self": (0.0144507, "m"),
        "distance queries, environment": (362.0, "1"),
        "smallest distance, environment": (0.02, "m"),
    }
    assert dict(told_figures(figures)) == {
        "largest velocity ratio": "0.98 of what is allowed",
        "smallest distance, self": "0.0144507 m",
        "smallest distance, environment": "at least 0.02 m",
        "distances computed": "1007 (self), 362 (environment)",
    }
    assert [*dict(told_figures(figures))][-1] == "distances computed"
    assert [*told_figures({})] == []
