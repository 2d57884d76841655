"""Our mechanism against MuJoCo's: every type, 3 s, within 0.005 rad or 0.5 mm.

MuJoCo 4, Newton solver, implicitfast integrator, steps of 0.5 ms; friction loss and stops as constraints with
impedance 0.9999 and time constants of 1.5 ms (three steps), critically damped. What MuJoCo has no element for
(latch, soft closer, break-away above Coulomb friction) is written here again, in MuJoCo's loop.
Excluded: 30 ms after a moment at which one of the two is at rest and the other is not, since MuJoCo's
friction and stops are soft constraints, which creep before they let go and give way when struck.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import mujoco
import numpy as np
import pytest

from services.dynamics.forward.simulate import simulate
from services.dynamics.model import Array, ForceModel, Load, Mechanics, Values

TIMES = np.linspace(0.0, 3.0, 601)
STEP = 5e-4
BAND = 0.03  # [s]
MOVING = 1e-4  # [rad/s or m/s]
GRAVITY = 9.81
PLAIN = Values(
    mass=8.0,
    inertia=1.0,
    weight=1.0,
    coulomb=3.0,
    break_away=3.0,
    viscous=4.0,
    stiffness=0.0,
    latch=0.0,
    closer=0.0,
    closer_damping=0.0,
)
WIDTH, HEIGHT = 0.6, 0.4  # [m] of a door about a vertical, and about a horizontal, axis
DRAWER = Load(True, 1.0, 0.0, 0.0, 0.0, (1.0, 1.0))
DOOR = Load(False, WIDTH**2 / 3, 0.0, 0.0, 0.0, (WIDTH, WIDTH))
# hinged at its lower edge, upright when closed, opening downwards: gravity pulls it open
OVEN = Load(False, HEIGHT**2 / 3, 0.0, -GRAVITY * HEIGHT / 2, 0.0, (HEIGHT, HEIGHT))


@dataclass(frozen=True)
class Type:
    """A mechanism, and the force of the joint that it is moved by."""

    load: Load
    values: Values
    force: Callable[[Array], Array]
    upper: float
    lengths: tuple[float, float, float] = (0.0, 0.0, 0.0)  # rest, latch width, closer range
    start: float = 0.0

    @property
    def mechanics(self) -> Mechanics:
        return Mechanics(
            "joint", ForceModel(self.values, self.values, *self.lengths, 60.0), self.load, 0.0, self.upper
        )


def pull(force: float, until: float) -> Callable[[Array], Array]:
    """A ramp of 0.3 s to the force, held, and nothing after `until`."""
    return lambda t: np.where(t < until, force * np.clip(t / 0.3, 0, 1), 0.0)


TYPES = {
    "plain drawer": Type(DRAWER, PLAIN, pull(8.0, 0.9), 0.5),
    "hinge": Type(
        DOOR, replace(PLAIN, mass=12.0, coulomb=0.8, break_away=0.8, viscous=0.6), pull(2.2, 1.2), 1.57
    ),
    "spring": Type(
        DRAWER, replace(PLAIN, stiffness=40.0), lambda t: 9.0 + 6.0 * np.sin(3 * t), 0.5, (0.05, 0, 0)
    ),
    "damper": Type(
        DOOR, replace(PLAIN, mass=12.0, coulomb=0.3, break_away=0.3, viscous=6.0), pull(5.0, 2.0), 1.57
    ),
    "gravity door": Type(
        OVEN, replace(PLAIN, mass=6.0, coulomb=2.5, break_away=2.5, viscous=8.0), pull(6.0, 1.2), 1.57
    ),
    "latch": Type(
        DRAWER, replace(PLAIN, latch=20.0), lambda t: np.minimum(60 * t, 30.0) * (t < 0.75), 0.5, (0, 0.02, 0)
    ),
    "soft closer": Type(
        DRAWER,
        replace(PLAIN, closer=12.0, closer_damping=60.0),
        lambda t: np.where(t < 0.8, -14.0, 0.0),
        0.5,
        (0, 0, 0.08),
        0.4,
    ),
    "stick-slip": Type(
        DRAWER, replace(PLAIN, break_away=6.0), lambda t: 9.0 * np.sin(4 * t), 0.5, (0, 0, 0), 0.2
    ),
    "contents": Type(DRAWER, replace(PLAIN, mass=18.0, coulomb=6.0, break_away=6.0), pull(14.0, 1.0), 0.5),
    "soft closer, latch and contents": Type(
        DRAWER,
        replace(PLAIN, mass=18.0, latch=15.0, closer=10.0, closer_damping=80.0, viscous=90.0),
        lambda t: np.minimum(150 * t, 60.0) * (t < 0.8) - 14.0 * (t > 1.2),
        0.5,
        (0, 0.02, 0.08),
    ),
    "both stops": Type(DRAWER, replace(PLAIN, viscous=80.0), lambda t: 18.0 * np.cos(2.5 * t), 0.1),
}


def theirs(kind: Type) -> tuple[Array, Array]:
    """MuJoCo's positions and speeds at TIMES."""
    v, load = kind.values, kind.load
    prismatic = load.prismatic
    inertia = v.mass * v.inertia * load.inertia
    joint = "slide" if prismatic else "hinge"
    downward = bool(load.sine or load.cosine)
    # a door at rest upright, its middle half its height above the axis; y turns it towards +x
    centre = f"0 0 {HEIGHT / 2}" if downward else "0 0 0"
    about = max(inertia - (v.mass * (HEIGHT / 2) ** 2 if downward else 0.0), 1e-6)
    axis = "1 0 0" if prismatic else ("0 1 0" if downward else "0 0 1")
    model = mujoco.MjModel.from_xml_string(f"""
      <mujoco>
        <compiler angle="radian"/>
        <option timestep="{STEP}" integrator="implicitfast" solver="Newton" gravity="0 0 -{GRAVITY}"/>
        <worldbody><body>
          <inertial pos="{centre}" mass="{v.mass}" diaginertia="{about} {about} {about}"/>
          <joint type="{joint}" axis="{axis}" damping="{v.viscous}" frictionloss="{v.coulomb}"
            stiffness="{v.stiffness}" springref="{kind.lengths[0]}" limited="true" range="0 {kind.upper}"
            solreflimit="0.0015 1" solimplimit="0.9999 0.9999 0.001"
            solreffriction="0.0015 1" solimpfriction="0.9999 0.9999 0.001"/>
        </body></worldbody>
      </mujoco>""")
    data = mujoco.MjData(model)
    data.qpos[0] = kind.start
    every = round((TIMES[1] - TIMES[0]) / STEP)
    forces = np.interp(np.arange(every * (len(TIMES) - 1) + 1) * STEP, TIMES, kind.force(TIMES))
    q, speed = np.empty(len(TIMES)), np.empty(len(TIMES))
    for i in range(len(TIMES)):
        q[i], speed[i] = data.qpos[0], data.qvel[0]
        for k in range(every if i + 1 < len(TIMES) else 0):
            data.qfrc_applied[0] = forces[i * every + k] + elements(
                kind, float(data.qpos[0]), float(data.qvel[0])
            )
            pushed = data.qfrc_applied[0] + data.qfrc_passive[0] - data.qfrc_bias[0]
            held = abs(data.qvel[0]) < 5 * MOVING and abs(pushed) <= v.break_away
            model.dof_frictionloss[0] = v.break_away if held else v.coulomb
            mujoco.mj_step(model, data)
    return q, speed


