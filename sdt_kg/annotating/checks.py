"""What an annotation says of its model, against that model: names, structure, numbers, what is lacking."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches
from pathlib import Path
from typing import Final

import pyoxigraph as ox

from sdt_kg.annotating.plausible import check_plausible
from sdt_kg.errors import AnnotationError
from sdt_kg.iri import SDT, Iri, body_iri, joint_iri, local_name, model_iri
from sdt_kg.mechanism import Joint, JointType, Mechanism
from sdt_kg.store import Triple
from sdt_kg.triples import Facts
from sdt_kg.triples.annotation import missing_of
from sdt_kg.triples.containers import torn
from sdt_kg.triples.facts import TYPE
from sdt_kg.triples.from_mechanism import JOINT_CLASSES
from sdt_kg.triples.vocabulary import DRIVES, fits, properties

VALUES: Final = {
    "baseBody": "body",
    "toolBody": "body",
    "hasFinger": "body",
    "mayTouch": "body",
    "hasFingerJoint": "joint",
    "couples": "joint",
}
"""Properties whose values are bodies or joints of the model."""

WOUND: Final = 4 * math.pi
"""[rad] A joint without limits is no farther from 0 than two turns, or somebody wrote degrees; ours."""

POSITIONS: Final = ("parkedPosition", "openPosition", "closedPosition")

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


def unknown_names(triples: Iterable[Triple], mechanism: Mechanism) -> list[tuple[str, str]]:
    """(body or joint, name) of what the annotation names and the model lacks."""
    model, known = model_iri(mechanism.name), _names(mechanism)
    named = [*triples]
    iris = {subject for subject, _, _ in named}
    iris |= {value.value for _, _, value in named if isinstance(value, ox.NamedNode)}
    found: list[tuple[str, str]] = []
    for iri in sorted(iris):
        for kind, names in known.items():
            itself = iri.startswith(f"{model}/{kind}/") and iri.count("/") == model.count("/") + 2
            if itself and local_name(iri) not in names:
                found.append((kind, local_name(iri)))
    return found


def _names(mechanism: Mechanism) -> dict[str, set[str]]:
    return {
        "body": {body.name for body in mechanism.bodies},
        "joint": {joint.name for joint in mechanism.joints},
    }


def check_against(triples: Sequence[Triple], mechanism: Mechanism, file: Path, kind: str) -> None:
    """The annotation names what the model has, lacks nothing, and no number contradicts the model.

    Args:
        triples: Of the annotation, about the model's own IRIs.
        mechanism: The model.
        file: Of the annotation, for errors.
        kind: `Robot` or `Environment`.

    Raises:
        AnnotationError: It does not.
    """
    unknown = unknown_names(triples, mechanism)
    if unknown:
        part, name = unknown[0]
        more = f" (and {len(unknown) - 1} more)" if len(unknown) > 1 else ""
        near = get_close_matches(name, _names(mechanism)[part], n=3, cutoff=0.5)
        hint = " or ".join(f"'{each}'" for each in near)
        raise AnnotationError(
            f"{file} names {part} '{name}', which '{mechanism.name}' does not have{more}",
            allowed=f"did you mean {hint}?" if hint else f"names of its URDF's {part}s",
        )
    _check_terms(triples, file)
    _check_named(triples, mechanism, file)
    facts = Facts(triples)
    missing = missing_of(facts, model_iri(mechanism.name), kind)
    if missing:
        page = "robots/README.md" if kind == "Robot" else "kitchens/README.md"
        raise AnnotationError(
            f"{file} lacks: {', '.join(missing)}", remedy=f"{page} lists what an annotation has"
        )
    _check_positions(facts, mechanism, file)
    check_plausible(facts, mechanism, file)
    if wrong := torn(triples, mechanism):
        raise AnnotationError(f"{file}: {wrong}", allowed="the joint that moves it, and a handle fixed to it")
    if kind == "Robot":
        _check_speeds(facts, mechanism, file)


def _check_named(triples: Iterable[Triple], mechanism: Mechanism, file: Path) -> None:
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


def _check_terms(triples: Iterable[Triple], file: Path) -> None:
    """Every sdt: property is one of `sdt.ttl` and has a value of its kind."""
    for subject, predicate, term in triples:
        if not predicate.startswith(SDT):
            continue
        name = local_name(predicate)
        where = f"{file}: sdt:{name} of '{local_name(subject)}'"
        if name not in properties():
            near = get_close_matches(name, properties(), n=3, cutoff=0.5)
            hint = " or ".join(f"sdt:{each}" for each in near)
            raise AnnotationError(
                f"{where}: no such property", allowed=f"did you mean {hint}?" if hint else "those of sdt.ttl"
            )
        if not fits(properties()[name], term):
            raise AnnotationError(f"{where} is {term}", allowed=properties()[name].value)
        if name == "drive" and term.value not in DRIVES:
            raise AnnotationError(f"{where} is {term}", allowed="sdt:Omni, sdt:Differential, sdt:Fixed")


def _check_positions(facts: Facts, mechanism: Mechanism, file: Path) -> None:
    for joint in mechanism.joints:
        iri = joint_iri(mechanism.name, joint.name)
        for name in POSITIONS:
            _check_position(joint, name, facts.one(iri, name), f"{file}: ")


def check_edited(mechanism: Mechanism, subject: Iri, changes: Mapping[str, object]) -> None:
    """Positions that an edit gives are inside limits, those that it gives too, as a file's are.

    Raises:
        AnnotationError: With what is allowed.
    """
    joint = _edited(mechanism, subject, changes)
    if joint is not None:
        for name in POSITIONS:
            _check_position(joint, name, changes.get(name), "")


def check_limits(mechanism: Mechanism, subject: Iri, changes: Mapping[str, object]) -> None:
    """Limits that an edit gives have room between them, as a file's have.

    Raises:
        AnnotationError: The lower is above the upper.
    """
    joint = _edited(mechanism, subject, changes)
    if joint is not None and joint.limits.lower > joint.limits.upper:
        lower, upper = joint.limits.lower, joint.limits.upper
        raise AnnotationError(
            f"joint '{joint.name}' between {lower:g} and {upper:g}: its lower limit is above its upper one",
            allowed="a lower limit that is not above the upper one",
            remedy="edit the other one first",
        )


def _edited(mechanism: Mechanism, subject: Iri, changes: Mapping[str, object]) -> Joint | None:
    """The joint with the limits that an edit gives; None where it is about no joint, or gives neither."""
    if not changes.keys() & {*POSITIONS, "lowerLimit", "upperLimit"}:
        return None
    joints = (each for each in mechanism.joints if joint_iri(mechanism.name, each.name) == subject)
    joint = next(joints, None)
    if joint is None:
        return None
    lower, upper = (changes.get(name) for name in ("lowerLimit", "upperLimit"))
    limits = replace(
        joint.limits,
        lower=lower if isinstance(lower, int | float) else joint.limits.lower,
        upper=upper if isinstance(upper, int | float) else joint.limits.upper,
    )
    return replace(joint, limits=limits)


def _check_position(joint: Joint, name: str, value: object, where: str) -> None:
    limits, whose, remedy = (joint.limits.lower, joint.limits.upper), "is outside its limits", ""
    if joint.type is JointType.CONTINUOUS:
        limits, whose = (-WOUND, WOUND), "is more than two turns away"
        remedy = "give it in rad, without whole turns"
    if isinstance(value, int | float) and not limits[0] <= value <= limits[1]:
        raise AnnotationError(
            f"{where}sdt:{name} {value:g} of joint '{joint.name}' {whose}",
            allowed=f"{limits[0]:g} to {limits[1]:g}",
            remedy=remedy,
        )


def _check_speeds(facts: Facts, mechanism: Mechanism, file: Path) -> None:
    """Every joint that planning may move has limits of velocity and acceleration: a check needs both."""
    movable = {joint.name: joint for joint in mechanism.joints if joint.type is not JointType.FIXED}
    for joint in movable.values():
        iri = joint_iri(mechanism.name, joint.name)
        source = joint if joint.mimic is None else movable.get(joint.mimic.joint, joint)
        moves = facts.one(joint_iri(mechanism.name, source.name), "held") is not True
        planned = moves and joint.mimic is None
        if planned and not facts.number(iri, "accelerationLimit", 0.0):
            raise AnnotationError(
                f"{file} has no sdt:accelerationLimit for joint '{joint.name}'",
                allowed="one above 0 for each joint that is not held",
                remedy="give it, or 'sdt:held true' if planning shall never move the joint",
            )
        if moves and joint.limits.velocity in ((0.0, math.inf) if planned else (0.0,)):
            raise AnnotationError(
                f"joint '{joint.name}' of '{mechanism.name}' has no velocity limit",
                allowed="one above 0 for each joint that is not held",
                remedy="add it to the URDF, or 'sdt:held true' to the annotation",
            )
