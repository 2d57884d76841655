"""Joints that move together: the sum of what each needs, by virtual work; against MuJoCo's own constraint."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import mujoco
import numpy as np
import pytest

from predicates.case import Case, Outcome, Verdict
from predicates.law import law
from sdt_kg.errors import MotionError
from sdt_kg.load import load_twin
from sdt_kg.motion import Motion
from sdt_kg.scope import D_ARTIC_DYN, violations
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Twin
from services.dynamics.data import with_forces
from services.dynamics.forward.simulate import simulate
from services.dynamics.model import Array, Load, Mechanics, Other
from services.dynamics.need import need
from services.dynamics.oracle import Dynamics
from services.dynamics.rest import at_rest
from tests.services.dynamics.mechanisms import NOTHING, slide

HERE = Path(__file__).parent
ID = "https://example.org/id/pair/"
TIMES = np.linspace(0.0, 3.0, 601)
STEP = 5e-4  # [s] of MuJoCo
RATIO, WIDTH, GRAVITY = 0.7, 0.5, 9.81
FIRST = replace(NOTHING, mass=6.0, coulomb=0.6, break_away=0.6, viscous=1.0)
SECOND = replace(NOTHING, mass=9.0, coulomb=0.4, break_away=0.4, viscous=2.0, stiffness=30.0)
UPRIGHT = Load(False, WIDTH**2 / 3, 0.0, 0.0, 0.0, (WIDTH, WIDTH))
DOWNWARD = Load(False, WIDTH**2 / 3, 0.0, -GRAVITY * WIDTH / 2, 0.0, (WIDTH, WIDTH))


@cache
def pair() -> Twin:
    return with_forces(load_twin(HERE / "pair.urdf"), HERE / "pair_forces.ttl")


def judged(twin: Twin, container: str) -> Verdict:
    (verdict,) = law(Case(twin, task=Task(Verb.OPEN, twin.container(container).iri)), Dynamics())
    return verdict


def coupled(ratio: float = RATIO, load: Load = DOWNWARD) -> Mechanics:
    second = Other(ratio, 0.0, slide(SECOND, load=load, allowed=1e-3))
    return replace(slide(FIRST, load=UPRIGHT, allowed=1e-3), upper=1.5, others=(second,))


def theirs(force: Array) -> Array:
    """MuJoCo's position of the first hinge; the second, downward one is tied to it by an equality."""
    about = WIDTH**2 / 3
    model = mujoco.MjModel.from_xml_string(f"""
      <mujoco>
        <compiler angle="radian"/>
        <option timestep="{STEP}" integrator="implicitfast" solver="Newton" gravity="0 0 -{GRAVITY}"/>
        <default>
          <joint type="hinge" solreffriction="0.0015 1" solimpfriction="0.9999 0.9999 0.001"/>
          <equality solref="0.0015 1" solimp="0.9999 0.9999 0.001"/>
        </default>
        <worldbody>
          <body>
            <inertial pos="0 0 0" mass="6" diaginertia="{6 * about} {6 * about} {6 * about}"/>
            <joint name="first" axis="0 0 1" damping="1" frictionloss="0.6"/>
          </body>
          <body>
            <inertial pos="0 0 {WIDTH / 2}" mass="9" diaginertia="1 {9 * (about - WIDTH**2 / 4)} 1"/>
            <joint name="second" axis="0 1 0" damping="2" frictionloss="0.4" stiffness="30" springref="0"/>
          </body>
        </worldbody>
        <equality><joint joint1="second" joint2="first" polycoef="0 {RATIO} 0 0 0"/></equality>
      </mujoco>""")
    data = mujoco.MjData(model)
    every, q = round((TIMES[1] - TIMES[0]) / STEP), np.empty(len(TIMES))
    forces = np.interp(np.arange(every * len(TIMES)) * STEP, TIMES, force)
    for i in range(len(TIMES)):
        q[i] = data.qpos[0]
        for k in range(every):
            data.qfrc_applied[0] = forces[i * every + k]
            mujoco.mj_step(model, data)
    return q


def test_a_hinge_and_one_that_follows_it_move_as_in_mujoco() -> None:
    force = 4.0 * np.clip(TIMES / 0.3, 0, 1) * (TIMES < 0.6) - 6.0 * (TIMES > 0.9) * (TIMES < 1.3)
    ours = simulate(replace(coupled(), lower=-2.0), FIRST, TIMES, force, start=0.0, others=(SECOND,))
    expected = theirs(force)
    assert np.ptp(expected) > 0.1
    assert np.abs(ours.q - expected).max() <= 0.005


