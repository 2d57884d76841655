"""Folding doors: inertia, weight and lever that change on the way, against Pinocchio and MuJoCo."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from predicates.case import Case
from predicates.law import law
from sdt_kg.errors import OracleRejectedError
from sdt_kg.iri import joint_iri
from sdt_kg.load import load_twin
from sdt_kg.motion import Motion
from sdt_kg.scope import D_ARTIC_DYN, violations
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Twin
from services.dynamics.cells import Cells
from services.dynamics.data import with_forces
from services.dynamics.forward.simulate import simulate
from services.dynamics.load import placed, unit_inertia
from services.dynamics.model import Array, Mechanics, Values
from services.dynamics.need import joint_force, need
from services.dynamics.oracle import Dynamics
from services.dynamics.resistance import heavy, held, lever
from services.dynamics.robot.balls import Vectors
from services.dynamics.robot.load import _folding
from services.embodiment.proof_check.geometry.interval import Interval, exact
from services.physics.tree import build
from tests.services.dynamics.mechanisms import NOTHING
from tests.small import small_twin

HERE = Path(__file__).parent
SMALL = HERE.parents[1] / "small" / "a.urdf"
UPPER, LOWER = joint_iri("a", "upper_panel_joint"), joint_iri("a", "folding_door_joint")
MASSES = {UPPER: 3.0, LOWER: 4.0}
FREE = replace(NOTHING, mass=1.0)


@cache
def folding() -> Twin:
    return with_forces(small_twin("a"), HERE / "folding_forces.ttl")


@cache
def mechanics() -> Mechanics:
    return Dynamics().mechanics(folding(), folding().container("folding_door"))


def known(upper: Values, lower: Values) -> Mechanics:
    """The folding door with one value of each parameter."""
    own = mechanics()
    (other,) = own.others
    forces = replace(own.forces, lower=lower, upper=lower, rest=0.0, latch_width=0.0)
    above = replace(other.mechanics.forces, lower=upper, upper=upper, rest=0.0, latch_width=0.0)
    others = (replace(other, mechanics=replace(other.mechanics, forces=above)),)
    return replace(own, forces=forces, others=others)


def model_of(masses: dict[str, float]) -> tuple[pin.Model, pin.Data]:
    """Pinocchio's model of the kitchen, with panels of these masses."""
    twin, model = folding(), build(folding().mechanism(folding().environment))
    placed(model, twin)
    for joint, mass in masses.items():
        index = model.model.getJointId(joint)
        body = unit_inertia(model, index, masses)
        model.model.inertias[index] = pin.Inertia(mass, body.lever, mass * body.inertia)
    return model.model, model.model.createData()


@pytest.mark.parametrize(
    ("s", "v", "a"), [(0.0, 0.0, 0.0), (0.3, 0.0, 2.0), (1.1, 1.5, 0.0), (1.9, -0.7, -3.0)]
)
def test_weight_and_inertia_are_pinocchios_by_virtual_work(s: float, v: float, a: float) -> None:
    model, data = model_of(MASSES)
    q, rate = np.zeros(model.nq), np.zeros(model.nq)
    for joint, ratio in ((UPPER, 0.5), (LOWER, 1.0)):
        k = model.joints[model.getJointId(joint)].idx_q
        q[k], rate[k] = ratio * s, ratio
    ours = known(replace(FREE, mass=3.0), replace(FREE, mass=4.0))
    at, speed, speeding = exact(np.array([s])), exact(np.array([v])), exact(np.array([a]))
    moved = [heavy(each, at, speed, speeding) for each in ours.moving]
    still = [held(each, at) for each in ours.moving]
    for found, expected in (
        (moved, rate @ pin.rnea(model, data, q, rate * v, rate * a)),
        (still, rate @ pin.computeGeneralizedGravity(model, data, q)),
    ):
        low, high = (
            sum(float(end[0]) for end in ends)
            for ends in zip(*((each.lo, each.hi) for each in found), strict=True)
        )
        assert low - 1e-9 <= expected <= high + 1e-9
        assert high - low < 1e-6


