"""Where fingers are parted, so that what both have beyond that is refuted, and what one has before it."""

from collections.abc import Callable, Sequence

from services.embodiment.proof_check.pinch.between import Along

Tree = Callable[[Along], bytes | None]
"""A tree that refutes such holds, if one is found."""


def by_ends(places: Sequence[float], tree: Tree) -> tuple[float, bytes] | None:
    """Such a place and both trees, one after the other; None if none is found.

    The farther out, the less is beyond: what is nearest of which that is refuted is looked for by halves.
    """
    beyond: bytes | None = None
    first, last = 0, len(places)
    while first < last:
        middle = (first + last) // 2
        found = tree(Along(places[middle], beyond=True))
        if found is None:
            first = middle + 1
        else:
            beyond, last = found, middle
    if beyond is None:
        return None
    before = tree(Along(places[last], beyond=False))
    return None if before is None else (places[last], beyond + before)
