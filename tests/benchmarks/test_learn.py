"""Figures of learning from observation, never assertions on time: `make bench`."""

from collections import defaultdict
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from predicates.learn import learn
from predicates.learn.phases import phases
from services.tracks import read_track
from tests.predicates.learn.logs import log
from tests.soak.test_tracks import LABELS, _of

Benchmark = Callable[..., Any]

TRACKS = {
    "shortest": "drawer_one/001.log",
    "usual": "mechanisms_iros_2010/right_door/001.log",
    "longest": "mechanisms_iros_2010/dishwasher/008.log",
}


@pytest.mark.reference
@pytest.mark.parametrize("which", TRACKS)
def test_learn_one_track(benchmark: Benchmark, reference: Path, which: str) -> None:
    track = read_track(reference / "articulation_tracks" / TRACKS[which])
    assert len(benchmark(learn, track).candidates) == 3


@pytest.mark.parametrize("kind", ["latch", "push_to_open"])
def test_phases_of_one_log(benchmark: Benchmark, kind: str) -> None:
    track, _ = log(kind, 0)
    joint = learn(track).best
    assert benchmark(phases, track, joint) is not None


@pytest.mark.reference
def test_accuracy_and_prediction_of_each_object(benchmark: Benchmark, reference: Path) -> None:
    """Label accuracy, and median error of the second half from the first [mm], as extra_info."""
    folder = reference / "articulation_tracks"

    def measure() -> dict[str, tuple[int, int, float]]:
        rows: dict[str, list[tuple[bool, float]]] = defaultdict(list)
        for path in sorted(folder.rglob("*.log")):
            track, label = read_track(path), LABELS[path.parent.name]
            half = len(track.positions) // 2
            gaps = _of(learn(track.part(0, half)), label).distance(track.positions[half:])
            right = learn(track).best.joint_type.value == label
            rows[path.parent.name].append((right, 1000 * float(np.median(gaps))))
        return {
            name: (sum(right for right, _ in each), len(each), float(np.median([mm for _, mm in each])))
            for name, each in rows.items()
        }

    benchmark.extra_info["objects"] = benchmark.pedantic(measure, rounds=1)
