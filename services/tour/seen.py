"""What a camera would have seen of a motion that was made."""

from pathlib import Path

import numpy as np

from sdt_kg.load import load_twin
from services.physics.chain import chain
from services.physics.tree import build
from services.tour.steps import DOOR, MOTION, NOISE, TRACK


def write_track(folder: Path) -> None:
    """Write where the handle of the fridge was in the motion of mode 1: t x y z a row, with noise."""
    twin = load_twin("b")
    container = twin.container(DOOR)
    with np.load(folder / MOTION, allow_pickle=False) as motion:
        times, positions = motion["times"], motion["kitchen_positions"][:, 0]
    poses, _ = chain(build(twin.mechanism(twin.environment)), container.handle, twin.state).poses(positions)
    points = poses[:, :3, 3] + np.random.default_rng(0).normal(0, NOISE, (len(times), 3))
    np.savetxt(folder / TRACK, np.column_stack([times, points]), header="t x y z", comments="", fmt="%.5f")
