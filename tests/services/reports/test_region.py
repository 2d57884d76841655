"""The region of a proof is drawn where the proof says that no gripper holds the handle."""

import numpy as np
import pytest

from sdt_kg.iri import local_name
from services.reports.studies import diagnosis
from services.viewer.picture.skeleton import Skeleton
from services.viewer.picture.standing import kitchen_positions


@pytest.mark.oracle
def test_a_proof_is_drawn_as_boxes_around_the_handle() -> None:
    found = diagnosis.diagnosed("b", "stretch", "open:iai_fridge_door", drive="fixed")
    assert [each.proof for each in found.verdict.diagnoses] == [True]
    (clip,) = diagnosis.view(found).clips
    assert {line.label for line in clip.lines} == {
        "proved: no gripper holds the handle here with iai_fridge_door at 0 rad"
    }
    assert "Violet: proved" in clip.note
    for line in clip.lines:
        corners = {tuple(each) for each in line.points.round(9)}
        edges = {
            frozenset(map(tuple, pair))
            for pair in zip(line.points.round(9), line.points[1:].round(9), strict=False)
        }
        assert (len(corners), len(edges)) == (8, 12)
    twin = found.world.service.twin
    skeleton = Skeleton.of(twin.mechanism(twin.environment))
    handle = local_name(twin.container("iai_fridge_door").handle)
    at = skeleton.body(handle, kitchen_positions(skeleton, twin.state), np.eye(4))[:3, 3]
    points = np.concatenate([each.points for each in clip.lines])
    assert np.all(points.min(axis=0) < at + 0.05)
    assert np.all(points.max(axis=0) > at - 0.05)
    assert np.ptp(points, axis=0).max() < 1.0
