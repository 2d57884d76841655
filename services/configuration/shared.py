"""Settings that several commands share: one key of the file, or one variable, for all of them."""

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True, slots=True)
class Shared:
    """A setting at the top of the file.

    Attributes:
        name: Its key; `SDT_` and this in capitals is its variable.
        option: Long name of the option that it sets.
        commands: Whose option it sets. Others have an option of that name which means something else there,
            or which changes what the command does.
        example: A value, as TOML.
        comment: What it decides.
    """

    name: str
    option: str
    commands: tuple[str, ...]
    example: str
    comment: str


ONE_CASE: Final = ("achieve", "place", "task", "whatif")

SHARED: Final = {
    each.name: each
    for each in (
        Shared("kitchen", "kitchen", (*ONE_CASE, "doctor"), '"b"', "bundled name or path of a model"),
        Shared("robot", "robot", (*ONE_CASE, "doctor"), '"pr2"', "bundled name or path of a model"),
        Shared("drive", "drive", ("achieve", "table", "task", "whatif"), '"omni"', "how the base moves"),
        Shared("budget", "budget", (*ONE_CASE, "table", "ask"), "20.0", "seconds of search a container"),
        Shared("seed", "seed", (*ONE_CASE, "table"), "0", "of the search"),
        Shared(
            "friction", "friction", (*ONE_CASE, "table"), "0.5", "of fingers on handles, which holds may take"
        ),
        Shared("jobs", "jobs", ("table", "query"), "2", "worker processes"),
        Shared("store", "store", ("achieve", "table", "doctor"), '"verdicts"', "where verdicts are kept"),
        Shared(
            "connect",
            "connect",
            ("ask", "oracle", "doctor"),
            '"tcp/127.0.0.1:7447"',
            "the bus",
        ),
    )
}