def test_spans_hold_all_that_lies_in_them_and_the_way_of_every_point_of_the_handle() -> None:
    ours = known(replace(FREE, mass=3.0), replace(FREE, mass=4.0))
    draw = np.random.default_rng(0)
    ends = (
        np.sort(draw.uniform(0, 2, (50, 2)), axis=1),
        np.sort(draw.uniform(-1, 1, (50, 2)), axis=1),
        np.sort(draw.uniform(-2, 2, (50, 2)), axis=1),
    )
    spans = Cells(
        np.arange(50),
        np.zeros(50),
        np.ones(50),
        *(Interval(each[:, 0], each[:, 1]) for each in ends),
        np.zeros(50, dtype=bool),
    )
    force, way = joint_force(ours, spans), lever(ours, spans.q)
    for _ in range(20):
        q, v, a = (each[:, 0] + draw.random(50) * (each[:, 1] - each[:, 0]) for each in ends)
        one = joint_force(ours, replace(spans, q=exact(q), v=exact(v), a=exact(a)))
        assert (force.lo <= one.lo).all()
        assert (one.hi <= force.hi).all()
        handle = np.linalg.norm(handle_at(q + 1e-6) - handle_at(q - 1e-6), axis=1) / 2e-6
        assert (way.lo <= handle + 1e-6).all()
        assert (handle <= way.hi + 1e-6).all()


def handle_at(s: Array, beside: float = 0.05) -> Array:
    """A point of the handle, by hand: panels of 0.4 m, turned by s / 2 one and the other way."""
    x = -0.4 * np.sin(s / 2) - 0.05 * np.cos(s / 2) + 0.35 * np.sin(s / 2)
    z = 1.8 - 0.4 * np.cos(s / 2) - 0.05 * np.sin(s / 2) - 0.35 * np.cos(s / 2)
    return np.column_stack([2.0 + x, 1.0 + beside + 0 * s, z])


def test_a_tools_way_is_that_of_the_panel_which_it_holds() -> None:
    reach = mechanics().reach
    assert reach is not None
    s = np.linspace(0.1, 1.9, 7)
    tool = Vectors(handle_at(s), np.zeros(7))
    found = _folding(reach, tool, exact(s))
    way = (handle_at(s + 1e-6) - handle_at(s - 1e-6)) / 2e-6
    assert found.centre == pytest.approx(way, abs=1e-6)
    wide = _folding(reach, tool, Interval(s - 0.05, s + 0.05))
    other = _folding(reach, tool, exact(s + 0.05))
    assert (np.linalg.norm(other.centre - wide.centre, axis=1) <= wide.radius).all()


TIMES, STEP = np.linspace(0.0, 3.0, 601), 5e-4
UP, DOWN = (
    replace(NOTHING, mass=3.0, coulomb=0.5, break_away=0.5, viscous=1.0),
    replace(NOTHING, mass=4.0, coulomb=0.3, break_away=0.3, viscous=0.5, stiffness=4.0),
)


def _inertial(joint: str, mass: float) -> str:
    """Of a panel with its handle, mass spread evenly, for MuJoCo."""
    model = build(folding().mechanism(folding().environment))
    placed(model, folding())
    body = unit_inertia(model, model.model.getJointId(joint), MASSES)
    xx, xy, xz, yy, yz, zz = mass * body.inertia[np.triu_indices(3)]
    place = " ".join(map(str, body.lever))
    return f'<inertial pos="{place}" mass="{mass}" fullinertia="{xx} {yy} {zz} {xy} {xz} {yz}"/>'


