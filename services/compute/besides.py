"""Verdicts that answer nothing which is asked now: of other versions, or models of the same names."""

from collections import Counter
from collections.abc import Iterable, Mapping
from typing import Final

from services.versions import outdated

BESIDES: Final = """SELECT ?environment ?robot ?physics ?embodiment (COUNT(?verdict) AS ?verdicts) WHERE {
  ?verdict a law:Verdict ; prov:wasGeneratedBy ?judging .
  ?judging prov:used ?e . ?e law:name "environment" ; law:inputHash ?environment .
  OPTIONAL { ?judging prov:used ?m . ?m law:name "robot" ; law:inputHash ?robot }
  OPTIONAL { ?judging prov:used ?p . ?p law:name "physics" ; law:inputHash ?physics }
  OPTIONAL { ?judging prov:used ?r . ?r law:name "embodiment" ; law:inputHash ?embodiment }
}
GROUP BY ?environment ?robot ?physics ?embodiment"""
"""How many verdicts are kept about which models, and of whom."""


def besides(kept: Iterable[Mapping[str, str]], models: frozenset[str]) -> Counter[str]:
    """How many of the kept verdicts are outdated or about other models.

    Args:
        kept: Rows of `BESIDES`: variable → text, where bound.
        models: What is loaded, as inputs of verdicts name it with its content.
    """
    here, counts = {each.partition(" ")[0] for each in models}, Counter[str]()
    for row in kept:
        of = [row[name] for name in ("environment", "robot") if name in row]
        if outdated(row):
            counts["outdated"] += int(row["verdicts"])
        elif any(each.partition(" ")[0] in here and each not in models for each in of):
            counts["about_other_models"] += int(row["verdicts"])
    return counts
