"""Cross products."""

from predicates.learn.track import Array


def cross(a: Array, b: Array) -> Array:
    """Cross products along the last axis; numpy's own takes ten times as long for few vectors."""
    ahead, behind = [1, 2, 0], [2, 0, 1]
    return a[..., ahead] * b[..., behind] - a[..., behind] * b[..., ahead]
