"""Verdicts that are judged one by one, as they are asked for."""

from collections.abc import Iterable, Iterator
from typing import Never

from predicates.case import OUTCOME_OF, Verdict
from sdt_kg.errors import NoTruthError


class Verdicts(Iterator[Verdict]):
    """What `achieve` gives: a verdict for each container, each judged when it is asked for, and once.

    Args:
        judged: Where they come from.
    """

    __slots__ = ("_judged",)

    def __init__(self, judged: Iterable[Verdict]) -> None:
        self._judged = iter(judged)

    def __next__(self) -> Verdict:
        return next(self._judged)

    def __bool__(self) -> Never:
        """Nothing is judged yet, and what comes may have several outcomes."""
        raise NoTruthError("a question", f"take its verdict first, (verdict,) = …; then {OUTCOME_OF}")

    def __repr__(self) -> str:
        return "<verdicts, judged as they are asked for: (verdict,) = …, or for verdict in …>"
