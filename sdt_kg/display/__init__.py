"""How values look in Jupyter: pure functions from words to HTML, with nothing to load."""

from sdt_kg.display.card import Badge, card, grid

__all__ = ["Badge", "card", "grid"]
