"""Which points of a mesh are one, and which of its triangles hang together."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from services.physics.geometry.pieces import joined, same_points

NEAR = st.sampled_from([-1.0, -1e-6, -4e-7, -0.0, 0.0, 4e-7, 6e-7, 1e-6, 0.1, 0.1000004, 2.0])
"""Coordinates of which some are one when rounded [m]."""


@given(arrays(float, st.tuples(st.integers(1, 40), st.just(3)), elements=NEAR))
def test_points_that_are_one_when_rounded_are_one_in_the_order_of_their_coordinates(
    points: np.ndarray,
) -> None:
    expected, which = np.unique(np.round(points, 6), axis=0, return_inverse=True)
    found, index = same_points(points)
    np.testing.assert_array_equal(found, expected)
    np.testing.assert_array_equal(index, which.reshape(-1))


@given(st.integers(1, 60), st.lists(st.tuples(*[st.integers(0, 59)] * 3), min_size=1, max_size=60))
def test_what_is_joined_over_any_number_of_rows_has_its_least_member_in_common(
    count: int, rows: list[tuple[int, int, int]]
) -> None:
    links = np.array(rows) % count
    ends = np.concatenate((links[:, :2], links[:, 1:]))
    graph = coo_matrix((np.ones(len(ends)), (ends[:, 0], ends[:, 1])), shape=(count, count))
    labels = connected_components(graph, directed=False)[1]
    expected = [int(np.flatnonzero(labels == label)[0]) for label in labels]
    assert joined(links, count).tolist() == expected
