"""How a notebook becomes a report: found, given its parameters, run, written."""
