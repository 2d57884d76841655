"""What an annotation says can be so: joints that move alike, a start on the floor, a tool near its hand."""

import math
from pathlib import Path
from typing import Final

from sdt_kg.annotation import FASTEST
from sdt_kg.errors import AnnotationError, meant
from sdt_kg.iri import SDT, Iri, joint_iri, local_name, model_iri
from sdt_kg.mechanism import JointType, Mechanism
from sdt_kg.triples import Facts
from sdt_kg.triples.vocabulary import classes

LEVEL: Final = 1e-6
"""[1, and m] What is written with six digits leans, or is above the floor, by less."""

HAND: Final = 2.0
"""[m] No tool frame is farther from the body that carries it, or somebody wrote millimetres; ours."""

BASE: Final = (
    ("baseLinearVelocity", FASTEST.linear_velocity, "m/s"),
    ("baseAngularVelocity", FASTEST.angular_velocity, "rad/s"),
    ("baseLinearAcceleration", FASTEST.linear_acceleration, "m/s2"),
    ("baseAngularAcceleration", FASTEST.angular_acceleration, "rad/s2"),
)


def check_plausible(facts: Facts, mechanism: Mechanism, file: Path) -> None:
    """No part of an annotation that is whole says what cannot be so.

    Args:
        facts: Of the annotation, which lacks nothing.
        mechanism: The model.
        file: Of the annotation, for errors.

    Raises:
        AnnotationError: It does.
        GraphError: A quaternion is none of a rotation.
    """
    model = model_iri(mechanism.name)
    for subject in facts.subjects():
        _check_kinds(facts, subject, file)
        for core in facts.iris(subject, "hasCore"):
            facts.pose(str(facts.one(core, "hasPose")))
    for coupling in sorted(facts.iris(model, "hasCoupling")):
        _check_coupling(facts, coupling, mechanism, file)
    for start in facts.iris(model, "startPose"):
        _check_start(facts, start, file)
    _check_base(facts, model, file)
    for gripper in sorted(facts.iris(model, "hasGripper")):
        for tool in facts.iris(gripper, "toolFrame"):
            away = math.hypot(*facts.pose(tool).position)
            if away > HAND:
                raise AnnotationError(
                    f"{file}: the tool frame of '{local_name(gripper)}' is {away:.4g} m from its body",
                    allowed=f"up to {HAND:g} m",
                    remedy="give sdt:x, sdt:y and sdt:z in m",
                )


def _check_base(facts: Facts, model: Iri, file: Path) -> None:
    """The base is as fast as a robot's in a kitchen may be."""
    for name, most, unit in BASE:
        if (told := facts.number(model, name, 0.0)) > most:
            raise AnnotationError(
                f"{file}: sdt:{name} is {told:.4g} {unit}",
                allowed=f"up to {most:.4g} {unit}",
                remedy="give it in m and rad",
            )


def _check_kinds(facts: Facts, subject: Iri, file: Path) -> None:
    """What something is said to be is a class of `sdt.ttl`, or of another vocabulary."""
    for name in (local_name(kind) for kind in facts.types(subject) if kind.startswith(SDT)):
        if name not in classes():
            near = meant(name, classes())
            raise AnnotationError(
                f"{file}: '{local_name(subject)}' is a sdt:{name}: no such class",
                allowed=f"did you mean sdt:{near}?" if near else "those of sdt.ttl",
            )


def _check_coupling(facts: Facts, coupling: Iri, mechanism: Mechanism, file: Path) -> None:
    """One motor moves several joints of one kind equally: of a hinge and a slide nothing would be equal."""
    named = set(facts.iris(coupling, "couples"))
    joints = [one for one in mechanism.joints if joint_iri(mechanism.name, one.name) in named]
    kinds = {one.type is JointType.PRISMATIC for one in joints}
    if len(joints) < 2 or len(kinds) > 1:
        names = ", ".join(one.name for one in joints)
        raise AnnotationError(
            f"{file}: coupling '{local_name(coupling)}' is of {names}",
            allowed="two joints or more, all hinges or all slides",
        )


def _check_start(facts: Facts, start: Iri, file: Path) -> None:
    """A robot stands upright on the floor: what else a start pose says would be passed over."""
    pose = facts.pose(start)
    if abs(pose.position[2]) > LEVEL or math.hypot(*pose.orientation[:2]) > LEVEL:
        raise AnnotationError(
            f"{file}: the start pose is above or below the floor, or leans",
            allowed="sdt:z, sdt:qx and sdt:qy of 0",
            remedy="give sdt:x, sdt:y [m] and the turn about the vertical, sdt:qz and sdt:qw",
        )
