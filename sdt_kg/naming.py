"""Names as sentences tell them."""

from collections.abc import Sequence


def few(names: Sequence[str], most: int) -> str:
    """So many of the names, the first ones, and how many more there are."""
    more = len(names) - most
    return ", ".join(names[:most]) + (f" and {more} more" if more > 0 else "")
