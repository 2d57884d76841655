"""Boxes inside the robot: what they refute is in contact, and a proof that rests on them is verified."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sdt_kg.annotation import Drive
from sdt_kg.load import load_twin
from sdt_kg.twin import Twin
from services.embodiment.body.demands import Margins, rules
from services.embodiment.body.limb import make_limb
from services.embodiment.body.world import World
from services.embodiment.certify import Certified, certify
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check import check
from services.embodiment.proof_check.arm import Arm
from services.embodiment.proof_check.check import refuted
from services.embodiment.proof_check.inside.cores import pierced
from services.embodiment.proof_check.proof.content import LEAF
from services.embodiment.proof_check.proof.written import read_proof
from services.embodiment.proof_check.statement import Statement
from services.embodiment.prove.prover import Proved, Prover
from services.physics.model import Scene
from tests.services.embodiment.gantry import FOLDER, RESTS, opening
from tests.small import beside
from tests.soak.doors import Front, draw, write

ROBOTS = ("pr2", "tiago_dual")
BASE = {"pr2": {"base_link"}, "tiago_dual": {"base_link", "torso_fixed_link"}}
"""Bodies of the base at the height of a drawer."""
HERE = (0.0, 0.0, 0.0)
NEAR = Front("drawer", 0.46, 0.2, 0.45, 0.2, (0.5, 0.0, 0.25))
"""A drawer that opens into the base of whoever stands at the origin."""
POSTURES = 400
MIDDLES = {"pr2": 300, "tiago_dual": 1000}
"""Of boxes of joint positions: enough that some fifteen are refuted, also of wide ones."""
BOXES = 4000


def front(folder: Path, robot: str, what: Front = NEAR) -> Twin:
    return beside(write(what, folder, f"front_{robot}"), robot)


def statement(twin: Twin) -> Statement:
    return Statement(twin, twin.robots[0], twin.container("front_door"), Drive.FIXED, HERE, Tolerances())


def deepest(about: Statement, arm: Arm, value: float, middle: np.ndarray, half: np.ndarray) -> np.ndarray:
    """Depth of the deepest point of anything solid in any core, shape (L,)."""
    around = about.around(arm, value)
    each = [pierced(arm.cores, c, arm.chain, around, (middle, half)) for c in range(len(arm.cores))]
    return np.max(each, axis=0)


def postures(arm: Arm, rng: np.random.Generator, count: int) -> np.ndarray:
    low, high = (np.array([getattr(one, end) for one in arm.chain.links]) for end in ("lower", "upper"))
    return rng.uniform(low, high, (count, len(low)))


def touching(twin: Twin, about: Statement, arm: Arm, q: np.ndarray, value: float) -> np.ndarray:
    """Whether the planner's shapes, which contain the real ones, touch at postures (L, n)."""
    scene = Scene(twin.at({twin.container("front_door").joint: value}), twin.robots[0])
    world = World(scene)
    (gripper,) = (one for one in about.grippers if one.name == arm.gripper)
    limb = make_limb(world, gripper)
    demands = rules(world, limb, Margins(0.0, 0.0, 0.0))
    names = [link.name for link in arm.chain.links[3:]]
    scenes = (scene.q(one[:3], dict(zip(names, one[3:].tolist(), strict=True))) for one in q)
    return np.array([world.contact(one[None], demands) is not None for one in scenes])


@pytest.mark.parametrize("robot", ROBOTS)
def test_of_400_postures_none_that_is_free_is_refuted_and_many_in_contact_are(
    tmp_path: Path, robot: str
) -> None:
    twin = front(tmp_path, robot, draw(np.random.default_rng(16)))
    about = statement(twin)
    arm = about.arm(about.grippers[0])
    assert arm is not None
    q = postures(arm, np.random.default_rng(1), POSTURES)
    met = deepest(about, arm, 0.0, q, np.zeros_like(q)) > 0
    contact = touching(twin, about, arm, q, 0.0)
    assert contact[met].all()
    assert not contact.all()
    assert met.sum() > POSTURES / 20


@pytest.mark.parametrize("width", [0.01, 0.04])
@pytest.mark.parametrize("robot", ROBOTS)
def test_all_postures_of_a_refuted_box_are_in_contact(tmp_path: Path, robot: str, width: float) -> None:
    twin, rng = front(tmp_path, robot), np.random.default_rng(2)
    about = statement(twin)
    arm = about.arm(about.grippers[0])
    assert arm is not None
    middle = postures(arm, rng, MIDDLES[robot])
    half = rng.uniform(0.0, width, middle.shape)
    met = np.flatnonzero(deepest(about, arm, 0.0, middle, half) > 0)
    assert len(met) >= 15
    inside = [middle[k] + half[k] * rng.uniform(-1, 1, (10, middle.shape[1])) for k in met[:15]]
    assert touching(twin, about, arm, np.concatenate(inside), 0.0).all()


def found(twin: Twin) -> Proved | None:
    container = twin.container("front_door")
    values = np.array([0.0, container.open_from])
    return Prover(twin, twin.robots[0], container, Drive.FIXED, HERE, values).prove(BOXES)


