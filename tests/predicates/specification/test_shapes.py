"""The shapes of tasks and the reader of tasks agree: what a shape refuses, no kitchen makes a task."""

from pathlib import Path

import pytest
import rdflib
from rdflib.namespace import RDF

import ontology
from predicates.specification.read import read_specification
from sdt_kg.errors import InputError
from sdt_kg.iri import LAW
from sdt_kg.shacl import check
from services.specifications import ready
from tests.small import small_twin

PROJECT = Path(__file__).resolve().parents[3]
SHAPES = rdflib.Graph().parse(ontology.path("shapes/task.shapes.ttl"))
TWIN = small_twin()
DOOR = TWIN.containers()[0].name
FAILING = sorted((PROJECT / "tests/shapes/task").glob("*.fail.ttl"))
HEAD = "@prefix id: <https://example.org/id/> .\n@prefix law: <https://example.org/law#> .\n"


def conforms(graph: rdflib.Graph) -> bool:
    return not check(graph, SHAPES, [])


@pytest.mark.parametrize("path", ready().values(), ids=ready())
def test_every_ready_task_conforms(path: Path) -> None:
    assert conforms(rdflib.Graph().parse(path))


@pytest.mark.parametrize("path", FAILING, ids=lambda path: path.stem)
def test_what_a_shape_refuses_the_reader_refuses(path: Path) -> None:
    text = path.read_text(encoding="utf-8").replace("fridge_door", DOOR).replace('"door"', f'"{DOOR}"')
    graph = rdflib.Graph().parse(data=text, format="turtle")
    assert not conforms(graph)
    rules = [str(each) for each in graph.subjects(RDF.type) if "Task" not in str(graph.value(each, RDF.type))]
    if rules:
        kept = ", ".join(f"<{each}>" for each in rules)
        text += f"id:all a law:TaskSpecification ; law:hasStep id:one ; law:keeps {kept} .\n"
        text += f'id:one a law:Task ; law:index 1 ; law:verb law:Open ; law:containerName "{DOOR}" .\n'
    elif (None, RDF.type, rdflib.URIRef(LAW + "TaskSpecification")) not in graph:
        text += "id:tea a law:TaskSpecification .\n"
    with pytest.raises(InputError):
        read_specification(TWIN, text, path.name)
