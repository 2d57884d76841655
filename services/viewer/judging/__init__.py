"""Judging for the page: questions as values, processes that answer them, points for the picture."""
