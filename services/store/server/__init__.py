"""A SPARQL 1.1 server, which others may write to."""
