"""What `sdt open` says of a store whose verdicts are about different things of one name."""

from pathlib import Path

from predicates.specification.read import read_specification
from services.app import Service
from services.specifications import achieve_task, keep
from services.store.files import SavedVerdicts
from tests.services.pages.test_tasks import TASK
from tests.small import small_twin
from tests.small.before import LiftsBefore
from tests.small.lift import Lifts


def test_models_and_versions_that_are_counted_together_are_told(sdt, tmp_path: Path) -> None:
    twin = small_twin("a", ("pr2",))
    wider = twin.with_edit(twin.container("low_drawer").joint, upperLimit=0.6)
    place = tmp_path / "my verdicts.trig"
    with SavedVerdicts(place) as saved:
        for each in (twin, wider):
            for verdict in Service(each, oracles=Lifts()).achieve("open:low_drawer"):
                saved.add(verdict)
    found = sdt("open", str(place), "--json").json
    assert found["verdicts"] == 2
    (said,) = found["mixed"]
    assert said.startswith("'a' is there as several models of that name: 1 about ")
    assert twin.content_hash(twin.environment)[:12] in said
    assert f"note: {said}" in sdt("open", str(place)).err
    assert f"note: {said}" in sdt("why", str(place)).err
    counts = "SELECT (COUNT(?v) AS ?n) { ?v law:outcome law:Certified }"
    assert f"note: {said}" in sdt("query", str(place), counts).err
    assert not sdt("query", str(place), "SELECT ?d { ?d a sdt:Door }").err


def test_what_is_of_one_model_and_version_is_not_told_apart(sdt, tmp_path: Path) -> None:
    twin = small_twin("a", ("pr2", "stretch"))
    with SavedVerdicts(tmp_path / "kept.trig") as saved:
        for robot in ("pr2", "stretch"):
            for verdict in Service(twin, oracles=Lifts()).achieve("open", robot):
                saved.add(verdict)
    assert sdt("open", str(tmp_path / "kept.trig"), "--json").json["mixed"] == []
    assert not sdt("query", str(tmp_path / "kept.trig"), "SELECT ?v { ?v a law:Verdict }").err


def test_a_changed_record_is_named_and_not_counted(sdt, tmp_path: Path) -> None:
    place = tmp_path / "kept.nq"
    with SavedVerdicts(place) as saved:
        for verdict in Service(small_twin("a", ("pr2",)), oracles=Lifts()).achieve("open"):
            saved.add(verdict)
    told = sdt("open", str(place), "--json").json
    before = place.read_text()
    line = next(each for each in before.splitlines() if "law#satisfiesRequest" in each and '"true"' in each)
    place.write_text(before.replace(line, line.replace('"true"', '"false"')))
    found = sdt("open", str(place), "--json").json
    (damaged,) = found["damaged"]
    assert f"<{damaged}>" in line
    assert (told["damaged"], found["verdicts"]) == ({}, told["verdicts"] - 1)
    assert "note: not counted: the record of" in sdt("open", str(place)).err
    assert {each["outcome"] for each in sdt("why", str(place), "--json").json} > {"DAMAGED"}


def test_a_record_that_says_to_be_something_else_is_named_by_open_and_why(sdt, tmp_path: Path) -> None:
    place = tmp_path / "kept.nq"
    with SavedVerdicts(place) as saved:
        for verdict in Service(small_twin("a", ("pr2",)), oracles=Lifts()).achieve("open"):
            saved.add(verdict)
    verdicts = sdt("open", str(place), "--json").json["verdicts"]
    place.write_text(place.read_text().replace("law#Verdict>", "law#Note>", 1))
    found = sdt("open", str(place), "--json").json
    assert (found["verdicts"], len(found["damaged"])) == (verdicts - 1, 1)
    ((changed, why),) = found["damaged"].items()
    assert "is of no law:Verdict" in why
    (row,) = (each for each in sdt("why", str(place), "--json").json if each["outcome"] == "DAMAGED")
    assert row["question"] == why
    told = sdt("why", changed, "--store", str(place))
    assert told.code == 2
    assert "is of no law:Verdict" in told.err


def test_what_another_version_judged_counts_as_outdated_and_says_what_to_do(sdt, tmp_path: Path) -> None:
    place, twin = tmp_path / "kept.trig", small_twin("a", ("pr2",))
    with SavedVerdicts(place) as saved:
        for oracles, task in ((LiftsBefore(), "open:low_drawer"), (Lifts(), "open:high_drawer")):
            for verdict in Service(twin, oracles=oracles).achieve(task):
                saved.add(verdict)
    found = sdt("open", str(place), "--json").json
    (row,) = found["cases"]
    assert (row["certified"], row["outdated"]) == (1, 1)
    (said,) = found["mixed"]
    assert said.startswith("1 outdated, judged by kinematics 0 (here ")
    assert f"--save {place}, judged anew" in said
    told = {each["question"]: each["outcome"] for each in sdt("why", str(place), "--json").json}
    assert told["Can pr2 open low_drawer in kitchen a?"] == "OUTDATED, WAS CERTIFIED"


def test_the_result_of_a_task_that_another_version_judged_is_listed_as_outdated(sdt, tmp_path: Path) -> None:
    place, service = tmp_path / "kept.trig", Service(small_twin("a", ("pr2",)), oracles=LiftsBefore())
    with SavedVerdicts(place) as saved:
        keep(saved, achieve_task(service, read_specification(service.twin, TASK % 1.5, "task.ttl")))
    listed = {each["question"]: each["outcome"] for each in sdt("why", str(place), "--json").json}
    assert all(said.startswith("OUTDATED, WAS ") for said in listed.values())
    assert any("do '" in question for question in listed)
    assert sdt("open", str(place), "--json").json["task_results"] == 1
    assert ", and 1 result of tasks\n" in sdt("open", str(place)).out
