"""Processes that judge, for whoever asks: who waits, who works, what is asked and answered."""
