"""Verdicts that `law` really gave, multiplied into as many kitchens as a store is to hold."""

import hashlib
import re
from collections.abc import Iterator, Sequence

import pyoxigraph as ox

from predicates.case import Verdict
from predicates.record import to_record
from sdt_kg.twin import Twin

QUADS_PER_KITCHEN = 5_000
"""Verdicts of one kitchen, in some states, with those states: 200 kitchens are a million quads."""

_NAME = re.compile(rb"example\.org/id/(graph/state/)?([ab])(?=[/>])")
_HASH = re.compile(rb"(/verdict/)([0-9a-f]{64})")
_STATE = re.compile(rb'(/input/2> <https://example.org/law#inputHash> ")([0-9a-f]{64})')


def multiplied(count: int, twins: Sequence[Twin], verdicts: Sequence[Verdict]) -> Iterator[bytes]:
    """N-Quads, at least so many lines: the twins as they are, then kitchen after kitchen of verdicts.

    The first kitchen keeps the names a and b, which queries spell out.
    """
    entities = b"".join({twin.environment: twin.serialize("nquads") for twin in twins}.values())
    yield entities
    made = entities.count(b"\n")
    template = _template(twins, verdicts)
    lines, kitchen = template.count(b"\n"), 0
    while made < count:
        for copy in range(max(1, round(QUADS_PER_KITCHEN / lines))):
            yield _renamed(template, kitchen, copy)
            made += lines
        kitchen += 1


def _template(twins: Sequence[Twin], verdicts: Sequence[Verdict]) -> bytes:
    quads = [quad for verdict in verdicts for quad in to_record(verdict).quads()]
    for twin in twins:
        quads += twin.entities.store.dump(twin.graphs()[-1:])
    text = ox.serialize(quads, format=ox.RdfFormat.N_QUADS)
    assert text is not None, "no output was given"
    return text


def _renamed(template: bytes, kitchen: int, copy: int) -> bytes:
    """The template about another kitchen and another state of it: other IRIs, other hashes."""

    def other(match: re.Match[bytes]) -> bytes:
        return match[1] + hashlib.sha256(b"%b %d %d" % (match[2], kitchen, copy)).hexdigest().encode()

    text = _STATE.sub(other, _HASH.sub(other, template))
    text = re.sub(rb"(/graph/state/[^/]+/)([0-9a-f]{16})", rb"\g<1>%08x" % (kitchen * 100 + copy), text)
    return text if kitchen == 0 else _NAME.sub(rb"example.org/id/\g<1>\g<2>%05d" % kitchen, text)
