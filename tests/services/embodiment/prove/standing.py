"""Fronts before a robot that stands, and proofs that the container comes into it."""

from pathlib import Path

import numpy as np

from sdt_kg.annotation import Drive
from sdt_kg.load import load_twin
from sdt_kg.twin import Twin
from services.embodiment.prove.prover import Proved, Prover
from tests.soak.doors import Front, draw, write

HERE = (0.0, 0.0, 0.0)


def front(folder: Path, robot: str, what: int | Front) -> Twin:
    """A front, or the one that is drawn from a seed, with the robot."""
    drawn = draw(np.random.default_rng(what)) if isinstance(what, int) else what
    return load_twin(write(drawn, folder, "front"), [robot])


def swept(twin: Twin, declared: bool = False) -> Proved | None:
    """What is proved of opening it with the base here."""
    door = twin.container("front_door")
    values = np.array([0.0, door.open_from])
    return Prover(twin, twin.robots[0], door, Drive.FIXED, HERE, values, declared=declared).swept()
