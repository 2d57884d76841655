"""What an edit leaves as it is is not read again, and what is read is what the graph says."""

import pytest

from sdt_kg.entities import Replacement
from sdt_kg.errors import GraphError
from sdt_kg.iri import SDT, body_iri
from sdt_kg.store import double
from sdt_kg.triples import Facts, read_mechanism_of
from sdt_kg.twin import Twin
from services.edits import parse_edit
from tests.small import small_twin

TWIN = small_twin("a", ("pr2",))
EDITS = (
    "box:crate=0.2,0.2,0.2@3,3,0.1",
    "furniture:low_drawer=0.1,0",
    "set:low_drawer_joint.upperLimit=0.3",
    "clear:low_drawer",
)


def anew(twin: Twin, model: str):
    """The mechanism, read from nothing but the graphs."""
    entities = twin.entities
    triples = (each for graph in entities.graphs_of(model) for each in entities.store.triples(graph))
    return read_mechanism_of(Facts(triples), model)


@pytest.mark.parametrize("text", EDITS)
def test_after_an_edit_the_kitchen_is_what_its_graph_says(text: str) -> None:
    edit = parse_edit(TWIN, text)
    after = edit.applied(TWIN)
    assert after.mechanism(after.environment) == anew(after, after.environment)
    back = edit.inverse(TWIN).applied(after)
    assert back.mechanism(back.environment) == anew(back, back.environment)
    assert back.mechanism(back.environment) == TWIN.mechanism(TWIN.environment)


def test_only_bodies_of_which_a_part_is_edited_are_other_ones() -> None:
    kitchen = TWIN.environment
    body = body_iri(TWIN.name(kitchen), "low_drawer")
    facts = TWIN.entities.facts
    shape = facts.iris(body, "hasCollisionGeometry")[0]
    pose = str(facts.one(shape, "hasPose"))
    after = TWIN.with_edit(pose, x=0.125)
    assert after.mechanism(kitchen) == anew(after, kitchen)
    pairs = zip(TWIN.mechanism(kitchen).bodies, after.mechanism(kitchen).bodies, strict=True)
    assert [one.name for one, other in pairs if one != other] == ["low_drawer"]


def test_an_edit_of_a_body_that_leaves_it_no_shape_type_is_refused() -> None:
    kitchen = TWIN.environment
    shape = TWIN.entities.facts.iris(body_iri(TWIN.name(kitchen), "low_drawer"), "hasCollisionGeometry")[0]
    store = TWIN.entities.store
    graph = TWIN.entities.asserted[kitchen]
    types = frozenset(each for each in store.triples(graph) if each[0] == shape and "type" in each[1])
    with pytest.raises(GraphError, match="cannot be read"):
        TWIN.rewritten(Replacement(kitchen, types, frozenset(), "no type"))
    with pytest.raises(GraphError, match="several values"):
        TWIN.rewritten(
            Replacement(kitchen, frozenset(), frozenset({(shape, SDT + "sizeX", double(9.0))}), "twice")
        )
