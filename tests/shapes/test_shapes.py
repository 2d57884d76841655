"""Every shape has a twin that passes and one that fails; a shape that looks at nothing is a violation."""

from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest
import rdflib
from rdflib.namespace import RDF, SH
from rdflib.term import Node, URIRef

import ontology
from sdt_kg.errors import InputError
from sdt_kg.iri import SDT
from sdt_kg.scope import D_ARTIC, D_ARTIC_DYN, TeeClass
from sdt_kg.shacl import Violation, check
from tests.shapes.engines import ENGINES

PAIRS = Path(__file__).parent
FILES = ("d_artic", "d_artic_dyn", "sdt", "task")


@cache
def shapes(name: str) -> rdflib.Graph:
    """The shapes of a file, to be read only."""
    return rdflib.Graph().parse(ontology.path(f"shapes/{name}.shapes.ttl"))


def targeted(name: str) -> list[URIRef]:
    graph = shapes(name)
    found = {*graph.subjects(SH.targetClass), *graph.subjects(SH.targetObjectsOf)}
    return sorted(node for node in found if isinstance(node, URIRef))


SHAPES = [(name, shape) for name in FILES for shape in targeted(name)]
PROPERTIES = [
    (name, shape, part) for name, shape in SHAPES for part in sorted(shapes(name).objects(shape, SH.property))
]
IDS = [shape.rsplit("#", 1)[-1] for _, shape in SHAPES]


def twin(name: str, shape: URIRef, kind: str) -> Path:
    return PAIRS / name / f"{shape.rsplit('#', 1)[-1]}.{kind}.ttl"


def results(name: str, shape: URIRef, data: rdflib.Graph) -> list[Violation]:
    found = check(data, shapes(name), [str(shape)])
    return [each for each in found if each.shape == str(shape) or each.shape.startswith(f"{shape}-")]


def test_there_are_shapes_and_no_pair_without_a_shape() -> None:
    assert len(SHAPES) == 32
    files = {path.relative_to(PAIRS) for path in PAIRS.glob("*/*.ttl")}
    expected = {twin(*each, kind).relative_to(PAIRS) for each in SHAPES for kind in ("pass", "fail")}
    assert files == expected


@pytest.mark.parametrize(("name", "shape"), SHAPES, ids=IDS)
def test_the_passing_twin_passes(name: str, shape: URIRef) -> None:
    assert results(name, shape, rdflib.Graph().parse(twin(name, shape, "pass"))) == []


@pytest.mark.parametrize(("name", "shape"), SHAPES, ids=IDS)
def test_the_failing_twin_violates_every_part_of_the_shape(name: str, shape: URIRef) -> None:
    path = twin(name, shape, "fail")
    head = path.read_text(encoding="utf-8").splitlines()[0].removeprefix("# violates: ")
    namespace = shape.rsplit("#", 1)[0] + "#"
    expected = {namespace + part.split(":", 1)[1] for part in head.split()}
    assert {each.shape for each in results(name, shape, rdflib.Graph().parse(path))} == expected
    assert expected >= {str(part) for part in shapes(name).objects(shape, SH.property)}


@pytest.mark.parametrize(("name", "shape", "part"), PROPERTIES)
def test_every_property_is_demanded_and_says_what_to_repair(name: str, shape: URIRef, part: URIRef) -> None:
    graph = shapes(name)
    path = graph.value(part, SH.path)
    assert graph.value(part, SH.minCount) is not None
    assert graph.value(part, SH.message) is not None
    data = rdflib.Graph().parse(twin(name, shape, "pass"))
    data.remove((None, path, None))
    assert str(part) in {each.shape for each in results(name, shape, data)}


@pytest.mark.parametrize(("name", "shape"), SHAPES, ids=IDS)
def test_a_typo_in_a_target_is_refused_and_one_that_nothing_is_lets_nothing_pass(
    name: str, shape: URIRef
) -> None:
    data = rdflib.Graph().parse(twin(name, shape, "pass"))
    with pytest.raises(InputError, match=r"Typo>, which no vocabulary has"):
        check(data, aimed(name, shape, lambda value: URIRef(f"{value}Typo")), [str(shape)])
    nowhere = aimed(name, shape, lambda _: URIRef(SDT + "Branch"))
    assert str(shape) in {each.focus for each in check(data, nowhere, [str(shape)])}


def aimed(name: str, shape: URIRef, at: Callable[[Node], URIRef]) -> rdflib.Graph:
    """The shapes, with other targets of one of them."""
    graph = rdflib.Graph() + shapes(name)
    for target in (SH.targetClass, SH.targetObjectsOf):
        for value in list(graph.objects(shape, target)):
            graph.remove((shape, target, value))
            graph.add((shape, target, at(value)))
    return graph


@pytest.mark.parametrize("tee", [D_ARTIC, D_ARTIC_DYN], ids=lambda tee: tee.name)
def test_every_shape_of_a_class_belongs_to_a_part_of_it(tee: TeeClass) -> None:
    parts = ("Task", "Environment", "Robot", "Physics")
    named = {shape for part in parts for shape in tee.shapes_of(part)}
    assert named == set(map(str, targeted(tee.name.lower())))


@pytest.mark.parametrize("name", FILES)
def test_property_shapes_are_used(name: str) -> None:
    graph = shapes(name)
    defined: set[Node] = set(graph.subjects(RDF.type, SH.PropertyShape))
    assert defined == set(graph.objects(None, SH.property))
    assert defined


def facts(found: list[Violation]) -> list[tuple[object, ...]]:
    return sorted(
        (each.focus, str(each.path), str(each.value), each.shape, str(each.component)) for each in found
    )


@pytest.mark.parametrize("kind", ["pass", "fail", "nothing"])
@pytest.mark.parametrize(("name", "shape"), SHAPES, ids=IDS)
def test_a_second_engine_agrees(name: str, shape: URIRef, kind: str) -> None:
    data = rdflib.Graph()
    if kind != "nothing":
        data.parse(twin(name, shape, kind))
    first, second = (check(data, shapes(name), [str(shape)], engine) for engine in ENGINES.values())
    assert facts(first) == facts(second)
    assert first or kind == "pass"


@pytest.mark.parametrize(("name", "shape", "part"), PROPERTIES)
def test_a_second_engine_agrees_where_a_property_is_missing(name: str, shape: URIRef, part: URIRef) -> None:
    data = rdflib.Graph().parse(twin(name, shape, "pass"))
    data.remove((None, shapes(name).value(part, SH.path), None))
    first, second = (check(data, shapes(name), [str(shape)], engine) for engine in ENGINES.values())
    assert facts(first) == facts(second)
    assert str(part) in {each.shape for each in second}
