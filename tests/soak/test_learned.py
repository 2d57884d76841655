"""Containers of the kitchens, seen to move otherwise than its twin says: proposed, accepted, undone."""

import numpy as np
import pytest

from predicates.case import Case
from predicates.learn import Track, learn
from predicates.learn.frames import motion_of, world_T_of
from predicates.record.inputs import inputs_of, verdict_iri
from sdt_kg.entities import Replacement
from sdt_kg.errors import InputError
from sdt_kg.iri import local_name
from sdt_kg.mechanism import JointType
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Container, Twin
from services.app import load
from services.embodiment.oracle import WholeBody
from services.learning import branch_triples, proposal_for, seen_in, write_branch
from services.physics.oracle import Kinematics
from tests.predicates.learn.observed import seen, stopping

pytestmark = pytest.mark.slow

PHYSICS = Kinematics()
SIDE = 0.06  # [rad] by which a drawer is seen to come out askew
STRIDE = 3  # one of so many containers
BESIDE = 0.1  # [m] by which a hinge is seen beside where the twin has it


def otherwise(twin: Twin, container: Container, seed: int) -> Track:
    """The handle's track, the drawer askew or the hinge elsewhere, seen with noise of 1 mm."""
    kitchen = twin.mechanism(twin.environment)
    joint = kitchen.joint(local_name(container.joint))
    world_T_joint = world_T_of(kitchen, joint.parent, twin.state) @ joint.origin.matrix()
    handle = world_T_of(kitchen, local_name(container.handle), twin.state)[:3, 3]
    axis = world_T_joint[:3, :3] @ np.array(joint.axis)
    q = stopping(0.9 * container.upper)
    if joint.type is JointType.PRISMATIC:
        across = np.cross(axis, [0.0, 0.0, 1.0]) if abs(axis[2]) < 0.9 else np.array([1.0, 0.0, 0.0])
        along = np.cos(SIDE) * axis + np.sin(SIDE) * across / np.linalg.norm(across)
        return seen(handle + q[:, None] * along, seed, 0.001)
    hinge = world_T_joint[:3, 3] + BESIDE * _away(handle - world_T_joint[:3, 3], axis)
    arm = handle - hinge
    turned = [motion_of(joint, each)[:3, :3] for each in q]
    root = world_T_joint[:3, :3]
    return seen(np.array([hinge + root @ turn @ root.T @ arm for turn in turned]), seed, 0.001)


def _away(arm: np.ndarray, axis: np.ndarray) -> np.ndarray:
    across = arm - (arm @ axis) * axis
    return -across / np.linalg.norm(across)


def iri(twin: Twin, container: str) -> str:
    """Of the question whether PR2 opens it."""
    task = Task(Verb.OPEN, twin.container(container).iri)
    return verdict_iri(inputs_of(Case(twin, robot=twin.robots[0], task=task), PHYSICS, WholeBody()))


@pytest.mark.parametrize("kitchen", ["a", "b"])
def test_what_is_accepted_replays_the_track_and_can_be_undone(kitchen: str, tmp_path) -> None:
    twin = load(kitchen, ["pr2"]).twin
    accepted, refused = 0, dict[str, str]()
    asked = twin.containers()[::STRIDE]
    for seed, container in enumerate(asked):
        learned = learn(otherwise(twin, container, seed))
        before = seen_in(twin, learned, PHYSICS, container.iri)
        assert not before.fits, container.name
        try:
            proposal, after = proposal_for(twin, learned, before, PHYSICS)
        except InputError as error:
            refused[container.name] = str(error)
            continue
        if not after.replayed:
            said = [each.reason for verdict in after.explanation.verdicts for each in verdict.diagnoses]
            refused[container.name] = next((each for each in said if "runs into" in each), f"{said}")
            continue
        path = tmp_path / f"{container.name}.trig"
        write_branch(path, proposal.twin, *branch_triples(twin, learned, before, proposal))
        branch = load(str(path), ["pr2"]).twin
        assert iri(branch, container.name) == iri(proposal.twin, container.name) != iri(twin, container.name)
        assert seen_in(branch, learned, PHYSICS, container.name).replayed, container.name
        assert iri(undone(twin, proposal.twin), container.name) == iri(twin, container.name)
        accepted += 1
    assert accepted >= 0.6 * len(asked), refused
    assert all("coupled" in each or "runs into" in each for each in refused.values()), refused


def undone(before: Twin, after: Twin) -> Twin:
    """The twin once what was accepted is taken back, triple by triple."""
    own = before.environment
    old, new = (frozenset(t.entities.store.triples(t.entities.asserted[own])) for t in (before, after))
    back = after.rewritten(Replacement(own, new - old, old - new, "undone"))
    assert back.content_hash(own) == before.content_hash(own) != after.content_hash(own)
    return back
