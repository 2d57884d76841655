"""Bodies and joints that an annotation names: each is one of its model, and is what it is named as."""

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Final

import pyoxigraph as ox

from sdt_kg.errors import AnnotationError
from sdt_kg.iri import SDT, Iri, body_iri, joint_iri, local_name, model_iri
from sdt_kg.mechanism import JointType, Mechanism
from sdt_kg.store import Triple
from sdt_kg.triples.facts import TYPE
from sdt_kg.triples.from_mechanism import JOINT_CLASSES

VALUES: Final = {
    "baseBody": "body",
    "toolBody": "body",
    "hasFinger": "body",
    "mayTouch": "body",
    "hasFingerJoint": "joint",
    "couples": "joint",
}
"""Properties whose values are bodies or joints of the model."""

SUBJECTS: Final = {
    "mayTouch": "body",
    "hasCore": "body",
    "parkedPosition": "joint",
    "openPosition": "joint",
    "closedPosition": "joint",
    "held": "joint",
    "accelerationLimit": "joint",
}
"""Properties of which bodies or joints of the model are the subjects."""

STRUCTURE: Final = tuple(
    SDT + name
    for name in (
        "parent",
        "child",
        "mimics",
        "hasOrigin",
        "hasCollisionGeometry",
        "hasInertia",
        "partOf",
        "rootBody",
    )
)
"""Properties of which a model is made: what they say is for its file to say."""

MOVED: Final = ("hasFingerJoint", "couples")


def check_structure(own: Iterable[Triple], said: Iterable[Triple]) -> None:
    """An annotation says nothing of how a model is made but what its file says.

    Args:
        own: The model's own triples.
        said: Those of its annotation.

    Raises:
        AnnotationError: It does: another parent, a joint that mimics, a kind of joint.
    """
    kinds = {ox.NamedNode(SDT + name) for name in JOINT_CLASSES.values()}
    made = [one for one in said if one[1] in STRUCTURE or (one[1] == TYPE and one[2] in kinds)]
    file_says = set(own) if made else set[Triple]()
    for subject, predicate, term in (one for one in made if one not in file_says):
        raise AnnotationError(
            f"'{local_name(subject)}' has {_short(predicate)} <{term.value}> in its annotation",
            allowed="what the model's file says of it",
            remedy="say it in the model's file",
        )


def _short(predicate: Iri) -> str:
    return "the type" if predicate == TYPE else f"sdt:{local_name(predicate)}"


def check_named(triples: Iterable[Triple], mechanism: Mechanism, file: Path) -> None:
    """What is named as a body or joint of the model is one, and what a motor is to move can move.

    Raises:
        AnnotationError: It is not: what is said of it would be said of nothing.
    """
    model = model_iri(mechanism.name)
    joints = {joint_iri(mechanism.name, joint.name): joint for joint in mechanism.joints}
    known = {"joint": joints.keys(), "body": {body_iri(mechanism.name, one.name) for one in mechanism.bodies}}
    for name, kind, iri, where in _named(triples):
        if iri not in known[kind]:
            raise AnnotationError(
                f"{file}: {where} is no {kind} of '{mechanism.name}'", allowed=f"<{model}/{kind}/NAME>"
            )
        if name in MOVED and joints[iri].type is JointType.FIXED:
            raise AnnotationError(f"{file}: {where} cannot move", allowed="a joint that moves")
        if name == "hasFingerJoint" and (mimic := joints[iri].mimic) is not None:
            raise AnnotationError(
                f"{file}: {where} mimics '{mimic.joint}'",
                allowed="joints that are moved for themselves",
                remedy="name that joint instead: what mimics it follows",
            )


def _named(triples: Iterable[Triple]) -> Iterator[tuple[str, str, Iri, str]]:
    """(property, kind, what is named, where it is) of each."""
    for subject, predicate, term in triples:
        name = predicate.removeprefix(SDT)
        if name in SUBJECTS:
            yield name, SUBJECTS[name], subject, f"<{subject}>, which has sdt:{name},"
        if name in VALUES:
            yield name, VALUES[name], term.value, f"<{term.value}>, sdt:{name} of '{local_name(subject)}',"
