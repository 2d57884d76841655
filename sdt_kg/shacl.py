"""SHACL results as violations, by pySHACL without the grammar of SPARQL.

That is half of what importing it takes, and no shape of ours asks for it.
"""

import re
import sys
import threading
from collections.abc import Callable
from dataclasses import dataclass
from decimal import Decimal
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from types import ModuleType
from typing import Any, Final

import rdflib
from rdflib.namespace import RDF as RDF_NS
from rdflib.namespace import RDFS
from rdflib.term import Node

from sdt_kg.errors import InputError
from sdt_kg.iri import SH, Iri, local_name
from sdt_kg.shapes import check_shapes
from sdt_kg.store import Value

SPARQL: Final = "rdflib.plugins.sparql"
"""A package that imports all of its modules; pySHACL begins with two, which need no others."""

_SH: Final = rdflib.Namespace(SH)

AS_MALFORMED: Final = (AssertionError, AttributeError, IndexError, KeyError, TypeError, ValueError)
"""What pySHACL raises, beside errors of its own, of shapes whose terms have values of another kind."""

MISSING: Final = SH + "MinCountConstraintComponent"
"""Of a result which says that a property has too few values."""

TOO_MANY: Final = SH + "MaxCountConstraintComponent"
"""Of a result which says that a property has too many values."""

Engine = Callable[[rdflib.Graph, rdflib.Graph], rdflib.Graph]
"""Data and shapes → SHACL validation report."""

# Constraint component → the parameter which holds its bound.
_BOUNDS: Final = {
    "ClassConstraintComponent": "class",
    "InConstraintComponent": "in",
    "LessThanConstraintComponent": "lessThan",
    "LessThanOrEqualsConstraintComponent": "lessThanOrEquals",
    "MaxCountConstraintComponent": "maxCount",
    "MaxExclusiveConstraintComponent": "maxExclusive",
    "MaxInclusiveConstraintComponent": "maxInclusive",
    "MinCountConstraintComponent": "minCount",
    "MinExclusiveConstraintComponent": "minExclusive",
    "MinInclusiveConstraintComponent": "minInclusive",
}


@dataclass(frozen=True, slots=True)
class Violation:
    """One SHACL result.

    Attributes:
        focus: The individual that is outside, or the shape which found none to look at.
        path: The property concerned, None for a constraint on the individual itself.
        value: Its value, None where there is none.
        bound: What the shape asks for, None where it is no single value.
        message: What to repair: the shape's words, or which values are too many.
        shape: IRI of the shape.
        component: IRI of the constraint component, None for a shape without focus node.
    """

    focus: Iri
    path: Iri | None
    value: Value
    bound: Value
    message: str
    shape: Iri
    component: Iri | None = None


@cache
def pyshacl() -> Any:  # noqa: ANN401 - its annotations are partial
    """The package; a shape with SPARQL, and who imports rdflib's later, gets that whole.

    Beside other threads all is imported as usual: one of them might ask for it meanwhile.
    """
    spec = find_spec(SPARQL)
    alone = SPARQL not in sys.modules and threading.active_count() == 1
    if not alone or spec is None or spec.submodule_search_locations is None:
        return import_module("pyshacl")
    bare = sys.modules[SPARQL] = ModuleType(SPARQL)
    bare.__path__ = spec.submodule_search_locations
    try:
        return import_module("pyshacl")
    finally:
        del sys.modules[SPARQL]


def pyshacl_report(data: rdflib.Graph, shapes: rdflib.Graph) -> rdflib.Graph:
    """The validation report of pySHACL, without inference: the engine of every verdict."""
    package = pyshacl()
    try:
        report = package.validate(data, shacl_graph=shapes, inference="none")[1]
    except (package.errors.ReportableRuntimeError, re.error, *AS_MALFORMED) as error:
        what = " ".join(str(error).split()) or "a term has a value of another kind than it may have"
        raise InputError(f"the shapes are not SHACL: {what}", allowed="SHACL core, well-formed") from None
    assert isinstance(report, rdflib.Graph), "pyshacl answers with a graph, or raises"
    return report


