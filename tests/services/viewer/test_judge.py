"""The judge behind the 3D page."""

import pickle
from pathlib import Path

import pytest

from services.app import Policy, load
from services.judging.workers.jobs import Done, Task
from services.viewer.judging.judge import Judge
from services.viewer.judging.question import Place, Question


@pytest.mark.oracle
def test_a_kitchen_that_was_saved_with_a_robot_is_asked_about_the_chosen_one(tmp_path: Path) -> None:
    path = tmp_path / "yesterday.nq"
    path.write_text(load("b", ["stretch"]).twin.serialize("nquads").decode())
    question = Question(Place(str(path), "pr2"), "open:sink_area_left_middle_drawer_main")
    task = Task("", "judge", pickle.dumps(question), "pickle", seconds=30.0)
    done = Judge()(task, lambda _: None)
    assert isinstance(done, Done), done
    judged = pickle.loads(done.payload)  # noqa: S301 - of our own judge
    assert judged.outcome == "certified"
    assert judged.motion.robot.endswith("/pr2")


@pytest.mark.oracle
def test_fingers_rub_as_much_as_is_asked_whatever_was_asked_before() -> None:
    judge, place = Judge(), Place("b", "pr2")
    for friction in (None, 0.3, 0.5, None):
        question = Question(place, "open:sink_area_left_middle_drawer_main", friction=friction)
        done = judge(Task("", "judge", pickle.dumps(question), "pickle", seconds=60.0), lambda _: None)
        assert isinstance(done, Done), done
        judged = pickle.loads(done.payload)  # noqa: S301 - of our own judge
        service = load("b", ["pr2"], policy=Policy(friction=friction))
        (verdict,) = service.achieve(question.task, "pr2")
        assert judged.iri == verdict.iri
        notes = [line for section in judged.sections for line in section.lines]
        asked = f"holds that need friction of more than {friction} are refused: as asked"
        assert (asked in notes) is (friction is not None)
