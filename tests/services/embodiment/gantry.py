"""A gantry robot with a two-finger gripper, a kitchen with one drawer, and a motion that opens it."""

from pathlib import Path

import numpy as np

from sdt_kg.iri import joint_iri, model_iri
from sdt_kg.load import load_twin
from sdt_kg.motion import BodyMotion
from sdt_kg.twin import Twin

FOLDER = Path(__file__).resolve().parent / "gantry"
START = (0.0, 0.0, 0.0)


def gantry_twin(folder: Path, more: str = "") -> Twin:
    """Twin of the cell and the gantry, with more links and joints in the kitchen if wanted."""
    cell = (FOLDER / "cell.urdf").read_text().replace("<!-- more -->", more)
    (folder / "cell.urdf").write_text(cell)
    return load_twin(folder / "cell.urdf", [FOLDER / "gantry.urdf"])


JOINTS = ("lift_joint", "arm_joint", "wrist_joint", "up_joint")
DRAWER = joint_iri("cell", "drawer_main_joint")
# Seconds, and at each a rest: base x, y, yaw; the joints above; drawer. The bar is at x = 1.205 m.
RESTS = np.array(
    (
        (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.04, 0.0),
        (5.0, 0.4, 0.0, 0.0, 0.2, 0.0, 0.0, 0.04, 0.0),
        (9.0, 0.4, 0.0, 0.0, 0.2, 0.635, 0.0, 0.04, 0.0),
        (11.0, 0.4, 0.0, 0.0, 0.2, 0.635, 0.0, 0.005, 0.0),
        (18.0, 0.0, 0.0, 0.0, 0.2, 0.575, 0.0, 0.005, 0.46),
    )
)
# And then, if wanted: the fingers open, the hand leaves.
LETTING_GO = np.vstack(
    (
        RESTS,
        (20.0, 0.0, 0.0, 0.0, 0.2, 0.575, 0.0, 0.04, 0.46),
        (23.0, 0.0, 0.0, 0.0, 0.2, 0.375, 0.0, 0.04, 0.46),
    )
)

# Or the drawer is pulled half out, let go, taken hold of 30 mm beside, and pulled on.
TWICE = np.vstack(
    (
        RESTS[:4],
        (15.0, 0.2, 0.0, 0.0, 0.2, 0.605, 0.0, 0.005, 0.23),
        (17.0, 0.2, 0.0, 0.0, 0.2, 0.605, 0.0, 0.04, 0.23),
        (19.0, 0.2, 0.0, 0.0, 0.2, 0.405, 0.0, 0.04, 0.23),
        (21.0, 0.2, 0.03, 0.0, 0.2, 0.405, 0.0, 0.04, 0.23),
        (23.0, 0.2, 0.03, 0.0, 0.2, 0.605, 0.0, 0.04, 0.23),
        (25.0, 0.2, 0.03, 0.0, 0.2, 0.605, 0.0, 0.005, 0.23),
        (29.0, 0.0, 0.03, 0.0, 0.2, 0.575, 0.0, 0.005, 0.46),
    )
)


def opening(step: float = 0.1, rests: np.ndarray = RESTS, joints: tuple[str, ...] = JOINTS) -> BodyMotion:
    """From rest to rest by cubic time laws, sampled every `step` seconds."""
    times = np.unique(np.concatenate((np.arange(0, rests[-1, 0], step), rests[:, 0])).round(9))
    leg = np.clip(np.searchsorted(rests[:, 0], times, side="right") - 1, 0, len(rests) - 2)
    length = rests[leg + 1, :1] - rests[leg, :1]
    part = (times[:, None] - rests[leg, :1]) / length
    way = rests[leg + 1, 1:] - rests[leg, 1:]
    q = rests[leg, 1:] + way * (3 * part**2 - 2 * part**3)
    v = way * (6 * part - 6 * part**2) / length
    count = 3 + len(joints)
    return BodyMotion(
        model_iri("gantry"),
        "hand",
        joints,
        times,
        q[:, :3],
        q[:, 3:count],
        v[:, 3:count],
        v[:, :3],
        (DRAWER,),
        q[:, count:],
        v[:, count:],
    )
