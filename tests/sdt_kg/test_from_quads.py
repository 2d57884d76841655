"""A twin is rebuilt from the graphs that it wrote; what was lost or changed on the way is told."""

from collections.abc import Callable
from pathlib import Path

import pyoxigraph as ox
import pytest
import rdflib

from sdt_kg.annotating.annotate import TEE_GRAPH
from sdt_kg.entities import state_iri
from sdt_kg.errors import GraphError, UnknownEntityError
from sdt_kg.history import History
from sdt_kg.history.edits import Moved
from sdt_kg.iri import SDT, TEE, XSD, graph_iri, joint_iri, model_iri
from sdt_kg.load import load_twin
from sdt_kg.store import MemoryStore
from sdt_kg.twin import Twin
from tests.sdt_kg.conftest import link
from tests.small import small_twin

SLIDE = joint_iri("k", "slide")
ASSERTED = ox.NamedNode(graph_iri("asserted", "k"))

Change = Callable[[ox.Store], None]


def store_of(twin: Twin) -> ox.Store:
    store = ox.Store()
    store.load(twin.serialize("nquads"), format=ox.RdfFormat.N_QUADS)
    return store


def described(twin: Twin) -> dict[str, object]:
    models = (twin.environment, *twin.robots)
    return {
        "hashes": {model: twin.content_hash(model) for model in models},
        "mechanisms": {model: twin.mechanism(model) for model in models},
        "robots": {robot: twin.robot(robot) for robot in twin.robots},
        "containers": twin.containers(),
        "kitchen": twin.kitchen(),
        "state": twin.state,
        "graphs": set(twin.graphs()),
    }


@pytest.mark.parametrize("form", ["nquads", "trig", "rdflib"])
def test_a_twin_comes_back_from_its_graphs(form: str) -> None:
    twin = small_twin("a", ("pr2", "stretch"))
    container = twin.containers()[0]
    twin = twin.at({container.active_joint: 0.5 * container.upper})
    if form == "rdflib":
        back = Twin.from_rdflib(twin.to_rdflib())
    else:
        back = Twin.from_quads(ox.parse(twin.serialize(form), format=FORMS[form]))
    assert described(back) == described(twin)


FORMS = {"nquads": ox.RdfFormat.N_QUADS, "trig": ox.RdfFormat.TRIG}


def test_an_edited_twin_comes_back(drawer: Path) -> None:
    twin = load_twin(drawer).with_edit(SLIDE, upperLimit=0.3)
    back = Twin.from_quads(store_of(twin))
    assert back.content_hash(back.environment) == twin.content_hash(twin.environment)
    assert back.container("cupboard_drawer").upper == 0.3


def test_a_twin_comes_back_from_a_store_that_keeps_its_branches(drawer: Path) -> None:
    twin = load_twin(drawer)
    kept = MemoryStore()
    history = History.of(twin, kept)
    history.derived(history.first, Moved(((SLIDE, 0.2),)))
    store = store_of(twin)
    store.extend(kept.everything())
    back = Twin.from_quads(store, state=state_iri(twin.environment, twin.state))
    assert described(back) == described(twin)


def test_of_several_twins_the_one_that_is_meant_comes_back() -> None:
    one, other = small_twin("a", ("pr2", "stretch")), small_twin("b", ("pr2",))
    store = store_of(one)
    store.extend(store_of(other))
    with pytest.raises(GraphError, match="hold 2 kitchens: a, b"):
        Twin.from_quads(store)
    back = Twin.from_quads(store, model_iri("b"), [model_iri("pr2")])
    assert described(back) == described(other)
    assert set(back.notes) >= set(other.notes) > set()
    with pytest.raises(UnknownEntityError, match="no robot in these graphs named 'tiago'"):
        Twin.from_quads(store, model_iri("b"), [model_iri("tiago")])


def test_of_several_states_the_one_that_is_meant_comes_back(drawer: Path) -> None:
    closed = load_twin(drawer)
    opened = closed.at({SLIDE: 0.5})
    store = store_of(closed)
    store.extend(store_of(opened))
    with pytest.raises(GraphError, match="hold 2 states of 'k'"):
        Twin.from_quads(store)
    for twin in (closed, opened):
        assert Twin.from_quads(store, state=twin.graphs()[-1]).state == twin.state


