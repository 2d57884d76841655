"""Annotation files: which `.ttl` belongs to a model, read and checked against it."""

import shlex
from codecs import BOM_UTF8
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from xml.etree import ElementTree as ET

import pyoxigraph as ox

import kitchens
import robots
from sdt_kg.annotating.checks import check_against, check_structure, unknown_names
from sdt_kg.errors import AnnotationError
from sdt_kg.iri import SDT, Iri, local_name, model_iri
from sdt_kg.mechanism import Mechanism, Pose
from sdt_kg.store import Term, Triple, value_of
from sdt_kg.triples.facts import TYPE
from sdt_kg.triples.from_mechanism import pose_triples
from sdt_kg.triples.vocabulary import NUMBERS, properties


@dataclass(frozen=True, slots=True)
class Chosen:
    """An annotation's triples, about the model's own IRIs, and what choosing it noticed."""

    triples: tuple[Triple, ...]
    notes: tuple[str, ...] = ()


def with_annotation(triples: Iterable[Triple], chosen: Chosen) -> list[Triple]:
    """A model's own triples and those of its annotation, each number said once.

    Raises:
        AnnotationError: Two values of one number: which of them counted would be chance; or another tree.
    """
    own, said, once = [*triples], dict[tuple[Iri, Iri], Term](), list[Triple]()
    check_structure(own, chosen.triples)
    annotated = {subject for subject, _, _ in chosen.triples}
    for subject, predicate, term in (*own, *chosen.triples):
        if subject in annotated and properties().get(predicate.removeprefix(SDT)) in NUMBERS:
            first = said.setdefault((subject, predicate), term)
            value, other = value_of(first), value_of(term)
            if value != other:
                raise AnnotationError(
                    f"sdt:{local_name(predicate)} of '{local_name(subject)}' is {value} and {other}",
                    allowed="one value, in the model or in its annotation",
                )
            if first != term:  # the same number, written otherwise
                continue
        once.append((subject, predicate, term))
    return once


def chosen_robot(mechanism: Mechanism, urdf: Path, explicit: Path | None) -> Chosen:
    """The robot's annotation: explicit, beside the URDF, or the bundled one that fits.

    Raises:
        AnnotationError: There is none, or it contradicts the model.
    """
    given = _given(mechanism, urdf, explicit, "Robot")
    if given is not None:
        return given
    for file in sorted(robots.path("").glob("*/*.ttl")):
        chosen = _read(file, mechanism, "Robot")
        if chosen is not None and not unknown_names(chosen.triples, mechanism):
            return _bundled(file, chosen, mechanism)
    raise AnnotationError(
        f"robot '{mechanism.name}' has no annotation",
        allowed=f"{urdf.with_name(mechanism.name + '.ttl')}, or --annotation FILE.ttl",
        remedy=f"sdt robot describe {shlex.quote(str(urdf))} writes a first one",
    )


def chosen_kitchen(mechanism: Mechanism, urdf: Path, explicit: Path | None) -> Chosen:
    """The kitchen's annotation: explicit, beside the URDF, or the bundled one that fits.

    Without any, robots start at the origin and joints get D_artic's acceleration, as assumptions.

    Raises:
        AnnotationError: It contradicts the model.
    """
    given = _given(mechanism, urdf, explicit, "Environment")
    if given is not None:
        return given
    joints = {joint.name for joint in mechanism.joints}
    for file in sorted(kitchens.path("").glob("*/*.ttl")):
        if _movable_joints(file.with_suffix(".urdf")) <= joints:
            chosen = _read(file, mechanism, "Environment")
            if chosen is not None and not unknown_names(chosen.triples, mechanism):
                return _bundled(file, chosen, mechanism)
    return _without_annotation(mechanism)


def described(file: Path) -> tuple[str, str]:
    """What an annotation describes: `Robot` or `Environment`, and the name of its model.

    Raises:
        AnnotationError: Neither or several, or not Turtle.
    """
    found = [
        (kind, local_name(quad.subject.value))
        for quad in _quads(file)
        for kind in ("Robot", "Environment")
        if isinstance(quad.subject, ox.NamedNode) and _is_type(quad, kind)
    ]
    if len(found) != 1:
        raise AnnotationError(
            f"{file} describes {len(found)} models",
            allowed="one sdt:Robot or one sdt:Environment for each file",
            remedy="add '<https://example.org/id/NAME> a sdt:Robot .'",
        )
    return found[0]


