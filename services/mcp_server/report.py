"""What a tool says: short, and open about what it leaves out."""

import json
from dataclasses import dataclass, field
from typing import Any, Final

LIMIT: Final = 4000
"""[characters] Of a report's text, and of its data as JSON."""
NOTICE: Final = 250
"""[characters] Kept free for saying what was left out."""

Json = dict[str, Any]  # a JSON object


@dataclass(frozen=True, slots=True)
class Report:
    """An answer, in words and as data.

    Attributes:
        lines: In words, the most important first.
        data: The same for programs.
        listed: Key of the list in the data that may be shortened; empty: the data is short.
        more: What to ask for the rest.
        unlisted: How many more there are than the list has.
    """

    lines: tuple[str, ...]
    data: Json = field(default_factory=dict[str, Any])
    listed: str = ""
    more: str = "ask for less at a time"
    unlisted: int = 0

    def text(self) -> str:
        """At most LIMIT characters."""
        if len("\n".join(self.lines)) <= LIMIT:
            return "\n".join(self.lines)
        kept, room = list[str](), LIMIT - NOTICE
        for line in self.lines:
            if len(line) + 1 > room:
                break
            kept.append(line)
            room -= len(line) + 1
        if not kept:
            kept = [f"{self.lines[0][:room]} …"]
        left = len(self.lines) - len(kept)
        return "\n".join((*kept, f"… {left} of {len(self.lines)} lines left out; {self.more}"[:NOTICE]))

    def content(self) -> Json:
        """The data, at most LIMIT characters as JSON; `left_out` counts what there is beside the list."""
        if not self.listed:
            return self.data
        entries = list[Any](self.data[self.listed])  # whatever the list holds
        there = len(entries) + self.unlisted
        room = LIMIT - size(self.data | {self.listed: [], "left_out": there})
        kept = 0
        while kept < len(entries) and (room := room - size(entries[kept]) - 2) >= 0:
            kept += 1
        return self.data | {self.listed: entries[:kept], "left_out": there - kept}


def size(value: object) -> int:
    """Characters of a value as JSON."""
    return len(json.dumps(value, ensure_ascii=False))
