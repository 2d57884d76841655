"""Φ′ terms that only forces show: latches and push-to-open mechanisms."""

from dataclasses import replace

import numpy as np
import pytest

from predicates.learn import learn
from predicates.learn.phases import Latch, Plain, PushToOpen, phases
from sdt_kg.errors import MotionError
from tests.predicates.learn.logs import Truth, log
from tests.predicates.learn.observed import drawer, seen, stopping

NAMES = {Plain: "plain", Latch: "latch", PushToOpen: "push_to_open"}


def recovered(kind: str, seed: int) -> bool:
    """The kind is right, forces are within 4 N, the depth within 2 mm and the way out within 5 mm."""
    track, truth = log(kind, seed)
    found = phases(track, learn(track).best)
    return NAMES[type(found)] == kind and _close(found, truth)


def _close(found: Latch | PushToOpen | Plain, truth: Truth) -> bool:
    if isinstance(found, Plain):
        return abs(found.friction - truth.friction) < 1.0
    if isinstance(found, Latch):
        return abs(found.force - truth.force) < 4.0 and abs(found.friction - truth.friction) < 1.0
    return (
        abs(found.force - truth.force) < 4.0
        and abs(found.depth - truth.depth) < 0.002
        and abs(found.spring_out - truth.spring_out) < 0.005
    )


@pytest.mark.parametrize("kind", ["plain", "latch", "push_to_open"])
def test_four_logs_of_each_kind_are_recovered(kind: str) -> None:
    assert [seed for seed in range(4) if not recovered(kind, seed)] == []


def test_what_was_pushed_in_came_out_by_itself() -> None:
    track, truth = log("push_to_open", 4)
    found = phases(track, learn(track).best)
    assert isinstance(found, PushToOpen)
    assert found.depth == pytest.approx(truth.depth, abs=3 * found.depth_deviation)
    assert 0.9 < found.release_time < 1.6


@pytest.mark.parametrize("force", [(-6.0, 8.0, 0.0), (6.0, -8.0, 0.0)])
def test_a_force_that_never_lets_go_is_no_push_to_open(force: tuple[float, float, float]) -> None:
    """As from a sensor that counts the other way."""
    for seed in range(4):
        track, _ = log("plain", seed)
        held = replace(track, forces=np.tile(force, (len(track.positions), 1)))
        assert isinstance(phases(held, learn(held).best), Plain)


def test_what_is_held_back_on_its_way_is_no_push_to_open() -> None:
    for seed in range(8):
        track, _ = log("plain", seed)
        assert track.forces is not None
        held = replace(track, forces=-track.forces)
        assert isinstance(phases(held, learn(held).best), Plain)


def test_without_forces_nothing_is_said_of_latches() -> None:
    track = seen(drawer(stopping(0.4)))
    with pytest.raises(MotionError, match="track has no forces"):
        phases(track, learn(track).best)


def test_what_stands_still_has_no_phases() -> None:
    track, _ = log("plain", 0)
    still = seen(np.tile(track.positions[0], (len(track.positions), 1)))
    with pytest.raises(MotionError, match="does not move"):
        phases(track, learn(still).best)
