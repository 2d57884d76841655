"""Queries of the ontology, as they are written."""

from functools import cache

import ontology


@cache
def query_text(name: str) -> str:
    """Text of a query of `ontology/queries`."""
    return ontology.path(f"queries/{name}.rq").read_text(encoding="utf-8")
