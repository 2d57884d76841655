"""What a twin says whatever its state, shared by all its branches."""

from sdt_kg.entities.entities import KEPT_STATES, Entities, state_iri
from sdt_kg.entities.queries import query_text
from sdt_kg.entities.replacement import Replacement

__all__ = ["KEPT_STATES", "Entities", "Replacement", "query_text", "state_iri"]