def elements(kind: Type, q: float, speed: float) -> float:
    """Force of latch and soft closer."""
    _, width, reach = kind.lengths
    force = 0.0
    if 0 < width > q:
        force -= kind.values.latch * (1 - max(q, 0.0) / width)
    if 0 < reach > q:
        force -= kind.values.closer + kind.values.closer_damping * min(speed, 0.0)
    return force


@pytest.mark.parametrize("name", TYPES)
def test_the_joint_moves_as_in_mujoco(name: str) -> None:
    kind = TYPES[name]
    ours = simulate(kind.mechanics, kind.values, TIMES, kind.force(TIMES), start=kind.start)
    q, speed = theirs(kind)
    differ = (np.abs(ours.v) < MOVING) != (np.abs(speed) < MOVING)
    excluded = np.zeros(len(TIMES), dtype=bool)
    for moment in TIMES[differ]:
        excluded |= (moment <= TIMES) & (moment + BAND >= TIMES)
    apart = np.abs(ours.q - q)[~excluded]
    assert np.ptp(q) > 0.05
    assert excluded.mean() < 0.25
    assert apart.max() <= (0.0005 if kind.load.prismatic else 0.005)
    assert math.isclose(ours.q[-1], q[-1], abs_tol=0.0005 if kind.load.prismatic else 0.005)
