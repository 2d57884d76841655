"""Proofs about holds in hand: what they refute, and that all grasps that are searched are meant."""

import json
import zlib
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize

from predicates.case import Artefact, ArtefactKind
from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from sdt_kg.load import load_twin
from sdt_kg.twin import Twin
from services.embodiment.body.demands import Margins, touching
from services.embodiment.body.world import World
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.hold.fit import Fitter
from services.embodiment.hold.handle import Mechanics, find_bar
from services.embodiment.hold.holding import Problem
from services.embodiment.hold.kit import Kits
from services.embodiment.hold.sets import grasp_set, wide_set
from services.embodiment.proof_check import check
from services.embodiment.proof_check.geometry.interval import exact
from services.embodiment.proof_check.geometry.mechanics import Placement
from services.embodiment.proof_check.proof.content import IN_HAND
from services.embodiment.proof_check.statement import Statement
from services.embodiment.proof_check.target import Target
from services.embodiment.proof_check.tree import all_far
from services.embodiment.prove import Proved, Prover, in_hand
from services.physics.model import Scene
from services.viewer.judging.measure import region
from tests.small import beside
from tests.soak.doors import draw, write

HERE = (0.0, 0.0, 0.0)
HIGH, LOW = 14, 6  # fronts by number: handles 1.65 m and 0.77 m above the floor
BOXES = 1000
WITHIN = 0.999  # [1] of the distance and of the tool's slip, both used
WIDTHS = (0.0, 1e-6, 1e-3, 0.03, 0.3, 3.0)  # [rad or m]
ENDS = np.array(np.meshgrid(*[(-1, 1)] * 3)).reshape(3, -1).T


def front(folder: Path, number: int) -> Twin:
    return beside(write(draw(np.random.default_rng(number)), folder, f"front{number}"), "stretch")


def found(twin: Twin, within: float | None) -> Proved | None:
    door = twin.container("front_door")
    values = np.array([0.0, door.open_from])
    return Prover(twin, twin.robots[0], door, Drive.OMNI, HERE, values, within).prove(BOXES)


@pytest.fixture(scope="module")
def high(tmp_path_factory: pytest.TempPathFactory) -> tuple[Twin, bytes]:
    """A front whose handle a finger of Stretch can touch, and that Stretch cannot have in hand."""
    twin = front(tmp_path_factory.mktemp("front"), HIGH)
    proved = found(twin, IN_HAND)
    assert proved is not None
    assert not proved.diagnosis.proof, "other holds are not refuted"
    assert "within 0.02 m" in proved.diagnosis.reason
    return twin, proved.artefact.content


def test_a_handle_that_can_be_touched_is_refuted_in_hand_and_the_proof_says_so(
    high: tuple[Twin, bytes],
) -> None:
    twin, content = high
    checked = check(twin, twin.robots[0], twin.container("front_door"), content)
    assert checked.holds, checked.reasons
    assert "in hand" in checked.statement
    assert any("at most 20 mm" in each for each in checked.assumptions)


def test_the_region_that_is_drawn_is_about_the_middle_between_the_fingers(high: tuple[Twin, bytes]) -> None:
    twin, content = high
    mark = region(twin, Artefact(ArtefactKind.PROOF, content))
    assert mark is not None
    assert "middle between its fingers" in mark.text
    assert min(min(box.sides) for box in mark.boxes) > 2 * IN_HAND


def test_a_handle_in_reach_is_not_refuted(tmp_path: Path) -> None:
    assert found(front(tmp_path, LOW), IN_HAND) is None


def test_no_optimised_posture_has_the_tool_as_near_as_the_proof_excludes(high: tuple[Twin, bytes]) -> None:
    twin, _ = high
    scene, rng = Scene(twin, twin.robots[0]), np.random.default_rng(3)
    q, bounds = scene.q(HERE, {}), scene.bounds
    own = [k for k in range(len(q)) if np.isfinite(bounds.upper[k]) and k not in scene.base]
    (gripper,) = scene.annotation.grippers
    tool = scene.tool_frame(gripper.name)

    def height(x: np.ndarray) -> float:
        at = q.copy()
        at[own] = x
        return -float(scene.placement(scene.coupling.positions(at), tool).translation[2])

    limits = np.stack((bounds.lower[own], bounds.upper[own]), axis=1)
    highest = -min(
        minimize(height, rng.uniform(*limits.T), method="L-BFGS-B", bounds=limits).fun for _ in range(5)
    )
    door = twin.container("front_door")
    target = Statement(twin, twin.robots[0], door, Drive.OMNI, HERE, Tolerances(), within=IN_HAND).target(0.0)
    lowest = min(
        float(box.translation.lo[2] - half[2]) for box, half in zip(target.boxes, target.half, strict=True)
    )
    assert 1.2 < highest < lowest


@pytest.mark.parametrize(
    ("robot", "drive"), [("pr2", Drive.FIXED), ("tiago_dual", Drive.OMNI), ("stretch", Drive.FIXED)]
)
def test_a_posture_with_the_handle_in_hand_is_in_no_refuted_box(robot: str, drive: Drive) -> None:
    check_posture(robot, drive, 2)


