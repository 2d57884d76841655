"""The merged default graph after changes of named graphs, small and large."""

import pyoxigraph as ox
import pytest

from services.store.workers import bulk, deltas, drop, put
from services.store.workers.deltas import Held

A, B, C = "http://e/a", "http://e/b", "http://e/c"


def quads(*pairs: tuple[str, str]) -> bytes:
    return "".join(f'<http://e/s> <http://e/p> "{value}" <{graph}> .\n' for value, graph in pairs).encode()


def merged(held: Held) -> set[str]:
    found = held.store.quads_for_pattern(None, None, None, ox.DefaultGraph())
    return {getattr(quad.object, "value", "") for quad in found}


@pytest.mark.parametrize("large", [1, 2**24])
@pytest.mark.parametrize(("apart", "expected"), [((), {"1", "2", "3"}), ((C,), {"1", "2"}), ((A, C), {"2"})])
def test_bulk_merges_all_but_what_is_apart(
    monkeypatch: pytest.MonkeyPatch, large: int, apart: tuple[str, ...], expected: set[str]
) -> None:
    monkeypatch.setattr(deltas, "LARGE", large)
    held = Held()
    held.apply(bulk(quads(("1", A), ("2", B), ("3", C)), apart))
    assert merged(held) == expected
    held.apply(bulk(quads(("4", A), ("5", "http://e/d"))))
    assert merged(held) == expected | {"4", "5"} | ({"1"} if A in apart else set())


def test_hiding_a_graph_leaves_what_another_shown_graph_says_too() -> None:
    held = Held()
    held.apply(bulk(quads(("1", A), ("1", B), ("2", B), ("2", C)), [C]))
    held.apply(put(A, b"", turned=(A, B)))
    assert merged(held) == {"1"}
    held.apply(put(A, b"", turned=(C, C)))
    assert merged(held) == {"1", "2"}
    held.apply(drop(A))
    assert (merged(held), held.is_graph(A), held.is_graph(B)) == ({"2"}, False, True)


def test_a_graph_put_instead_is_what_was_put() -> None:
    held = Held()
    held.apply(put(A, b'<http://e/s> <http://e/p> "1" .'))
    held.apply(put(A, b'<http://e/s> <http://e/p> "2" .', instead=True))
    assert merged(held) == {"2"}
    with pytest.raises(SyntaxError):
        held.apply(put(A, b"nonsense", instead=True))
    assert merged(held) == {"2"}
    held.apply(put(B, b""))
    assert held.is_graph(B)
