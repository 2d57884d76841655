"""The exception tree. A false predicate is a value; an exception is a broken promise.

SdtError
├── InputError                  the caller's: it can be mended by changing the input
│   ├── UrdfError               a model file that is not a valid, tree-shaped URDF
│   ├── AnnotationError         a robot or kitchen annotation that contradicts its model
│   ├── UnknownEntityError      no kitchen, robot, container or joint of that name
│   ├── StateError              a joint value outside its limits, or not a number
│   ├── MotionError             a motion that is not one: units, times, frames, joints
│   │   └── DisconnectedFrameError   poses of a frame which no joint moves
│   ├── GraphError              graphs that are not those of one twin, whole and unchanged
│   └── QueryError              SPARQL that does not parse or asks for more than it may
├── NoModeError                 the case has too many unknowns for every predicate
├── OracleError                 the world's
│   ├── OracleUnavailableError  nobody answered: there is no verdict
│   └── OracleRejectedError     the oracle answered that it cannot judge this input
└── StoreError                  the world's, too: what it had acknowledged is kept, this was not
    ├── StoreUnavailableError   a server that is gone, a directory or file that another process holds
    └── StoreRejectedError      the store answered, but not with what was asked
"""

from collections.abc import Iterable
from difflib import get_close_matches
from itertools import takewhile
from operator import eq
from typing import Final

ALIKE: Final = 0.75
"""[1] From which likeness on, of 0 to 1, an unknown name is taken for a known one misspelled."""

FAR: Final = 0.5
"""[1] The same for names that are proposed to people, who look at them."""
SHORT: Final = 5
"""[characters] Up to which half a name in common is chance: two or three characters, in any name."""
TELLING: Final = 3
"""[characters] From which on the beginning of a name, or one slip in it, means that name."""
MOST_NEAR: Final = 3
"""[1] Names that are proposed."""
JOINT: Final = "joint"
"""What names of joints begin or end with, whatever they are of."""


def meant(name: str, known: Iterable[str]) -> str | None:
    """The known name of which this one is a misspelling, if there is one; a known name means itself."""
    return next(iter(get_close_matches(name, list(known), n=1, cutoff=ALIKE)), None)


class SdtError(Exception):
    """Root of all errors which this project raises; each can be sent to another process."""

    def __reduce__(self) -> tuple[object, ...]:
        """As it is, whatever it was made of."""
        return type(self).__new__, (type(self), *self.args), self.__dict__


class InputError(SdtError):
    """The input is wrong: the message says what, what is allowed and what to do.

    Attributes:
        what: The input as given, and what is wrong with it.
        allowed: What would have been accepted; or a question back, which stands in the message as it is.
        remedy: What to do.
    """

    def __init__(self, what: str, *, allowed: str = "", remedy: str = "") -> None:
        self.what, self.allowed, self.remedy = what, allowed, remedy
        asked = allowed.endswith("?")
        hint = f"allowed: {allowed}" if allowed and not asked else allowed
        told = "; ".join(part for part in (what, hint) if part)
        super().__init__(f"{told}{' ' if asked else '; '}{remedy}" if remedy else told)

    def be_from(self, source: str) -> None:
        """The message begins with where the input is from: the name of its file."""
        self.what = f"{source}: {self.what}"
        self.args = (f"{source}: {self}",)


class NoTruthError(InputError):
    """Something was taken for true or false that is neither: a verdict has three outcomes."""

    def __init__(self, what: str, remedy: str) -> None:
        super().__init__(f"{what} was taken for true or false, and is neither", remedy=remedy)


class UrdfError(InputError):
    """A model file is not a valid, tree-shaped URDF."""


class AnnotationError(InputError):
    """An annotation names what its model does not have, or lacks what is needed."""


class StateError(InputError):
    """A joint value lies outside its limits or is not a number."""


class MotionError(InputError):
    """A motion has wrong units, unsorted times, unknown joints or values which are not numbers."""


class DisconnectedFrameError(MotionError):
    """A motion is of a frame or joint that nothing moves."""


class GraphError(InputError):
    """Graphs are not those of one twin, whole and unchanged."""