def _given(mechanism: Mechanism, urdf: Path, explicit: Path | None, kind: str) -> Chosen | None:
    """The explicit annotation if it is of this kind, else the one beside the URDF, else None."""
    for file in (explicit, urdf.with_name(f"{mechanism.name}.ttl")):
        if file is None or (file is not explicit and not file.is_file()):
            continue
        chosen = _read(file, mechanism, kind)
        if chosen is not None:
            check_against(chosen.triples, mechanism, file, kind)
            return chosen
        if file is not explicit:
            raise _of_another_kind(file, mechanism, kind)
    return None


def _of_another_kind(file: Path, mechanism: Mechanism, kind: str) -> AnnotationError:
    """The file beside a model of this kind describes none: nothing, or a model of the other kind."""
    other, words = ("Robot", "a robot's") if kind == "Environment" else ("Environment", "a kitchen's")
    if any(_is_type(quad, other) for quad in _quads(file)):
        what = f"{file} is {words} annotation (sdt:{other}), and lies where that of this sdt:{kind} would be"
        return AnnotationError(what, remedy="delete it or move it elsewhere")
    remedy = f"add '<{model_iri(mechanism.name)}> a sdt:{kind} .'"
    return AnnotationError(f"{file} describes no sdt:{kind}", remedy=remedy)


def _bundled(file: Path, chosen: Chosen, mechanism: Mechanism) -> Chosen:
    check_against(chosen.triples, mechanism, file, "Robot" if "robots" in file.parts else "Environment")
    note = f"has no annotation of its own: that of the bundled '{file.stem}' fits and is used"
    start = next((term for _, name, term in chosen.triples if name == SDT + "startPose"), None)
    return Chosen(chosen.triples, (note + (", its start pose included" if start is not None else ""),))


@cache
def _movable_joints(urdf: Path) -> set[str]:
    """Of a bundled kitchen: its file does not change."""
    joints = ET.parse(urdf).iterfind("joint")  # noqa: S314 - our own
    return {joint.get("name", "") for joint in joints if joint.get("type") != "fixed"}


def _without_annotation(mechanism: Mechanism) -> Chosen:
    kitchen = model_iri(mechanism.name)
    note = "no annotation: robots are assumed to start at x = 0, y = 0, yaw = 0 of the root frame"
    start = f"{kitchen}/start"
    triples: list[Triple] = [
        (kitchen, SDT + "startPose", ox.NamedNode(start)),
        (kitchen, SDT + "assumption", ox.Literal(note)),
        *pose_triples(start, Pose()),
    ]
    return Chosen(tuple(triples), (note,))


def _read(file: Path, mechanism: Mechanism, kind: str) -> Chosen | None:
    """The file's triples, its model's IRIs replaced by this model's; None if it describes no such thing.

    Raises:
        AnnotationError: Not there, not Turtle, or blank nodes.
    """
    quads = _quads(file)
    models = [quad.subject for quad in quads if _is_type(quad, kind)]
    if not models:
        return None
    if len(models) > 1 or not isinstance(models[0], ox.NamedNode):
        raise AnnotationError(f"{file} describes {len(models)} of sdt:{kind}", allowed="one for each file")
    return Chosen(tuple(_renamed(quads, models[0].value, model_iri(mechanism.name), file)))


def _quads(file: Path) -> list[ox.Quad]:
    if not file.is_file():
        raise AnnotationError(f"no annotation file at {file}", allowed="a Turtle file")
    try:
        return list(ox.parse(file.read_bytes().removeprefix(BOM_UTF8), format=ox.RdfFormat.TURTLE))
    except SyntaxError as error:
        raise AnnotationError(f"{file} is not Turtle: {error}") from None


def _is_type(quad: ox.Quad, kind: str) -> bool:
    return quad.predicate.value == TYPE and quad.object == ox.NamedNode(SDT + kind)


def _renamed(quads: Iterable[ox.Quad], old: Iri, new: Iri, file: Path) -> Iterator[Triple]:
    def renamed(iri: Iri) -> Iri:
        return new + iri.removeprefix(old) if iri == old or iri.startswith(old + "/") else iri

    for quad in quads:
        subject, value = quad.subject, quad.object
        if not isinstance(subject, ox.NamedNode) or not isinstance(value, ox.NamedNode | ox.Literal):
            raise AnnotationError(
                f"{file} has a blank node: {quad}", remedy="name it: a verdict must be able to point at it"
            )
        if isinstance(value, ox.NamedNode):
            value = ox.NamedNode(renamed(value.value))
        yield renamed(subject.value), quad.predicate.value, value