def theirs(force: Array) -> Array:
    """MuJoCo's position of the lower hinge: two panels, one on the other, tied by an equality."""
    inertial = [_inertial(joint, mass) for joint, mass in MASSES.items()]
    model = mujoco.MjModel.from_xml_string(f"""
      <mujoco>
        <compiler angle="radian"/>
        <option timestep="{STEP}" integrator="implicitfast" solver="Newton" gravity="0 0 -9.81"/>
        <default>
          <joint type="hinge" solreffriction="0.0015 1" solimpfriction="0.9999 0.9999 0.001"/>
          <equality solref="0.0015 1" solimp="0.9999 0.9999 0.001"/>
        </default>
        <worldbody><body>
          {inertial[0]}
          <joint name="upper" axis="0 1 0" damping="1" frictionloss="0.5"/>
          <body pos="0 0 -0.4">
            {inertial[1]}
            <joint name="lower" axis="0 -1 0" damping="0.5" frictionloss="0.3" stiffness="4"/>
          </body>
        </body></worldbody>
        <equality><joint joint1="upper" joint2="lower" polycoef="0 0.5 0 0 0"/></equality>
      </mujoco>""")
    data, q = mujoco.MjData(model), np.empty(len(TIMES))
    every = round((TIMES[1] - TIMES[0]) / STEP)
    forces = np.interp(np.arange(every * len(TIMES)) * STEP, TIMES, force)
    for i in range(len(TIMES)):
        q[i] = data.qpos[1]
        for k in range(every):
            data.qfrc_applied[1] = forces[i * every + k]
            mujoco.mj_step(model, data)
    return q


def test_a_folding_door_moves_as_in_mujoco() -> None:
    force = 14.0 * np.clip(TIMES / 0.4, 0, 1) * (TIMES < 1.0)
    own = known(UP, DOWN)
    bare = replace(own, lower=-1.0, upper=2.5)
    ours = simulate(bare, DOWN, TIMES, force, start=0.0, others=(UP,))
    expected = theirs(force)
    assert np.ptp(expected) > 0.5
    assert np.abs(ours.q - expected).max() <= 0.005


def test_a_folding_door_is_inside_and_its_verdict_says_whose_forces_it_sums() -> None:
    twin = folding().with_edit("https://example.org/id/a/force_model/hinge", springStiffnessFrom=0.0)
    assert not violations(twin, twin.container("folding_door"), tee=D_ARTIC_DYN)
    (verdict,) = law(Case(twin, task=Task(Verb.OPEN, twin.container("folding_door").iri)), Dynamics())
    assert verdict.causes is not None
    assert "handle force, at most" in verdict.causes.figures, verdict.diagnoses


def test_every_value_of_the_parameters_needs_what_the_bounds_of_all_say() -> None:
    u = np.linspace(0.0, 1.0, 33)
    motion = Motion(LOWER, 4 * u, (2 * u**2 * (3 - 2 * u))[:, None])
    found = need(replace(mechanics(), forces=replace(mechanics().forces, allowed=1e-3)), motion)
    assert not found.monotone
    draw = np.random.default_rng(1)
    for _ in range(10):
        own = known(*(_some(each.mechanics, draw) for each in reversed(mechanics().moving)))
        one = need(replace(own, forces=replace(own.forces, allowed=1e-3)), motion)
        assert found.least - 1e-9 <= one.most
        assert one.most <= found.most + 1e-9


def _some(of: Mechanics, draw: np.random.Generator) -> Values:
    low, high = of.forces.lower.array(), of.forces.upper.array()
    return Values(*(low + draw.random(len(low)) * (high - low)).tolist())


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ('<origin xyz="0 0 -0.4"/><axis xyz="0 -1 0"/>', '<origin xyz="0 0 -0.4"/><axis xyz="0.1 -1 0"/>'),
        ('folding_door_joint" type="revolute"', 'folding_door_joint" type="prismatic"'),
    ],
)
def test_what_hangs_on_another_and_is_no_parallel_hinge_stays_outside(
    tmp_path: Path, before: str, after: str
) -> None:
    text = SMALL.read_text()
    assert before in text
    (tmp_path / "a.urdf").write_text(text.replace(before, after))
    twin = load_twin(tmp_path / "a.urdf")
    found = violations(twin, twin.container("folding_door"), tee=D_ARTIC_DYN)
    assert any("no parallel hinges" in each.message for each in found)
    with pytest.raises(OracleRejectedError, match="not as a folding door's"):
        Dynamics().mechanics(twin, twin.container("folding_door"))
