"""RDF Patch: a difference as text that can be applied to the one side, and in reverse to the other.

Lines are `H` (header), `TX`, `TC`, `TA` (transactions), `A` and `D` (a quad or triple as in N-Quads),
as https://afs.github.io/rdf-patch/ has them; prefixes (`PA`, `PD`) are refused.
"""

import hashlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import pyoxigraph as ox

from sdt_kg.errors import GraphError
from sdt_kg.history.diff import Difference
from sdt_kg.iri import ID, Iri

ADD, DELETE = "A", "D"
_OPPOSITE = {ADD: DELETE, DELETE: ADD}


@dataclass(frozen=True, slots=True)
class Patch:
    """Changes in order.

    Attributes:
        changes: (`A` or `D`, quad), in the order in which they are made.
        before: SHA-256 of the quads that it applies to, empty if not told.
        after: SHA-256 of the quads that it makes, empty if not told.
    """

    changes: tuple[tuple[str, ox.Quad], ...]
    before: str = ""
    after: str = ""

    @property
    def iri(self) -> Iri:
        """The hash of what it changes."""
        text = "\n".join(f"{sign} {quad}" for sign, quad in self.changes)
        digest = hashlib.sha256(f"{self.before} {self.after}\n{text}".encode())
        return f"{ID}patch/{digest.hexdigest()}"

    def reverse(self) -> "Patch":
        """The patch that undoes this one."""
        changes = tuple((_OPPOSITE[sign], quad) for sign, quad in reversed(self.changes))
        return Patch(changes, self.after, self.before)

    def applied(self, quads: Iterable[ox.Quad]) -> frozenset[ox.Quad]:
        """The quads after it.

        Raises:
            GraphError: They are not those that it was made for: it could not be undone.
        """
        now = set(quads)
        _check("is not made for these quads", self.before, now)
        for sign, quad in self.changes:
            if (quad in now) != (sign == DELETE):
                state = "is there already" if sign == ADD else "is not there"
                raise GraphError(
                    f"the patch does not apply: {quad} {state}", allowed="the quads it is made for"
                )
            (now.add if sign == ADD else now.discard)(quad)
        _check("does not make what it says", self.after, now)
        return frozenset(now)

    def to_text(self) -> str:
        """As RDF Patch, one transaction."""
        head = [f"H id <{self.iri}> ."]
        head += [f'H before "{self.before}" .'] if self.before else []
        head += [f'H after "{self.after}" .'] if self.after else []
        body = [f"{sign} {_line(quad)}" for sign, quad in self.changes]
        return "\n".join([*head, "TX .", *body, "TC ."]) + "\n"


def patch_of(difference: Difference, before: Iterable[ox.Quad], after: Iterable[ox.Quad]) -> Patch:
    """The patch that makes the second set of quads of the first: deletions, then additions, sorted."""
    changes = [(DELETE, quad) for quad in sorted(difference.removed, key=_line)]
    changes += [(ADD, quad) for quad in sorted(difference.added, key=_line)]
    return Patch(tuple(changes), quads_hash(before), quads_hash(after))


def quads_hash(quads: Iterable[ox.Quad]) -> str:
    """SHA-256 over the quads as N-Quads, sorted."""
    return hashlib.sha256("\n".join(sorted(map(_line, quads))).encode()).hexdigest()


def _check(what: str, expected: str, quads: Iterable[ox.Quad]) -> None:
    if expected and quads_hash(quads) != expected:
        raise GraphError(f"the patch {what}", allowed=f"quads of SHA-256 {expected}")


def _line(quad: ox.Quad) -> str:
    written = ox.serialize([quad], format=ox.RdfFormat.N_QUADS)
    assert written is not None, "without an output, the bytes are returned"
    return written.decode().rstrip("\n")


def read_patch(text: str) -> Patch:
    """The patch that the text holds; what an aborted transaction has is left out.

    Raises:
        GraphError: A line that is none of RDF Patch, or that this reader does not do.
    """
    hashes: dict[str, str] = {}
    done: list[tuple[str, ox.Quad]] = []
    pending: list[tuple[str, ox.Quad]] | None = None
    for number, verb, rest in _rows(text):
        if verb == "H":
            key, _, value = rest.removesuffix(".").strip().partition(" ")
            hashes[key] = value.strip().strip('"')
        elif verb in (ADD, DELETE):
            (done if pending is None else pending).append((verb, _quad(rest, number)))
        elif verb == "TX" and pending is None:
            pending = []
        elif verb in ("TC", "TA") and pending is not None:
            done += pending if verb == "TC" else []
            pending = None
        else:
            raise GraphError(f"line {number} of the patch: '{verb}'", allowed="H, TX, TC, TA, A, D lines")
    if pending is not None:
        raise GraphError("the patch ends within a transaction", allowed="TC . at its end")
    return _checked(
        Patch(tuple(done), hashes.get("before", ""), hashes.get("after", "")), hashes.get("id", "")
    )


def _rows(text: str) -> Iterator[tuple[int, str, str]]:
    """Number, verb and rest of each line that says something."""
    # Not splitlines: a literal may hold what that takes for the end of a line.
    for number, line in enumerate(text.split("\n"), 1):
        verb, _, rest = line.strip(" \t\r").partition(" ")
        if verb and not verb.startswith("#"):
            yield number, verb, rest


def _checked(patch: Patch, given: str) -> Patch:
    if given.startswith(f"<{ID}patch/") and given != f"<{patch.iri}>":
        raise GraphError("the patch was changed: its id is not the hash of what it says")
    return patch


def _quad(text: str, number: int) -> ox.Quad:
    try:
        (quad,) = ox.parse(text.encode(), format=ox.RdfFormat.N_QUADS)
    except (SyntaxError, ValueError) as error:
        raise GraphError(f"line {number} of the patch: {error}", allowed="a quad as in N-Quads") from None
    return quad
