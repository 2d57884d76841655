"""A record that was changed and sealed again, and says what its certificate does not show, does not hold."""

from pathlib import Path

import pyoxigraph as ox
import pytest

from sdt_kg.iri import ID, LAW, TEE, graph_iri, local_name
from services.store.records import damage
from tests.services.embodiment.test_recheck import Change, Kept, changed, kept_in, sealed_again, setting

pytestmark = pytest.mark.oracle

Said = tuple[str, ox.NamedNode | ox.Literal]
"""Name of a property of law:, and a value."""

JOINT = ox.NamedNode(ID + "cell/joint/drawer_main_joint")
FORCE = "largest force at the handle"


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Kept:
    return kept_in(tmp_path_factory.mktemp("kept"))


def adding(*said: Said, part: str = "") -> Change:
    """Triples more about the verdict, and about a part that it has then, by a property of law:."""

    def change(store: ox.Store) -> None:
        (verdict,) = {
            each.subject for each in store.quads_for_pattern(None, ox.NamedNode(LAW + "outcome"), None)
        }
        assert isinstance(verdict, ox.NamedNode)
        graph = ox.NamedNode(graph_iri("verdict", local_name(verdict.value)))
        of = ox.NamedNode(f"{verdict.value}/{part}/99")
        if part:
            name, _, more = part.partition("_")
            store.add(ox.Quad(verdict, ox.NamedNode(LAW + name + more.capitalize()), of, graph))
        for property_name, value in said:
            store.add(ox.Quad(of if part else verdict, ox.NamedNode(LAW + property_name), value, graph))

    return change


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (setting(LAW + "drive", "differential"), "drive is differential, by its inputs omni"),
        (setting(LAW + "gripper", "other"), "gripper is other, its certificate's hand"),
        (setting(LAW + "teeClass", TEE + "D_artic_dyn"), "D_artic_dyn, by its inputs"),
        (setting(LAW + "holds", False, "/answer/3"), "its answer of CanPerform is False"),
        (setting(LAW + "note", "drive: fixed", was="drive: omni"), "notes 'drive: fixed'"),
        (
            adding(
                ("name", ox.Literal(FORCE)),
                ("value", ox.Literal(1.0)),
                ("unit", ox.Literal("N")),
                part="figure",
            ),
            f"the verdict has the figure '{FORCE}'",
        ),
        (
            adding(("entity", JOINT), ("value", ox.Literal(0.2)), part="joint_position"),
            "drawer_main_joint at 0.2, its state where the kitchen starts",
        ),
        (adding(("robot", ox.NamedNode(ID + "zebra"))), "it has 2 values of"),
        (adding(("outcome", ox.NamedNode(LAW + "NotCertified"))), "it has 2 values of"),
    ],
    ids=["drive", "gripper", "class", "answer", "note", "figure", "state", "two robots", "two outcomes"],
)
def test_what_a_record_says_that_its_certificate_does_not_is_found(
    kept: Kept, tmp_path: Path, change: Change, said: str
) -> None:
    found = changed(kept, tmp_path, change)
    assert not found.holds
    assert said in "; ".join(found.reasons)


def between(was: str, said: str) -> Change:
    """A body whose name ends so is said to be another one, wherever a smallest distance is to the handle."""

    def change(store: ox.Store) -> None:
        handle = ox.Literal("smallest distance, handle")
        (figure,) = (
            each.subject for each in store.quads_for_pattern(None, ox.NamedNode(LAW + "name"), handle)
        )
        for quad in list(store.quads_for_pattern(figure, ox.NamedNode(LAW + "link"), None)):
            if isinstance(quad.object, ox.NamedNode) and quad.object.value.endswith(was):
                store.remove(quad)
                other = ox.NamedNode(quad.object.value.rsplit("/", 1)[0] + "/" + said)
                store.add(ox.Quad(quad.subject, quad.predicate, other, quad.graph_name))

    return change


def without_note(beginning: str) -> Change:
    """The verdict no more has the notes that begin so."""

    def change(store: ox.Store) -> None:
        for quad in list(store.quads_for_pattern(None, ox.NamedNode(LAW + "note"), None)):
            if isinstance(quad.object, ox.Literal) and quad.object.value.startswith(beginning):
                store.remove(quad)

    return change


def test_what_a_record_says_in_words_is_compared_with_what_is_found_again(kept: Kept, tmp_path: Path) -> None:
    whole = changed(kept, tmp_path, lambda store: None)
    assert whole.holds
    assert whole.notes == ("models of the saved graphs",)
    found = changed(kept, tmp_path, without_note("nearest (handle)"))
    assert found.holds, "words decide nothing"
    assert any(each.startswith("the verdict does not note: nearest (handle)") for each in found.notes)
    found = changed(kept, tmp_path, between("finger", "thumb"))
    assert found.holds, "of two pairs that are as near another processor may find the other"
    (told,) = (each for each in found.notes if each.startswith("'smallest distance, handle' is that of"))
    assert "thumb in the verdict, that of" in told
    assert "thumb" not in told.partition("in the verdict")[2]
    boast = adding(("note", ox.Literal("checked on the real robot")))
    found = changed(kept, tmp_path, boast)
    (rest,) = (each for each in found.notes if each.startswith("notes of the verdict that were not checked"))
    assert "checked on the real robot" in rest


@pytest.mark.parametrize(
    "change",
    [
        setting(LAW + "drive", "differential"),
        setting(LAW + "holds", False, "/answer/3"),
        adding(("robot", ox.NamedNode(ID + "zebra"))),
    ],
)
def test_a_record_that_contradicts_itself_is_damaged_wherever_it_is_read(kept: Kept, change: Change) -> None:
    store = ox.Store()
    store.load(path=str(kept.file), format=ox.RdfFormat.N_QUADS)
    graph = ox.NamedNode(graph_iri("verdict", local_name(kept.iri)))
    assert not damage(store.quads_for_pattern(None, None, None, graph), kept.iri)
    change(store)
    sealed_again(store, kept.iri)
    assert damage(store.quads_for_pattern(None, None, None, graph), kept.iri)
