"""A motion that is played: where it is, whether it runs, and what is to be seen at a time."""

import re
from collections.abc import Sequence
from typing import Final

from services.viewer.picture.marks import Mark, What
from services.viewer.picture.timeline import Timeline

SIGNS: Final = re.compile(r"[!-/:-@\[-`{-~]")
"""ASCII punctuation: what a backslash before it makes plain in Markdown (CommonMark 2.4)."""

AROUND = 0.5
"""[s] A mark of a certificate is seen so long before and after its time."""


class Film:
    """A motion, and the marks that belong to it.

    Attributes:
        timeline: None: there is nothing to play.
        time: [s] since the motion began.
        playing: Whether it runs.
    """

    def __init__(self, timeline: Timeline | None, marks: Sequence[Mark] = ()) -> None:
        self.timeline, self.marks = timeline, tuple(marks)
        self.time, self.playing = 0.0, False

    def play(self) -> None:
        """It runs, from the beginning if it was at its end."""
        if self.timeline is not None:
            self.playing = True
            self.time = 0.0 if self.time >= self.timeline.duration else self.time

    def advance(self, seconds: float) -> None:
        """So much time goes by; at the end it stops."""
        if self.timeline is not None and self.playing:
            self.time = min(self.time + seconds, self.timeline.duration)
            self.playing = self.time < self.timeline.duration

    def when(self, mark: Mark) -> float | None:
        """When a mark is to be seen, in s since the beginning."""
        if self.timeline is None or mark.time is None:
            return None
        return min(max(self.timeline.since_start(mark.time), 0.0), self.timeline.duration)

    def seen(self, chosen: Mark | None) -> list[Mark]:
        """The marks that are shown now: what is chosen, regions always, closest pairs around their time."""
        shown = [mark for mark in self.marks if mark is chosen or mark.what is What.REGION]
        for mark in self.marks:
            at = self.when(mark)
            near = at is not None and abs(at - self.time) < AROUND
            if mark.what is What.NEAREST and near and mark not in shown:
                shown.append(mark)
        return shown

    def says(self) -> str:
        """Phase and time, in Markdown; the phases' names come from files, and are not read as that."""
        if self.timeline is None:
            return ""
        phase = self.timeline.phase(self.time)
        names = " → ".join(
            f"**{name}**" if each is phase else name
            for each in self.timeline.phases
            for name in (_plain(each.name),)
        )
        return f"{names}  \n{self.time:.1f} of {self.timeline.duration:.1f} s"


def _plain(name: str) -> str:
    """A name in which nothing is a sign of Markdown or HTML."""
    return SIGNS.sub(r"\\\g<0>", " ".join(name.split()))
