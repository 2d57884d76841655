"""The rigid body that a joint moves, from the twin: closed forms of boxes, and Pinocchio's own gravity."""

import math
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from sdt_kg.twin import Twin
from services.dynamics.load import load_of
from services.dynamics.model import Load
from services.physics.tree import build
from tests.services.dynamics.forced import forced_twin

GRAVITY = 9.81
DOOR, HANDLE = (0.02, 0.5, 0.4), (0.02, 0.12, 0.02)  # [m] boxes of tests/small/b.urdf
DOOR_AT, HANDLE_AT = (0.0, 0.2), (-0.05, 0.35)  # x, z of their middles


def loaded(twin: Twin, name: str) -> Load:
    container = twin.container(name)
    return load_of(build(twin.mechanism(twin.environment)), twin, container.joint, container)


def box_about_y(size: tuple[float, float, float], at: tuple[float, float]) -> tuple[float, float, np.ndarray]:
    """Volume, second moment about the hinge along y, first moment in x and z."""
    volume = size[0] * size[1] * size[2]
    own = volume * (size[0] ** 2 + size[2] ** 2) / 12
    return volume, own + volume * (at[0] ** 2 + at[1] ** 2), volume * np.array(at)


def test_a_door_of_boxes_has_their_inertia_weight_and_lever() -> None:
    twin = forced_twin()
    load = loaded(twin, "oven_door")
    parts = [box_about_y(DOOR, DOOR_AT), box_about_y(HANDLE, HANDLE_AT)]
    volume = sum(each[0] for each in parts)
    x, z = sum(each[2] for each in parts) / volume
    assert load.inertia == pytest.approx(sum(each[1] for each in parts) / volume, rel=1e-9)
    # hinged along -y, opening turns z towards -x: height is z cos q + x sin q, the force its derivative
    assert (load.cosine, load.sine) == pytest.approx((GRAVITY * x, -GRAVITY * z), rel=1e-6)
    assert load.constant == pytest.approx(0, abs=1e-12)
    distance = math.hypot(*HANDLE_AT)
    assert load.lever[0] <= distance - 0.01 <= distance + 0.01 <= load.lever[1]
    assert load.lever[1] - load.lever[0] <= 2 * math.hypot(0.01, 0.01) + 1e-9


def test_where_a_door_has_more_handles_its_lever_is_that_of_any() -> None:
    twin = forced_twin()
    door = twin.container("oven_door")
    model = build(twin.mechanism(twin.environment))
    one = load_of(model, twin, door.joint, door).lever
    low, high = load_of(model, twin, door.joint, replace(door, more_handles=(door.iri,))).lever
    assert low <= DOOR_AT[1] - 0.2  # the door itself is one, from its hinge on
    assert high >= one[1]


def test_a_drawer_is_mass_alone_and_its_weight_is_borne_by_its_runners() -> None:
    twin = forced_twin()
    load = loaded(twin, "top_drawer")
    assert (load.prismatic, load.lever) == (True, (1.0, 1.0))
    assert (load.inertia, load.constant) == pytest.approx((1.0, 0.0), abs=1e-12)


def test_the_weight_is_pinocchios_gravity_at_every_angle() -> None:
    twin = forced_twin()
    load = loaded(twin, "oven_door")
    model = pin.Model()
    joint = model.addJoint(
        0, pin.JointModelRevoluteUnaligned(np.array([0.0, -1.0, 0.0])), pin.SE3.Identity(), "door"
    )
    for size, (x, z) in ((DOOR, DOOR_AT), (HANDLE, HANDLE_AT)):
        inertia = pin.Inertia.FromBox(size[0] * size[1] * size[2], *size)
        model.appendBodyToJoint(joint, inertia, pin.SE3(np.eye(3), np.array([x, 0.0, z])))
    data, mass = model.createData(), model.inertias[joint].mass
    for q in np.linspace(0.0, 1.5, 7):
        expected = pin.computeGeneralizedGravity(model, data, np.array([q]))[0] / mass
        assert float(load.weight(np.array(q))) == pytest.approx(expected, abs=1e-9)
