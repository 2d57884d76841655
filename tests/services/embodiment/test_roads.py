"""The shortest way over the links of a roadmap."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

from services.embodiment.ways.roads import shortest


@pytest.mark.parametrize("seed", range(20))
def test_the_way_is_as_short_as_any_and_there_is_none_where_nothing_leads(seed: int) -> None:
    rng, count = np.random.default_rng(seed), 30
    pairs = {(int(a), int(b)) for a, b in rng.integers(0, count, (rng.integers(10, 60), 2)) if a < b}
    links = [(a, b, float(rng.uniform(0.1, 2.0))) for a, b in sorted(pairs)]
    one, other, length = (np.array(column) for column in zip(*links, strict=True))
    graph = coo_matrix((length, (one, other)), shape=(count, count))
    far = float(dijkstra(graph, directed=False, indices=0)[count - 1])
    way = shortest(links, 0, count - 1)
    if way is None:
        assert far == np.inf
        return
    steps = {frozenset((a, b)): d for a, b, d in links}
    assert (way[0], way[-1]) == (0, count - 1)
    assert sum(steps[frozenset(each)] for each in pairwise(way)) == pytest.approx(far)


def test_where_one_stands_already_the_way_is_that_place() -> None:
    assert shortest([(0, 1, 1.0)], 1, 1) == [1]
    assert shortest([(0, 1, 1.0)], 0, 2) is None
