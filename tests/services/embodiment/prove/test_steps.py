"""Steps up a lift: no motion takes a container past them, and a check finds out where one is missing."""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from sdt_kg.twin import Twin
from services.embodiment.body.demands import Margins, rules
from services.embodiment.body.limb import make_limb
from services.embodiment.body.world import World
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check.arm import Arm
from services.embodiment.proof_check.check import leaves_of_one
from services.embodiment.proof_check.inside.solids import FLOOR
from services.embodiment.proof_check.proof.content import STEPPED, Steps
from services.embodiment.proof_check.proof.written import read_proof
from services.embodiment.proof_check.statement import Statement
from services.embodiment.proof_check.steps import LIFT
from services.embodiment.prove import never
from services.embodiment.prove.limbs.steps import Climb
from services.physics.model import Scene
from tests.services.embodiment.prove.standing import (
    HERE,
    Change,
    Known,
    again,
    front,
    refuted_front,
    swept,
    up_to_its_stops,
)
from tests.small import beside
from tests.soak.doors import draw, write

TIPS = 106
"""Front whose door tips past the right shoulder of the PR2: at no value it is in the way of all the lift."""
POSTURES = 20  # at each place of a step


@pytest.fixture(scope="module")
def tipped(tmp_path_factory: pytest.TempPathFactory) -> Known:
    folder = tmp_path_factory.mktemp("front")
    return refuted_front(folder, up_to_its_stops(folder, "pr2"), TIPS)


def about(twin: Twin) -> Statement:
    door = twin.container("front_door")
    span = (0.0, door.open_from)
    return Statement(twin, twin.robots[0], door, Drive.FIXED, HERE, Tolerances(), span=span)


def climber(tipped: Known, late: Callable[[], bool]) -> tuple[Climb, Arm]:
    """Who looks for steps at the values of those that are known, and an arm."""
    statement = about(tipped[0])
    one = read_proof(tipped[1].artefact.content).refutations[0]
    arm = statement.arm(statement.grippers[0])
    assert arm is not None
    assert one.steps is not None
    return Climb(statement, one.beside, sorted(set(one.steps.values)), arm, late), arm


def test_a_door_that_a_lift_dodges_at_each_value_is_refuted_for_good(tipped: Known) -> None:
    _, proved = tipped
    assert proved.diagnosis.proof
    for one in read_proof(proved.artefact.content).refutations:
        assert one.steps is not None
        assert len(set(one.steps.values)) > 1
    holds, said = again(tipped)
    assert holds
    assert STEPPED in said


def test_everywhere_on_the_steps_something_is_in_contact(tipped: Known) -> None:
    twin, proved = tipped
    door, rng = twin.container("front_door"), np.random.default_rng(0)
    one, gripper = read_proof(proved.artefact.content).refutations[0], about(twin).grippers[0]
    arm = about(twin).arm(gripper)
    assert one.steps is not None
    assert arm is not None
    low, high = arm.chain.ranges()
    names = [link.name for link in arm.chain.links[3:]]
    edges = np.linspace(low[LIFT], high[LIFT], len(one.steps.values) + 1)
    places = [(value, (edges[k], edges[k + 1])) for k, value in enumerate(one.steps.values)]
    for k, (first, last) in enumerate(pairwise(one.steps.values), 1):
        places += [(value, (edges[k], edges[k])) for value in np.linspace(first, last, 8) if first != last]
    for value, lifts in places:
        scene = Scene(twin.at({door.joint: float(value)}), twin.robots[0])
        world = World(scene)
        demands = rules(world, make_limb(world, gripper), Margins(0.0, 0.0, 0.0))
        for q in rng.uniform(low, high, (POSTURES, len(low))):
            q[LIFT] = rng.uniform(*lifts)
            posture = scene.q(q[:3], dict(zip(names, q[3:].tolist(), strict=True)))
            assert world.contact(posture[None], demands) is not None


def _steps(change: Callable[[dict[str, Any]], dict[str, Any]]) -> Change:
    def changed(whole: dict[str, Any]) -> None:
        for one in whole["refutations"]:
            one["steps"] |= change(one["steps"])
            one["value"] = one["steps"]["values"][0] if one["steps"]["values"] else one["value"]

    return changed