def rewrite(store: ox.Store, predicate: str, value: object, subject: str = SLIDE) -> None:
    """Replace the property's value wherever it stands; None removes it."""
    found = list(store.quads_for_pattern(ox.NamedNode(subject), ox.NamedNode(SDT + predicate), None, None))
    assert found
    for quad in found:
        store.remove(quad)
        if value is not None:
            term = value if isinstance(value, ox.BlankNode | ox.Literal) else ox.Literal(value)  # type: ignore[arg-type]
            store.add(ox.Quad(quad.subject, quad.predicate, term, quad.graph_name))


NO_NUMBER = ox.Literal("0/4", datatype=ox.NamedNode(XSD + "double"))
BODY = f"{model_iri('k')}/body/cupboard_drawer"
RULE_11 = graph_iri("inferred", "k/r11_thresholds")


def without(store: ox.Store, tee_class: str) -> None:
    """Take away what `tee.ttl` says of a class."""
    graph = ox.NamedNode(TEE_GRAPH)
    for quad in list(store.quads_for_pattern(ox.NamedNode(TEE + tee_class), None, None, graph)):
        store.remove(quad)


def test_what_was_saved_before_a_class_was_added_is_read(drawer: Path) -> None:
    twin = load_twin(drawer)
    store = store_of(twin)
    size = len(store)
    without(store, "D_artic_dyn")
    assert len(store) < size
    assert described(Twin.from_quads(store)) == described(twin)


def test_what_was_saved_before_another_class_asked_for_more_is_read(drawer: Path) -> None:
    twin = load_twin(drawer)
    store = store_of(twin)
    shapes = ox.NamedNode(TEE + "hasPhysicsShape")
    (some, *_) = store.quads_for_pattern(
        ox.NamedNode(TEE + "D_artic_dyn"), shapes, None, ox.NamedNode(TEE_GRAPH)
    )
    store.remove(some)
    assert described(Twin.from_quads(store)) == described(twin)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda store: rewrite(store, "upperLimit", 0.4), "inferred about 'k' is not what the rules"),
        (lambda store: rewrite(store, "openFrom", 0.1), "with 'slide openFrom 0.1'"),
        (lambda store: rewrite(store, "openFrom", None), "without 'slide openFrom 0.45'"),
        (lambda store: store.remove_graph(ox.NamedNode(RULE_11)), "r11_thresholds> without"),
        (lambda store: store.remove_graph(ox.NamedNode(TEE_GRAPH)), "constants of D_artic differ"),
        (lambda store: without(store, "D_artic"), "constants of D_artic differ"),
        (lambda store: rewrite(store, "position", 0.2), "its name is not the hash of its positions"),
        (lambda store: rewrite(store, "position", None), "lacks joints .*: slide"),
        (lambda store: rewrite(store, "axisX", None), "'k' is not whole: .*axisX"),
        (lambda store: rewrite(store, "axisX", "east"), "sdt:axisX of 'slide' in 'k' is \"east\""),
        (lambda store: rewrite(store, "axisX", NO_NUMBER), "sdt:axisX of 'slide' in 'k' is \"0/4\""),
        (lambda store: rewrite(store, "upperLimit", NO_NUMBER), "upperLimit of 'slide' in 'k' is \"0/4\""),
        (lambda store: rewrite(store, "openFrom", NO_NUMBER), "with 'slide openFrom 0/4'"),
        (lambda store: rewrite(store, "position", NO_NUMBER), "position"),
        (lambda store: rewrite(store, "axisX", ox.BlankNode()), "blank node"),
        (lambda store: rewrite(store, "child", None), "'k' is not whole"),
        (lambda store: rewrite(store, "hasCollisionGeometry", None, BODY), "whole: nothing has '.*0'"),
        (lambda store: rewrite(store, "partOf", None, BODY), "'k' is no tree|'k' is not whole"),
        (
            lambda store: store.add(
                ox.Quad(ox.NamedNode(SLIDE), ox.NamedNode(SDT + "axisX"), ox.Literal(0.5), ASSERTED)
            ),
            "several values",
        ),
        (lambda store: store.remove_graph(ASSERTED), "hold 0 kitchens"),
    ],
)
def test_what_was_lost_or_changed_is_told(drawer: Path, change: Change, message: str) -> None:
    store = store_of(load_twin(drawer))
    change(store)
    with pytest.raises(GraphError, match=message):
        Twin.from_quads(store)


