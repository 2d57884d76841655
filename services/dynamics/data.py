"""Force data: which `.ttl` says what pushes back in a kitchen, and the twin that knows it.

Force data are no part of a kitchen's own annotation: verdicts of D_artic do not depend on them, and keep
their IRIs whatever is measured later.
"""

import math
from codecs import BOM_UTF8
from pathlib import Path

import pyoxigraph as ox

import kitchens
import robots
from sdt_kg.endless import check_ends
from sdt_kg.entities import Replacement
from sdt_kg.errors import AnnotationError, InputError
from sdt_kg.iri import SDT, Iri, local_name
from sdt_kg.store import Triple
from sdt_kg.twin import Twin

HAS_FORCE_MODEL = SDT + "hasForceModel"

ROBOT_DATA = ("effortLimitKnown", "standsOn", "gripForce", "padFriction", "wheelFriction")
"""What is bundled of a robot, unless its own annotation says any of it."""


def with_forces(twin: Twin, file: Path | None = None, handle_force: float | None = None) -> Twin:
    """The twin with force data: of its kitchen the file's, else the bundled ones; of bundled robots theirs.

    A kitchen that has none stays as it is: then nothing of it lies inside D_artic_dyn, and the shapes say
    so. Of a robot that has none nothing is checked, and the verdict says so. A handle force [N] is allowed
    at every handle instead of what the force models say.

    Raises:
        AnnotationError: The file is not Turtle, has blank nodes, or speaks of another kitchen.
        GraphError: It uses a property that `sdt.ttl` does not have, or one twice.
    """
    check_force(handle_force)
    for robot in twin.robots:
        twin = _with_efforts(twin, robot)
    chosen = file or _bundled(twin)
    if chosen is None:
        return _allowing(twin, handle_force)
    triples = frozenset(_triples(chosen))
    _check(twin, chosen, triples)
    note = f"force data of {chosen.name}"
    return _allowing(twin.rewritten(Replacement(twin.environment, frozenset(), triples, note)), handle_force)


def check_force(handle_force: float | None) -> None:
    """A force [N] that may be allowed at handles.

    Raises:
        InputError: It is none.
    """
    if handle_force is not None and not 0 < handle_force < math.inf:
        raise InputError(f"a handle_force of {handle_force:g} N", allowed="more than 0, and finite")


def _allowing(twin: Twin, handle_force: float | None) -> Twin:
    """The twin with this force at every handle, which says that who asked allows it, and no force data do."""
    if handle_force is None:
        return twin
    joints = (each.joint for each in twin.containers())
    models = {each for joint in joints for each in twin.entities.facts.iris(joint, "hasForceModel")}
    parts = [twin.entities.replacement(twin.environment, {"allowedAtEveryHandle": handle_force})]
    parts += [twin.entities.replacement(each, {"allowedHandleForce": handle_force}) for each in models]
    removed = frozenset[Triple]().union(*(each.removed for each in parts))
    added = frozenset[Triple]().union(*(each.added for each in parts))
    note = f"at every handle {handle_force:g} N are allowed"
    return twin.rewritten(Replacement(twin.environment, removed, added, note))


def _bundled(twin: Twin) -> Path | None:
    """The bundled force data of a bundled kitchen; None where it has its own, or is only called like one."""
    name = local_name(twin.environment)
    file = kitchens.path(f"{name}/dynamics/{name}.ttl")
    if _has_forces(twin) or not file.is_file():
        return None
    about = {subject for subject, predicate, _ in _triples(file) if predicate == HAS_FORCE_MODEL}
    return file if about <= _moving(twin) else None


def _with_efforts(twin: Twin, robot: Iri) -> Twin:
    """The twin with a robot's bundled efforts, grippers and wheels, if none is there yet.

    Of grippers that its annotation leaves out there are none; a robot that lacks a joint or body of which
    they speak is another one, which is only called so. The twin's notes tell either.
    """
    name = local_name(robot)
    file = robots.path(f"{name}/dynamics/{name}.ttl")
    facts = twin.entities.facts
    parts = (*facts.having("partOf", robot), *facts.iris(robot, "hasGripper"))
    known = (each for part in (robot, *parts) for each in ROBOT_DATA if facts.all(part, each))
    if not file.is_file() or any(known):
        return twin
    triples = frozenset(_triples(file))
    about = {subject for subject, _, _ in triples}
    about |= {value.value for _, predicate, value in triples if predicate == SDT + "standsOn"}
    missing = about - {robot, *parts}
    gone = {each for each in missing if each.startswith(f"{robot}/gripper/")}
    note = f"efforts, grippers and wheels of {name}"
    if foreign := sorted(map(local_name, missing - gone)):
        added, note = frozenset[Triple](), f"no {note}: it has no {foreign[0]}, so it is another robot"
    else:
        added = frozenset(each for each in triples if each[0] not in gone)
        names = ", ".join(sorted(map(local_name, gone)))
        note += f", without those of the gripper {names}, which it does not have" if gone else ""
    return twin.rewritten(Replacement(robot, frozenset(), added, note))


def _has_forces(twin: Twin) -> bool:
    facts = twin.entities.facts
    return any(facts.iris(each.joint, "hasForceModel") for each in twin.containers())


def _triples(file: Path) -> list[Triple]:
    found: list[Triple] = []
    check_ends(file)
    try:
        for quad in ox.parse(file.read_bytes().removeprefix(BOM_UTF8), format=ox.RdfFormat.TURTLE):
            subject, value = quad.subject, quad.object
            if not isinstance(subject, ox.NamedNode) or not isinstance(value, ox.NamedNode | ox.Literal):
                raise AnnotationError(
                    f"{file} has a blank node", allowed="IRIs, so that a verdict can name them"
                )
            found.append((subject.value, quad.predicate.value, value))
    except (OSError, SyntaxError) as error:
        raise AnnotationError(f"{file} cannot be read ({error})", allowed="a Turtle file") from error
    return found


def _moving(twin: Twin) -> set[Iri]:
    """Joints that move containers, and those that move with them."""
    own = {each.joint for each in twin.containers()}
    return own.union(*(twin.entities.coupling.together(each) for each in own))


def _check(twin: Twin, file: Path, triples: frozenset[Triple]) -> None:
    joints = _moving(twin)
    about = {subject for subject, name, _ in triples if name == HAS_FORCE_MODEL}
    if not about:
        what = f"{file} gives no joint a force model"
        raise AnnotationError(what, allowed="JOINT sdt:hasForceModel MODEL")
    if unknown := sorted(about - joints):
        what = f"{file} speaks of {unknown[0]}, which moves no container of {local_name(twin.environment)}"
        raise AnnotationError(what, allowed=", ".join(sorted(joints)[:3]) + " …")