def check_posture(robot: str, drive: Drive, count: int) -> None:
    """None of so many postures that have the handle in hand, by each gripper in turn, is refuted."""
    twin, rng = load_twin("b", [robot]), np.random.default_rng(9)
    about = twin, twin.robots[0], twin.container("iai_fridge_door"), drive, (0.3, -0.2, 0.7), Tolerances()
    statement = Statement(*about, within=IN_HAND)
    widened = IN_HAND + Tolerances().tool_position
    for number in range(count):
        arm = statement.arm(statement.grippers[number % len(statement.grippers)])
        assert arm is not None
        low, high = (np.array([getattr(one, end) for one in arm.chain.links]) for end in ("lower", "upper"))
        truth = np.where(rng.random(len(low)) < 0.3, rng.choice([low, high]), rng.uniform(low, high))
        _, _, tool = arm.chain.frames(truth[None])
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        half, away = rng.uniform(0.002, 0.008, 3), rng.normal(size=3)
        corner = rng.choice([-1, 1]) * half  # the tool lies beyond a corner or a face of the handle
        beyond = corner + np.sign(corner) * np.abs(away) / np.linalg.norm(away) * widened * WITHIN
        middle = tool.translation.lo[0] - turn @ beyond
        target = Target((Placement(exact(turn), exact(middle)),), half[None] + widened, np.zeros(1))
        for width in WIDTHS:
            ends = truth - width * rng.random(len(low)), truth + width * rng.random(len(low))
            for leaf in range(len(low) + 1):
                with pytest.raises(InputError, match=r"come as near|come to the handle"):
                    all_far(arm, target, [(*ends, leaf)], statement.level)


def wider(whole: dict[str, Any]) -> None:
    whole["claim"]["within"] = 0.3


def narrower(whole: dict[str, Any]) -> None:
    whole["claim"]["within"] = 0.001


def unsaid(whole: dict[str, Any]) -> None:
    del whole["claim"]["within"]


def of_all(whole: dict[str, Any]) -> None:
    del whole["claim"]["within"], whole["claim"]["declared"], whole["claim"]["one_hold"]
    whole["schema"] = "sdt proof 2"


def older(whole: dict[str, Any]) -> None:
    whole["schema"] = "sdt proof 2"


def open_wide(whole: dict[str, Any]) -> None:
    whole["refutations"][0]["value"] = 99.0


def careless(whole: dict[str, Any]) -> None:
    whole["refutations"][0]["tree"] = "gA=="  # 128: that the lift's origin never comes near


def about_times(whole: dict[str, Any]) -> None:
    whole["claim"]["timing"] = {"times": [0.0, 0.001], "values": [0.0, 1.4]}
    whole["window"], whole["refutations"] = [0, 1], []


CHANGES = (wider, narrower, of_all, open_wide, careless, about_times)


def changed(content: bytes, change: Callable[[dict[str, Any]], None]) -> bytes:
    whole = json.loads(zlib.decompress(content))
    change(whole)
    return zlib.compress(json.dumps(whole).encode())


@pytest.mark.parametrize("change", CHANGES)
def test_a_changed_proof_does_not_hold(
    high: tuple[Twin, bytes], change: Callable[[dict[str, Any]], None]
) -> None:
    twin, content = high
    assert not check(twin, twin.robots[0], twin.container("front_door"), changed(content, change)).holds


@pytest.mark.parametrize("change", [unsaid, older])
def test_which_holds_are_meant_is_told_in_a_schema_of_its_own(
    high: tuple[Twin, bytes], change: Callable[[dict[str, Any]], None]
) -> None:
    twin, content = high
    with pytest.raises(InputError, match="which holds are meant"):
        check(twin, twin.robots[0], twin.container("front_door"), changed(content, change))


@pytest.mark.parametrize("kitchen", ["a", "b"])
def test_every_grasp_of_every_handle_has_it_in_hand(kitchen: str) -> None:
    twin = load_twin(kitchen, ["pr2"])
    world = World(Scene(twin, twin.robots[0]))
    seen = 0
    for container in twin.containers():
        bar = find_bar(world, Mechanics(world, container), world.scene.q(HERE, {}))
        if bar is None:
            continue
        for grasps in (grasp_set(bar), wide_set(bar)):
            seen += 1
            assert in_hand(world, container.handle, np.unique([one.translation for one in grasps], axis=0))
        assert not in_hand(world, container.handle, [bar.centre + 0.1 * bar.outward])
    assert seen > 20


@pytest.mark.parametrize("robot", ["pr2", "tiago_dual", "stretch"])
def test_a_grasp_has_the_handle_in_hand_when_the_fingers_are_closed_too(tmp_path: Path, robot: str) -> None:
    path = write(draw(np.random.default_rng(HIGH)), tmp_path, "front")
    twin = beside(path, robot)
    world = World(Scene(twin, twin.robots[0]))
    container, kits = twin.container("front_door"), Kits(world, Margins())
    mechanics = Mechanics(world, container)
    for gripper in world.scene.annotation.grippers:
        kit = kits.of(gripper)
        q = kit.limb.q(kit.limb.parked)
        bar = find_bar(world, mechanics, q)
        assert bar is not None
        values = np.linspace(0.0, container.open_from, 7)
        handle_r, handle_p = mechanics.handle_poses(q, bar.joint, values)
        problem = Problem(mechanics, values, handle_r, handle_p, handle_r[0] @ bar.outward)
        rules = touching(world, kit.limb, kit.demands, (container.handle,)), kit.demands
        fitter = Fitter(kit.hand, problem, bar, rules, Counter())
        grasps = [*filter(None, map(fitter.fitted, fitter.wide(lambda: False)))]
        assert grasps
        assert in_hand(world, container.handle, [grasp.translation for grasp, _ in grasps])
