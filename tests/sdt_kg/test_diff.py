"""Differences between graphs: as sets, as sentences, and as RDF Patch that goes both ways."""

import pyoxigraph as ox
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sdt_kg.errors import GraphError
from sdt_kg.history import TakenAway, changed, obstacle, posed
from sdt_kg.history.diff import difference, quads_of_twin, twin_difference
from sdt_kg.history.patch import Patch, patch_of, read_patch
from sdt_kg.iri import joint_iri
from sdt_kg.mechanism import Geometry, Pose, ShapeType
from sdt_kg.twin import Twin
from tests.small import small_twin

EX = "https://example.org/x/"
IRIS = st.sampled_from([ox.NamedNode(EX + name) for name in "abc"])
TEXTS = st.text(st.characters(exclude_categories=("Cs",)), max_size=8)
LITERALS = st.one_of(
    TEXTS.map(ox.Literal),
    TEXTS.map(lambda text: ox.Literal(text, language="en")),
    st.floats(allow_nan=False).map(ox.Literal),
    st.integers(-5, 5).map(ox.Literal),
    st.booleans().map(ox.Literal),
)
GRAPHS = st.one_of(IRIS, st.just(ox.DefaultGraph()))
QUADS = st.frozensets(st.builds(ox.Quad, IRIS, IRIS, IRIS | LITERALS, GRAPHS), max_size=6)
PANEL = joint_iri("a", "upper_panel_joint")


@settings(max_examples=60)
@given(before=QUADS, after=QUADS)
def test_a_patch_goes_there_and_back_through_its_text(
    before: frozenset[ox.Quad], after: frozenset[ox.Quad]
) -> None:
    patch = read_patch(patch_of(difference(before, after), before, after).to_text())
    assert patch.applied(before) == after
    assert patch.reverse().applied(after) == before
    assert read_patch(patch.reverse().to_text()).reverse() == patch


def test_a_patch_of_two_twins_rebuilds_the_other() -> None:
    before = small_twin("a", ("pr2", "stretch"))
    after = before.with_edit(PANEL, velocityLimit=0.5).at({PANEL: 1.0})
    first, second = list(quads_of_twin(before)), list(quads_of_twin(after))
    patch = patch_of(difference(first, second), first, second)
    back = Twin.from_quads(read_patch(patch.to_text()).applied(first))
    assert back.content_hash(back.environment) == after.content_hash(after.environment)
    assert back.state == after.state


def test_a_patch_that_does_not_fit_is_refused() -> None:
    one = ox.Quad(ox.NamedNode(EX + "a"), ox.NamedNode(EX + "b"), ox.Literal("c"))
    patch = patch_of(difference([], [one]), [], [one])
    with pytest.raises(GraphError, match="is not made for these quads"):
        patch.applied([one])
    with pytest.raises(GraphError, match="is there already"):
        Patch(patch.changes).applied([one])
    with pytest.raises(GraphError, match="its id is not the hash"):
        read_patch(patch.to_text().replace('"c"', '"d"'))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("PA ex <https://example.org/> .", "line 1 of the patch"),
        ("A <https://example.org/a> .", "line 1 of the patch"),
        ("TX .\nA ex:a ex:b ex:c .\nTC .", "line 2 of the patch"),
        ("TX .\n", "ends within a transaction"),
        ("TC .\n", "line 1 of the patch"),
        ("<html>", "line 1 of the patch"),
    ],
)
def test_what_is_no_patch_is_refused(text: str, message: str) -> None:
    with pytest.raises(GraphError, match=message):
        read_patch(text)


def test_an_aborted_transaction_changes_nothing() -> None:
    line = "A <https://example.org/a> <https://example.org/b> <https://example.org/c> ."
    assert read_patch(f"TX .\n{line}\nTA .\n").changes == ()
    assert len(read_patch(f"# a comment\nTX .\n{line}\nTC .\n").changes) == 1


