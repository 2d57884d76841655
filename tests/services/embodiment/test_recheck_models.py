"""A store has one model of each name for queries; a recheck takes the one that a verdict is about."""

import json
from dataclasses import replace
from pathlib import Path

import pyoxigraph as ox
import pytest
from click.testing import CliRunner

from predicates.record.inputs import verdict_iri
from sdt_kg.errors import UnknownEntityError
from sdt_kg.iri import ID, local_name
from sdt_kg.load import load_twin
from services.commands.saved.recheck import as_meant
from services.commands.saved.recheck import recheck as recheck_command
from services.dynamics.data import with_forces
from services.embodiment.recheck import Saved, recheck_verdict
from services.embodiment.recheck.saved import by_name
from services.store.files import SavedVerdicts
from services.store.models import REPLACED
from tests.services.embodiment.gantry import FOLDER
from tests.services.embodiment.test_recheck import Kept, kept_in, recheck

pytestmark = pytest.mark.oracle

CHANGES = [('upper="0.5"', 'upper="0.49"'), ("drawer_main_joint", "drawer_top_joint")]
"""A limit, and a name; what is inferred differs, too."""


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Kept:
    return kept_in(tmp_path_factory.mktemp("kept"))


def mixed(kept: Kept, folder: Path, was: str, now: str) -> Path:
    """What was kept, and then another kitchen of that name: queries see but the last."""
    store = folder / "kept.nq"
    store.write_bytes(kept.file.read_bytes())
    (folder / "cell.urdf").write_text((kept.folder / "cell.urdf").read_text().replace(was, now))
    with SavedVerdicts(store) as saved:
        saved.add_twin(load_twin(folder / "cell.urdf", [FOLDER / "gantry.urdf"]))
    return store


@pytest.mark.parametrize(("was", "now"), CHANGES, ids=["of another limit", "of another joint"])
def test_a_certificate_about_a_kitchen_that_was_replaced_is_checked_with_it(
    kept: Kept, tmp_path: Path, was: str, now: str
) -> None:
    found = recheck(mixed(kept, tmp_path, was, now))
    assert found.reasons == ()
    assert found.notes == (
        "models of the saved graphs, with what was kept of cell when another of that name took its place",
    )


def test_a_kitchen_that_comes_back_is_kept_once(kept: Kept, tmp_path: Path) -> None:
    store = mixed(kept, tmp_path, *CHANGES[0])
    before = {each.graph_name for each in ox.parse(path=store) if each.predicate == REPLACED}
    with SavedVerdicts(store) as saved:
        saved.add_twin(load_twin(kept.folder / "cell.urdf", [FOLDER / "gantry.urdf"]))
    after = {each.graph_name for each in ox.parse(path=store) if each.predicate == REPLACED}
    assert (len(before), len(after), before & after) == (1, 1, set())
    assert recheck(store).notes == ("models of the saved graphs",)


@pytest.mark.parametrize(("was", "now"), CHANGES, ids=["of another limit", "of another joint"])
def test_a_certificate_about_another_kitchen_of_that_name_is_not_checked(
    kept: Kept, tmp_path: Path, was: str, now: str
) -> None:
    store = mixed(kept, tmp_path, was, now)
    quads = [each for each in ox.parse(path=store) if each.predicate != REPLACED]
    ox.serialize(quads, store, format=ox.RdfFormat.N_QUADS)
    found = recheck(store)
    assert (found.holds, found.about_others) == (False, True)
    assert "it is about another cell, of content hash" in found.reasons[0]
    asked = CliRunner().invoke(recheck_command, [str(store), "--json"])
    (told,) = json.loads(asked.stdout)
    assert (told["holds"], told["about_other_models"], asked.exit_code) == (None, True, 1)


def test_a_certificate_about_another_robot_than_the_one_that_is_given_is_not_checked(kept: Kept) -> None:
    given = ["--kitchen", str(kept.folder / "cell.urdf"), "--robot", "stretch"]
    asked = CliRunner().invoke(recheck_command, [str(kept.file), *given, "--json"])
    (told,) = json.loads(asked.stdout)
    assert (told["holds"], told["about_other_models"], asked.exit_code) == (None, True, 1)
    assert "it is about gantry (models " in told["reasons"][0]


