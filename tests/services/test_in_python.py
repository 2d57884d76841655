"""What people give from Python, where no type checker looks, is told as what is typed on the shell."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyoxigraph as ox
import pytest

from predicates.case import Outcome
from predicates.record import read_verdicts, to_record, write
from predicates.record.stored import read_verdict
from sdt_kg.errors import InputError, NoTruthError
from sdt_kg.motion import Motion
from sdt_kg.task import Task, Verb
from services import load
from services.app import Service
from services.bus.client import Verdicts
from tests.small import FOLDER
from tests.small.lift import Lifts

TIMES = np.linspace(0.0, 6.0, 20)
WAY = 0.45 * np.sin(np.linspace(0.0, np.pi / 2, 20))[:, None] ** 2


def service(robot: str = "pr2") -> Service:
    found = load(FOLDER / "a.urdf", robots=[FOLDER / f"{robot}.urdf"])
    return Service(found.twin, oracles=Lifts())


WRONG = {
    "one robot that is no list": (lambda: load("b", robots="pr2"), r"robots=\['pr2'\]"),
    "one path that is no list": (lambda: load("b", robots=Path("my.urdf")), "a list"),
    "one state that is no list": (lambda: load("b", state="all=open"), r"state=\['all=open'\]"),
    "a task that is none": (lambda: service().achieve({"open": "low_drawer"}), "a task that is a dict"),
    "a state that is none": (lambda: service().at(0.5), "a state that is a float"),
    "a motion's path": (lambda: service().achieve("open:low_drawer", motion="x.npz"), "read_motion"),
    "lists in a motion": (
        lambda: service().achieve("open:low_drawer", motion=Motion("low_drawer_joint", [0, 1], [[0], [1]])),
        "'times' of a motion is a list",
    ),
    "complex numbers in a motion": (
        lambda: service().achieve("open:low_drawer", motion=Motion("low_drawer_joint", TIMES, WAY + 0j)),
        "'values' of a motion is an array of complex128; allowed: of real numbers",
    ),
    "texts in a motion": (
        lambda: service().achieve(
            "open:low_drawer", motion=Motion("low_drawer_joint", TIMES.astype(str), WAY)
        ),
        "'times' of a motion is an array of <U",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_of_another_type_is_told(name: str) -> None:
    ask, said = WRONG[name]
    assert isinstance(ask, Callable)
    with pytest.raises(InputError, match=said):
        ask()


def test_a_task_is_told_as_it_is_typed() -> None:
    met = [str(answer.case.task) for answer in service().at("low_drawer=open").satisfies()]
    assert "open:low_drawer" in met
    assert str(Task(Verb.CLOSE)) == "close"


def test_a_motion_may_name_its_joint() -> None:
    asked = service()
    joint = asked.twin.container("low_drawer").joint
    by_name, by_iri = (
        next(iter(asked.achieve("open:low_drawer", motion=Motion(of, TIMES, WAY))))
        for of in ("low_drawer_joint", joint)
    )
    assert by_name.iri == by_iri.iri
    assert by_name.outcome is Outcome.CERTIFIED
    (answer,) = asked.causes("open:low_drawer", Motion("low_drawer_joint", TIMES, WAY))
    assert answer.holds


def test_a_verdict_is_printed_in_a_line_and_its_reasons() -> None:
    asked = service("stretch")
    (verdict,) = asked.achieve("open:high_drawer")
    first, *reasons = str(verdict).splitlines()
    assert first == "not certified: stretch, open:high_drawer in kitchen a"
    assert reasons
    assert repr(asked.twin) == "<Twin of kitchen a with stretch>"


def test_a_verdict_is_neither_true_nor_false_whatever_its_outcome() -> None:
    for robot in ("pr2", "stretch"):
        for verdict in service(robot).achieve("open"):
            with pytest.raises(
                NoTruthError, match=r"neither; compare its outcome: verdict\.outcome is Outcome"
            ):
                bool(verdict)
            with pytest.raises(NoTruthError, match="stored verdict was taken for true or false"):
                bool(read_verdict(to_record(verdict).quads(), verdict.iri))


def test_what_was_asked_is_no_answer_before_its_verdict_is_taken() -> None:
    asked = service().achieve("open:low_drawer")
    with pytest.raises(NoTruthError, match=r"take its verdict first, \(verdict,\) = …"):
        bool(asked)
    assert repr(asked).startswith("<verdicts, judged as they are asked for")
    assert iter(asked) is asked
    assert next(asked).outcome is Outcome.CERTIFIED
    assert next(asked, None) is None


def test_verdicts_of_a_server_are_neither_true_nor_false() -> None:
    with pytest.raises(NoTruthError, match="each one's outcome"):
        bool(Verdicts((), (), "server"))


def test_a_stored_refusal_answers_again_though_it_is_not_true() -> None:
    asked, store = service("stretch"), ox.Store()
    (first,) = asked.achieve("open:high_drawer")
    write(store, to_record(first))
    again = replace(asked, recall={each.iri: each for each in read_verdicts(store)}.get)
    (second,) = again.achieve("open:high_drawer")
    assert (second.stored, second.outcome) == (True, Outcome.NOT_CERTIFIED)


def test_an_answer_is_true_where_its_relation_holds() -> None:
    (caused,) = service().causes("open:low_drawer")
    (refused,) = service().causes("close:low_drawer")
    assert (caused.holds, refused.holds) == (True, False)
    assert (bool(caused), bool(refused)) == (True, False)