def test_the_bound_is_the_sum_by_virtual_work_and_the_parameters_move_it_as_they_say() -> None:
    u = np.linspace(0.0, 1.0, 17)
    motion = Motion("https://example.org/id/test/joint/slide", 2 * u, u[:, None] ** 3)
    alone = [replace(coupled(), others=()), replace(coupled().others[0].mechanics, upper=1.5)]
    whole, first = need(coupled(), motion), need(alone[0], motion)
    second = need(alone[1], replace(motion, values=RATIO * motion.values))
    assert whole.most <= first.most + RATIO * second.most + 1e-9
    assert whole.most > first.most
    still = at_rest(coupled(), 0.5)
    pull = 9.0 * GRAVITY * WIDTH / 2 * np.sin(RATIO * 0.5) - 30.0 * RATIO * 0.5
    assert still.friction == pytest.approx(0.6 + RATIO * 0.4)
    assert (still.shuts, still.pull) == (True, pytest.approx(-RATIO * pull, rel=1e-6))


def test_each_joint_that_moves_along_needs_its_parameters() -> None:
    with pytest.raises(MotionError, match="1"):
        simulate(coupled(), FIRST, TIMES, np.zeros(len(TIMES)), start=0.0)


def test_two_leaves_need_twice_the_force_of_one_whichever_way_the_axis_points() -> None:
    mechanics = Dynamics().mechanics(pair(), pair().container("left_leaf"))
    (other,) = mechanics.others
    assert (other.ratio, other.offset, other.mechanics.upper) == (1.0, 0.0, 1.5)
    one = replace(mechanics, others=(replace(other, mechanics=replace(mechanics, others=())),))
    motion = Motion(mechanics.joint, np.linspace(0, 9, 10), np.linspace(0, 1.4, 10)[:, None])
    alone = need(replace(mechanics, others=()), motion)
    handle = need(one, motion)
    assert handle.most == pytest.approx(2 * alone.most, rel=1e-6)
    assert handle.least == pytest.approx(2 * alone.least, rel=1e-6)


def test_containers_that_lead_and_that_follow_are_inside_and_say_whose_forces_they_sum() -> None:
    most = dict[str, float]()
    for name in ("left_leaf", "upper_drawer", "lower_drawer"):
        verdict = judged(pair(), name)
        assert verdict.causes is not None, verdict.diagnoses
        assert verdict.causes.holds
        most[name], _ = verdict.causes.figures["handle force, at most"]
    assert most["lower_drawer"] > 1.5 * most["upper_drawer"], (
        "a follower that goes half as far has the longer lever"
    )


def test_a_follower_of_which_no_forces_are_known_keeps_its_leader_outside() -> None:
    twin = pair().with_edit(f"{ID}joint/right_leaf_joint", hasForceModel=None)
    verdict = judged(twin, "left_leaf")
    assert verdict.outcome is Outcome.ABSTAINED
    assert any(
        each.violation is not None and each.violation.focus.endswith("right_leaf_joint")
        for each in verdict.diagnoses
    )


def test_bad_figures_of_a_follower_keep_its_leader_outside() -> None:
    own = f"{ID}force_model/hinge"
    twin = pair().with_edit(own, coulombFrictionFrom=-1.0)
    (found,) = violations(twin, twin.container("left_leaf"), tee=D_ARTIC_DYN)
    assert (found.focus, found.value) == (own, -1.0)


def test_a_motion_of_the_joint_that_a_container_follows_needs_the_force_of_the_containers_own(
    tmp_path: Path,
) -> None:
    """The upper drawer has no handle: the lower one is the container, and goes half as far."""
    text = (HERE / "pair.urdf").read_text().replace("upper_drawer_handle", "upper_drawer_trim")
    (tmp_path / "pair.urdf").write_text(text)
    twin, physics = with_forces(load_twin(tmp_path / "pair.urdf"), HERE / "pair_forces.ttl"), Dynamics()
    drawer = twin.container("lower_drawer")
    assert (drawer.joint, drawer.active_joint) == (
        f"{ID}joint/lower_drawer_joint",
        f"{ID}joint/upper_drawer_joint",
    )
    values = np.array([[0.0], [0.12], [0.24]])
    own = Motion(drawer.joint, np.array([0.0, 1.5, 3.0]), values)
    led = replace(own, of=drawer.active_joint, values=values / drawer.multiplier)
    one, other = (physics.replay(twin, each) for each in (own, led))
    assert other.figures == one.figures
    assert [each.reason for each in other.violations] == [each.reason for each in one.violations]
    assert other.final == one.final


