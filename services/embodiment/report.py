"""A search that gave up, in words and figures."""

from collections import Counter
from sdt_kg.iri import local_name
from predicates.case import Diagnosis, Kind, Search
from services.embodiment.plan import Planner


def refusal(planner: Planner, rejected: list[tuple[Diagnosis, ...]], search: Search) -> tuple[Diagnosis, ...]:
    """Why no body motion was found."""
    return (Diagnosis(Kind.EMBODIMENT, f"search gave up; {len(rejected)} rejected; holdings {planner.holdings}; {Counter((b.stage, tuple(local_name(planner.setting.world.body[i]) for i in b.contact.shapes) if b.contact else '') for b in planner.blocked).most_common(5)}", search=search), *(d for r in rejected[:2] for d in r))