def test_of_several_robots_that_are_given_each_verdict_is_checked_with_its_own(kept: Kept) -> None:
    robots = ["--robot", "stretch", "--robot", str(FOLDER / "gantry.urdf")]
    given = ["--kitchen", str(kept.folder / "cell.urdf"), *robots]
    asked = CliRunner().invoke(recheck_command, [str(kept.file), *given, "--json"])
    (told,) = json.loads(asked.stdout)
    assert (told["holds"], asked.exit_code) == (True, 0)
    assert told["notes"][0] == f"models {given[1]}, stretch, {robots[-1]}"


def test_the_beginning_of_a_hash_names_the_verdict_that_is_checked(kept: Kept) -> None:
    (whole,) = [each.iri for each in Saved(kept.file).entries()]
    key = local_name(whole)
    for said in (whole, key, key[:12], whole[:-40]):
        asked = CliRunner().invoke(recheck_command, [said, "--store", str(kept.file), "--json"])
        (told,) = json.loads(asked.stdout)
        assert told["of"] == whole
    other = "nobody"
    refused = CliRunner().invoke(recheck_command, [other, "--store", str(kept.file)]).exception
    assert isinstance(refused, UnknownEntityError)
    assert f"no verdict named '{other}'; allowed: {key[:12]}" in str(refused)


def test_a_model_that_is_not_there_is_bad_input_and_speaks_against_no_certificate(kept: Kept) -> None:
    asked = CliRunner().invoke(recheck_command, [str(kept.file), "--kitchen", "b", "--robot", "nobody"])
    assert isinstance(asked.exception, UnknownEntityError)


def test_a_certificate_relative_to_a_class_of_another_version_is_not_checked(kept: Kept) -> None:
    saved = Saved(kept.file)
    (entry,) = saved.entries()
    assert entry.stored is not None
    assert entry.artefact is not None
    inputs = tuple((name, "0" * 64 if name == "tee_class" else value) for name, value in entry.stored.inputs)
    other = replace(entry.stored, inputs=inputs, iri=verdict_iri(inputs))
    found = recheck_verdict(other, entry.artefact, saved.twin)
    assert (found.holds, found.about_others) == (False, True)
    assert "it is relative to D_artic of another version" in found.reasons[0]


@pytest.mark.parametrize("content", ["no base 64", "bm8gemxpYg==", "eJwDAAA="])
def test_a_kitchen_that_was_set_aside_and_is_damaged_is_told(
    kept: Kept, tmp_path: Path, content: str
) -> None:
    store = mixed(kept, tmp_path, *CHANGES[0])
    quads = [
        ox.Quad(each.subject, each.predicate, ox.Literal(content), each.graph_name)
        if each.predicate == REPLACED
        else each
        for each in ox.parse(path=store)
    ]
    ox.serialize(quads, store, format=ox.RdfFormat.N_QUADS)
    found = recheck(store)
    assert not found.holds
    assert "of another cell is damaged" in found.reasons[0]


def test_a_verdict_about_forces_is_checked_with_those_that_are_bundled() -> None:
    forced = with_forces(load_twin("b", ["pr2"]))
    (kitchen, robot) = (f"{ID}b", f"{ID}pr2")
    twin, source = as_meant(by_name)(
        ((kitchen, forced.content_hash(kitchen)), (robot, forced.content_hash(robot)))
    )
    assert source.endswith(", with bundled force data")
    assert twin.content_hash(kitchen) == forced.content_hash(kitchen)
    plain, source = as_meant(by_name)(((kitchen, "another"), (robot, "another")))
    assert "force" not in source
    assert plain.content_hash(kitchen) == load_twin("b").content_hash(kitchen)


def test_a_kitchen_of_which_a_rule_finds_less_leaves_nothing_of_the_other(kept: Kept, tmp_path: Path) -> None:
    store = mixed(kept, tmp_path, '"drawer_handle"', '"drawer_bar"')
    expected = load_twin(tmp_path / "cell.urdf", [FOLDER / "gantry.urdf"])
    models = tuple((model, expected.content_hash(model)) for model in expected.entities.asserted)
    twin, source = Saved(store).twin((models[0], models[1]))
    assert source == "models of the saved graphs"
    assert [twin.content_hash(model) for model, _ in models] == [content for _, content in models]
