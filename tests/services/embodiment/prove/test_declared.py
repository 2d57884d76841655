"""Proofs that take the robot's collision shapes for its bodies: what they refute, and that they say so."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from sdt_kg.mechanism import Body, Geometry, Pose, ShapeType
from services.embodiment.body.demands import Margins, rules
from services.embodiment.body.limb import make_limb
from services.embodiment.body.world import World
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check.inside.boxes import GAP, THIN, boxes_within
from services.embodiment.proof_check.inside.cores import pierced
from services.embodiment.proof_check.statement import Statement
from services.physics.model import Scene
from tests.services.embodiment.prove.standing import (
    HERE,
    Change,
    Known,
    again,
    front,
    refuted_front,
    swept,
    without_cores,
)
from tests.soak.doors import Front

TIPS, MET = 65, "torso_fixed_link"  # front whose door comes into that body of the TIAGo++
PASSING, PASSING_TOO = 47, 51  # fronts whose doors pass the corners that the PR2's base lacks
STANDING = 31  # front whose door comes into the TIAGo++'s column
BAR = 0.594  # [m] from the origin to what of a drawer's bar is nearest
STRIDE = 3  # every so many cores are looked at
FACE = 0.3342  # [m] from the origin to the front of the PR2's base


@pytest.fixture(scope="module")
def tipped(tmp_path_factory: pytest.TempPathFactory) -> Known:
    """A front whose door comes into shapes of a TIAGo++, not into what is known of its bodies."""
    folder = tmp_path_factory.mktemp("front")
    twin = front(folder, without_cores(folder, "tiago_dual", MET), TIPS)
    assert swept(twin, declared=False) is None
    proved = swept(twin, declared=True)
    assert proved is not None
    assert not proved.diagnosis.proof, "a TIAGo++ with closer shapes is not refuted"
    assert "collision shapes" in proved.diagnosis.reason
    return twin, proved


@pytest.fixture(scope="module")
def standing(tmp_path_factory: pytest.TempPathFactory) -> Known:
    """The same of a door that comes into the TIAGo++'s column, which is refuted for good."""
    twin, proved = refuted_front(tmp_path_factory.mktemp("front"), "tiago_dual", STANDING)
    assert proved.diagnosis.proof
    return twin, proved


def test_corners_that_the_base_lacks_refute_nothing(tmp_path: Path) -> None:
    assert swept(front(tmp_path, "pr2", PASSING), declared=True) is None


def test_a_proof_says_of_which_bodies_it_is(tipped: Known, standing: Known) -> None:
    holds, said = again(tipped)
    assert holds
    assert "its collision shapes for its bodies" in said
    assert "hasCore" not in said
    holds, said = again(standing)
    assert holds
    assert "collision shapes" not in said
    assert "hasCore" in said


def of_bodies(whole: dict[str, Any]) -> None:
    whole["claim"]["declared"] = False


def of_shapes(whole: dict[str, Any]) -> None:
    whole["claim"]["declared"] = True


def earlier(whole: dict[str, Any]) -> None:
    whole["refutations"][0]["value"] = 0.0


def unsaid(whole: dict[str, Any]) -> None:
    del whole["claim"]["declared"]


def older(whole: dict[str, Any]) -> None:
    unsaid(whole)
    del whole["claim"]["one_hold"]
    whole["schema"] = "sdt proof 5"


def older_and_said(whole: dict[str, Any]) -> None:
    whole["schema"] = "sdt proof 5"


def in_words(whole: dict[str, Any]) -> None:
    whole["claim"]["declared"] = "yes"


@pytest.mark.parametrize("change", [of_bodies, earlier, older])
def test_a_changed_proof_of_shapes_does_not_hold(tipped: Known, change: Change) -> None:
    assert not again(tipped, change)[0]


def test_one_of_bodies_is_none_of_shapes_and_an_older_one_is_read(standing: Known) -> None:
    assert not again(standing, of_shapes)[0]
    assert again(standing, older)[0]


@pytest.mark.parametrize("change", [unsaid, older_and_said, in_words])
def test_of_which_bodies_it_is_has_to_be_told(standing: Known, change: Change) -> None:
    with pytest.raises(InputError, match="how the robot's bodies are taken"):
        again(standing, change)


