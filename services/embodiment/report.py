"""A search that gave up, in words and figures."""

from predicates.case import Diagnosis, Kind, Search
from services.embodiment.plan import Planner


def refusal(planner: Planner, rejected: list[tuple[Diagnosis, ...]], search: Search) -> tuple[Diagnosis, ...]:
    """Why no body motion was found."""
    return (Diagnosis(Kind.EMBODIMENT, f"search gave up; {len(rejected)} rejected", search=search), *(d for r in rejected[:2] for d in r))
