"""What ontology/README.md shows to who asks questions of their own is true."""

import re
import subprocess
import sys
from contextlib import closing
from pathlib import Path

import pytest

import ontology
from predicates.margins import CLEARANCES
from sdt_kg.annotation import Drive
from sdt_kg.iri import local_name
from sdt_kg.store import Row, checked_query, rows_of
from services import load
from services.app import Policy
from services.ontology_page.spelling import unknown_terms
from services.store.files import SavedVerdicts, readable

README = ontology.path("README.md").read_text(encoding="utf-8")
TIGHTEST, REFUSED, VERSIONS = re.findall(r"```sparql\n(.*?)```", README, re.DOTALL)
(PYTHON,) = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
TERMS = sorted(set(re.findall(r"`[^`]*\b(?:law|sdt):\w+[^`]*`", README)))
NEAREST = r"nearest \((\w+)\): (\w+) and (\w+), ([\d.]+) mm at [\d.]+ s"
LOADED = """
import owlready2
loaded = owlready2.get_ontology("https://example.org/test#").load(fileobj=open("demo.nt", "rb"))
law = loaded.get_namespace("https://example.org/law#")
print(len(law.Diagnosis.instances()), len(law.Judgement.instances()))
print(len(saved.query("SELECT ?verdict { ?verdict a <https://example.org/law#Verdict> }")))
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Has demo.trig: a door that one robot opens, and another, that may not drive, provably does not."""
    place = tmp_path_factory.mktemp("saved")
    with SavedVerdicts(str(place / "demo.trig")) as saved:
        for robot, drive in (("pr2", Drive.OMNI), ("stretch", Drive.FIXED)):
            kitchen = load("b", robots=[robot], policy=Policy(drive=drive))
            saved.add_twin(kitchen.twin)
            for verdict in kitchen.achieve("open:iai_fridge_door", robot=robot):
                saved.add(verdict)
    return place


def asked(folder: Path, query: str) -> list[Row]:
    with closing(readable(str(folder / "demo.trig"))) as store:
        return rows_of(store.query(checked_query(query)))[1]


@pytest.mark.oracle
def test_the_tightest_certificate_is_found_with_the_bodies_that_are_nearest(folder: Path) -> None:
    (row,) = asked(folder, TIGHTEST)
    figures = "SELECT ?name ?at { ?v law:figure ?f . ?f law:name ?name ; law:value ?at }"
    clearances = [float(str(each["at"])) for each in asked(folder, figures) if each["name"] in CLEARANCES]
    assert row["margin"] == min(clearances)
    notes = "SELECT ?note { ?v law:note ?note FILTER(STRSTARTS(?note, 'nearest (')) }"
    told = [re.fullmatch(NEAREST, str(each["note"])) for each in asked(folder, notes)]
    (said,) = (each for each in told if each and row["name"] == f"smallest distance, {each[1]}")
    assert {said[2], said[3]} == {local_name(str(row[each])) for each in ("one", "other")}
    assert float(said[4]) == pytest.approx(1000 * float(str(row["margin"])), abs=0.06)


@pytest.mark.oracle
def test_what_one_robot_is_proved_not_to_open_and_another_opens_is_found(folder: Path) -> None:
    (row,) = asked(folder, REFUSED)
    said = [str(row[each]).rsplit("/", 1)[-1] for each in ("container", "refused", "certified")]
    assert (said, row["proof"]) == (["iai_fridge_door", "stretch", "pr2"], True)


@pytest.mark.oracle
def test_each_verdict_rests_on_the_version_of_three_oracles(folder: Path) -> None:
    rows = asked(folder, VERSIONS)
    assert len(rows) == 2 * 3
    assert {str(row["version"]).split()[0] for row in rows} == {
        "kinematics",
        "satisfied_requests.rq",
        "whole",
    }


@pytest.mark.oracle
def test_what_the_page_does_with_other_tools_works(folder: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", PYTHON + LOADED], cwd=folder, capture_output=True, text=True, check=True
    )
    first, *_, instances, verdicts = done.stdout.splitlines()
    assert (first.split()[0], instances, verdicts) == ("True", "1 2", "2")


@pytest.mark.parametrize("said", [TIGHTEST, REFUSED, VERSIONS, *TERMS])
def test_the_page_names_terms_that_there_are(said: str) -> None:
    assert list(unknown_terms(said)) == []
