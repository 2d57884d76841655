"""Verdicts that are kept: their list, and each in plain words."""
