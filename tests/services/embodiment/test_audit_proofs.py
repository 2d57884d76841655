"""No box of joint positions in which a posture has the handle in hand can be refuted, whatever is claimed."""

import numpy as np
import pytest

from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from sdt_kg.iri import joint_iri
from sdt_kg.load import load_twin
from services.embodiment.body.world import World
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check.geometry.interval import exact
from services.embodiment.proof_check.geometry.mechanics import Placement
from services.embodiment.proof_check.statement import Statement
from services.embodiment.proof_check.target import Target
from services.embodiment.proof_check.tree import all_far
from services.physics.model import Scene

pytestmark = pytest.mark.oracle

WITHIN = 0.999  # [1] of each tolerance, of contact and of the tool's slip, both used
WIDTHS = (0.0, 1e-6, 1e-3, 0.03, 0.3, 3.0)  # [rad or m]


def corners(world: World, q: np.ndarray, bodies: list[str]) -> np.ndarray:
    """Corners of the boxes about these bodies' shapes, shape (N, 3)."""
    rotations, places = world.frames(q)
    ends = np.array(np.meshgrid(*[(-1, 1)] * 3)).reshape(3, -1).T
    found = []
    for shape in world.shapes_of(bodies):
        joint = world.boxes[0][shape]
        local = world.boxes[2][shape] + (ends * world.half[shape]) @ world.boxes[1][shape].T
        found.append(local @ rotations[joint].T + places[joint])
    return np.vstack(found)


@pytest.mark.parametrize(
    ("robot", "drive"), [("pr2", Drive.FIXED), ("tiago_dual", Drive.OMNI), ("stretch", Drive.FIXED)]
)
def test_a_posture_that_holds_a_handle_is_in_no_refuted_box(robot: str, drive: Drive) -> None:
    twin, rng = load_twin("b", [robot]), np.random.default_rng(8)
    iri = twin.robots[0]
    scene = Scene(twin, iri)
    world = World(scene)
    statement = Statement(twin, iri, twin.container("iai_fridge_door"), drive, (0.3, -0.2, 0.7), Tolerances())
    for number in range(3):
        gripper = statement.grippers[number % len(statement.grippers)]
        arm = statement.arm(gripper)
        assert arm is not None
        low, high = (np.array([getattr(one, end) for one in arm.chain.links]) for end in ("lower", "upper"))
        truth = np.where(rng.random(len(low)) < 0.3, rng.choice([low, high]), rng.uniform(low, high))
        named = dict(zip((one.name for one in arm.chain.links), truth.tolist(), strict=True))
        base = [named.pop(name, 0.0) for name in ("base_x", "base_y", "base_yaw")]
        for finger in gripper.finger_joints:
            k = scene.coordinate[joint_iri(robot, finger.joint)]
            named[finger.joint] = rng.choice([scene.bounds.lower[k], scene.bounds.upper[k]])
        q = scene.q(base, named)
        turn = scene.placement(q, scene.tool_frame(gripper.name)).rotation
        axis = turn[:, 2 * rng.integers(2)] * rng.choice([-1, 1])  # out of the palm, or across
        ends = corners(world, q, [f"{iri}/body/{name}" for name in gripper.fingers])
        away = (Tolerances().contact + Tolerances().tool_position) * WITHIN
        half = rng.uniform(0.002, 0.008)
        middle = ends[np.argmax(ends @ axis)] + (away + half) * axis
        target = Target((Placement(exact(turn), exact(middle)),), np.full((1, 3), half), np.zeros(1))
        for width in WIDTHS:
            ends = truth - width * rng.random(len(low)), truth + width * rng.random(len(low))
            for leaf in range(len(low) + 1):
                with pytest.raises(InputError, match=r"come as near|come to the handle"):
                    all_far(arm, target, [(*ends, leaf)], statement.level)
