"""Graphs: queries, branches, differences, reasoning, the ontology's page."""
