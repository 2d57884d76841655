"""What another version judged is outdated: the law has another IRI. Versions are told without oracles."""

import subprocess
import sys
from dataclasses import replace

import pytest

from predicates.record import StoredVerdict, read_verdict, to_record
from services.app import Service
from services.dynamics.oracle import Dynamics
from services.dynamics.robot.bearing import Bearing
from services.embodiment.oracle import WholeBody
from services.physics.oracle import Kinematics
from services.versions import outdated
from tests.small import small_twin
from tests.small.before import LiftsBefore
from tests.small.lift import Lift, Lifts

NOW = {"physics": Kinematics().version, "embodiment": WholeBody().version}


def test_what_the_oracles_of_this_installation_judged_is_not_outdated() -> None:
    assert outdated(NOW) == ()
    assert outdated({"physics": Dynamics().version, "embodiment": Bearing(WholeBody()).version}) == ()


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"physics": "kinematics 0"}, ["kinematics 0 (here "]),
        ({"embodiment": NOW["embodiment"].replace("coal ", "coal 0.")}, ["coal 0."]),
        ({"physics": "dynamics 0, kinematics 0"}, ["dynamics 0 (here ", "kinematics 0 (here "]),
        ({"embodiment": "bearing 0, lift 7"}, ["bearing 0 (here "]),
    ],
)
def test_each_part_of_another_version_is_told(changed: dict[str, str], told: list[str]) -> None:
    found = outdated(NOW | changed)
    assert len(found) == len(told)
    assert all(each.startswith(begin) for each, begin in zip(found, told, strict=True))


@pytest.mark.parametrize("embodiment", [Lift.version, "planner of others 3, pin 0.1", "", "unversioned"])
def test_an_oracle_of_others_has_no_version_here_and_is_not_outdated(embodiment: str) -> None:
    assert outdated({"physics": NOW["physics"], "embodiment": embodiment}) == ()
    assert outdated({"physics": NOW["physics"]}) == ()


def test_the_law_does_not_answer_with_what_is_outdated() -> None:
    service = Service(small_twin("a", ("stretch",)), oracles=LiftsBefore())
    (before,) = service.achieve("open:high_drawer")
    record = to_record(before)
    kept = {record.verdict: read_verdict(record.quads(), record.verdict)}
    assert outdated(dict(before.inputs)) != ()

    def recall(iri: str) -> StoredVerdict | None:
        return kept.get(iri)

    assert replace(service, recall=recall).stored("open:high_drawer") is not None
    assert replace(service, oracles=Lifts(), recall=recall).stored("open:high_drawer") is None


def test_versions_are_told_without_loading_an_oracle() -> None:
    code = (
        "import sys; from services.versions import bearing, dynamics, whole_body;"
        "print(dynamics(), bearing(whole_body()), 'pinocchio' in sys.modules)"
    )
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert said.split() == [*Dynamics().version.split(), *Bearing(WholeBody()).version.split(), "False"]
