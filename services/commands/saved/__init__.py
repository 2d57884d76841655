"""Verdicts that were kept: told, and checked again."""