def test_a_figure_from_which_nothing_follows_is_told_by_the_content_hash_alone(drawer: Path) -> None:
    twin = load_twin(drawer)
    hashes = {twin.environment: twin.content_hash(twin.environment)}
    store = store_of(twin)
    assert Twin.from_quads(store, hashes=hashes).state == twin.state
    rewrite(store, "effortLimit", 11.0)
    assert Twin.from_quads(store).mechanism(twin.environment).joint("slide").limits.effort == 11.0
    with pytest.raises(GraphError, match="has the content hash"):
        Twin.from_quads(store, hashes=hashes)


def test_triples_without_graph_names_are_no_twin(drawer: Path) -> None:
    merged = ox.parse(load_twin(drawer).serialize("turtle"), format=ox.RdfFormat.TURTLE)
    with pytest.raises(GraphError, match="named graphs are needed"):
        Twin.from_quads(merged)


def test_a_blank_node_in_an_rdflib_dataset_is_refused(drawer: Path) -> None:
    dataset = load_twin(drawer).to_rdflib()
    dataset.graph(rdflib.URIRef(ASSERTED.value)).add(
        (rdflib.BNode(), rdflib.RDF.type, rdflib.URIRef(SDT + "Body"))
    )
    with pytest.raises(GraphError, match="is no IRI"):
        Twin.from_rdflib(dataset)


@pytest.mark.parametrize(
    ("property_name", "reason"),
    [
        ("hasCore", r"is not whole: it lacks '\S+ a sdt:Box'"),
        ("hasCollisionGeometry", r"is not whole: the type of"),
    ],
)
def test_a_shape_that_is_none_is_told(property_name: str, reason: str) -> None:
    store = store_of(load_twin("b", ["pr2"]))
    shape = next(store.quads_for_pattern(None, ox.NamedNode(SDT + property_name), None)).object
    assert isinstance(shape, ox.NamedNode)
    for quad in list(store.quads_for_pattern(shape, ox.NamedNode(rdflib.RDF.type), None)):
        store.remove(quad)
    with pytest.raises(GraphError, match=reason):
        Twin.from_quads(store)


def test_a_mesh_must_be_where_it_was_and_what_it_was(tmp_path: Path) -> None:
    (tmp_path / "m.stl").write_bytes(b"solid")
    (tmp_path / "k.urdf").write_text(f'<robot name="k">{link("w", MESH)}</robot>', encoding="utf-8")
    store = store_of(load_twin(tmp_path / "k.urdf"))
    (shape,) = Twin.from_quads(store).mechanism(model_iri("k")).bodies[0].collision
    assert shape.mesh_file == str(tmp_path / "m.stl")
    (tmp_path / "m.stl").write_bytes(b"other stuff")
    with pytest.raises(GraphError, match="is another file than the one that was saved"):
        Twin.from_quads(store)
    (tmp_path / "m.stl").unlink()
    with pytest.raises(GraphError, match="of body 'w' of 'k' is not there"):
        Twin.from_quads(store)


MESH = '<mesh filename="m.stl"/>'


def test_moments_that_no_body_has_are_told() -> None:
    store = store_of(load_twin("b", ["pr2"]))
    moments = next(store.quads_for_pattern(None, ox.NamedNode(SDT + "ixx"), None)).subject
    assert isinstance(moments, ox.NamedNode)
    rewrite(store, "ixx", -1.0, moments.value)
    with pytest.raises(GraphError, match="whose moments no body has, cannot be read"):
        Twin.from_quads(store)


def test_an_edit_that_takes_away_what_a_model_needs_is_refused(drawer: Path) -> None:
    with pytest.raises(GraphError, match="'k' is not whole"):
        load_twin(drawer).with_edit(SLIDE, axisX=None)


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("hasHandle", "body/world", "handle 'world' of 'cupboard_drawer' is not fixed to what moves"),
        ("hasHandle", "body/nothing", "handle 'nothing' of 'cupboard_drawer' is not fixed"),
        ("hasJoint", "joint/mount", "joint 'mount' of 'cupboard_drawer' does not move it"),
    ],
)
def test_a_handle_or_joint_that_does_not_move_with_its_container_is_told(
    drawer: Path, name: str, value: str, message: str
) -> None:
    store = store_of(load_twin(drawer))
    subject, other = ox.NamedNode(BODY), ox.NamedNode(f"{model_iri('k')}/{value}")
    store.add(ox.Quad(subject, ox.NamedNode(SDT + name), other, ASSERTED))
    with pytest.raises(GraphError, match=message):
        Twin.from_quads(store)
    with pytest.raises(GraphError, match=message):
        load_twin(drawer).with_edit(BODY, **{name: other.value})
