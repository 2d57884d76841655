"""Figures of D_artic_dyn: a second of mechanism, the force bound of a motion, the scope with forces."""

import numpy as np

from sdt_kg.scope import D_ARTIC_DYN, request_graph
from sdt_kg.shacl import check
from sdt_kg.state import Interval
from services.dynamics.forward.simulate import simulate
from services.dynamics.model import ForceModel, Load, Mechanics, Values
from services.dynamics.need import need
from services.dynamics.oracle import Dynamics
from services.physics.generate import generate
from services.physics.tree import build
from tests.services.dynamics.forced import forced_twin

ROUGH = Values(8.0, 1.0, 1.0, 3.0, 6.0, 4.0, 20.0, 10.0, 12.0, 60.0)
DRAWER = Mechanics(
    "joint",
    ForceModel(ROUGH, ROUGH, 0.1, 0.02, 0.08, 60.0),
    Load(True, 1.0, 0.0, 0.0, 0.0, (1.0, 1.0)),
    0.0,
    0.5,
)


def test_one_second_of_mechanism(benchmark) -> None:
    """A drawer with every element, slipping and sticking; steps are halved until two agree."""
    times = np.linspace(0.0, 1.0, 201)
    force = 25.0 * np.sin(9.0 * times)
    moved = benchmark(simulate, DRAWER, ROUGH, times, force, start=0.1)
    assert np.ptp(moved.q) > 0.05


def test_force_bound_of_a_motion(benchmark) -> None:
    twin = forced_twin()
    container = twin.container("oven_door")
    mechanics = Dynamics().mechanics(twin, container)
    model = build(twin.mechanism(twin.environment))
    motion = generate(model, twin, container.joint, Interval(container.open_from, container.upper))
    assert motion is not None
    assert benchmark(need, mechanics, motion).most > 0


def test_scope_with_forces(benchmark) -> None:
    twin = forced_twin()
    data = request_graph(twin, twin.container("oven_door"), tee=D_ARTIC_DYN)
    assert benchmark(check, data, D_ARTIC_DYN.shapes, []) == []
