"""Each bundled robot: model, shapes, annotation; and the reference's model of it."""

from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from pathlib import Path

import coal
import numpy as np
import pinocchio as pin
import pytest
import rdflib

import robots
from sdt_kg import iri
from tests.robots.shapes import Array, Links, Shape

SDT = rdflib.Namespace(iri.SDT)
REFERENCE = {
    "pr2": "robot_pr2/pr2_with_ft2_cableguide.urdf",
    "tiago_dual": "robot_tiago_dual/tiago_dual.urdf",
    "stretch": "robot_stretch/stretch_description_local.urdf",
}


def solid(shape: Shape) -> coal.CollisionGeometry:
    makers = {"box": coal.Box, "cylinder": coal.Cylinder, "sphere": coal.Sphere}
    return makers[shape.kind](*map(float, shape.size))


def touch(one: tuple[coal.CollisionGeometry, Array], two: tuple[coal.CollisionGeometry, Array]) -> bool:
    """Whether two placed shapes overlap; request and result are new at each call (cached guesses lie)."""
    (shape, pose), (other, place) = one, two
    poses = [coal.Transform3s(matrix[:3, :3], matrix[:3, 3]) for matrix in (pose, place)]
    return bool(
        coal.collide(shape, poses[0], other, poses[1], coal.CollisionRequest(), coal.CollisionResult())
    )


@dataclass
class Robot:
    """A robot's URDF and annotation."""

    name: str
    file: Path
    notes: Path

    @cached_property
    def links(self) -> Links:
        return Links(self.file)

    @cached_property
    def model(self) -> pin.Model:
        return pin.buildModelFromUrdf(str(self.file))

    @cached_property
    def graph(self) -> rdflib.Graph:
        return rdflib.Graph().parse(self.notes)

    def values(self, term: str) -> dict[str, float]:
        """Joint → number that the annotation gives for it."""
        return {iri.local_name(str(s)): float(o.toPython()) for s, o in self.graph.subject_objects(SDT[term])}

    def named(self, term: str) -> list[tuple[str, str]]:
        """Subject and object names of a property."""
        return [
            (iri.local_name(str(s)), iri.local_name(str(o))) for s, o in self.graph.subject_objects(SDT[term])
        ]

    @cached_property
    def mimics(self) -> dict[str, tuple[str, float]]:
        """Mimicking joint → mimicked joint and multiplier."""
        found = [(name, joint.find("mimic")) for name, joint in self.links.joints.items()]
        return {n: (str(m.get("joint")), float(m.get("multiplier", "1"))) for n, m in found if m is not None}

    @cached_property
    def places(self) -> dict[str, tuple[int, int]]:
        """Joint → where it stands in q, and how many numbers it has there."""
        joints = {name: self.model.joints[self.model.getJointId(name)] for name in self.model.names[1:]}
        return {name: (joint.idx_q, joint.nq) for name, joint in joints.items()}

    @cached_property
    def data(self) -> pin.Data:
        return self.model.createData()

    def configuration(self, positions: dict[str, float]) -> Array:
        """Pinocchio's q for joint positions; mimicking joints follow, all others stay at 0."""
        follow = {n: k * positions[joint] for n, (joint, k) in self.mimics.items() if joint in positions}
        q = pin.neutral(self.model)
        for name, value in (positions | follow).items():
            place, count = self.places[name]
            q[place : place + count] = [np.cos(value), np.sin(value)] if count == 2 else [value]
        return q

    def frames(self, positions: dict[str, float], links: list[str] | None = None) -> dict[str, Array]:
        """World pose of links, by default of all."""
        pin.framesForwardKinematics(self.model, self.data, self.configuration(positions))
        wanted = self.links.links if links is None else links
        return {link: self.data.oMf[self.model.getFrameId(link)].homogeneous for link in wanted}

    def placed(self, frames: dict[str, Array], link: str) -> list[tuple[coal.CollisionGeometry, Array]]:
        return [(solid(shape), frames[link] @ shape.pose) for shape in self.links.shapes(link)]

    @cached_property
    def allowed(self) -> set[frozenset[str]]:
        """Pairs joined by one joint, rigidly attached to each other, or annotated."""
        rigid = {link: link for link in self.links.links}
        pairs = {frozenset(pair) for pair in self.named("mayTouch")}
        for name, joint in self.links.joints.items():
            parent, child = self.links.ends(name)
            pairs.add(frozenset((parent, child)))
            if joint.get("type") == "fixed":
                old, new = rigid[child], rigid[parent]
                rigid = {link: new if group == old else group for link, group in rigid.items()}
        return pairs | {
            frozenset(pair) for pair in combinations(rigid, 2) if rigid[pair[0]] == rigid[pair[1]]
        }

    def self_collisions(self, positions: dict[str, float]) -> set[frozenset[str]]:
        """Pairs of links whose shapes overlap although that is not allowed."""
        frames = self.frames(positions)
        solids = {link: self.placed(frames, link) for link in self.links.links}
        return {
            pair
            for one, two in combinations(solids, 2)
            if (pair := frozenset((one, two))) not in self.allowed
            and any(touch(a, b) for a in solids[one] for b in solids[two])
        }


@pytest.fixture(scope="session", params=list(REFERENCE))
def robot(request: pytest.FixtureRequest) -> Robot:
    name = request.param
    return Robot(name, robots.path(f"{name}/{name}.urdf"), robots.path(f"{name}/{name}.ttl"))


@pytest.fixture(scope="session")
def theirs(robot: Robot, reference: Path) -> Robot:
    return Robot(robot.name, reference / REFERENCE[robot.name], robot.notes)