@pytest.mark.parametrize("robot", ROBOTS)
def test_a_drawer_that_opens_into_a_fixed_base_is_refuted_in_one_box(tmp_path: Path, robot: str) -> None:
    twin = front(tmp_path, robot)
    proved = found(twin)
    assert proved is not None
    asked = twin, twin.robots[0], twin.container("front_door")
    assert check(*asked, proved.artefact.content).holds
    assert any(body in proved.diagnosis.reason for body in BASE[robot])
    refutation = read_proof(proved.artefact.content).refutations[0]
    assert len(refutation.tree) == 1
    (code,) = refutation.tree
    assert code > LEAF + len(refutation.joints), "a core, not a distance"
    about = statement(twin)
    arm = about.arm(about.grippers[0])
    assert arm is not None
    span = read_proof(proved.artefact.content).claim.span
    holding: dict[int, str] = {}
    for c, core in enumerate(arm.cores):
        other = LEAF + len(refutation.joints) + 1 + c
        reasons, _ = refuted(about, span, (replace(refutation, tree=bytes([other])),))
        if not any(refutation.gripper + ":" in reason for reason in reasons):
            holding[other] = core.body
    assert code in holding
    assert set(holding.values()) == BASE[robot]


def test_the_same_drawer_farther_away_is_not_refuted(tmp_path: Path) -> None:
    twin = front(tmp_path, "pr2", Front("drawer", 0.46, 0.2, 0.3, 0.2, (0.75, 0.0, 0.8)))
    assert found(twin) is None


def test_a_robot_without_cores_is_refuted_by_reach_alone(tmp_path: Path) -> None:
    about = statement(front(tmp_path, "stretch"))
    arm = about.arm(about.grippers[0])
    assert arm is not None
    assert arm.cores == ()
    assert about.around(arm, 0.0) == ()


CORE = """
b:{} sdt:hasCore <https://example.org/id/gantry/core> .
<https://example.org/id/gantry/core> a sdt:Box ; sdt:sizeX {} ; sdt:sizeY {} ; sdt:sizeZ {} ;
    sdt:hasPose <https://example.org/id/gantry/core/pose> .
<https://example.org/id/gantry/core/pose> a sdt:Pose ; sdt:x {} ; sdt:y 0.0 ; sdt:z {} ;
    sdt:qx 0.0 ; sdt:qy 0.0 ; sdt:qz 0.0 ; sdt:qw 1.0 .
"""
WHOLE = '<collision><geometry><box size="0.2 0.2 0.6"/></geometry></collision>'
POST = '<collision><origin xyz="0 {} 0"/><geometry><box size="0.2 0.06 0.6"/></geometry></collision>'
POSTS = POST.format(-0.07) + POST.format(0.07)
"""As far apart as the tower is wide: all corners of a core lie in them, and nothing is amid them."""


@pytest.mark.parametrize(
    ("shapes", "aside", "is_inside"), [(WHOLE, 0.0, True), (WHOLE, 0.2, False), (POSTS, 0.0, False)]
)
def test_a_core_that_sticks_out_of_its_body_refutes_nothing(
    tmp_path: Path, shapes: str, aside: float, is_inside: bool
) -> None:
    # What it meets, certification, which knows of shapes alone, would let pass.
    urdf = (FOLDER / "gantry.urdf").read_text()
    tower = f'<link name="tower">{shapes}</link>'
    fixed = '<joint name="tower_joint" type="fixed"><parent link="base"/><child link="tower"/></joint>'
    (tmp_path / "gantry.urdf").write_text(urdf.replace("</robot>", f"{tower}{fixed}</robot>"))
    core = CORE.format("tower", 0.15, 0.15, 0.5, aside, 0.0)
    (tmp_path / "gantry.ttl").write_text((FOLDER / "gantry.ttl").read_text() + core)
    twin = load_twin(FOLDER / "cell.urdf", [tmp_path / "gantry.urdf"])
    about = Statement(twin, twin.robots[0], twin.container("drawer_main"), Drive.FIXED, HERE, Tolerances())
    arm = about.arm(about.grippers[0])
    assert arm is not None
    assert [each.body for each in arm.cores] == (["tower"] if is_inside else [])


STEP = """<link name="step"><collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
<joint name="step_joint" type="fixed"><parent link="world"/><child link="step"/>
<origin xyz="{} 0 0.1"/></joint>"""
BACK = 0.000999  # [m] as far from its start as certification lets a fixed base stand, but for rounding
ROUNDED = 9e-5  # [m] of a core on each side out of the base, whose collision shape is 0.4 m long


@pytest.mark.oracle
@pytest.mark.parametrize(("clear", "passes"), [(5e-5, True), (-1e-3, False)])
def test_what_a_core_meets_that_sticks_out_by_rounding_is_not_refuted_where_it_is_certified(
    tmp_path: Path, clear: float, passes: bool
) -> None:
    """The base stands before a step, nearer to it than its core sticks out of its shape, or inside it."""
    text = (FOLDER / "gantry.ttl").read_text().replace(", <https://example.org/id/gantry/gripper/other>", "")
    (tmp_path / "gantry.ttl").write_text(text + CORE.format("base", 0.4 + 2 * ROUNDED, 0.4, 0.19, 0.0, 0.1))
    (tmp_path / "gantry.urdf").write_text((FOLDER / "gantry.urdf").read_text())
    step = STEP.format(0.4 - BACK + 0.2 + clear + 0.05)
    (tmp_path / "cell.urdf").write_text((FOLDER / "cell.urdf").read_text().replace("<!-- more -->", step))
    twin = load_twin(tmp_path / "cell.urdf", [tmp_path / "gantry.urdf"])
    robot, drawer, start = twin.robots[0], twin.container("drawer_main"), (0.4, 0.0, 0.0)
    rests = RESTS.copy()
    rests[:, 1] = start[0] - BACK
    rests[2:, 5] = 0.635 + BACK - rests[2:, 8]
    moved = opening(rests=rests)
    found = certify(twin, robot, moved, drawer, Tolerances(), drive=Drive.FIXED, start=start)
    proved = Prover(twin, robot, drawer, Drive.FIXED, start, np.array([0.0, 0.46])).prove(BOXES)
    assert isinstance(found, Certified) is passes
    assert (proved is None) is passes
