"""What a twin says whatever its state, shared by all its branches."""

from sdt_kg.entities.entities import Entities
from sdt_kg.entities.queries import query_text
from sdt_kg.entities.replacement import Replacement
from sdt_kg.entities.states import KEPT_STATES, state_iri

__all__ = ["KEPT_STATES", "Entities", "Replacement", "query_text", "state_iri"]