def _three_drawers(folder: Path) -> Twin:
    """The upper drawer has no handle: a second one follows it, a tenth as far, besides the lower one."""
    text = (HERE / "pair.urdf").read_text().replace("upper_drawer_handle", "upper_drawer_trim")
    lower = text[text.index('  <link name="lower_drawer">') : text.index("</robot>")]
    small = lower.replace("lower_drawer", "small_drawer").replace("-1.5 0.5", "-1.5 0.2")
    small = small.replace('multiplier="0.5"', 'multiplier="0.1"').replace('upper="0.25"', 'upper="0.05"')
    (folder / "pair.urdf").write_text(text.replace("</robot>", small + "</robot>"))
    forces = (HERE / "pair_forces.ttl").read_text()
    forces += forces[forces.index(f"<{ID}joint/lower") :].replace("lower_drawer", "small_drawer")
    (folder / "forces.ttl").write_text(forces)
    return with_forces(load_twin(folder / "pair.urdf"), folder / "forces.ttl")


def test_a_motion_that_moves_several_containers_needs_the_force_at_each_handle(tmp_path: Path) -> None:
    """At the small drawer's handle all three are moved by a tenth of the way, with ten times the force."""
    twin, physics = _three_drawers(tmp_path), Dynamics()
    lower, small = (twin.container(f"{name}_drawer") for name in ("lower", "small"))
    assert lower.active_joint == small.active_joint != lower.joint
    values = np.array([[0.0], [0.12], [0.24]])
    own = Motion(lower.joint, np.array([0.0, 1.5, 3.0]), values)
    led = replace(own, of=lower.active_joint, values=values / lower.multiplier)
    at_small = physics.replay(twin, replace(own, of=small.joint, values=values / 5))
    at_lower, at_each = physics.replay(twin, own), physics.replay(twin, led)
    assert not at_lower.violations
    assert at_each.figures == at_small.figures
    assert [each.evidence.entity for each in at_each.violations if each.evidence] == [small.handle]
    assert not any(each.proof for each in at_each.violations)
    assert any("at the handles of lower_drawer and small_drawer" in note for note in at_each.notes)


@pytest.mark.parametrize(("upper", "rest"), [(0.0, 0.5), (0.1, -0.5)], ids=["turned", "as in its file"])
def test_a_spring_rests_where_its_own_joint_is_said_to_be(tmp_path: Path, upper: float, rest: float) -> None:
    """The right leaf goes to -1.5 rad as the left one opens; limits that end at 0 turn its axis on import."""
    ends = 'lower="-1.5" upper="{}"'
    text = (HERE / "pair.urdf").read_text().replace(ends.format("0"), ends.format(upper))
    (tmp_path / "pair.urdf").write_text(text)
    own, leaf = f"<{ID}force_model/hinge>", f"<{ID}joint/right_leaf_joint>"
    forces, springs = (HERE / "pair_forces.ttl").read_text(), f"<{ID}force_model/sprung>"
    model = forces[forces.index(own) : forces.index(f"<{ID}joint/left")].replace(own, springs)
    for name, value in (("StiffnessFrom", 8.0), ("StiffnessTo", 8.0), ("RestPosition", rest)):
        model = model.replace(f"sdt:spring{name} 0.0", f"sdt:spring{name} {value!r}")
    forces = forces.replace(f"{leaf} sdt:hasForceModel {own}", f"{leaf} sdt:hasForceModel {springs}")
    (tmp_path / "forces.ttl").write_text(forces + model)
    twin = with_forces(load_twin(tmp_path / "pair.urdf"), tmp_path / "forces.ttl")
    mechanics = Dynamics().mechanics(twin, twin.container("left_leaf"))
    assert at_rest(mechanics, 0.5).pull == pytest.approx(0.0, abs=1e-9)
    assert at_rest(mechanics, 1.2).pull == pytest.approx(8.0 * 0.7)
    assert at_rest(mechanics, 1.2).shuts
    assert at_rest(mechanics, 0.0).pull == pytest.approx(8.0 * 0.5)
    assert not at_rest(mechanics, 0.0).shuts
