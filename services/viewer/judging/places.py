"""Twins by the texts that describe them; the last few are kept."""

from collections import OrderedDict
from dataclasses import replace
from typing import Final

from sdt_kg.load import load_twin
from sdt_kg.twin import Twin
from services.edits import parse_edit
from services.requests import parse_state
from services.viewer.judging.question import Place

KEPT: Final = 12
"""Twins that are kept; those of one kitchen and robot share their entities."""


class Places:
    """Twins of places."""

    def __init__(self) -> None:
        self._twins: OrderedDict[Place, Twin] = OrderedDict()

    def twin(self, place: Place) -> Twin:
        """Kitchen and robot in the place's state, with its edits.

        Raises:
            InputError: A model, state or edit that is not one.
        """
        if place in self._twins:
            self._twins.move_to_end(place)
            return self._twins[place]
        twin = self._made(place)
        self._twins[place] = twin
        while len(self._twins) > KEPT:
            self._twins.popitem(last=False)
        return twin

    def _made(self, place: Place) -> Twin:
        if place.edits:
            edited = replace(place, edits=place.edits[:-1])
            before = self.twin(edited)
            return parse_edit(before, place.edits[-1]).applied(before)
        if place.states:
            closed = self.twin(replace(place, states=()))
            return closed.at(parse_state(closed, place.states))
        return load_twin(place.kitchen, [place.robot] if place.robot else [])
