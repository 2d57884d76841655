"""SPARQL 1.1 Protocol, Graph Store Protocol (read), JSON verbs and pages over HTTP."""