def test_blank_nodes_cannot_be_compared() -> None:
    quad = ox.Quad(ox.BlankNode(), ox.NamedNode(EX + "b"), ox.Literal("c"))
    with pytest.raises(GraphError, match="blank node cannot be compared"):
        difference([quad], [])


def test_people_read_what_moved_what_changed_and_what_came_and_went() -> None:
    twin = small_twin("a", ("pr2", "stretch"))
    cube = (Geometry(ShapeType.BOX, Pose(), (0.2, 0.2, 0.2)),)
    swing = joint_iri("a", "swing_door_joint")
    assert twin_difference(twin, twin).sentences() == []
    assert twin_difference(twin, twin.at({PANEL: 1.0})).sentences() == [
        "folding_door_joint moved from 0 to 2 rad: folding_door closed → open",
        "upper_panel_joint moved from 0 to 1 rad",
    ]
    slow = twin_difference(twin, twin.with_edit(PANEL, velocityLimit=0.5)).sentences()
    assert slow[0] == "upper_panel_joint: velocityLimit 1 → 0.5"
    assert "inferred triples differ" in slow[-1]
    put = obstacle(twin, "box", cube, Pose((0.5, 0.0, 0.1))).applied(twin)
    came = twin_difference(twin, put).sentences()
    assert [text.split(" (")[0] for text in came[:2]] == ["added: box", "added: box_obstacle"]
    assert twin_difference(put, twin).sentences()[0].startswith("removed: box (Body, Obstacle")
    nudged = posed(twin, swing, Pose((0.0, 2.5, 1.0))).applied(twin)
    assert "swing_door_joint origin: y 2 → 2.5" in twin_difference(twin, nudged).sentences()
    (gone, *_) = twin_difference(twin, TakenAway(twin.robots[0]).applied(twin)).sentences()
    assert gone.startswith("removed: pr2 (Robot")
    assert changed(twin, PANEL, velocityLimit=1.0).by.removed == frozenset()


def sentences(before: str, after: str) -> list[str]:
    head = "PREFIX s: <https://example.org/sdt#> PREFIX x: <https://example.org/x/> "
    one, two = (list(ox.parse(head + each + " .", format=ox.RdfFormat.TURTLE)) for each in (before, after))
    return difference(one, two).sentences()


def test_figures_that_differ_are_told_so_that_they_do() -> None:
    assert sentences("x:a x:p 0.48e0", "x:a x:p 0.48000001e0") == ["a: p 0.48 → 0.48000001"]
    assert sentences("x:a s:position 1.41371660e0", "x:a s:position 1.41371670e0") == [
        "a moved from 1.4137166 to 1.4137167"
    ]


def test_texts_that_differ_in_language_or_type_alone_are_told() -> None:
    assert sentences('x:a x:p "tür"', 'x:a x:p "tür"@de') == ['a: p "tür" → "tür"@de']
    whole, decimal = (
        "<http://www.w3.org/2001/XMLSchema#integer>",
        "<http://www.w3.org/2001/XMLSchema#decimal>",
    )
    assert sentences("x:a x:p 1", "x:a x:p 1.0") == [f'a: p "1"^^{whole} → "1.0"^^{decimal}']


def test_one_number_that_is_spelled_in_two_ways_is_no_difference_to_tell() -> None:
    assert sentences('x:a x:p "1"^^<http://www.w3.org/2001/XMLSchema#double>', "x:a x:p 1.0e0") == []


def test_what_was_open_is_told_by_the_threshold_it_had() -> None:
    door = "x:door s:hasJoint x:j . x:j a s:RevoluteJoint ; "
    before, after = (
        door + f"s:openFrom {at}e0 ; s:position {where}e0" for at, where in ((1.4, 1.2), (1.1, 1.15))
    )
    assert sentences(before, after) == [
        "j: openFrom 1.4 → 1.1",
        "j moved from 1.2 to 1.15 rad: door half open → open",
    ]