def check(
    data: rdflib.Graph, shapes: rdflib.Graph, expected: list[Iri], engine: Engine = pyshacl_report
) -> list[Violation]:
    """SHACL results of the data, and a violation for each expected shape without focus node.

    A shape that looks at the values of a property which a result misses has no focus node for that reason:
    the result says it, and nothing is said of the shape.

    Args:
        data: What the shapes look at.
        shapes: All are run.
        expected: IRIs of those that have to find something to look at, and to demand something of it.
        engine: That runs them.

    Raises:
        InputError: They are malformed; or, where some are expected, let everything pass (`check_shapes`).
    """
    if expected:
        check_shapes(shapes, tuple(expected))
    found = read_report(data, shapes, engine(data, shapes))
    missing = {each.path for each in found if each.component == MISSING}
    idle = [each for each in expected if not _has_focus(data, shapes, each)]
    found += [_without_focus(each) for each in idle if not missing & _looked_along(shapes, each)]
    return sorted(found, key=order)


def order(each: Violation) -> tuple[str, str, str]:
    """The same order each time."""
    return each.focus, each.path or "", each.message


def read_report(data: rdflib.Graph, shapes: rdflib.Graph, report: rdflib.Graph) -> list[Violation]:
    """The results of a SHACL validation report about the data; details of a result are not results."""
    return [_violation(data, shapes, report, result) for result in report.objects(None, _SH.result)]


def _has_focus(data: rdflib.Graph, shapes: rdflib.Graph, shape: Iri) -> bool:
    node = rdflib.URIRef(shape)
    found = [data.subjects(RDF_NS.type, each) for each in shapes.objects(node, _SH.targetClass)]
    found += [data.objects(None, each) for each in shapes.objects(node, _SH.targetObjectsOf)]
    found += [data.subjects(each, None) for each in shapes.objects(node, _SH.targetSubjectsOf)]
    found += [data.predicates(each, None) for each in shapes.objects(node, _SH.targetNode)]
    found += [data.subjects(RDF_NS.type, node)] if (node, RDF_NS.type, RDFS.Class) in shapes else []
    return any(next(each, None) is not None for each in found)


def _looked_along(shapes: rdflib.Graph, shape: Iri) -> set[Iri]:
    """Properties whose values the shape looks at."""
    return {str(each) for each in shapes.objects(rdflib.URIRef(shape), _SH.targetObjectsOf)}


def _without_focus(shape: Iri) -> Violation:
    said = f"the shape <{shape}> finds nothing to look at: nothing is known to be inside the class"
    return Violation(shape, None, None, None, said, shape)


def _violation(data: rdflib.Graph, shapes: rdflib.Graph, report: rdflib.Graph, result: Node) -> Violation:
    def one(name: str) -> Node | None:
        return report.value(result, _SH[name])

    focus, path, source = one("focusNode"), one("resultPath"), one("sourceShape")
    component = str(one("sourceConstraintComponent"))
    parameter = _BOUNDS.get(component.removeprefix(SH), "")
    bound = shapes.value(source, _SH[parameter]) if parameter else None
    if parameter.startswith("lessThan") and focus is not None and bound is not None:
        bound = data.value(focus, bound)
    return Violation(
        focus=str(focus),
        path=None if path is None else str(path),
        value=_value(one("value")),
        bound=_value(bound),
        message=(component == TOO_MANY and _too_many(data, focus, path)) or str(one("resultMessage")),
        shape=str(source),
        component=component,
    )


def _too_many(data: rdflib.Graph, focus: Node | None, path: Node | None) -> str:
    """What to do, with the values by names, or as RDF where these are the same; empty of a longer path.

    A shape has one message for too few values and for too many.
    """
    values: list[Node] = list(data.objects(focus, path))
    named = {
        each.n3(): local_name(str(each)) if isinstance(each, rdflib.URIRef) else str(each) for each in values
    }
    told = sorted(named.values() if len({*named.values()}) == len(named) else named)
    several = "there are several, and which counts is not guessed: keep one of"
    return f"{several} {' and '.join(told)}" if told else ""


def _value(node: Node | None) -> Value:
    if not isinstance(node, rdflib.Literal):
        return None if node is None or isinstance(node, rdflib.BNode) else str(node)
    value = node.toPython()
    if isinstance(value, bool | int | str):
        return value
    return float(value) if isinstance(value, float | Decimal) else str(node)