def coming(deep: float) -> Front:
    """A drawer that comes so deep [m] into the PR2's base."""
    return Front("drawer", 0.46, 0.2, (BAR - FACE + deep) / 0.9, 0.2, (0.6, 0.0, 0.15))


@pytest.mark.parametrize(("deep", "refuted"), [(0.001, False), (0.006, True)])
def test_a_drawer_is_refuted_if_it_comes_farther_into_a_base_than_certification_tolerates(
    tmp_path: Path, deep: float, refuted: bool
) -> None:
    twin = front(tmp_path, "pr2", coming(deep))
    assert (swept(twin, declared=True) is not None) is refuted


@pytest.mark.parametrize("radius", [0.02, 0.0557, 0.0853, 0.2691])
def test_boxes_fill_a_cylinder_but_for_a_millimetre_and_stay_inside(radius: float) -> None:
    pose = Pose((0.1, -0.2, 0.3), (0.0, 0.0, 0.0, 1.0))
    body = Body("one", collision=(Geometry(ShapeType.CYLINDER, pose, (radius, 0.4)),))
    angles, rim = np.linspace(0, 2 * np.pi, 1000), np.zeros(1000, dtype=np.bool_)
    points = np.stack([np.cos(angles), np.sin(angles), np.full(1000, 0.19)], axis=1)
    points = points * (radius - GAP, radius - GAP, 1.0) + pose.position
    for at, half in boxes_within(body):
        turn = (at.rotation.lo + at.rotation.hi) / 2
        corner = turn @ (half * (1, 1, 0))
        assert radius - 1e-6 < np.hypot(corner[0], corner[1]) < radius
        assert at.translation.lo == pytest.approx(pose.position, abs=1e-12)
        rim |= (np.abs((points - pose.position) @ turn) <= half).all(axis=1)
    assert rim.all()


def test_no_box_is_taken_of_what_is_thin_or_a_mesh() -> None:
    pose = Pose((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    plate = Geometry(ShapeType.BOX, pose, (0.3, 1.9 * THIN, 0.3))
    mesh = Geometry(ShapeType.MESH, pose, (1.0, 1.0, 1.0), "none.stl")
    block, ball = Geometry(ShapeType.BOX, pose, (0.3, 0.2, 0.1)), Geometry(ShapeType.SPHERE, pose, (0.1,))
    assert not [*boxes_within(Body("one", collision=(plate, mesh)))]
    (_, half), (_, cube) = boxes_within(Body("one", collision=(plate, block, ball)))
    assert half.tolist() == [0.15, 0.1, 0.05]
    assert np.linalg.norm(cube) == pytest.approx(0.1, abs=1e-9)


@pytest.mark.parametrize("robot", ["pr2", "tiago_dual"])
def test_postures_in_a_refuted_box_are_in_contact(tmp_path: Path, robot: str) -> None:
    twin, rng = front(tmp_path, robot, 16), np.random.default_rng(4)
    door = twin.container("front_door")
    about = Statement(twin, twin.robots[0], door, Drive.FIXED, HERE, Tolerances(), declared=True)
    gripper = about.grippers[0]
    arm = about.arm(gripper)
    assert arm is not None
    low, high = (np.array([getattr(one, end) for one in arm.chain.links]) for end in ("lower", "upper"))
    middle = rng.uniform(low, high, (100, len(low)))
    half = rng.uniform(0.0, 0.02, middle.shape)
    around = about.around(arm, 0.0)
    some = range(0, len(arm.cores), STRIDE)
    met = [pierced(arm.cores, c, arm.chain, around, (middle, half)) > 0 for c in some]
    chosen = np.flatnonzero(np.any(met, axis=0))
    assert len(chosen) >= 5
    q = middle[chosen] + half[chosen] * rng.uniform(-1, 1, (len(chosen), len(low)))
    world = World(Scene(twin, twin.robots[0]))
    demands = rules(world, make_limb(world, gripper), Margins(0.0, 0.0, 0.0))
    names = [link.name for link in arm.chain.links[3:]]
    scenes = [world.scene.q(one[:3], dict(zip(names, one[3:].tolist(), strict=True))) for one in q]
    assert all(world.contact(one[None], demands) is not None for one in scenes)
