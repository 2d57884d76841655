"""Processes that work for the bus: who waits, who works, what is kept."""
