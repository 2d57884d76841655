"""One HTML page that documents the ontology, made from the ontology itself."""

from services.ontology_page.page import page

__all__ = ["page"]
