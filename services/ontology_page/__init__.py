"""One HTML page that documents the ontology, made from the ontology itself; and what is no term of it."""
