"""Processes that judge: who waits, who works, and when whoever waits is answered."""