@pytest.mark.parametrize(
    "change",
    [
        _steps(lambda steps: {"values": [value + 0.05 for value in steps["values"]]}),
        _steps(lambda steps: {"values": [0.0] * len(steps["values"])}),
        _steps(lambda steps: {"values": steps["values"][:-1], "pieces": steps["pieces"][:-1]}),
        _steps(lambda _: {"values": [], "pieces": []}),
        _steps(lambda steps: {"pieces": [0] * len(steps["pieces"])}),
        _steps(lambda steps: {"pieces": [min(each, 1) for each in steps["pieces"]]}),
        _steps(lambda steps: {"pieces": [10**9 if each else 0 for each in steps["pieces"]]}),
        _steps(lambda steps: {"pieces": [-each for each in steps["pieces"]]}),
        lambda whole: [one.pop("steps") for one in whole["refutations"]],
        lambda whole: [one.update(value=1.0) for one in whole["refutations"]],
        lambda whole: [one.update(pinched=True) for one in whole["refutations"]],
        lambda whole: [one.update(beside=[]) for one in whole["refutations"]],
        lambda whole: whole["claim"].update(span=[0.0, 1.2]),
    ],
    ids=[
        "elsewhere",
        "closed",
        "a part less",
        "no part",
        "no way between",
        "few pieces",
        "too many",
        "less than none",
        "no steps",
        "another value",
        "fingers",
        "no limb",
        "beyond the span",
    ],
)
def test_steps_with_a_gap_or_elsewhere_do_not_hold(tipped: Known, change: Change) -> None:
    try:
        holds, _ = again(tipped, change)
    except InputError:
        return
    assert not holds


def test_a_way_between_two_values_that_nothing_refutes_is_found(tipped: Known) -> None:
    """Each part alone is refuted, and its tree is there: only the ways between are missing."""
    twin, proved = tipped
    statement = about(twin)
    one = read_proof(proved.artefact.content).refutations[0]
    arm = statement.arm(statement.grippers[0])
    assert arm is not None
    assert one.steps is not None
    skipped = Steps(one.steps.values, (0,) * len(one.steps.pieces))
    with pytest.raises(InputError, match="nothing refutes"):
        leaves_of_one(statement, arm, replace(one, steps=skipped))


def test_values_that_need_not_be_passed_exactly_are_no_steps(tipped: Known) -> None:
    twin, proved = tipped
    known = about(twin)
    one = read_proof(proved.artefact.content).refutations[0]
    loose = Statement(twin, twin.robots[0], known.container, Drive.FIXED, HERE, Tolerances())
    arm = loose.arm(loose.grippers[0])
    assert arm is not None
    with pytest.raises(InputError, match="need not be exactly"):
        leaves_of_one(loose, arm, one)


FOLLOWER = """<link name="vane"/>
<joint name="vane_joint" type="revolute"><parent link="wall"/><child link="vane"/><axis xyz="0 0 1"/>
<limit lower="-9" upper="9" velocity="1" effort="1"/><mimic joint="front_door_joint" multiplier="5"/></joint>
</robot>"""


def test_a_container_that_another_joint_follows_goes_up_no_steps(tipped: Known, tmp_path: Path) -> None:
    path = write(draw(np.random.default_rng(TIPS)), tmp_path, "front")
    path.write_text(path.read_text().replace("</robot>", FOLLOWER))
    statement = about(beside(path, "pr2"))
    one = read_proof(tipped[1].artefact.content).refutations[0]
    arm = statement.arm(statement.grippers[0])
    assert arm is not None
    with pytest.raises(InputError, match="which vane_joint follows"):
        leaves_of_one(statement, arm, one)


def test_solids_of_a_piece_are_smaller_than_those_of_its_middle(tipped: Known) -> None:
    statement = about(tipped[0])
    arm = statement.arm(statement.grippers[0])
    assert arm is not None
    for value in (1.2, 1.3):
        (exact, *_), (wide, *_) = statement.around(arm, value), statement.around(arm, value, 0.003)
        smaller = wide.solids.half < exact.solids.half
        moving = np.array([body.rsplit("/")[-1] != "wall" for body in exact.solids.bodies]) & (
            np.array(exact.solids.bodies) != FLOOR
        )
        assert smaller[moving].all()
        assert not smaller[~moving].any()


def test_an_arm_with_more_cores_than_leaves_can_name_goes_up_no_steps(tipped: Known) -> None:
    climb, arm = climber(tipped, never)
    assert len([*climb.refutations(arm)]) == 1
    assert not [*climb.refutations(replace(arm, cores=arm.cores * 2))]


def test_steps_are_looked_for_until_it_is_late(tipped: Known) -> None:
    looks = iter([False] * 5)
    climb, arm = climber(tipped, lambda: next(looks, True))
    assert not [*climb.refutations(arm)]


def test_no_steps_refute_what_is_certified(tmp_path: Path) -> None:
    assert swept(front(tmp_path, "pr2", 3), declared=True) is None
