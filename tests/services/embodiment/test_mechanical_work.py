"""Mechanical work: lifting from rest to rest is m g h, however fast; what has no known mass has no value."""

import numpy as np
import pytest

from predicates.specification.quality import unweighed
from sdt_kg.iri import body_iri
from sdt_kg.motion import BodyMotion
from services.app import load
from services.embodiment.certify.tasks.work import mechanical_work
from services.physics.model import Scene

pytestmark = pytest.mark.oracle

GRAVITY = 9.81
LIFT = 0.1


@pytest.fixture(scope="module")
def scenes() -> dict[str, Scene]:
    service = load("b", ["pr2", "stretch"])
    return {name: Scene(service.twin, service.robot(name)) for name in ("pr2", "stretch")}


def lifted(scene: Scene, seconds: float) -> BodyMotion:
    times, still = np.array([0.0, seconds]), np.zeros((2, 3))
    q = np.array([[0.1], [0.1 + LIFT]])
    return BodyMotion(scene.robot_iri, "", ("torso_lift_joint",), times, still, q, np.zeros((2, 1)), still)


@pytest.mark.parametrize("seconds", [1.0, 20.0])
def test_lifting_from_rest_to_rest_is_weight_times_height(scenes: dict[str, Scene], seconds: float) -> None:
    scene = scenes["pr2"]
    above = {"torso_lift_link"}
    for joint in scene.robot.mechanism.joints:  # parents before children
        if joint.parent in above:
            above.add(joint.child)
    bodies = scene.robot.mechanism.bodies
    mass = sum(each.inertia.mass for each in bodies if each.name in above and each.inertia)
    found = mechanical_work(scene, lifted(scene, seconds))
    assert found == pytest.approx(mass * GRAVITY * LIFT, rel=1e-9)


def test_a_robot_whose_base_has_no_mass_in_its_model_has_no_value(scenes: dict[str, Scene]) -> None:
    scene = scenes["stretch"]
    times, still = np.array([0.0, 1.0]), np.zeros((2, 3))
    motion = BodyMotion(
        scene.robot_iri, "", ("joint_lift",), times, still, np.array([[0.2], [0.3]]), np.zeros((2, 1)), still
    )
    assert mechanical_work(scene, motion) is None


def test_a_sensor_without_mass_is_named_and_a_joint_that_moves_nothing_but_such_has_no_value(
    scenes: dict[str, Scene],
) -> None:
    scene = scenes["pr2"]
    assert unweighed(scene.robot.mechanism) == ("l_force_torque_link",)
    twin = scene.twin.with_edit(body_iri("pr2", "l_wrist_flex_link") + "/inertia", mass=0.0)
    assert unweighed(twin.mechanism(scene.robot_iri)) == ("l_force_torque_link", "l_wrist_flex_link")
    assert mechanical_work(Scene(twin, scene.robot_iri), lifted(scene, 1.0)) is None


def test_work_of_the_base_does_not_depend_on_where_the_kitchens_axes_look(scenes: dict[str, Scene]) -> None:
    scene, angle = scenes["pr2"], np.linspace(0.0, np.pi / 2, 40)
    times, none = 5 * angle, np.zeros((40, 0))
    found: list[float | None] = []
    for turn in (0.0, np.pi / 4):
        at, way = angle + turn, angle + turn + np.pi / 2  # a quarter of a circle, driven along it
        base = np.column_stack((np.cos(at), np.sin(at), way))
        speed = np.column_stack((np.cos(way), np.sin(way), np.ones_like(way))) / 5
        motion = BodyMotion(scene.robot_iri, "", (), times, base, none, none, speed)
        found.append(mechanical_work(scene, motion))
    assert found[0] == pytest.approx(found[1], rel=1e-6)
