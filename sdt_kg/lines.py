"""A store as N-Quads, all of it at once, as it goes to another process."""

import pyoxigraph as ox


def to_lines(store: ox.Store) -> bytes:
    """All that it has."""
    return store.dump(format=ox.RdfFormat.N_QUADS) or b""  # None only where it was written to a file


def of_lines(lines: bytes) -> ox.Store:
    """A store in memory that has it."""
    store = ox.Store()
    store.bulk_load(lines, format=ox.RdfFormat.N_QUADS)
    return store