class QueryError(InputError):
    """A query does not parse, or asks for what this service does not do."""


class UnknownEntityError(InputError):
    """No entity has that name; the nearest names are told.

    Attributes:
        kind: What was looked for: kitchen, robot, container, joint.
        name: The name as given.
        near: The nearest known names, best first.

    Args:
        alike: From which likeness on names are proposed: less for what people type than for what files have.
    """

    def __init__(
        self, kind: str, name: str, known: Iterable[str], remedy: str = "", *, alike: float = FAR
    ) -> None:
        names = sorted(set(known))
        self.kind, self.name = kind, name
        self.near = _near(name, names, JOINT if JOINT in kind else "", alike)
        if self.near:
            allowed = "did you mean " + " or ".join(f"'{near}'" for near in self.near) + "?"
        else:
            shown = ", ".join(names[:10]) or "there are none"
            allowed = shown + (f", … ({len(names)} in all)" if len(names) > 10 else "")
        super().__init__(f"no {kind} named '{name}'", allowed=allowed, remedy=remedy)


def _near(name: str, names: list[str], word: str, far: float) -> list[str]:
    """Those that the name may stand for, best first, whatever is written in capitals.

    A word that all such names begin or end with is no likeness, but where it is that which is misspelled.
    """
    found = [each for each in names if each.casefold() == name.casefold()]
    near = found or _near_without(word, name, names, far)
    if not near and word and _without(word, name) == name.casefold():
        near = _near_without("", name, names, ALIKE)
    return near


def _near_without(word: str, name: str, names: list[str], far: float) -> list[str]:
    told: dict[str, list[str]] = {}
    for each in names:
        told.setdefault(_without(word, each), []).append(each)
    alike = (each for one in _alike(_without(word, name), list(told), far) for each in told[one])
    return list(alike)[:MOST_NEAR]


def _without(word: str, name: str) -> str:
    """The name, but for that word at its ends, in small letters."""
    name = name.casefold()
    if not word:
        return name
    return name.removeprefix(f"{word}_").removesuffix(f"_{word}")


def _alike(name: str, known: list[str], far: float) -> list[str]:
    """The nearest, best first; of a short name only what it is, but for a slip, or begins."""
    if len(name) > SHORT:
        return get_close_matches(name, known, n=MOST_NEAR, cutoff=far)
    alike = get_close_matches(name, known, n=MOST_NEAR, cutoff=ALIKE)
    if len(name) >= TELLING:
        alike += [each for each in known if _one_slip(name, each)]
        alike += sorted((each for each in known if each.startswith(name)), key=len)
    return list(dict.fromkeys(alike))[:MOST_NEAR]


def _one_slip(one: str, other: str) -> bool:
    """Whether a character more, less or other, or two that are swapped, is all that differs."""
    begin = _alike_for(one, other)
    one, other = one[begin:], other[begin:]
    end = _alike_for(one[::-1], other[::-1])
    one, other = one[: len(one) - end], other[: len(other) - end]
    return max(len(one), len(other)) <= 1 or (len(one) == 2 and one == other[::-1])


def _alike_for(one: str, other: str) -> int:
    """[characters] How long both begin alike."""
    return sum(takewhile(bool, map(eq, one, other)))


class NoModeError(SdtError):
    """Too many fields of the case are unknown: no predicate can run."""


class OracleError(SdtError):
    """An oracle kept no promise: there is no verdict."""


class OracleUnavailableError(OracleError):
    """Nobody answered."""


class OracleRejectedError(OracleError):
    """The oracle answered that it cannot judge this input."""


class StoreError(SdtError):
    """A store did not do what was asked of it; what it acknowledged before is kept.

    Attributes:
        place: Its address or path, without a password.
        what: What went wrong.
        remedy: What to do.
    """

    def __init__(self, place: str, what: str, *, remedy: str = "") -> None:
        self.place, self.what, self.remedy = place, what, remedy
        super().__init__("; ".join(part for part in (f"the store {place} {what}", remedy) if part))


class StoreUnavailableError(StoreError):
    """A server that does not answer, or a directory or file that another process holds."""


class StoreRejectedError(StoreError):
    """The store answered, but not with what was asked."""
